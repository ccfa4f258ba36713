"""Checks of scenes that say nothing of their solver, stiffness or support ratio: each at three spacings and at three steps, up to
the longest of which the program does not warn. A row is of the step that is farthest off; a chart has them all."""

import math

from lab import DENSITY, GRAVITY, Chart, Outcome, Row, mean, node  # first: it finds those of tools/paper
from at_rest import rows_of_ball, rows_of_wall
from in_motion import Column, Efflux, Turning
import scene as scenes


def steps_of(spacing):
    """s: the longest without a warning, of which a particle falls its first spacing in four
    (nodes/particle_fluid/fluid_warnings.cpp), after a ninth and a third of it."""
    longest = math.sqrt(2 * spacing / GRAVITY) / 4
    return longest / 9, longest / 3, longest


def settings_of(spacing, dt, rate):
    """For --set. Frames are whole numbers of the longest step, near the rate, as steps are made shorter where they do not fit."""
    longest = steps_of(spacing)[-1]
    return {"water.spacing": str(spacing), "world.dt": str(dt),
            "world.frame_rate": str(1 / (longest * max(1, round(1 / (rate * longest)))))}


def off(row):
    """What is the larger, the farther a row is from what is demanded; no number is the farthest."""
    if math.isnan(row.measured):
        return math.inf
    return row.measured if row.deviation is None else abs(row.deviation)


def farthest(runs, rows_of):
    """Rows, and points of a chart, of what is demanded of all runs at a spacing: `runs` are (spacing, {step: result})."""
    spacing, by_step = runs
    label = f"d = {1000 * spacing:g} mm, steps of {', '.join(f'{1000 * dt:.2g}' for dt in by_step)} ms"
    found = [rows_of(result, spacing, label) for result in by_step.values()]
    same = [rows for rows in zip(*found) if rows[0].passed is not None]
    points = [(rows[0].what.removesuffix(label).rstrip(", ") + f", d = {1000 * spacing:g} mm", [1000 * dt for dt in by_step],
               [100 * row.deviation for row in rows], "o-") for rows in same if rows[0].deviation is not None]
    return [max(rows, key=off) for rows in same], points


def compared(title, spacings, start, rows_of):
    """The outcome of what start(spacing, step) begins, and rows_of(result, spacing, label) finds of it."""
    runs = {d: {dt: start(d, dt) for dt in steps_of(d)} for d in spacings}
    judged = [farthest(one, rows_of) for one in runs.items()]
    return Outcome([row for rows, _ in judged for row in rows],
                   (Chart(title, "step (ms)", "off by (%)", tuple(curve for _, points in judged for curve in points)),))


def default_solver(lab):
    """A tank at rest and a dam that breaks, with plain walls: how much the water is compressed in any frame from 0.2 s on, and what
    it weighs on its tank. This and the next five are of scenes as if they said nothing of their solver, at three spacings and three
    steps each, the longest of which is the longest that is not warned of; each row is of the step that is farthest off."""
    def start(d, dt):
        settings = {**settings_of(d, dt, 20), "tank.report_forces": "true", "world.duration": "0.4"}
        return [lab.run(f"default_solver/{scene}_{d}_{dt:.3g}", scene, settings, defaults=True)
                for scene in ("tank_at_rest", "dam_break")]

    def rows_of(results, _, label):
        late = [[frame for frame in result.series if frame["time"] > 0.1999] for result in results]
        rows = [Row(f"largest mean compression, {what}, {label}", max(node(f, "water")["compression"]["mean"] for f in frames),
                    below=0.002) for what, frames in zip(("tank", "dam"), late)]
        weight = DENSITY * GRAVITY * node(late[0][0], "water")["fluid_volume"]
        return rows + [Row(f"weight on the tank, {label}", mean(-node(f, "tank")["force"][1] for f in late[0]), "N", weight, 0.01)]

    return compared("Weight on a tank", lab.scale((0.04, 0.03, 0.025), (0.03, 0.02, 0.01)), start, rows_of)


def default_wall_force(lab):
    """The wall of plates of `Hydrostatic pressure`, by default: its force, the weight on the tank, and the worst plate."""
    return compared("Force on a wall, and weight", lab.scale((0.025, 0.02, 0.0166667), (0.0125, 0.01, 0.00625)),
                    lambda d, dt: lab.run(f"default_wall_force/{d}_{dt:.3g}", "validation/wall_force", settings_of(d, dt, 50),
                                          defaults=True),
                    lambda result, _, label: rows_of_wall(result, label))


def default_held_sphere(lab):
    """The ball of `Buoyancy`, by default: over two fillings, and in the second half of the first second, as with a support of two
    spacings forces differ less between fillings, and do not creep."""
    def start(d, dt):
        settings = {**settings_of(d, dt, 50), "world.duration": "1"}
        return [lab.run(f"default_held_sphere/{d}_{dt:.3g}_{seed}", "validation/held_sphere",
                        {**settings, "world.seed": str(seed)}, defaults=True) for seed in (1, 2)]

    return compared("Buoyancy", lab.scale((0.0216667, 0.02, 0.0173333), (0.02, 0.013, 0.01)), start,
                    lambda results, _, label: rows_of_ball(results, label, after=0.5))


def default_rotating_tank(lab):
    """The tank of `A tank that turns`, by default."""
    tank = Turning()
    return compared("Turning water", lab.scale((0.01, 0.00875, 0.0075), (0.0075, 0.005, 0.004)),
                    lambda d, dt: lab.run(f"default_rotating_tank/{d}_{dt:.3g}", "validation/rotating_tank",
                                          settings_of(d, dt, 10), defaults=True, export=True), tank.rows_of)


def default_efflux(lab):
    """The jet of `Efflux from a hole`, by default: its speed, and how the level falls. The hole is at least eight spacings wide."""
    def start(d, dt):
        # At once there is a flow, so the water need not come to rest first, which takes most of the time.
        settings = {**settings_of(d, dt, 50), "vessel.profile": scenes.text(Efflux(4 * d).profile), "water.rest_steps": "100"}
        return lab.run(f"default_efflux/{d}_{dt:.3g}", "validation/efflux", settings, defaults=True, export=True)

    def rows_of(result, d, label):
        tank = Efflux(4 * d)
        return tank.rows_of(tank.over_time(result, d), label, True)

    return compared("A jet", lab.scale((0.016, 0.0145, 0.0125), (0.01, 0.0075, 0.005)), start, rows_of)


def default_dam_front(lab):
    """The column of `The front of a dam break`, by default."""
    column = Column()
    spacings = [column.width / parts for parts in lab.scale((10, 14, 16), (20, 30, 40))]  # even, as the column is half as deep
    return compared("The front's speed", spacings,
                    lambda d, dt: lab.run(f"default_dam_front/{column.width / d:.0f}_{dt:.3g}", "validation/dam_front",
                                          settings_of(d, dt, 200), defaults=True, export=True),
                    lambda result, d, label: column.rows_of(*column.front(result, column.width / d), label))
