"""Checks of small waves, by potential flow."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

from lab import GRAVITY, SCENES, Chart, Outcome, Row, exported

LENGTH, DEPTH = 1.0, 0.4  # m, of the tank
RADIUS, ROUND_DEPTH = 0.25, 0.2  # m, of the round one


class Standing:
    """What all standing waves have: by their wave number `number` in 1/m, in water of `depth` m, so high in spacings of `spacing` m."""

    @property
    def period(self):
        """Of potential flow, s."""
        return 2 * math.pi / math.sqrt(GRAVITY * self.number * math.tanh(self.number * self.depth))


@dataclass(frozen=True)
class Wave(Standing):
    """A wave of that many halves of a length along the tank."""

    spacing: float
    halves: int = 1
    height: float = 1.5
    scene, depth = "small_wave", DEPTH

    @property
    def number(self):
        return self.halves * math.pi / LENGTH

    def mode(self, positions):
        """Velocities where the surface moves by 1 m/s, as an array of shape (n, 3)."""
        import numpy
        along, up = self.number * positions[:, 0], self.number * positions[:, 1]
        return numpy.stack([-numpy.sin(along) * numpy.cosh(up), numpy.cos(along) * numpy.sinh(up), 0 * up],
                           axis=1) / math.sinh(self.number * self.depth)

    def name(self, solver):
        return f"{solver}_{self.spacing}_{self.halves}_{self.height}"


def bessel(order, x):
    """J of a whole order at numbers of at most 10 or so, by its power series."""
    term = (x / 2) ** order / math.factorial(order)
    total = term
    for k in range(1, 40):
        term = term * -(x / 2) ** 2 / (k * (k + order))
        total = total + term
    return total


def slope_of_bessel(order, x):
    """J' there."""
    return -bessel(1, x) if order == 0 else (bessel(order - 1, x) - bessel(order + 1, x)) / 2


def first_extreme(order):
    """The smallest x > 0 with J'(x) = 0, by bisection."""
    low, high = order + 0.5, order + 4.0
    for _ in range(60):
        middle = (low + high) / 2
        same = (slope_of_bessel(order, middle) > 0) == (slope_of_bessel(order, low) > 0)
        low, high = (middle, high) if same else (low, middle)
    return low


@dataclass(frozen=True)
class RoundWave(Standing):
    """A wave in the round tank, J(k·r)·cos(turns·θ): of one turn, water goes from side to side; of none, it rises in the middle."""

    spacing: float
    turns: int = 1
    height: float = 1.5
    scene, depth = "round_tank", ROUND_DEPTH

    @property
    def number(self):
        return first_extreme(self.turns) / RADIUS

    def mode(self, positions):
        """Velocities where the surface moves by 1 m/s where it is highest, as an array of shape (n, 3)."""
        import numpy
        x, y, z = positions.T
        k, r = self.number, numpy.maximum(numpy.hypot(x, z), 1e-9)
        angle = numpy.arctan2(z, x)
        level, up = numpy.cosh(k * y), numpy.sinh(k * y)
        outwards = slope_of_bessel(self.turns, k * r) * numpy.cos(self.turns * angle) * level
        around = -self.turns * bessel(self.turns, k * r) / (k * r) * numpy.sin(self.turns * angle) * level
        upwards = bessel(self.turns, k * r) * numpy.cos(self.turns * angle) * up
        highest = 1 if self.turns == 0 else bessel(self.turns, k * RADIUS)
        return numpy.stack([outwards * x / r - around * z / r, upwards, outwards * z / r + around * x / r],
                           axis=1) / (highest * math.sinh(k * self.depth))

    def name(self, solver):
        return f"{solver}_{self.spacing}_{self.turns}_{self.height}"


