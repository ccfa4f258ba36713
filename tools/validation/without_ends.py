"""Checks of viscous flows in periodic domains, which have no ends."""

import json
import math
from pathlib import Path

from lab import DENSITY, SCENES, Chart, Outcome, Row, exported, mean, node

HEIGHT, VISCOSITY = 0.12, 10.0  # m and Pa·s, of both channels


def mean_velocity(frame):
    """Along x, m/s."""
    honey = node(frame, "honey")
    return honey["linear_momentum"][0] / (DENSITY * honey["fluid_volume"])


def steady(series):
    """The last third."""
    return series[-(len(series) // 3):]


def refined(what, unit, spacings, found, expected):
    """Rows of what was found at each spacing, of which the finest is judged, and the power of the spacing with which the
    error goes from the coarsest to the finest."""
    errors = [abs(value / of - 1) for value, of in zip(found, expected)]
    rows = [Row(f"{what}, {HEIGHT / d:.0f} spacings between the plates", value, unit, of,
                0.01 if d == spacings[-1] else None) for d, value, of in zip(spacings, found, expected)]
    return rows + [Row("order of the error", math.log(errors[0] / errors[-1]) / math.log(spacings[0] / spacings[-1]))]


def profile(result):
    """(x velocity, y) of the particles at the end, from the lower to the upper plate."""
    last = exported(result.folder, -1)
    places = last.positions[:, 1].argsort()
    return last.velocities[places, 0], last.positions[places, 1]


def spacings_of(lab):
    return lab.scale((0.02, 0.01, 0.005), (0.02, 0.01, 0.005, 0.0025))


def poiseuille(lab):
    """Honey is driven along a channel by a body force, in a slab of 12 by 4 spacings, periodic along the other two axes.
    Closed form: u = G·y·(h − y)/(2ν), with a mean of G·h²/(12ν)."""
    pull = 0.5
    expected = pull * HEIGHT ** 2 / (12 * VISCOSITY / DENSITY)
    spacings = spacings_of(lab)
    runs = [lab.run(f"poiseuille/{d}", "validation/poiseuille", {"let.spacing": str(d)}, export=True) for d in spacings]
    found = [mean(mean_velocity(frame) for frame in steady(run.series)) for run in runs]
    rows = refined("mean velocity", "m/s", spacings, found, [expected] * len(spacings))
    ys = [HEIGHT * k / 60 for k in range(61)]
    curves = [("closed form", [pull * y * (HEIGHT - y) / (2 * VISCOSITY / DENSITY) for y in ys], ys, "k-")]
    curves += [(f"{HEIGHT / d:.0f} spacings", *profile(run), ".") for d, run in zip(spacings, runs)]
    return Outcome(rows, (Chart("Poiseuille flow", "velocity (m/s)", "y (m)", tuple(curves)),))


def couette(lab):
    """Honey between two plates, of which one glides, in the same slab. Closed form: u = U·y/h, and a drag of μ·U/h by
    area."""
    speed = 0.1
    spacings = spacings_of(lab)
    runs = [lab.run(f"couette/{d}", "validation/couette", {"let.spacing": str(d)}, export=True) for d in spacings]
    drags = [mean(-node(frame, "gliding")["solids"][0]["force"][0] for frame in steady(run.series)) for run in runs]
    expected = [VISCOSITY * speed / HEIGHT * 12 * d * 4 * d for d in spacings]
    rows = refined("drag on the plate", "N", spacings, drags, expected)
    rows.append(Row("mean velocity at the finest spacing",
                    mean(mean_velocity(frame) for frame in steady(runs[-1].series)), "m/s", speed / 2, 0.02))
    curves = [("closed form", [0, speed], [0, HEIGHT], "k-")]
    curves += [(f"{HEIGHT / d:.0f} spacings", *profile(run), ".") for d, run in zip(spacings, runs)]
    return Outcome(rows, (Chart("Couette flow", "velocity (m/s)", "y (m)", tuple(curves)),))


def vortices(positions, side):
    """The velocities of Taylor–Green vortices of 1 m/s in a square of that side, as an array of shape (n, 3)."""
    import numpy
    x, y = (2 * math.pi / side * positions[:, axis] for axis in (0, 1))
    return numpy.stack([numpy.sin(x) * numpy.cos(y), -numpy.cos(x) * numpy.sin(y), 0 * x], axis=1)


def with_vortices(lab, spacing, side, speed):
    """The path of the scene, without its ending, whose fluid has come to rest and then got these velocities."""
    import numpy
    rest = lab.run(f"taylor_green/rest_{spacing}", "validation/taylor_green", {"let.spacing": str(spacing)}, export=True,
                   frames=0)
    start = exported(rest.folder, 0).positions
    stem = lab.out.resolve() / f"vortices_{spacing}"
    numpy.savetxt(f"{stem}.csv", numpy.hstack([start, speed * vortices(start, side)]), delimiter=",", comments="",
                  header="x,y,z,vx,vy,vz")
    scene = json.loads((SCENES / "validation" / "taylor_green.json").read_text(encoding="utf-8"))
    scene["nodes"]["fill"] = {"type": "ParticleFile", "params": {"file": f"{stem}.csv"}}
    Path(f"{stem}.json").write_text(json.dumps(scene), encoding="utf-8")
    return str(stem)


def taylor_green(lab):
    """Vortices that turn against each other, in fluid that was brought to rest in a box of 24 cm, 4 spacings thick and
    periodic along all axes. Closed form: they keep their shape and decay as exp(−2ν·k²·t)."""
    side, speed = 0.24, 0.1
    rate = 2 * VISCOSITY / DENSITY * (2 * math.pi / side) ** 2
    spacings = spacings_of(lab)
    rows, curves = [], []
    for d in spacings:
        result = lab.run(f"taylor_green/{d}", with_vortices(lab, d, side, speed), {"let.spacing": str(d)}, export=True)
        times, amplitudes = [], []
        for k, frame in enumerate(result.series):
            at = exported(result.folder, k)
            mode = vortices(at.positions, side)
            times.append(frame["time"])
            amplitudes.append(float((at.velocities * mode).sum() / (mode * mode).sum()))
        found = math.log(amplitudes[0] / amplitudes[-1]) / times[-1]
        rows.append(Row(f"rate of decay, {side / d:.0f} spacings a side", found, "1/s", rate,
                        0.01 if d == spacings[-1] else None))
        curves.append((f"{side / d:.0f} spacings", times, [a / speed for a in amplitudes], "o"))
    curves.append(("closed form", times, [math.exp(-rate * t) for t in times], "k-"))
    return Outcome(rows, (Chart("Decay of Taylor–Green vortices", "time (s)", "amplitude", tuple(curves)),))
