"""Checks of bodies that water moves, by TwoProjections, as docs/bodies.md says, and of solids that enter it."""

import math

from lab import DENSITY, GRAVITY, SCENES, Chart, Outcome, Row, mean, node
import scene as scenes


def variable(scene, name):
    """Of the scene's `let`."""
    return scenes.read(SCENES / "validation" / f"{scene}.json")["let"][name]


def turned(frame, name):
    """By how many degrees a body of square section is turned about z, between -45 and 45."""
    w, _, _, z = node(frame, name)["rotation"]
    angle = math.degrees(2 * math.atan2(z, w))
    return (angle + 45) % 90 - 45


def attitude(density):
    """How a long beam of square section of this density over water's floats: by how many degrees it is turned, 0 being
    upright and 45 on an edge, and how far its middle is above the level, in sides. The attitude with the least potential
    energy, by integrating over a fine grid; Archimedes' theorem and nothing else."""
    import numpy
    grid = (numpy.arange(400) + 0.5) / 400 - 0.5
    x, y = numpy.meshgrid(grid, grid)

    def floating(angle):
        height = numpy.sort((x * math.sin(angle) + y * math.cos(angle)).ravel())
        level = height[round(density * height.size)]
        # Of the beam about the level, and of the water that it has moved there.
        return density * -level * 1.0 - (height[height < level] - level).sum() / height.size, -level

    angles = numpy.radians(numpy.linspace(0, 45, 91))
    found = [floating(a) for a in angles]
    best = min(range(len(found)), key=lambda k: found[k][0])
    return math.degrees(angles[best]), found[best][1]


def level_in_tank(frame, mass, area, spacing):
    """m above the ground, by volume: of the water as far as it is compressed, and of what the body's weight displaces."""
    water = node(frame, "water")
    density = DENSITY * (1 + water["compression"]["mean"])
    return (water["particles"] * DENSITY * spacing ** 3 + mass) / density / area


def floating_cube(lab):
    """A cube and a cylinder as high as wide, both upright, are let go in one pool where they should float: as deep as the
    share of water's density that they have (Archimedes). TwoProjections is held to it, the default solver stands beside."""
    half, width, length = (variable("floating_cube", name) for name in ("half", "width", "length"))
    spacing = lab.scale(0.01, 0.005)
    runs = {(solver, density): lab.run(f"floating_cube/{solver}_{density}", "validation/floating_cube",
                                       {"let.density": str(density), "water.spacing": str(spacing), "water.solver.type": solver,
                                        "world.dt": lab.scale("2 ms", "1 ms")})
            for solver in ("TwoProjections", "AcceleratedSolver") for density in (100, 500, 900)}
    within = lab.scale(0.02, 0.01)
    rows, curves = [], []
    for (solver, density), result in runs.items():
        held = solver == "TwoProjections"
        for body in ("cube", "cylinder"):
            def draught(frame):
                mass = sum(node(frame, name)["mass"] for name in ("cube", "cylinder"))
                level = level_in_tank(frame, mass, 4 * width * length, spacing)
                return (level - node(frame, body)["position"][1] + half) / (2 * half)
            right = density / DENSITY
            found = mean(draught(frame) for frame in result.series if frame["time"] > 0.8)
            rows.append(Row(f"draught over height, {body} of {2 * half / spacing:.0f} spacings, {density} kg/m³, {solver}", found,
                            "", right, **({"above": right - within, "below": right + within} if held else {})))
            if held:
                curves.append((f"{body}, {density} kg/m³", [f["time"] for f in result.series],
                               [draught(frame) for frame in result.series], "-"))
    return Outcome(rows, (Chart("How deep bodies float", "time (s)", "draught over height", tuple(curves)),))


