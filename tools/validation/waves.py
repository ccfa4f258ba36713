"""A check of small waves, which water of potential flow makes."""

import json
import math
from pathlib import Path

from lab import GRAVITY, SCENES, Chart, Outcome, Row, exported

LENGTH, DEPTH = 1.0, 0.4  # m, of the tank
NUMBER = math.pi / LENGTH  # of the first mode, 1/m
PERIOD = 2 * math.pi / math.sqrt(GRAVITY * NUMBER * math.tanh(NUMBER * DEPTH))
HIGHEST = 1.5  # spacings, of the wave


def mode(positions):
    """Velocities of the mode whose surface moves by 1 m/s, as an array of shape (n, 3)."""
    import numpy
    along, up = NUMBER * positions[:, 0], NUMBER * positions[:, 1]
    return numpy.stack([-numpy.sin(along) * numpy.cosh(up), numpy.cos(along) * numpy.sinh(up), 0 * up],
                       axis=1) / math.sinh(NUMBER * DEPTH)


def with_wave(lab, spacing, name, settings):
    """The path of the scene, without its ending, whose water has come to rest and then got the velocities of the mode."""
    import numpy
    rest = lab.run(f"small_wave/rest_{name}", "validation/small_wave", settings, export=True, frames=0)
    start = exported(rest.folder, 0).positions
    stem = lab.out.resolve() / f"wave_{name}"
    speed = HIGHEST * spacing * 2 * math.pi / PERIOD
    numpy.savetxt(f"{stem}.csv", numpy.hstack([start, speed * mode(start)]), delimiter=",", comments="",
                  header="x,y,z,vx,vy,vz")
    scene = json.loads((SCENES / "validation" / "small_wave.json").read_text(encoding="utf-8"))
    scene["nodes"]["fill"] = {"type": "ParticleFile", "params": {"file": f"{stem}.csv"}}
    Path(f"{stem}.json").write_text(json.dumps(scene), encoding="utf-8")
    return str(stem)


def amplitudes(result):
    """Of the mode at each frame, m/s."""
    found = []
    for k in range(len(result.series)):
        at = exported(result.folder, k)
        shape = mode(at.positions)
        found.append(float((at.velocities * shape).sum() / (shape * shape).sum()))
    return found


def period_of(times, values):
    """Twice the mean way between zeros."""
    ends = range(len(values) - 1)
    zeros = [times[k] + (times[k + 1] - times[k]) * values[k] / (values[k] - values[k + 1]) for k in ends
             if (values[k] > 0) != (values[k + 1] > 0)]
    return 2 * (zeros[-1] - zeros[0]) / (len(zeros) - 1)


def small_wave(lab):
    """The first mode of a tank 1 m long and 40 cm deep, 1.5 spacings high, without viscosity. Closed form: ω² =
    g·k·tanh(k·h), and no loss. TwoProjections is held to it, the default solver stands beside."""
    spacing = lab.scale(0.025, 0.01)
    rows, curves = [], [("closed form", [PERIOD * k / 100 for k in range(131)],
                         [math.cos(2 * math.pi * k / 100) for k in range(131)], "k-")]
    for solver, held in (("TwoProjections", True), ("AcceleratedSolver", False)):
        settings = {"let.spacing": str(spacing), "water.solver.type": solver}
        result = lab.run(f"small_wave/{solver}", with_wave(lab, spacing, solver, settings), settings, export=True)
        times, values = [frame["time"] for frame in result.series], amplitudes(result)
        later = [abs(v) for t, v in zip(times, values) if t > 0.75 * PERIOD]
        rows += [Row(f"period, {solver}", period_of(times, values), "s", PERIOD, 0.005 if held else None),
                 Row(f"share of the amplitude that a period takes, {solver}", 1 - max(later) / values[0],
                     below=0.03 if held else None)]
        curves.append((solver, times, [v / values[0] for v in values], "--"))
    return Outcome(rows, (Chart("A small wave", "time (s)", "amplitude", tuple(curves)),))
