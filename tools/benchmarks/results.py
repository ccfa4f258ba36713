"""What `weir bench --json` wrote, as rows."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

FORM = 1  # "weir_bench" in the files
SOFT = 0.1  # a mean compression from which a row shows capacity, and not water


class Unusable(Exception):
    """A file that holds no results of weir bench, or none that the page may show."""


@dataclass(frozen=True)
class Row:
    """One case of one size: moments by name; those that diverged have no times."""

    case: str
    size: int | None
    moments: dict
    bytes_per_particle: float | None
    trouble: str | None  # why there are no times

    def moment(self, name):
        moment = self.moments.get(name)
        return moment if moment and "step_ms_median" in moment else None

    def ms(self, name):
        moment = self.moment(name)
        return moment["step_ms_median"] if moment else None

    @property
    def is_soft(self):
        return any(moment.get("compression_mean", 0) > SOFT for moment in self.moments.values())

    @property
    def particles(self):
        """Of the last moment."""
        return [moment["particles"] for moment in self.moments.values()][-1] if self.moments else self.size


@dataclass(frozen=True)
class Results:
    machine: dict
    command: str
    copy_bytes_per_second: float
    rows: list

    @property
    def device(self):
        return self.machine["device"]["description"]

    @property
    def on_cuda(self):
        return self.machine["device"]["back_end"] == "cuda"

    @property
    def key(self):
        """A name of a file for this machine: "nvidia_h100_80gb_hbm3_79_gib"."""
        words = "".join(c.lower() if c.isalnum() else " " for c in self.device).split()
        return "_".join(words)

    def series(self, case, moment, of="step_ms_median"):
        """(particles, ms) of all sizes that have a time, in order."""
        pairs = [(row.particles, (row.moment(moment) or {}).get(of)) for row in self.rows if row.case == case and row.size]
        return sorted(pair for pair in pairs if pair[1])


def row_of(entry):
    moments = {moment["moment"]: moment for moment in entry.get("moments", [])}
    trouble = entry.get("skipped") or entry.get("failed")
    if entry.get("interrupted"):
        trouble = "interrupted"
    for moment in moments.values():
        if "diverged" in moment:
            trouble = f"diverged ({moment['moment']}): {moment['diverged']}"
    return Row(entry["case"], entry.get("size"), moments, entry.get("memory", {}).get("bytes_per_particle"), trouble)


def read(path):
    try:
        written = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as e:
        raise Unusable(f"{path}: {e}") from e
    if not isinstance(written, dict) or written.get("weir_bench") != FORM:
        raise Unusable(f"{path} is not a file that weir bench --json wrote (its weir_bench is not {FORM})")
    return Results(written["machine"], written["command"], written["copy_bytes_per_second"],
                   [row_of(entry) for entry in written["results"]])


def merged(many):
    """One Results for each device, in the order given; where two have the same case and size, the later one's."""
    by_key = {}
    for results in many:
        by_key.setdefault(results.key, []).append(results)
    return [by_last_row(group) for group in by_key.values()]


def by_last_row(group):
    rows = {}
    for results in group:
        for row in results.rows:
            rows[row.case, row.size] = row
    last = group[-1]
    command = "; ".join(dict.fromkeys(results.command for results in group))
    commits = {results.machine["commit"] for results in group}
    if len(commits) > 1:
        raise Unusable(f"results of {last.device} are of several commits, {', '.join(sorted(commits))}: "
                       "measure them with one")
    return Results(last.machine, command, last.copy_bytes_per_second, list(rows.values()))


def exponent(series, least=135_000):
    """p of the law ms = a·particles^p that fits best (least squares of logarithms) from `least` particles on; None of
    fewer than two sizes."""
    points = [(math.log(n), math.log(ms)) for n, ms in series if n >= least]
    if len(points) < 2:
        return None
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    return (sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points))
