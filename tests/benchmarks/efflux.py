#!/usr/bin/env python3
"""Speed of the jet from a hole in a tank, against Torricelli's, with other settings than those of ./dev validate --only efflux.

  efflux.py PROGRAM [--device D] [--threads N] [--spacings 0.01,0.005] [--ratios 1.5,2] [--set PATH=VALUE …] [--out DIR]

Prints a Markdown table with a row for every spacing (m) and support ratio, all with the same settings for --set: by how
much the jet and its core are slower than a fall from the surface, and the coefficients of discharge by the fall of the
level and by the flux. The scene is resources/scenes/validation/efflux.json, whose hole is 8 cm wide.
"""
import argparse
import math
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools" / "validation"))

from lab import GRAVITY, Lab  # noqa: E402
from in_motion import Efflux, line  # noqa: E402


def row(tank, result, spacing, ratio):
    import numpy
    times, level, speed, core, fall, flux = tank.over_time(result, spacing)
    slope, _ = line(times, numpy.sqrt(level))
    ideal = math.pi * tank.hole ** 2 * numpy.sqrt(2 * GRAVITY * level)
    return (f"| {1000 * spacing:g} | {ratio:g} | {100 * (speed.mean() / fall.mean() - 1):+.1f} "
            f"| {100 * (core.mean() / fall.mean() - 1):+.1f} "
            f"| {-slope * (tank.inner / tank.hole) ** 2 / math.sqrt(GRAVITY / 2):.3f} | {(flux / ideal).mean():.3f} |")


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
    arguments = parser.parse_args()
    settings = dict(setting.split("=", 1) for setting in arguments.settings)
    tank = Efflux()
    print("| d (mm) | H/d | jet (%) | its core (%) | discharge, by the level | by the flux |\n" + "|---:" * 6 + "|")
    with tempfile.TemporaryDirectory() as folder, \
            Lab(arguments.program.resolve(), arguments.out or folder, arguments.device, arguments.threads, False,
                lambda text: None) as lab:
        for spacing in arguments.spacings:
            for ratio in arguments.ratios:
                print(row(tank, tank.run(lab, spacing, ratio, settings), spacing, ratio), flush=True)


if __name__ == "__main__":
    main()
