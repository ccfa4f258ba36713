#!/usr/bin/env python3
"""Time of a converged step against the number of particles, from what `weir bench --json` wrote, beside that of three
iterations: a Markdown table, and with --plot a plot.

  converged_steps.py FILE… [--plot FILE]

Files of one device, support ratio and solver are one curve; `dam-default` goes to a tolerance, `dam-packing` makes three
iterations. The exponent is that of ms = a·particles^p from 135,000 particles on.
"""
import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools" / "benchmarks"))
import results as benchmarks  # noqa: E402

SOLVERS = {"dam-default": "to 0.1 %", "dam-packing": "three iterations"}
DEFAULT_RATIO = {"dam-default": "2", "dam-packing": "1.2"}


def ratio_of(command, case):
    """The support ratio that a command sets, or that of the case's scene."""
    found = [word.split("=")[1] for word in command.split() if word.startswith("water.support_ratio=")]
    return found[-1] if found else DEFAULT_RATIO[case]


def curves_of(files):
    """{(device, solver, ratio): {particles: row}}; later files replace earlier ones."""
    curves = {}
    for file in files:
        results = benchmarks.read(file)
        for row in results.rows:
            if row.case in SOLVERS and row.size:
                key = results.device.split(",")[0], SOLVERS[row.case], ratio_of(results.command, row.case)
                curves.setdefault(key, {})[row.particles] = row
    return curves


def batch_ms(row, moment):
    return (row.moment(moment) or {}).get("batch_step_ms_mean")


def table(curves):
    lines = ["| device | solver | H/d | particles | early, ms | late, ms | mean compression, late |", "|---|---|---:|---:|---:|---:|---:|"]
    for (device, solver, ratio), rows in sorted(curves.items()):
        for particles, row in sorted(rows.items()):
            early, late = batch_ms(row, "early"), batch_ms(row, "late")
            left = (row.moments.get("late") or {}).get("compression_mean")
            cells = [f"{value:.3g}" if value else row.trouble or "–" for value in (early, late)]
            lines.append(f"| {device} | {solver} | {ratio} | {particles:,} | {cells[0]} | {cells[1]} | "
                         f"{'–' if left is None else f'{100 * left:.2g} %'} |")
    return lines


def exponents(curves, moment):
    for (device, solver, ratio), rows in sorted(curves.items()):
        found = benchmarks.exponent(series(rows, moment))
        if found is not None:
            yield f"{device}, {solver}, {ratio} d, {moment}: particles^{found:.2f} from 135,000 on"


def series(rows, moment):
    return [(n, batch_ms(row, moment)) for n, row in sorted(rows.items()) if batch_ms(row, moment)]


def draw(curves, file):
    import plot
    figure, axis = plot.plt.subplots(figsize=(7.5, 5))
    colors = {}
    for (device, solver, ratio), rows in sorted(curves.items()):
        color = colors.setdefault((device, ratio), f"C{len(colors)}")
        for moment, style in (("early", ":"), ("late", "-" if solver == SOLVERS["dam-default"] else "--")):
            points = series(rows, moment)
            if points and (moment == "late" or solver == SOLVERS["dam-default"]):
                axis.loglog(*zip(*points), style, color=color, marker="o", markersize=3.5, label=f"{device}, {ratio} d, {solver}, {moment}")
    plot.save(figure, axis, file)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE")
    parser.add_argument("--plot", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    try:
        curves = curves_of(arguments.files)
    except benchmarks.Unusable as problem:
        sys.exit(f"converged_steps: {problem}")
    print("\n".join([*table(curves), "", *exponents(curves, "early"), *exponents(curves, "late")]))
    if arguments.plot:
        draw(curves, arguments.plot)


if __name__ == "__main__":
    main()
