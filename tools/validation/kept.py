"""Results of checks, kept in a file each as each ends: a call that was cut off loses only the check that it was in."""

import json
import os
import shutil
import subprocess
from dataclasses import asdict, dataclass
from pathlib import Path

from lab import Chart, Outcome, Row

CHANGED = "-changed"  # follows a commit that files differ from, as in cmake/WeirCommit.cmake


def commit_of(folder):
    """That of a clone, or "" where the folder is none."""
    def git(*words):
        return subprocess.run(["git", "-C", str(folder), *words], capture_output=True, text=True, check=False).stdout.strip()
    if not shutil.which("git") or git("rev-parse", "--show-toplevel") != str(Path(folder).resolve()):
        return ""
    return git("describe", "--always", "--abbrev=8", "--exclude=*", f"--dirty={CHANGED}")


@dataclass(frozen=True)
class Result:
    """What a check found, and how it was made."""

    outcome: Outcome
    seconds: float  # of simulation
    machine: str | None  # None where no run ended
    day: str  # YYYY-MM-DD


class Kept:
    """The files `checks/KEY.json` of an output folder. Only what the same `commit` made on the same `device` at the same
    `scale` is found again, and where `drawn`, only what was made with pictures."""

    def __init__(self, out, commit, device, scale, drawn):
        self._out = Path(out)
        self._made_by = {"commit": commit, "device": device, "scale": scale}
        self._drawn = drawn

    def _file(self, key):
        return self._out / "checks" / f"{key}.json"

    def write(self, key, result):
        """In place of an earlier one. A file is whole or not there."""
        outcome = result.outcome
        text = json.dumps(
            {"key": key, **self._made_by, "drawn": self._drawn, "day": result.day, "machine": result.machine,
             "seconds": result.seconds, "rows": [asdict(row) for row in outcome.rows],
             "charts": [asdict(chart) for chart in outcome.charts],
             "picture": outcome.picture and os.path.relpath(outcome.picture, self._out)},
            indent=1, ensure_ascii=False, default=lambda array: array.tolist())
        file = self._file(key)
        file.parent.mkdir(parents=True, exist_ok=True)
        unfinished = file.with_suffix(".part")
        unfinished.write_text(text + "\n", encoding="utf-8")
        unfinished.replace(file)

    def read(self, key):
        """None where there is none that counts."""
        try:
            found = json.loads(self._file(key).read_text(encoding="utf-8"))
            if any(found[name] != value for name, value in self._made_by.items()) or (self._drawn and not found["drawn"]):
                return None
            picture = found["picture"] and self._out / found["picture"]
            if picture and not picture.exists():
                return None
            outcome = Outcome([Row(**row) for row in found["rows"]], tuple(Chart(**chart) for chart in found["charts"]), picture)
            return Result(outcome, found["seconds"], found["machine"], found["day"])
        except (OSError, ValueError, KeyError, TypeError):
            return None
