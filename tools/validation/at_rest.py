"""Checks of water at rest, or at rest in a tank that moves."""

import math

from lab import DENSITY, GRAVITY, SCENES, Chart, Outcome, Row, mean, mean_force  # first: it finds the next two
import quantities
import scene as scenes


def height(frame):
    """Twice the height of the centre of mass: that of a block of water that stands on the ground at 0."""
    return 2 * quantities.fluid(frame)["center_of_mass"][1]


def settled_volume(lab):
    """Blocks in disorder settle in tanks that they fill from wall to wall. 90 iterations carry the weight of 16 layers."""
    spacing, iterations = lab.scale(("0.0125", "90"), ("0.005", "563"))
    runs = {(ratio, calibration): lab.run(f"settled_volume/{calibration}_{ratio}", "validation/settled_block",
                                          {"water.support_ratio": str(ratio), "water.calibration": calibration,
                                           "water.spacing": spacing, "water.solver.iterations": iterations})
            for ratio in (1.2, 1.5, 2.0, 2.4) for calibration in ("packing", "lattice")}
    rows, curves = [], []
    for (ratio, calibration), result in runs.items():
        series = result.series
        last = mean(height(frame) for frame in series[-5:])
        demanded = 0.01 if calibration == "packing" else None
        rows.append(Row(f"height of the settled water, H = {ratio}d, {calibration}", last, "m", 0.2, demanded))
        if calibration == "packing":
            curves.append((f"H = {ratio}d", [f["time"] for f in series], [height(f) for f in series], "-"))
    chart = Chart("Water settles from disorder", "time (s)", "height (m)", tuple(curves))
    return Outcome(rows, (chart,))


def block_at_rest(lab):
    """Blocks as samplers make them, at rest in their tanks: nothing should move, from the first frame on. One tank is a
    mesh of SemiAnalyticalSFI, the other a StaticBoundary."""
    spacing = lab.scale("0.0125", "0.005")
    mesh = {"block.jitter": "0", "block.arrangement": "relaxed", "world.frame_rate": "100", "world.duration": "0.5"}
    tanks = {"mesh": ("", "settled_block", mesh), "plain": ("_", "block_in_plain_tank", {})}
    runs = {(tank, ratio): lab.run(f"block_at_rest/{style}{ratio}", f"validation/{scene}",
                                   {"water.support_ratio": str(ratio), **settings, "water.spacing": spacing})
            for tank, (style, scene, settings) in tanks.items() for ratio in (1.2, 1.5, 2.0, 2.4)}
    rows, curves = [], []
    for k, ((tank, ratio), result) in enumerate(runs.items()):
        times, energies = quantities.over_time(result.series[1:], quantities.kinetic)
        label = f"{tank} tank, H = {ratio}d"
        rows.append(Row(f"most kinetic energy per mass, {label}", max(energies), "m²/s²", below=1e-3))
        curves.append((label, times, energies, f"C{k % 4}" + ("-" if tank == "mesh" else ":")))
    return Outcome(rows, (Chart("A block that starts at rest", "time (s)", "kinetic energy / mass (m²/s²)",
                                tuple(curves)),))


def enough(spacing):
    """Iterations for pressure to spread through 30 cm of water of 1 MPa within a step of 1 ms."""
    return math.ceil(40 * (0.02 / spacing) ** 2)


DEPTH, WIDTH, PLATE = 0.3, 0.2, 0.05  # m, of the water of wall_force, and how high its plates are
BOTTOM = DENSITY * GRAVITY * DEPTH  # Pa
HEIGHTS = [PLATE * (k + 0.5) for k in range(6)]  # of the plates that are under water


def pressures_on(forces):
    """Pa on each plate that is under water."""
    return [forces[f"plate{k}"][0] / (PLATE * WIDTH) for k in range(len(HEIGHTS))]


def rows_of_wall(result, label, demanded=True):
    """What the wall and the ground bear after 0.7 s."""
    forces = mean_force(result.series, "wall", 0.7)
    weight = mean_force(result.series, "ground", 0.7)["tank"][1] + sum(f[1] for f in forces.values())
    worst = max(abs(p - BOTTOM + DENSITY * GRAVITY * y) for y, p in zip(HEIGHTS, pressures_on(forces))) / BOTTOM
    return [Row(f"force on the wall, {label}", sum(f[0] for f in forces.values()), "N",
                BOTTOM * DEPTH / 2 * WIDTH, 0.03 if demanded else None),
            Row(f"weight on the tank, {label}", -weight, "N", BOTTOM * WIDTH ** 2, 0.01 if demanded else None),
            Row(f"worst plate, error over the pressure at the bottom, {label}", worst, below=0.05 if demanded else None)]


def wall_force(lab):
    """The wall is a stack of plates. With few iterations the pressure has not spread through the water yet: what is
    missing of the weight is momentum that the iterations have not passed on."""
    runs = {(spacing, iterations): lab.run(f"wall_force/{spacing}_{iterations}", "validation/wall_force",
                                           {"water.spacing": str(spacing), "water.solver.iterations": str(iterations)})
            for spacing in lab.scale((0.02, 0.0125), (0.02, 0.01, 0.005)) for iterations in (enough(spacing), 3)}
    rows, curves = [], [("ρg(h − y)", [0, BOTTOM], [DEPTH, 0], "-")]
    for (spacing, iterations), result in runs.items():
        label = f"d = {1000 * spacing:g} mm, {iterations} iterations"
        rows += rows_of_wall(result, label, iterations > 3)
        curves.append((label, pressures_on(mean_force(result.series, "wall", 0.7)), HEIGHTS, "o" if iterations > 3 else "x"))
    return Outcome(rows, (Chart("Pressure on a wall", "pressure (Pa)", "height (m)", tuple(curves)),))


