"""Where checks are made: runs scenes through the weir program and reads what it wrote."""

import copy
import json
import shutil
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "paper"))

import program  # noqa: E402
import scene as scenes  # noqa: E402

SCENES = ROOT / "resources" / "scenes"
GRAVITY, DENSITY = 9.8, 1000.0  # of all scenes


@dataclass(frozen=True)
class Row:
    """One number of a check. Without a limit it is only reported."""

    what: str
    measured: float
    unit: str = ""
    expected: float | None = None
    within: float | None = None  # allowed deviation from what is expected, as a share of it
    below: float | None = None
    above: float | None = None
    note: str = ""

    @property
    def deviation(self):
        return (self.measured - self.expected) / self.expected if self.expected else None

    @property
    def passed(self):
        """None where nothing is demanded. NaN passes nothing."""
        demands = []
        if self.within is not None:
            demands.append(abs(self.measured - self.expected) <= self.within * abs(self.expected))
        if self.below is not None:
            demands.append(self.measured < self.below)
        if self.above is not None:
            demands.append(self.measured > self.above)
        return all(demands) if demands else None


@dataclass(frozen=True)
class Chart:
    """Curves of a check: (label, xs, ys, style) each; the style is matplotlib's, such as "-" or "o"."""

    title: str
    x: str
    y: str
    curves: tuple


@dataclass(frozen=True)
class Outcome:
    rows: list
    charts: tuple = ()
    picture: Path | None = None
    judged: bool = True  # False where the runs tell nothing


class Particles:
    """Positions (m) and velocities (m/s) of one frame, as arrays of shape (n, 3)."""

    def __init__(self, positions, velocities):
        self.positions, self.velocities = positions, velocities


def exported(folder, frame):
    """The particles of a frame of a run that was exported; -1 is the last one."""
    import h5py  # slow to load, and needed by some checks only
    with h5py.File(folder / "particles.vtkhdf") as file:
        root = file["VTKHDF"]
        count, first = root["NumberOfPoints"][root["Steps/PartOffsets"][frame]], root["Steps/PointOffsets"][frame]
        part = slice(first, first + count)
        return Particles(root["Points"][part].astype(float), root["PointData/velocity"][part].astype(float))


class Pending:
    """A result of a run that may not have ended: what it is asked for waits for it, and raises what the run raised."""

    def __init__(self, future):
        self._future = future

    def __getattr__(self, name):
        return getattr(self._future.result(), name)


class Lab:
    """Runs of all checks, that many `jobs` at a time, first come, first served. With `reuse`, results of the very same
    command are taken where they are there already: they may be another build's. `limit`: s that a run may take. `solver`: a
    type of module that takes the place of the solver of all scenes."""

    def __init__(self, weir, out, device, threads, full, say, reuse=False, jobs=1, pictures=True, limit=None, solver=None):
        self.reuse, self._limit, self._solver = reuse, limit, solver
        self._pictures = pictures  # whether those that a check asks for are made
        self._pool = ThreadPoolExecutor(jobs)
        self._lock = threading.Lock()  # of what runs leave here
        self.weir, self.out, self.device, self.threads = weir, Path(out), device, threads
        self.full, self.say = full, say
        self.seconds = 0.0  # of simulation, those of runs that were there already too
        self.machine = None  # until a run has ended

    def of_one_check(self):
        """The same, which counts seconds and knows the machine of its own runs alone."""
        other = copy.copy(self)
        other.seconds, other.machine = 0.0, None
        return other

    def scale(self, quick, full):
        """What to take at this scale."""
        return full if self.full else quick

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._pool.shutdown(cancel_futures=True)

    def run(self, name, scene, settings=None, defaults=False, **options):
        """The results of a scene in resources/scenes, with settings for --set, once they are there: checks start all of
        their runs before they look at the first. With `defaults`: of the scene as if it said nothing of its solver."""
        return Pending(self._pool.submit(self._run, name, scene, settings, defaults, options))

    def _as_run(self, name, scene, defaults):
        """The path of the scene, or of a copy: with `defaults` its fluids say nothing of a solver or a support ratio; this
        lab's solver, if there is one, they have with its defaults, and then no artificial viscosity."""
        if not (defaults or self._solver):
            return scene
        changed = scenes.read(scene)
        for fluid in changed["nodes"].values():
            if fluid["type"] != "ParticleFluid":
                continue
            if defaults:
                fluid["params"].pop("support_ratio", None)
                fluid.get("modules", {}).pop("solver", None)
            if self._solver:
                fluid.setdefault("modules", {}).update(solver={"type": self._solver}, viscosity={"enabled": False})
        made = self.out / "scenes" / f"{name}.json"
        made.parent.mkdir(parents=True, exist_ok=True)
        made.write_text(json.dumps(changed), encoding="utf-8")
        return made

    def _run(self, name, scene, settings, defaults, options):
        options["pictures"] = self._pictures and options.get("pictures", False)
        if not self.reuse:
            shutil.rmtree(self.out / name, ignore_errors=True)
        scene = self._as_run(name, SCENES / f"{scene}.json", defaults)
        result, seconds = program.run(self.weir, scene, self.out / name, settings or {}, self.device, threads=self.threads,
                                      limit=self._limit, **options)
        with self._lock:
            if result.stats:
                self.seconds += result.stats["wall_seconds"]
                self.machine = result.stats["device"]["description"]
            self.say(f"  {name}: {seconds:.0f} s" + (", diverged: " + result.error if result.error else ""))
        return result


def node(frame, name):
    """What a node reported at a frame of a series."""
    return frame["nodes"][name]


def mean(values):
    values = list(values)
    return sum(values) / len(values)


def mean_force(series, name, after):
    """Mean force on each solid of a SemiAnalyticalSFI after a time, {solid: [x, y, z]} in N."""
    frames = [node(frame, name)["solids"] for frame in series if frame["time"] > after + 1e-9]
    return {solid["solid"]: [mean(f[k]["force"][axis] for f in frames) for axis in range(3)]
            for k, solid in enumerate(frames[0])}