def with_wave(lab, wave, rest, name):
    """The path of the scene, without its ending, whose water has come to rest in a run and then gets the velocities of the
    mode."""
    import numpy
    start = exported(rest.folder, 0).positions
    stem = lab.out.resolve() / f"{wave.scene}_{name}"
    speed = wave.height * wave.spacing * 2 * math.pi / wave.period
    numpy.savetxt(f"{stem}.csv", numpy.hstack([start, speed * wave.mode(start)]), delimiter=",", comments="",
                  header="x,y,z,vx,vy,vz")
    scene = json.loads((SCENES / "validation" / f"{wave.scene}.json").read_text(encoding="utf-8"))
    scene["nodes"]["fill"] = {"type": "ParticleFile", "params": {"file": f"{stem}.csv"}}
    scene["nodes"].pop("filling", None)  # what the round tank is filled by
    scene["links"] = [link for link in scene["links"] if not link.startswith("filling.")]
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


def loss_of(wave, times, values):
    """The share of its amplitude that a wave has lost after a period."""
    return 1 - max(abs(v) for t, v in zip(times, values) if 0.75 * wave.period < t < 1.25 * wave.period) / values[0]


def runs_of(lab, cases):
    """Of waves and solvers: each starts with water that this solver has brought to rest."""
    def settings_of(spacing, solver):
        return {"let.spacing": str(spacing), "water.solver.type": solver}

    scene = cases[0][0].scene
    rests = {(spacing, solver): lab.run(f"{scene}/rest_{solver}_{spacing}", f"validation/{scene}", settings_of(spacing, solver),
                                        export=True, frames=0)
             for spacing, solver in dict.fromkeys((wave.spacing, solver) for wave, solver in cases)}
    return [lab.run(f"{scene}/{wave.name(solver)}",
                    with_wave(lab, wave, rests[wave.spacing, solver], wave.name(solver)), settings_of(wave.spacing, solver),
                    export=True)
            for wave, solver in cases]


def compared(lab, title, cases, shown, loss=None):
    """The outcome of cases (what, wave, solver, within which share of the period): curves are of the wave that is `shown`, of which a
    period takes less than `loss` where its period is held to something."""
    rows, curves = [], [("closed form", [shown.period * k / 100 for k in range(131)],
                         [math.cos(2 * math.pi * k / 100) for k in range(131)], "k-")]
    for (what, wave, solver, within), run in zip(cases, runs_of(lab, [(wave, solver) for _, wave, solver, _ in cases])):
        times, values = [frame["time"] for frame in run.series], amplitudes(wave, run)
        rows += [Row(f"period{what}, {solver}", period_of(times, values), "s", wave.period, within),
                 Row(f"share of the amplitude that a period takes{what}, {solver}", loss_of(wave, times, values),
                     below=loss if wave == shown and within else None)]
        if wave == shown:
            curves.append((solver, times, [v / values[0] for v in values], "--"))
    return Outcome(rows, (Chart(title, "time (s)", "amplitude", tuple(curves)),))


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
    return compared(lab, "A small wave", cases, main, loss=0.03)


def round_tank(lab):
    """Standing waves without viscosity in a round tank, 50 cm across and 20 cm deep: from side to side and up and down in the middle,
    at three spacings, and the first of three heights. Closed form: ω² = g·k·tanh(k·h), where k·R is a zero of a Bessel function's slope,
    and no loss. TwoProjections is held to it, the default solver stands beside."""
    spacings = lab.scale((0.025, 0.0166667, 0.0125), (0.0125, 0.01, 0.00625))
    fine = spacings[-1]
    cases = [(f", {RADIUS / d:.0f} spacings of radius", RoundWave(d), "TwoProjections", 0.01) for d in spacings]
    cases += [(f", {height:g} spacings high", RoundWave(fine, height=height), "TwoProjections", 0.01) for height in (0.75, 3)]
    cases += [(f" of the second mode, {RADIUS / d:.0f} spacings of radius", RoundWave(d, turns=0), "TwoProjections",
               0.01 if d == fine else None) for d in spacings]
    cases.append((f", {RADIUS / fine:.0f} spacings of radius", RoundWave(fine), "AcceleratedSolver", None))
    return compared(lab, "From side to side of a round tank", cases, RoundWave(fine))
