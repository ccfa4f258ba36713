#!/usr/bin/env python3
"""How long a step takes on so many GPUs: a model with four numbers, fitted to what was measured, and what it foretells.

A step of n particles a rank takes

    t(N, R) = a + b N/R + c h(N, R) + d log2(R)

with N particles on R ranks, and h of other ranks' particles beside a rank's own. a is what a step costs with no particles, b one
particle, c one particle of a halo (all its exchanges and what waits for them), d what a doubling of the ranks adds: waits of
hosts for each other. Block is a cube of particles on a lattice, cut into slabs of cells 1.2 spacings thick:

    h = 1.2 N^(2/3) min(R - 1, 2)

Blocks in place of slabs, which Weir does not have, would have six faces of a rank's own size: h = 7.2 (N/R)^(2/3).
"""

import argparse
import csv
from pathlib import Path

import numpy as np

DATA = Path(__file__).parents[2] / "engineering/benchmarks/ranks_h200.csv"
LAYER = 1.2  # particles across a layer of cells


def halo_of_slabs(particles: float, ranks: int) -> float:
    return LAYER * particles ** (2 / 3) * min(ranks - 1, 2)


def halo_of_blocks(particles: float, ranks: int) -> float:
    return 6 * LAYER * (particles / ranks) ** (2 / 3) if ranks > 1 else 0.0


def terms(particles: float, ranks: int, halo=halo_of_slabs) -> np.ndarray:
    """What a, b, c and d are multiplied by, in millions of particles."""
    return np.array([1.0, particles / ranks / 1e6, halo(particles, ranks) / 1e6, np.log2(ranks)])


def fitted(points: list[tuple[int, int, float]]) -> np.ndarray:
    """a in ms, b and c in ns a particle, d in ms, by least squares of relative errors."""
    rows = np.array([terms(particles, ranks) / ms for particles, ranks, ms in points])
    return np.linalg.lstsq(rows, np.ones(len(points)), rcond=None)[0]


def read(path: Path) -> list[tuple[int, int, float]]:
    with path.open() as file:
        return [(int(row["particles"]), int(row["gpus"]), float(row["step_ms"])) for row in csv.DictReader(file)]


def print_points(points, model) -> None:
    print("| particles | GPUs | measured, ms | model, ms | error |\n|---:|---:|---:|---:|---:|")
    for particles, ranks, ms in points:
        told = terms(particles, ranks) @ model
        print(f"| {particles:,} | {ranks} | {ms:.2f} | {told:.2f} | {told / ms - 1:+.1%} |")


def print_prospects(model) -> None:
    print("\n| particles a GPU | GPUs | step, ms | own particles | halo | waits | efficiency | with blocks |")
    print("|---:|---:|---:|---:|---:|---:|---:|---:|")
    for own in (23e6, 100e6):
        alone = terms(own, 1) @ model
        for ranks in (2, 4, 8, 64, 1024):
            _, of_own, of_halo, of_waits = terms(own * ranks, ranks) * model
            step = terms(own * ranks, ranks) @ model
            blocks = terms(own * ranks, ranks, halo_of_blocks) @ model
            print(f"| {own / 1e6:.0f} million | {ranks} | {step:.1f} | {of_own:.1f} | {of_halo:.1f} | {of_waits:.1f} "
                  f"| {alone / step:.2f} | {alone / blocks:.2f} |")


def main() -> None:
    parser = argparse.ArgumentParser(description="Fits a model of the time of a step to measured ones on several GPUs.")
    parser.add_argument("data", nargs="?", type=Path, default=DATA, help="a CSV with particles, gpus and step_ms")
    points = read(parser.parse_args().data)
    model = fitted(points)
    print("a = {:.3f} ms, b = {:.3f} ns, c = {:.2f} ns, d = {:.3f} ms\n".format(*model))
    print_points(points, model)
    print_prospects(model)


if __name__ == "__main__":
    main()
