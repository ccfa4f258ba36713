#!/usr/bin/env python3
"""Reads the hardware counters of a late step's kernels with Nsight Compute (ncu) and prints a Markdown table.

    kernel_counters.py build/cuda/bin/weir [--spacing 0.00642857] [--skip 15000]

Needs ncu on the PATH and the right to read counters. Caches are flushed before each kernel and clocks are left as
they are, so times are a little longer than those of a run.
"""

import argparse
import csv
import re
import subprocess
import sys
from pathlib import Path

FIRST = "CountInCells"
SCENE = Path(__file__).resolve().parents[2] / "resources/scenes/benchmark_dam_break.json"

# Counter, heading, factor after conversion to the base unit, digits.
COLUMNS = [
    ("gpu__time_duration.sum", "time (µs)", 1e6, 1),
    ("dram__bytes.sum", "DRAM (MB)", 1e-6, 0),
    ("lts__t_sectors.sum", "L2 (MB)", 32e-6, 0),
    ("smsp__inst_executed.sum", "instructions (10⁶)", 1e-6, 1),
    ("smsp__issue_active.avg.pct_of_peak_sustained_active", "issue (%)", 1, 0),
    ("l1tex__throughput.avg.pct_of_peak_sustained_active", "L1 (%)", 1, 0),
    ("lts__throughput.avg.pct_of_peak_sustained_elapsed", "L2 (%)", 1, 0),
    ("dram__throughput.avg.pct_of_peak_sustained_elapsed", "DRAM (%)", 1, 0),
    ("sm__warps_active.avg.pct_of_peak_sustained_active", "occupancy (%)", 1, 0),
]
UNITS = {"nsecond": 1e-9, "ns": 1e-9, "usecond": 1e-6, "us": 1e-6, "msecond": 1e-3, "ms": 1e-3, "second": 1, "s": 1,
         "byte": 1, "Kbyte": 1e3, "Mbyte": 1e6, "Gbyte": 1e9}


def short_name(kernel):
    """FindNeighbors of void weir::detail::forEachKernel<weir::<unnamed>::FindNeighbors>(…)."""
    plain = re.sub(r"^void |<unnamed>::|\(anonymous namespace\)::|weir::|detail::|cub::", "", kernel)
    found = re.search(r"[kK]ernel<(?:(?:\(int\))?\d+, |CallAlone<|CallWithTeamIndex<)*(\w+)", plain) or re.search(r"(Device\w+)", plain) or re.search(r"(\w+)", plain)
    return found.group(1)


def rows_of(text):
    """Of ncu's CSV: the kernels of one whole step, from one sort to the next."""
    lines = [line for line in text.splitlines() if line.startswith('"')]
    table = list(csv.DictReader(lines))
    if len(table) < 2:
        return []
    units, kernels = table[0], table[1:]
    starts = [k for k, row in enumerate(kernels) if short_name(row["Kernel Name"]) == FIRST]
    # A frame sorts once more, without a step of the solver.
    steps = [kernels[a:b] for a, b in zip(starts, starts[1:]) if any(short_name(row["Kernel Name"]) == "Substitute" for row in kernels[a:b])]
    if not steps:
        return []
    rows = []
    for row in steps[0]:
        values = []
        for counter, _, factor, digits in COLUMNS:
            value = float(row[counter].replace(",", "")) * UNITS.get(units[counter], 1) * factor
            values.append(f"{value:.{digits}f}")
        rows.append([short_name(row["Kernel Name"]), *values])
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weir", help="the program, built with CUDA")
    parser.add_argument("--spacing", default="0.00642857", help="of the particles, m; 0.81 m divided by it, cubed, is their number")
    parser.add_argument("--skip", default="15000", help="kernels before the step that is looked at")
    options = parser.parse_args()
    command = ["ncu", "--clock-control", "none", "--launch-skip", options.skip, "--launch-count", "50", "--csv", "--page", "raw",
               "--metrics", ",".join(counter for counter, *_ in COLUMNS),
               options.weir, "run", str(SCENE), "--device", "cuda", "--quiet", "--set", f"water.spacing={options.spacing}"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        sys.exit("there is no ncu on the PATH: it comes with the CUDA toolkit (Nsight Compute)")
    rows = rows_of(done.stdout)
    if not rows:
        sys.exit(f"ncu gave no counters of a whole step (exit status {done.returncode}):\n{done.stderr or done.stdout}")
    print("| kernel | " + " | ".join(heading for _, heading, *_ in COLUMNS) + " |")
    print("|---" + "|---:" * len(COLUMNS) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