def floating_beam(lab):
    """A beam of square section is let go 20 degrees off upright. Light and heavy ones turn upright, those of some half of
    water's density onto an edge, as has the least potential energy; and they float as deep as their density says."""
    side = 2 * variable("floating_beam", "half")
    spacing = lab.scale(0.0125, 0.01)
    runs = {density: lab.run(f"floating_beam/{density}", "validation/floating_beam",
                             {"let.density": str(density), "water.spacing": str(spacing)})
            for density in (100, 150, 500, 850, 900)}
    tank = scenes.read(SCENES / "validation" / "floating_beam.json")
    lo, hi = (scenes.parameter(tank, f"tank.{end}")[2] for end in ("min", "max"))
    area = 2 * variable("floating_beam", "side") * (hi - lo)
    rows, curves = [], []
    for density, result in runs.items():
        expected, above = attitude(density / DENSITY)
        angles = [abs(turned(frame, "beam")) for frame in result.series]
        last = [frame for frame in result.series if frame["time"] > 3]
        found = mean(abs(turned(frame, "beam")) for frame in last)
        off = mean(above - (node(f, "beam")["position"][1]
                            - level_in_tank(f, node(f, "beam")["mass"], area, spacing)) / side for f in last)
        rows.append(Row(f"turned by, {density} kg/m³", found, "°", expected or None,
                        **({"within": 0.15} if expected else {"below": 7}), note=f"{expected:.0f}° has the least energy"))
        rows.append(Row(f"deeper than Archimedes', over its side of {side / spacing:.0f} spacings, {density} kg/m³", off,
                        below=0.02, above=-0.02))
        curves.append((f"{density} kg/m³", [f["time"] for f in result.series], angles, "-"))
    return Outcome(rows, (Chart("Beams turn to how they float", "time (s)", "off upright (degrees)", tuple(curves)),))


def line(xs, ys):
    """Of the straight line through the points: its slope, and where it is 0."""
    import numpy
    slope, start = numpy.polyfit(xs, ys, 1)
    return float(slope), float(-start / slope)


def added_mass_in_tank(radius, side):
    """Of a ball in the middle of a tank of water, over the mass of its water: a half, by what its first images in the
    walls add to it, 3/16 (radius over distance)³ of it for each wall beside it and 3/8 for one that it moves away from
    (Lamb, Hydrodynamics, art. 137f), and by as much less for the free surface, whose image has the other sign."""
    ratio = (radius / side) ** 3
    return 0.5 * (1 + ratio * (4 * 3 / 16 + 3 / 8 - 3 / 8))


def released_ball(lab):
    """A ball is let go in water at rest, four diameters wide and deep. It accelerates at g(ρs − ρf)/(ρs + ρf/2), since it
    moves water of half of its own volume along; and a little slower for the walls."""
    added = added_mass_in_tank(variable("released_ball", "radius"), variable("released_ball", "side"))
    runs = {ratio: lab.run(f"released_ball/{ratio}", "validation/released_ball",
                           {"ball.density": str(1000 * ratio), "water.spacing": str(lab.scale(0.025, 0.02))})
            for ratio in (2, 0.5, 0.1, 0.01)}
    rows = []
    for ratio, result in runs.items():
        moving = [frame for frame in result.series if 0 < frame["time"] <= 0.0301]
        expected = GRAVITY * (1 - ratio) / (ratio + added)
        means = [node(frame, "ball")["velocity"][1] / frame["time"] for frame in (moving[-1], moving[0])]
        rows.append(Row(f"mean acceleration of 30 ms, ρs = {ratio:g} ρf", means[0], "m/s²", expected, 0.05))
        rows.append(Row(f"that of the first step, ρs = {ratio:g} ρf", means[1], "m/s²", expected))
    return Outcome(rows)


def crossings(times, values):
    """When values go through 0, by straight lines between the times."""
    return [t0 - v0 * (t1 - t0) / (v1 - v0)
            for (t0, v0), (t1, v1) in zip(zip(times, values), zip(times[1:], values[1:])) if v0 * v1 < 0]


# s. By linear potential flow in a round tank of this one's area, of the first full swing of a ball that is let go
# (engineering/experiments/heave_in_tank.py). In open water that has 0.769 s, and one that has always swung 0.759 s, as Kramer
# et al. 2021 ("Highly Accurate Experimental Heave Decay Tests with a Floating Sphere", Energies 14, 269) have it, as far as
# we remember: our walls are less than a wave's length away. Of a drop as high as a good part of the radius the period is
# longer: engineering/bodies.md.
HEAVE_PERIOD = 0.787


