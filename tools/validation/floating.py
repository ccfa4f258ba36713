"""Checks of bodies that water moves, and of solids that enter it."""

import math

from lab import DENSITY, GRAVITY, SCENES, Chart, Outcome, Row, node
import scene as scenes


def variable(scene, name):
    """Of the scene's `let`."""
    return scenes.read(SCENES / "validation" / f"{scene}.json")["let"][name]


def turned(frame, name):
    """By how many degrees a body of square section is turned about z, between -45 and 45."""
    w, _, _, z = node(frame, name)["rotation"]
    angle = math.degrees(2 * math.atan2(z, w))
    return (angle + 45) % 90 - 45


def settled_turn(density):
    """Of a long beam of square section of this density over water's, in degrees: 0 is upright, 45 on an edge. The attitude
    with the least potential energy, by integrating over a fine grid; Archimedes' theorem and nothing else."""
    import numpy
    grid = (numpy.arange(400) + 0.5) / 400 - 0.5
    x, y = numpy.meshgrid(grid, grid)

    def energy(angle):
        height = numpy.sort((x * math.sin(angle) + y * math.cos(angle)).ravel())
        level = height[round(density * height.size)]
        # Of the beam about the level, and of the water that it has moved there.
        return density * -level * 1.0 - (height[height < level] - level).sum() / height.size

    angles = numpy.radians(numpy.linspace(0, 45, 91))
    return math.degrees(angles[int(numpy.argmin([energy(a) for a in angles]))])


def floating_beam(lab):
    """A beam of square section is let go 20 degrees off upright. Light and heavy ones turn upright, those of some half of
    water's density onto an edge, as has the least potential energy; and they float as deep as their density says."""
    depth, side = variable("floating_beam", "depth"), 2 * variable("floating_beam", "half")
    spacing = lab.scale(0.0125, 0.01)
    runs = {density: lab.run(f"floating_beam/{density}", "validation/floating_beam",
                             {"let.density": str(density), "water.spacing": str(spacing)})
            for density in (100, 150, 500, 850, 900)}
    rows, curves = [], []
    for density, result in runs.items():
        expected = settled_turn(density / DENSITY)
        angles = [abs(turned(frame, "beam")) for frame in result.series]
        last = [frame for frame in result.series if frame["time"] > 3]
        found = sum(abs(turned(frame, "beam")) for frame in last) / len(last)
        rows.append(Row(f"turned by, {density} kg/m³", found, "°", expected or None,
                        **({"within": 0.15} if expected else {"below": 7}), note=f"{expected:.0f}° has the least energy"))
        curves.append((f"{density} kg/m³", [f["time"] for f in result.series], angles, "-"))
    return Outcome(rows, (Chart("Beams turn to how they float", "time (s)", "off upright (degrees)", tuple(curves)),))


def line(xs, ys):
    import numpy
    return float(numpy.polyfit(xs, ys, 1)[0])


def released_ball(lab):
    """A ball is let go in water at rest, four diameters wide and deep. It accelerates at g(ρs − ρf)/(ρs + ρf/2), since it
    moves water of half of its own volume along."""
    runs = {ratio: lab.run(f"released_ball/{ratio}", "validation/released_ball",
                           {"ball.density": str(1000 * ratio), "water.spacing": str(lab.scale(0.025, 0.02))})
            for ratio in (2, 0.5, 0.1, 0.01)}
    rows = []
    for ratio, result in runs.items():
        last = [frame for frame in result.series if frame["time"] <= 0.0301][-1]
        found = node(last, "ball")["velocity"][1] / last["time"]
        rows.append(Row(f"mean acceleration of 30 ms, ρs = {ratio:g} ρf", found, "m/s²", GRAVITY * (1 - ratio) / (ratio + 0.5), 0.05))
    return Outcome(rows)


def crossings(times, values):
    """When values go through 0, by straight lines between the times."""
    return [t0 - v0 * (t1 - t0) / (v1 - v0)
            for (t0, v0), (t1, v1) in zip(zip(times, values), zip(times[1:], values[1:])) if v0 * v1 < 0]


# Kramer et al. 2021, "Highly Accurate Experimental Heave Decay Tests with a Floating Sphere", Energies 14, 269: the ball of
# 300 mm and 7.056 kg has a period of 0.76 s.
KRAMER_PERIOD = 0.76


def heaving_ball(lab):
    """A floating ball of 300 mm is let go 30, 90 and 150 mm above where it rests, as in the experiment of Kramer et al.
    (2021), whose period is 0.76 s. Here it is that of the first full swing, before waves come back from the walls."""
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
                        KRAMER_PERIOD, 0.05))
        curves.append((f"{drop} mm", times, [1000 * (h - rest) for h in heights], "-"))
    return Outcome(rows, (Chart("A ball heaves", "time (s)", "height over where it rests (mm)", tuple(curves)),))


# Zhao and Faltinsen 1993, "Water entry of two-dimensional bodies", J. Fluid Mech. 246, table 1: force on a wedge over
# ρV³t, by similarity.
ZHAO_FALTINSEN = {15: 85.522, 20: 42.485, 30: 14.139}


def wedge_entry(lab):
    """A wedge enters water at constant speed, without gravity. The force is ρV³t times a number of its angle alone (Zhao
    and Faltinsen 1993); Wagner's (π³/4)/tan² of the angle is an upper bound."""
    scene = scenes.read(SCENES / "validation" / "wedge_entry.json")
    low, high = (scenes.parameter(scene, f"block.{end}")[2] for end in ("min", "max"))
    rows, curves = [], []
    runs = {angle: lab.run(f"wedge_entry/{angle}", "validation/wedge_entry",
                           {"wedge.file": f"../../meshes/wedge_{angle}.ply", "water.spacing": str(lab.scale(0.01, 0.005)),
                            "world.duration": str(end)})
            for angle, end in ((30, 0.12), (20, 0.08), (15, 0.06))}
    for angle, result in runs.items():
        frames = [frame for frame in result.series if frame["time"] > 0]
        # Forces are means since the frame before.
        times = [frame["time"] - 0.005 for frame in frames]
        forces = [node(f, "moved")["solids"][0]["force"][1] / (DENSITY * (high - low)) for f in frames]
        late = [(t, f) for t, f in zip(times, forces) if t > 0.35 * times[-1]]
        found = line([t for t, _ in late], [f for _, f in late])
        wagner = math.pi ** 3 / 4 / math.tan(math.radians(angle)) ** 2
        rows.append(Row(f"force over ρV³t, {angle}°", found, "", ZHAO_FALTINSEN[angle], 0.1,
                        below=wagner, note=f"Wagner: {wagner:.1f}"))
        curves += [(f"{angle}°", times, forces, "o"), (f"{angle}°, Zhao and Faltinsen", times,
                                                      [ZHAO_FALTINSEN[angle] * t for t in times], "-")]
    return Outcome(rows, (Chart("Wedges enter water", "time (s)", "force over ρ and width (m³/s²)", tuple(curves)),))