def volume_of_revolution(profile, segments):
    """m³ inside a polygon of [radius, height] turned in this many steps."""
    cones = sum((a[0] ** 2 + a[0] * b[0] + b[0] ** 2) * (b[1] - a[1]) for a, b in zip(profile, profile[1:]))
    return abs(cones) / 6 * segments * math.sin(2 * math.pi / segments)


def rows_of_ball(results, label, after=2.0):
    """Of several fillings, by means after that many seconds."""
    ball = scenes.parameter(scenes.read(SCENES / "validation" / "held_sphere.json"), "ball.profile")
    expected = DENSITY * GRAVITY * volume_of_revolution(ball, 64)
    forces = [mean_force(result.series, "held", after)["ball"] for result in results]
    force = [mean(axis) for axis in zip(*forces)]
    upwards = [f[1] for f in forces]
    label = f"{label}, {len(results)} fillings"
    return [Row(f"buoyancy, {label}", force[1], "N", expected, 0.03),
            Row(f"its largest less its least as a share of it, {label}", (max(upwards) - min(upwards)) / expected),
            Row(f"horizontal force as a share of the buoyancy, {label}",
                math.hypot(force[0], force[2]) / expected, below=0.02)]


def held_sphere(lab):
    """A ball held under water that is at rest: Archimedes, and no force to any side. Particles at rest bear some stress
    in whatever arrangement they came to, so the force differs from filling to filling; this is the mean over fillings.
    The stress creeps away for seconds, so what counts is the third second."""
    runs = {spacing: [lab.run(f"held_sphere/{spacing}_{seed}", "validation/held_sphere",
                              {"water.spacing": str(spacing), "water.solver.iterations": str(enough(spacing)),
                               "world.seed": str(seed)}) for seed in range(1, fillings + 1)]
            for spacing, fillings in lab.scale(((0.02, 24), (0.013, 8)), ((0.02, 24), (0.013, 8), (0.005, 1)))}
    return Outcome([row for spacing, results in runs.items() for row in rows_of_ball(results, f"d = {1000 * spacing:g} mm")])


def relative_kinetic(report, velocity):
    """Kinetic energy per mass as seen from what moves at this velocity."""
    mass = quantities.mass(report)
    momentum = report["linear_momentum"]
    across = sum(p * v for p, v in zip(momentum, velocity)) / mass
    return report["kinetic_energy"] / mass - across + sum(v * v for v in velocity) / 2


def moving_tank(lab):
    """In a tank that moves at a constant velocity water does what it does in one that stands."""
    velocity = scenes.parameter(scenes.read(SCENES / "validation" / "moving_tank.json"), "walls.velocity")
    still = {"walls.velocity": "[0, 0, 0]", "block.velocity": "[0, 0, 0]"}
    runs = [(name, moves, lab.run(f"moving_tank/{name}", "validation/moving_tank", settings))
            for name, moves, settings in (("moving", velocity, {}), ("standing", [0, 0, 0], still))]
    rows, curves = [], []
    for name, moves, result in runs:
        series = result.series[1:]
        energies = [relative_kinetic(quantities.fluid(frame), moves) for frame in series]
        slip = [p / quantities.mass(quantities.fluid(series[-1])) - v
                for p, v in zip(quantities.fluid(series[-1])["linear_momentum"], moves)]
        rows.append(Row(f"kinetic energy per mass relative to the {name} tank, at the end", energies[-1], "m²/s²",
                        below=1e-3))
        rows.append(Row(f"mean velocity relative to the {name} tank, at the end", math.hypot(*slip), "m/s",
                        below=1e-2))
        curves.append((f"{name} tank", [f["time"] for f in series], energies, "-"))
    chart = Chart("Water in a tank", "time (s)", "kinetic energy / mass, relative (m²/s²)", tuple(curves))
    return Outcome(rows, (chart,))


def sloshing(lab):
    """Kinetic and potential energy of water that falls in a closed tank: their sum may only fall. A rise is energy that
    the samplers stored in particles that were too close (the lattice calibration has none of that)."""
    runs = [(calibration, style, lab.run(f"sloshing/{calibration}", "validation/sloshing",
                                         {"water.spacing": lab.scale("0.01", "0.005"),
                                          "water.calibration": calibration}))
            for calibration, style in (("packing", "-"), ("lattice", ":"))]
    rows, curves = [], []
    for calibration, style, result in runs:
        series = result.series
        reports = [quantities.fluid(frame) for frame in series]
        kinetic = [r["kinetic_energy"] for r in reports]
        total = [r["kinetic_energy"] + r["potential_energy"] for r in reports]
        rise = max(after - min(total[:k + 1]) for k, after in enumerate(total[1:])) / (total[0] - total[-1])
        rows += [Row(f"largest rise of the energy as a share of what is lost in all, {calibration}", rise, below=0.005),
                 Row(f"kinetic energy at the end as a share of it, {calibration}",
                     kinetic[-1] / (total[0] - total[-1]))]
        times = [frame["time"] for frame in series]
        curves += [(f"total, {calibration}", times, total, "C0" + style),
                   (f"kinetic, {calibration}", times, kinetic, "C1" + style)]
    return Outcome(rows, (Chart("Energy in a closed tank", "time (s)", "energy (J)", tuple(curves)),))
