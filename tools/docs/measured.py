#!/usr/bin/env python3
"""Writes the numbers of the documentation from what was measured, so that no page says another than the tables.

    tools/docs/measured.py            writes them into the pages
    tools/docs/measured.py --check    ends with 1 where a page has others

A page holds them between `<!-- measured: NAME -->` and `<!-- end of measured -->`. They come
from the tables of engineering/benchmarks.md and engineering/validation.md, which `./dev bench --docs` and `./dev validate --docs` write.
"""

import re
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "benchmarks"))
import results as benchmarks  # noqa: E402

BLOCK = re.compile(r"(<!-- measured: (\w+) -->\n).*?(<!-- end of measured -->)", re.DOTALL)


def tables(text):
    """(heading, heads, rows) of each table; the rows are dicts by head."""
    heading, heads, rows = "", None, []
    for line in [*text.split("\n"), ""]:
        if line.startswith("|"):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            if heads is None:
                heads = cells
            elif not set(line) <= set("|-: "):
                rows.append(cells)
            continue
        if heads:
            yield heading, heads, rows
            heads, rows = None, []
        if line.startswith("#"):
            heading = line.lstrip("# ")


@dataclass
class Device:
    """What the benchmarks' page says of one device."""

    name: str
    date: str
    rows: list  # of the table of cases, as dicts
    others: list  # of the table beside other programs

    @property
    def is_gpu(self):
        return "NVIDIA" in self.name

    def of(self, case):
        return [row for row in self.rows if row["case"] == case and row["late, batch (ms)"] not in ("", "–")]


def measured():
    text = (ROOT / "engineering" / "benchmarks.md").read_text(encoding="utf-8")
    text = text[text.index("## Results of `weir bench`"):]
    dates = dict(re.findall(r"### (.*)\n\n.*, (\d{4}-\d\d-\d\d)\. A copy", text))
    devices = {}
    for heading, heads, rows in tables(text):
        device = devices.setdefault(heading, Device(heading, dates[heading], [], []))
        named = [dict(zip(heads, row)) for row in rows]
        if heads[0] == "case":
            device.rows += named
        elif "times faster" in heads:
            device.others += named
    return list(devices.values())


def percent(share):
    return f"{100 * float(share):.2g} %"


def number(text):
    return float(text.replace(",", ""))


def short(name):
    """NVIDIA H100; AMD EPYC, 4 threads, avx2."""
    name = re.sub(r", \d+ GiB$", "", name).replace("(R)", "").replace(" Processor", "")
    return re.sub(r"(H\d00).*", r"\1", name)


def speed(devices):
    """Steps of the dam break by device and size."""
    lines = ["| device | particles | ms a step | mean compression | bytes a particle |", "|---|---:|---:|---:|---:|"]
    for device in devices:
        for row in device.of("dam"):
            mark = " **(soft)**" if float(row["compression"]) > benchmarks.SOFT else ""
            lines.append(f"| {short(device.name)} | {row['particles']} | {row['late, batch (ms)']} | {percent(row['compression'])}{mark} | "
                         f"{row['memory (B a particle)']} |")
    dates = sorted({device.date for device in devices})
    return [*lines, "", f"Measured on {' and '.join(dates)}; means over steps without a wait between them."]


def beside(devices):
    """Late steps of other programs."""
    gpu = next(device for device in devices if device.is_gpu)
    lines = ["| particles | Weir, ms | PeriDyNo, ms | times faster |", "|---:|---:|---:|---:|"]
    for row in gpu.others:
        lines.append(f"| {row['particles']} | {row['Weir'].split(', ')[1]} | {row['PeriDyNo'].split(', ')[1]} | {row['times faster']} |")
    return lines


def validation_rows():
    """(check, what, demanded, [[expected, measured, off, verdict] of each device])."""
    text, found = (ROOT / "engineering" / "validation.md").read_text(encoding="utf-8"), []
    for check, heads, rows in tables(text[text.index("<!-- The rest is made by"):]):
        for row in rows:
            if heads[2] == "demanded":  # devices side by side
                found.append((check, row[0], row[2], [row[i:i + 4] for i in range(3, len(row), 4)]))
            else:
                found.append((check, row[0], row[5], [[row[1], row[2], row[4], row[6]]]))
    return found


def deviation(groups):
    """Per cent by which the device that is farthest off misses what is expected; None where nothing is."""
    offs = [abs(float(group[2].removesuffix(" %"))) for group in groups if group[2].endswith("%")]
    return max(offs) if offs else None


