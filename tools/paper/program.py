"""Calls the weir program and reads what it wrote. Results of a run lie in one folder:

  frames/frame_00000.png …   stats.json   series.jsonl   particles.vtkhdf   command.txt   error.txt (if it failed)
"""

import hashlib
import json
import shlex
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

SIMULATION_FAILED = 4  # exit code: the simulation diverged, which is a result


class RunFailed(Exception):
    """The program could not do what it was asked for."""


@dataclass
class Result:
    """What one run left."""

    folder: Path

    @property
    def stats(self):
        path = self.folder / "stats.json"
        return json.loads(path.read_text()) if path.exists() else {}

    @property
    def series(self):
        path = self.folder / "series.jsonl"
        return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []

    @property
    def error(self):
        """What the program said when the simulation diverged, or ""."""
        path = self.folder / "error.txt"
        return path.read_text().strip() if path.exists() else ""

    def picture(self, frame):
        """The picture of this frame, or the last before it where the run ended earlier; None without any."""
        pictures = sorted((self.folder / "frames").glob("frame_*.png"))
        return pictures[min(frame, len(pictures) - 1)] if pictures else None


def command_line(weir, scene, folder, settings, device, pictures=True, frames=None, threads=None,
                 export=False):
    command = [str(weir), "run", str(scene), "--device", device, "--quiet"]
    for path, value in settings.items():
        command += ["--set", f"{path}={value}"]
    if frames is not None:
        command += ["--frames", str(frames)]
    if threads is not None:
        command += ["--threads", str(threads)]
    if pictures:
        command += ["--images", str(folder / "frames")]
    if export:
        command += ["--export", str(folder / "particles.vtkhdf")]
    return command + ["--stats", str(folder / "stats.json"), "--series", str(folder / "series.jsonl")]


def record_of(scene, settings, device, threads=None, **options):
    """What decides a run's results: neither where files lie nor, on the CPU, how many threads there are."""
    del threads
    digest = hashlib.sha256(Path(scene).read_bytes()).hexdigest()
    command = command_line("weir", Path(scene).name, Path("."), settings, device, **options)
    return f"{shlex.join(command)}\n# scene {digest}\n"


class TookTooLong(ValueError):
    """A run was ended by its limit."""


def run(weir, scene, folder, settings, device, limit=None, **options):
    """Runs, or finds the results of the very same command on the same scene there. Returns (result, seconds). Raises
    TookTooLong after `limit` seconds."""
    folder = Path(folder)
    command = command_line(weir, scene, folder, settings, device, **options)
    record = record_of(scene, settings, device, **options)
    if (folder / "command.txt").exists() and (folder / "command.txt").read_text() == record:
        return Result(folder), 0.0
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    started = time.monotonic()
    try:
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False,
                              timeout=limit)
    except subprocess.TimeoutExpired as e:
        raise TookTooLong(f"not done after {limit:g} s: {folder.name}") from e
    if done.returncode not in (0, SIMULATION_FAILED):
        raise RunFailed(f"exit code {done.returncode} of\n  {shlex.join(command)}\n{done.stderr}")
    if done.returncode == SIMULATION_FAILED:
        (folder / "error.txt").write_text(done.stderr)
    (folder / "command.txt").write_text(record)  # last: a folder without it is not complete
    return Result(folder), time.monotonic() - started
