"""A check of small waves, by potential flow."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

from lab import GRAVITY, SCENES, Chart, Outcome, Row, exported

LENGTH, DEPTH = 1.0, 0.4  # m, of the tank


@dataclass(frozen=True)
class Wave:
    """A standing wave of that many halves of a length, and how high it gets, in spacings of its fluid (m)."""

    spacing: float
    halves: int = 1
    height: float = 1.5

    @property
    def number(self):
        return self.halves * math.pi / LENGTH  # 1/m

    @property
    def period(self):
        """Of potential flow, s."""
        return 2 * math.pi / math.sqrt(GRAVITY * self.number * math.tanh(self.number * DEPTH))

    def mode(self, positions):
        """Velocities where the surface moves by 1 m/s, as an array of shape (n, 3)."""
        import numpy
        along, up = self.number * positions[:, 0], self.number * positions[:, 1]
        return numpy.stack([-numpy.sin(along) * numpy.cosh(up), numpy.cos(along) * numpy.sinh(up), 0 * up],
                           axis=1) / math.sinh(self.number * DEPTH)

    def name(self, solver):
        return f"{solver}_{self.spacing}_{self.halves}_{self.height}"


def with_wave(lab, wave, rest, name):
    """The path of the scene, without its ending, whose water has come to rest in a run and then gets the velocities of the
    mode."""
    import numpy
    start = exported(rest.folder, 0).positions
    stem = lab.out.resolve() / f"wave_{name}"
    speed = wave.height * wave.spacing * 2 * math.pi / wave.period
    numpy.savetxt(f"{stem}.csv", numpy.hstack([start, speed * wave.mode(start)]), delimiter=",", comments="",
                  header="x,y,z,vx,vy,vz")
    scene = json.loads((SCENES / "validation" / "small_wave.json").read_text(encoding="utf-8"))
    scene["nodes"]["fill"] = {"type": "ParticleFile", "params": {"file": f"{stem}.csv"}}
    Path(f"{stem}.json").write_text(json.dumps(scene), encoding="utf-8")
    return str(stem)


def amplitudes(wave, result):
    """Of the mode at each frame, m/s."""
    found = []
    for k in range(len(result.series)):
        at = exported(result.folder, k)
        shape = wave.mode(at.positions)
        found.append(float((at.velocities * shape).sum() / (shape * shape).sum()))
    return found


def zeros_of(times, values):
    """Where they change their sign."""
    return [times[k] + (times[k + 1] - times[k]) * values[k] / (values[k] - values[k + 1]) for k in range(len(values) - 1)
            if (values[k] > 0) != (values[k + 1] > 0)]


def period_of(times, values):
    """Twice the mean way between zeros."""
    zeros = zeros_of(times, values)
    return 2 * (zeros[-1] - zeros[0]) / (len(zeros) - 1)


def small_wave(lab):
    """Standing waves without viscosity in a tank 1 m long and 40 cm deep: the first mode, 1.5 spacings high, of coarser fluid, and
    half and twice as high; and the second mode. Closed form: ω² = g·k·tanh(k·h), and no loss. TwoProjections is held to it, the
    default solver stands beside."""
    fine = lab.scale(0.025, 0.01)
    main = Wave(fine)
    cases = [("", main, "TwoProjections", 0.005), ("", main, "AcceleratedSolver", None),
             (", 20 spacings long", Wave(LENGTH / 20), "TwoProjections", 0.02),
             (", 0.75 spacings high", Wave(fine, height=0.75), "TwoProjections", 0.01),
             (", 3 spacings high", Wave(fine, height=3), "TwoProjections", 0.01),
             (" of the second mode", Wave(fine, halves=2), "TwoProjections", 0.01)]

    def settings_of(wave, solver):
        return {"let.spacing": str(wave.spacing), "water.solver.type": solver}

    rests = {(wave.spacing, solver): lab.run(f"small_wave/rest_{solver}_{wave.spacing}", "validation/small_wave",
                                             settings_of(wave, solver), export=True, frames=0)
             for _, wave, solver, _ in cases}
    runs = [lab.run(f"small_wave/{wave.name(solver)}",
                    with_wave(lab, wave, rests[wave.spacing, solver], wave.name(solver)), settings_of(wave, solver), export=True)
            for _, wave, solver, _ in cases]
    rows, curves = [], [("closed form", [main.period * k / 100 for k in range(131)],
                         [math.cos(2 * math.pi * k / 100) for k in range(131)], "k-")]
    for (what, wave, solver, within), run in zip(cases, runs):
        times, values = [frame["time"] for frame in run.series], amplitudes(wave, run)
        later = [abs(v) for t, v in zip(times, values) if 0.75 * wave.period < t < 1.25 * wave.period]
        rows += [Row(f"period{what}, {solver}", period_of(times, values), "s", wave.period, within),
                 Row(f"share of the amplitude that a period takes{what}, {solver}", 1 - max(later) / values[0],
                     below=0.03 if wave is main and within else None)]
        if wave is main:
            curves.append((solver, times, [v / values[0] for v in values], "--"))
    return Outcome(rows, (Chart("A small wave", "time (s)", "amplitude", tuple(curves)),))