ANSWERS = {
    "Settled volume": "the volume that was filled", "A block at rest": "no motion", "Hydrostatic pressure": "weight, and ρg·h²/2 on a wall",
    "The default solver": "0.2 % of compression, and weight",
    "Buoyancy": "Archimedes", "A tank that moves": "a tank that stands", "Energy": "a sum that may only fall",
    "A tank that turns": "the parabola ω²r²/2g", "Efflux from a hole": "Torricelli's law", "The front of a dam break": "an experiment",
    "A full goblet": "no particle lost in 10 s", "A small wave": "potential flow", "Waves in a round tank": "potential flow", "Water in a U": "potential flow",
    "A lid-driven cavity": "Ghia, Ghia and Shin (1982)", "A drop": "a sphere",
    "Pressure in drops": "Laplace's law", "A drop that swings": "Rayleigh's period", "Drops on a table": "the angle that is given",
    "Hydrostatic pressure, by default": "weight, and ρg·h²/2 on a wall", "Buoyancy, by default": "Archimedes",
    "A tank that turns, by default": "the parabola ω²r²/2g", "Efflux from a hole, by default": "Torricelli's law",
    "The front of a dam break, by default": "an experiment",
    "Momentum": "a free blob", "A rope of honey": "the theory of slender ropes",
    "Poiseuille flow": "its parabola", "Couette flow": "a straight line", "Taylor–Green vortices": "exponential decay",
    "Added mass": "a closed form", "Draught of floating bodies": "Archimedes", "Attitudes of a floating beam": "the least energy", "A ball that heaves": "potential flow",
    "Water entry of a wedge": "a similarity solution",
}


def validated(_):
    """One line for each check."""
    lines = ["| check | compared with | demands | met | largest deviation |", "|---|---|---:|---:|---|"]
    checks = {}
    for check, what, demanded, groups in validation_rows():
        if demanded != "–":
            checks.setdefault(check, []).append((what, deviation(groups), any("FAIL" in group[3] for group in groups)))
    for check, rows in checks.items():
        off = max((row for row in rows if row[1]), key=lambda row: row[1], default=None)
        met = sum(not failed for _, _, failed in rows)
        lines.append(f"| {check} | {ANSWERS.get(check, '–')} | {len(rows)} | {met if met == len(rows) else f'**{met}**'} | " +
                     (f"{off[1]:.2g} %: {off[0]} |" if off else "– |"))
    return lines


def verdicts():
    demands = [any("FAIL" in group[3] for group in groups) for _, _, demanded, groups in validation_rows() if demanded != "–"]
    return demands.count(False), len(demands)


def value(what, column=1, device=0):
    return next(groups[device][column] for _, name, _, groups in validation_rows() if name == what)


def facts(devices):
    gpu = next(device for device in devices if device.is_gpu)
    dam = {number(row["particles"]): row for row in gpu.of("dam")}
    large, most = dam[2_000_376], dam[max(dam)]
    faster = [float(row["times faster"]) for row in gpu.others]
    times = [row["late, batch (ms)"] for device in devices if not device.is_gpu for row in device.of("dam") if number(row["particles"]) == 135_252]
    times.sort(key=float)
    met, demands = verdicts()
    bench, validate = "[measured by `weir bench`](docs/performance.md)", "[measured by `./dev validate`](docs/validation.md)"
    volume = value("height of the settled water, H = 2.0d, packing", 2).lstrip("-+")
    force = value("force on the wall, d = 20 mm, 40 iterations", 2).lstrip("-+")
    return [
        f"- **Speed.** A step of {large['particles']} particles takes {large['late, batch (ms)']} ms on an H100, {percent(large['compression'])} compressed. One of 135,252 takes {times[0]} to "
        f"{times[-1]} ms on four CPU threads. These are the paper's settings, which cost less than the defaults ({bench}).",
        f"- **Against PeriDyNo**, the paper's own code: {min(faster):.0f} to {max(faster):.0f} times as fast on the same GPU with the same settings ({bench}).",
        f"- **Memory.** {large['memory (B a particle)']} bytes a particle. {most['particles']} particles fit on one H100, at {most['late, batch (ms)']} ms a "
        f"step. The three iterations of that run leave its water {percent(most['compression'])} compressed: it shows capacity, not accuracy ({bench}).",
        f"- **Volume.** Settled water keeps its height to {volume} at the default support ratio, with 90 iterations ({validate}).",
        f"- **Validation.** {met} of {demands} demands are met. With 40 iterations the force of 30 cm of water on a wall is off by {force} ({validate}).",
    ]


MAKERS = {"speed": speed, "beside": beside, "validated": validated, "facts": facts}


def filled(text, devices):
    def made(match):
        if match[2] not in MAKERS:
            raise SystemExit(f"measured: there is no '{match[2]}': {', '.join(MAKERS)}")
        return match[1] + "\n" + "\n".join(MAKERS[match[2]](devices)) + "\n\n" + match[3]

    return BLOCK.sub(made, text)


def stale(write):
    """The pages whose numbers are others than those measured."""
    devices, found = measured(), []
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        text = path.read_text(encoding="utf-8")
        new = filled(text, devices)
        if new != text:
            found.append(path.relative_to(ROOT).as_posix())
            if write:
                path.write_text(new, encoding="utf-8")
    return found


def main():
    check = sys.argv[1:] == ["--check"]
    found = stale(write=not check)
    for name in found:
        print(f"{name}: {'has other numbers than those measured: run tools/docs/measured.py' if check else 'written'}")
    return 1 if check and found else 0


if __name__ == "__main__":
    sys.exit(main())
