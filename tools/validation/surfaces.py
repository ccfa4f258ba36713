"""Checks of surface tension: pressure, oscillation and contact of drops."""

import json
import math
from pathlib import Path

from lab import DENSITY, SCENES, Chart, Outcome, Row, exported, mean, node

SPACING = 0.01  # m, of all scenes


def ball_radius(particles):
    """That of the ball that has their volume, m."""
    return SPACING * (3 * particles / (4 * math.pi)) ** (1 / 3)


def laplace(lab):
    """Balls under their surface tension, without gravity: the mean pressure over a box of 4 spacings at the centre.
    Closed form: 2σ/R, R being the radius of a ball of the fluid's volume."""
    tension, radii = 0.5, lab.scale((5, 6.5, 8), (5, 6.5, 8, 10))
    runs = [lab.run(f"laplace/{radius}", "validation/ball", {"let.radius": str(radius)}) for radius in radii]
    rows, found, expected = [], [], []
    for radius, run in zip(radii, runs):
        series = run.series
        found.append(mean(node(frame, "inside")["pressure"] for frame in series[len(series) // 2:]))
        expected.append(2 * tension / ball_radius(node(series[-1], "fluid")["particles"]))
        rows.append(Row(f"pressure in a ball of {radius} spacings", found[-1], "Pa", expected[-1], 0.03))
    chart = Chart("Pressure in drops", "radius (spacings)", "pressure (Pa)",
                  (("closed form", radii, expected, "k-"), ("found", radii, found, "o")))
    return Outcome(rows, (chart,))


def crossings(times, values):
    """When values change their sign."""
    return [t0 - v0 * (t1 - t0) / (v1 - v0) for t0, t1, v0, v1 in zip(times, times[1:], values, values[1:]) if v0 * v1 < 0]


def elongation(positions):
    """Along x, (⟨x²⟩ − ⟨y² + z²⟩/2)/⟨r²⟩."""
    second = ((positions - positions.mean(axis=0)) ** 2).mean(axis=0)
    return float((second[0] - (second[1] + second[2]) / 2) / second.sum())


def with_start(lab, particles):
    """The path of the scene, without its ending, that begins with these positions and velocities."""
    import numpy
    stem = lab.out.resolve() / "swinging_drop"
    numpy.savetxt(f"{stem}.csv", particles, delimiter=",", comments="", header="x,y,z,vx,vy,vz")
    scene = json.loads((SCENES / "validation" / "ball.json").read_text(encoding="utf-8"))
    del scene["let"]["radius"]
    scene["nodes"]["ball"] = {"type": "ParticleFile", "params": {"file": f"{stem}.csv"}}
    Path(f"{stem}.json").write_text(json.dumps(scene), encoding="utf-8")
    return str(stem)


def swinging_drop(lab):
    """A ball that has come to rest under its tension is drawn along one axis by a velocity field without divergence,
    of 12 % of the radius. Closed form (Rayleigh) of small oscillations between long and flat: ω² = 8σ/(ρ0·R³)."""
    import numpy
    tension = 5.0
    rest = lab.run("swinging_drop/rest", "validation/ball", {"fluid.tension.tension": str(tension),
                                                                "world.duration": "0.2"}, export=True)
    start = exported(rest.folder, -1).positions
    start = start - start.mean(axis=0)
    radius = ball_radius(len(start))
    rate = math.sqrt(8 * tension / (DENSITY * radius ** 3))
    result = lab.run("swinging_drop/run", with_start(lab, numpy.hstack([start, 0.12 * rate * start * [1, -0.5, -0.5]])),
                     {"fluid.tension.tension": str(tension), "fluid.viscosity.enabled": "false", "world.dt": "0.002",
                      "world.frame_rate": "100", "world.duration": "1.15"}, export=True)
    times = [frame["time"] for frame in result.series]
    longer = [elongation(exported(result.folder, k).positions) for k in range(len(times))]
    through = crossings(times[1:], longer[1:])  # it starts at none
    period = through[2] / 1.5 if len(through) > 2 else math.nan
    scale = max(longer)
    chart = Chart("A drop swings", "time (s)", "elongation",
                  (("closed form", times, [scale * math.sin(rate * t) for t in times], "k-"),
                   ("found", times, longer, "-")))
    return Outcome([Row("period", period, "s", 2 * math.pi / rate, 0.05),
                    Row("elongation half a period later, over the first", -min(longer) / scale,
                        note="1 without friction")], (chart,))


def cap_angle(height):
    """The angle of contact, in degrees, of a spherical cap whose centre of mass is at this height over the cube root of
    its volume."""
    def height_of(angle):
        c = math.cos(angle)
        radius = (3 / (math.pi * (2 + c) * (1 - c) ** 2)) ** (1 / 3)
        return radius * (3 * (1 + c) ** 2 / (4 * (2 + c)) - c)
    low, high = 0.01, math.pi - 0.01
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if height_of(middle) < height else (low, middle)
    return math.degrees(low)


def sessile_drop(lab):
    """A block on a table becomes a drop, without gravity. Its shape is a cap of a ball, whose angle of contact follows
    from the height of the centre of mass; it is measured over the last half second."""
    angles = (60, 90, 120)
    runs = [lab.run(f"sessile_drop/{angle}", "validation/sessile_drop", {"let.angle": str(angle)},
                    pictures=angle == 60) for angle in angles]
    rows, curves = [], []
    for angle, run in zip(angles, runs):
        of = [cap_angle(node(f, "fluid")["center_of_mass"][1] / node(f, "fluid")["fluid_volume"] ** (1 / 3))
              for f in run.series]
        rows.append(Row(f"angle of contact of {angle}°", mean(of[-10:]), "°", angle, 5 / angle))
        curves.append((f"{angle}°", [f["time"] for f in run.series], of, "-"))
    chart = Chart("Drops on a table", "time (s)", "angle of contact (°)", tuple(curves))
    return Outcome(rows, (chart,), runs[0].picture(10 ** 6))
