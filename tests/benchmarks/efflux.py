#!/usr/bin/env python3
"""Speed of the jet from a hole in a tank, against Torricelli's, with other settings than those of ./dev validate --only efflux.

  efflux.py PROGRAM [--device D] [--threads N] [--spacings 0.01,0.005] [--ratios 1.5,2] [--set PATH=VALUE …] [--out DIR]
           [--stress]

Prints a Markdown table with a row for every spacing (m) and support ratio, all with the same settings for --set: by how
much the jet and its core are slower than a fall from the surface, and the coefficients of discharge by the fall of the
level and by the flux. The scene is resources/scenes/validation/efflux.json, whose hole is 8 cm wide.

With --stress a second table follows each row: the mean stress of the pairs of particles near the hole, by distance from
its centre, and near its axis, as deviators over the pressure. A particle's part of it, summed in double precision, is
half of that of its pairs, -(p_i + p_j)·V0·|W'|/r·(r ⊗ r)/2 with p in proportion to max(λ - 1, 0).
"""
import argparse
import math
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools" / "validation"))

from lab import Lab  # noqa: E402
from in_motion import Efflux  # noqa: E402


def row(tank, result, spacing, ratio):
    table = tank.over_time(result, spacing)
    _, _, speed, core, fall, _ = table
    by_level, by_flux, _ = tank.discharge(table)
    return (f"| {1000 * spacing:g} | {ratio:g} | {100 * (speed.mean() / fall.mean() - 1):+.1f} "
            f"| {100 * (core.mean() / fall.mean() - 1):+.1f} | {by_level:.3f} | {by_flux:.3f} |")


def pairs(positions, radius):
    """Arrays i, j and x_j - x_i of all pairs nearer to each other than the radius, each of them once."""
    import numpy
    cells = numpy.floor((positions - positions.min(axis=0)) / radius).astype(numpy.int64) + 1
    size = cells.max(axis=0) + 2
    key = (cells[:, 0] * size[1] + cells[:, 1]) * size[2] + cells[:, 2]
    order = numpy.argsort(key, kind="stable")
    ordered, everyone = key[order], numpy.arange(len(key))
    found = []
    for x, y, z in ((x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)):
        there = key + (x * size[1] + y) * size[2] + z
        first, end = numpy.searchsorted(ordered, there, "left"), numpy.searchsorted(ordered, there, "right")
        for k in range(int((end - first).max())):
            i = everyone[first + k < end]
            j = order[first[i] + k]
            found.append(numpy.stack((i, j), axis=1)[i < j])
    i, j = numpy.concatenate(found).T
    way = positions[j] - positions[i]
    near = (way * way).sum(axis=1) < radius * radius
    return i[near], j[near], way[near]


def stress_table(tank, result, spacing, ratio):
    import h5py
    import numpy
    sums = {}
    with h5py.File(result.folder / "particles.vtkhdf") as file:
        root = file["VTKHDF"]
        for frame in [k for k, at in enumerate(result.series) if at["time"] >= 0.3]:
            count, first = root["NumberOfPoints"][root["Steps/PartOffsets"][frame]], root["Steps/PointOffsets"][frame]
            x = root["Points"][first:first + count].astype(float)
            excess = numpy.maximum(root["PointData/density"][first:first + count].astype(float) / 1000 - 1, 0)
            i, j, way = pairs(x, ratio * spacing)
            r = numpy.linalg.norm(way, axis=1)
            weight = -(excess[i] + excess[j]) * (1 - r / (ratio * spacing)) ** 2 / r
            stress = numpy.zeros((len(x), 3, 3))
            each = weight[:, None, None] * way[:, :, None] * way[:, None, :]
            numpy.add.at(stress, i, each)
            numpy.add.at(stress, j, each)
            aside = numpy.hypot(x[:, 0], x[:, 2])
            out = numpy.stack((x[:, 0], 0 * aside, x[:, 2]), axis=1) / aside[:, None]
            # Along r, y and around the axis; and the shear of r and y.
            rr, yy = numpy.einsum("na,nab,nb->n", out, stress, out), stress[:, 1, 1]
            parts = numpy.stack((rr, yy, numpy.trace(stress, axis1=1, axis2=2) - rr - yy,
                                 numpy.einsum("na,nab->nb", out, stress)[:, 1]), axis=1)
            far = numpy.hypot(aside, x[:, 1] - tank.floor)
            above = x[:, 1] > tank.floor + 1.5 * spacing  # without the layer at the floor
            shells = [(f"{100 * a:g} to {100 * b:g} cm from the hole", above & (far > a) & (far < b))
                      for a, b in ((0.03, 0.05), (0.05, 0.08), (0.08, 0.12))]
            for name, there in [*shells, ("3 to 8 cm above it", above & (aside < 0.025) & (far > 0.03) & (far < 0.08))]:
                sums[name] = sums.get(name, 0) + parts[there].sum(axis=0)
    print(f"\n| d = {1000 * spacing:g} mm, H = {ratio:g}d | rr | yy | around | ry | norm |\n" + "|---|" + "---:|" * 5)
    for name, (rr, yy, around, ry) in sums.items():
        pressure = -(rr + yy + around) / 3
        deviator = [(part + pressure) / pressure for part in (rr, yy, around)]
        norm = math.sqrt(sum(part * part for part in deviator) / 2 + (ry / pressure) ** 2)
        print(f"| {name} | " + " | ".join(f"{part:+.3f}" for part in [*deviator, ry / pressure]) + f" | {norm:.3f} |")
    print(flush=True)


def numbers(text):
    return [float(part) for part in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="the program weir")
    parser.add_argument("--device", default="auto")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--spacings", type=numbers, default=[0.01], metavar="M,…")
    parser.add_argument("--ratios", type=numbers, default=[1.5], metavar="R,…")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", dest="settings")
    parser.add_argument("--out", metavar="DIR", help="keep the runs' files there")
    parser.add_argument("--stress", action="store_true", help="print the pairs' stress near the hole, too")
    arguments = parser.parse_args()
    settings = dict(setting.split("=", 1) for setting in arguments.settings)
    tank = Efflux()
    print("| d (mm) | H/d | jet (%) | its core (%) | discharge, by the level | by the flux |\n" + "|---:" * 6 + "|")
    with tempfile.TemporaryDirectory() as folder, \
            Lab(arguments.program.resolve(), arguments.out or folder, arguments.device, arguments.threads, False,
                lambda text: None) as lab:
        for spacing in arguments.spacings:
            for ratio in arguments.ratios:
                result = tank.run(lab, spacing, ratio, settings)
                print(row(tank, result, spacing, ratio), flush=True)
                if arguments.stress:
                    stress_table(tank, result, spacing, ratio)


if __name__ == "__main__":
    main()