def heaving_ball(lab):
    """A floating ball of 300 mm is let go 30, 90 and 150 mm above where it rests, as in the experiment of Kramer et al.
    (2021). The period of the first full swing is that of linear waves in the tank."""
    runs = {drop: lab.run(f"heaving_ball/{drop}", "validation/heaving_ball",
                          {"let.drop": str(drop / 1000), "water.spacing": str(lab.scale(0.03, 0.02))})
            for drop in lab.scale((90,), (30, 90, 150))}
    rows, curves = [], []
    for drop, result in runs.items():
        times = [frame["time"] for frame in result.series]
        heights = [node(frame, "ball")["position"][1] for frame in result.series]
        rest = sum(heights[len(heights) * 3 // 5:]) / len(heights[len(heights) * 3 // 5:])
        through = crossings(times, [h - rest for h in heights])
        rows.append(Row(f"period, let go at {drop} mm", through[2] - through[0] if len(through) > 2 else math.nan, "s",
                        HEAVE_PERIOD, 0.03))
        curves.append((f"{drop} mm", times, [1000 * (h - rest) for h in heights], "-"))
    return Outcome(rows, (Chart("A ball heaves", "time (s)", "height over where it rests (mm)", tuple(curves)),))


# Zhao and Faltinsen 1993, "Water entry of two-dimensional bodies", J. Fluid Mech. 246, table 1: force on a wedge over
# ρV³t, by similarity, from memory; logvinovich() has 84.5, 42.9 and 15.1.
ZHAO_FALTINSEN = {15: 85.522, 20: 42.485, 30: 14.139}


def logvinovich(degrees):
    """The same by the modified Logvinovich model in closed form (Korobkin 2004, "Analytical models of water impact", Eur.
    J. Appl. Math. 15): pressure over ρV² is k/u − cos²β/(2u²) − sin²β/2 with u = √(1 − s²), s being the place over the
    wetted half width c = kVt, k = π/(2·tan β), as far out as it is positive."""
    beta = math.radians(degrees)
    k, far, near = math.pi / (2 * math.tan(beta)), math.cos(beta) ** 2 / 2, math.sin(beta) ** 2 / 2
    u = (k - math.sqrt(k * k - 4 * near * far)) / (2 * near)
    s = math.sqrt(1 - u * u)
    return 2 * k * (k * math.asin(s) - far * math.atanh(s) - near * s)


def wedge_entry(lab):
    """A wedge enters water at constant speed, without gravity. The force is ρV³t times a number of its angle alone (Zhao
    and Faltinsen 1993); Wagner's (π³/4)/tan² of the angle is an upper bound. The number is the slope of a line through
    the forces; from how far above the water that line seems to start is told beside it."""
    scene = scenes.read(SCENES / "validation" / "wedge_entry.json")
    low, high = (scenes.parameter(scene, f"block.{end}")[2] for end in ("min", "max"))
    rows, curves = [], []
    runs = {angle: lab.run(f"wedge_entry/{angle}", "validation/wedge_entry",
                           {"wedge.file": str(SCENES.parent / "meshes" / f"wedge_{angle}.ply"),
                            "water.spacing": str(lab.scale(0.01, 0.005)), "world.duration": str(end)})
            for angle, end in ((30, 0.12), (20, 0.08), (15, 0.06))}
    spacing = lab.scale(0.01, 0.005)
    above = scenes.parameter(scene, "moved.position")[1] - scenes.parameter(scene, "block.max")[1]  # m, over 1 m/s
    for angle, result in runs.items():
        frames = [frame for frame in result.series if frame["time"] > 0]
        # Forces are means since the frame before; time counts from when the wedge touches the water.
        times = [frame["time"] - 0.005 - above for frame in frames]
        forces = [node(f, "moved")["solids"][0]["force"][1] / (DENSITY * (high - low)) for f in frames]
        late = [(t, f) for t, f in zip(times, forces) if t > 0.35 * times[-1]]
        found, begins = line([t for t, _ in late], [f for _, f in late])
        wagner = math.pi ** 3 / 4 / math.tan(math.radians(angle)) ** 2
        rows.append(Row(f"force over ρV³t, {angle}°", found, "", ZHAO_FALTINSEN[angle], 0.1,
                        below=wagner, note=f"Wagner: {wagner:.1f}; Logvinovich: {logvinovich(angle):.1f}"))
        rows.append(Row(f"the line starts that many spacings above the water, {angle}°", -begins / spacing))
        curves += [(f"{angle}°", times, forces, "o"), (f"{angle}°, Zhao and Faltinsen", times,
                                                      [ZHAO_FALTINSEN[angle] * t for t in times], "-")]
    return Outcome(rows, (Chart("Wedges enter water", "time (s)", "force over ρ and width (m³/s²)", tuple(curves)),))
