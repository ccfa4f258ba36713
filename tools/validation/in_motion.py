"""Checks of water in motion."""

import math

from lab import GRAVITY, SCENES, Chart, Outcome, Row, exported, mean  # first: it finds those of tools/paper
from at_rest import volume_of_revolution
import figures
import quantities
import scene as scenes

# Martin and Moyce 1952, "An Experimental Study of the Collapse of Liquid Columns on a Rigid Horizontal Plane", read off
# their Fig. 3 for n² = 2, a = 2.25 in: t·sqrt(2g/a) and the front's place by a.
MARTIN_MOYCE = ((0.832, 1.217), (1.219, 1.474), (1.997, 2.292), (2.547, 2.995), (3.345, 4.134), (4.034, 4.944),
                (4.418, 5.881), (5.091, 6.980), (5.685, 7.945), (6.306, 8.966), (6.822, 9.986))


def line(xs, ys):
    """(slope, intercept) of the straight line of least squares."""
    import numpy
    slope, intercept = numpy.polyfit(xs, ys, 1)
    return float(slope), float(intercept)


def interpolated(x, xs, ys):
    import numpy
    return float(numpy.interp(x, xs, ys))


def surface(positions, spacing, radius):
    """Where the water's surface is, as arrays r and y: the top of the highest particle of each square column, one and a
    half spacings wide, that is wholly within this radius of the axis."""
    import numpy
    width = 1.5 * spacing
    cells = numpy.floor(positions[:, [0, 2]] / width).astype(int)
    order = numpy.argsort(positions[:, 1])  # so that later writes are higher
    top = {tuple(cells[i]): positions[i] for i in order}
    points = numpy.array([p for (i, k), p in top.items()
                          if math.hypot(max(abs(i), abs(i + 1)), max(abs(k), abs(k + 1))) * width < radius])
    return numpy.hypot(points[:, 0], points[:, 2]), points[:, 1] + spacing / 2


class Turning:
    """The tank that turns (rad/s, m), and what was measured of a run of it."""

    def __init__(self):
        scene = scenes.read(SCENES / "validation" / "rotating_tank.json")
        self.omega = scenes.parameter(scene, "walls.angular_velocity")[1]
        self.radius = scenes.parameter(scene, "tank.profile")[1][0]

    def rows_of(self, result, spacing, label):
        particles = exported(result.folder, -1)
        x, _, z = particles.positions.T
        turning = float((z * particles.velocities[:, 0] - x * particles.velocities[:, 2]).sum() / (x * x + z * z).sum())
        r, heights = surface(particles.positions, spacing, self.radius)
        slope, _ = line(r * r, heights)
        return [Row(f"angular velocity of the water, {label}", turning, "rad/s", self.omega, 0.03),
                Row(f"curvature of the surface against ω²/2g of the water, dh/d(r²), {label}", slope, "1/m",
                    turning ** 2 / (2 * GRAVITY), 0.03)]


def rotating_tank(lab):
    """With walls that water sticks to, all of it turns with the tank in the end, and its surface is z0 + ω²r²/2g."""
    import numpy
    tank = Turning()
    spacing = lab.scale(0.0075, 0.004)
    runs = {ratio: lab.run(f"rotating_tank/{ratio}", "validation/rotating_tank",
                           {"water.spacing": str(spacing), "water.support_ratio": str(ratio)}, export=True)
            for ratio in (1.5, 2.0)}
    rows, curves = [], []
    for ratio, result in runs.items():
        rows += tank.rows_of(result, spacing, f"H = {ratio}d")
        r, heights = surface(exported(result.folder, -1).positions, spacing, tank.radius)
        curves.append((f"surface, H = {ratio}d", r, heights, "." if ratio == 1.5 else "x"))
        if ratio == 1.5:
            fine = numpy.linspace(0, tank.radius, 40)
            level = heights.mean() + tank.omega ** 2 * (fine ** 2 - (r * r).mean()) / (2 * GRAVITY)
            curves.append(("ω²r²/2g", fine, level, "-"))
    return Outcome(rows, (Chart("Surface of turning water", "r (m)", "height (m)", tuple(curves)),))


class Efflux:
    """The geometry of the tank with a hole (m), and what was measured of runs of it. A hole has at least this radius."""

    def __init__(self, hole=0):
        scene = scenes.read(SCENES / "validation" / "efflux.json")
        (radius, bottom), *wall = scenes.parameter(scene, "vessel.profile")
        self.hole = max(radius, hole)
        self.profile = [[self.hole, bottom], *wall]
        self.floor = scenes.parameter(scene, "vessel.thickness")
        self.inner = self.profile[1][0] - self.floor

    @staticmethod
    def run(lab, spacing, ratio, settings=None, name=""):
        return lab.run(f"efflux/{spacing}_{ratio}{name}", "validation/efflux",
                       {"water.spacing": str(spacing), "water.support_ratio": str(ratio), **(settings or {})}, export=True)

    def over_time(self, result, spacing):
        """Arrays, from 0.3 s on: time, level, speed of the jet, in its core, and of a free fall from the surface, flux."""
        import numpy
        table = []
        for k, frame in enumerate(result.series):
            if frame["time"] < 0.3:
                continue
            particles = exported(result.folder, k)
            (x, y, z), velocity = particles.positions.T, particles.velocities
            top = surface(particles.positions[y > self.floor], spacing, self.inner)[1].mean()
            jet = (y < -1.5 * self.hole) & (y > -2.5 * self.hole)
            core = jet & (numpy.hypot(x, z) < 0.4 * self.hole)
            table.append((frame["time"],
                          self.floor + (y > self.floor).sum() * spacing ** 3 / (math.pi * self.inner ** 2),
                          numpy.linalg.norm(velocity[jet], axis=1).mean(),
                          numpy.linalg.norm(velocity[core], axis=1).mean(),
                          numpy.sqrt(2 * GRAVITY * (top - y[jet])).mean(),
                          -velocity[jet, 1].sum() * spacing ** 3 / self.hole))
        return numpy.array(table).T

    def discharge(self, table):
        """The coefficient by the fall of the level and by the flux of the jet, and by how much the root of the level leaves a
        straight line, over its start."""
        import numpy
        times, level, _, _, _, flux = table
        slope, start = line(times, numpy.sqrt(level))
        ideal = math.pi * self.hole ** 2 * numpy.sqrt(2 * GRAVITY * level)
        return (-slope * (self.inner / self.hole) ** 2 / math.sqrt(GRAVITY / 2), float((flux / ideal).mean()),
                float(abs(numpy.sqrt(level) - start - slope * times).max() / start))

    def rows_of(self, table, label, demanded):
        """Of what over_time() has; the speed is held to Torricelli's where that is demanded."""
        _, _, speed, core, fall, _ = table
        by_level, by_flux, bent = self.discharge(table)
        return [Row(f"speed of the contracted jet, mean from 0.3 s on, {label}", float(speed.mean()), "m/s",
                    float(fall.mean()), 0.05 if demanded else None),
                Row(f"the same in the core of the jet, half as wide, {label}", float(core.mean()), "m/s",
                    float(fall.mean())),
                Row(f"deviation of √level from a straight line, {label}", bent, below=0.02),
                Row(f"coefficient of discharge by the fall of the level, {label}", by_level),
                Row(f"the same by the flux of the jet, {label}", by_flux)]


def efflux(lab):
    """A round tank with a sharp-edged hole in its bottom, eight spacings wide. Where the jet has contracted, one diameter
    below the hole, the speed is that of a fall from the surface above, √(2g·depth). The root of the level, which is the
    water in the tank over its area, falls linearly with time; its slope and the jet's flux give the same coefficient of
    discharge, 0.6 to 0.65 for a sharp edge. Particles keep a distance from the edge, which narrows the hole. Holes of fewer
    than eight spacings are there to show what the spacing does."""
    tank = Efflux()
    runs = {(spacing, ratio): tank.run(lab, spacing, ratio)
            for spacing, ratio in lab.scale(((0.016, 1.5), (0.0133, 1.5), (0.01, 1.5), (0.01, 2.0), (0.01, 2.4)),
                                            ((0.01, 1.5), (0.005, 1.5), (0.01, 2.0), (0.005, 2.0), (0.01, 2.4)))}
    rows, speeds, levels = [], [], []
    for (spacing, ratio), result in runs.items():
        table = tank.over_time(result, spacing)
        times, level, speed, _, fall, _ = table
        label, resolved = f"d = {1000 * spacing:g} mm, H = {ratio}d", 8 * spacing <= 2 * tank.hole
        rows += tank.rows_of(table, label, resolved)
        if resolved:
            speeds += [(f"jet, H = {ratio}d", times, speed, "."), (f"√(2g·depth), H = {ratio}d", times, fall, "-")]
        levels.append((label, times, level, "-"))
    return Outcome(rows, (Chart("Jet, one diameter below the hole", "time (s)", "speed (m/s)", tuple(speeds)),
                          Chart("Level in the tank", "time (s)", "height (m)", tuple(levels))))


class Column:
    """The column that falls: its width, the unit of lengths, and that of times (m, s), and what was measured of a run of it."""

    def __init__(self):
        self._size = scenes.parameter(scenes.read(SCENES / "validation" / "dam_front.json"), "column.max")
        self.width = self._size[0]
        self.time = math.sqrt(self.width / (2 * GRAVITY))

    def front(self, result, parts):
        """Times, and where one row of particles lies farther; in these units."""
        import numpy
        spacing = self.width / parts
        row = round(self._size[2] / spacing)
        times = [frame["time"] / self.time for frame in result.series]
        return times, [float(numpy.sort(exported(result.folder, k).positions[:, 0])[-row] + spacing / 2) / self.width
                       for k in range(len(times))]

    @staticmethod
    def rows_of(times, fronts, label):
        late = [(t, x) for t, x in MARTIN_MOYCE if t > 2.5]
        speed, _ = line(*zip(*late))
        ours, _ = line(*zip(*((t, x) for t, x in zip(times, fronts) if late[0][1] <= x <= late[-1][1])))
        lead = [t - interpolated(x, fronts, times) for t, x in late]
        return [Row(f"speed of the front from x = 3a to 10a, in √(2ga), {label}", ours, "", speed, 0.1),
                Row(f"time by which our front is early, mean, in √(a/2g), {label}", mean(lead)),
                Row(f"the same, largest less least, {label}", max(lead) - min(lead))]


def dam_front(lab):
    """A column of water twice as high as wide falls; its front is where one row of particles lies farther. The gate of
    the experiment needed time to open, so the front may be early by a constant; its speed may not differ."""
    column = Column()
    runs = {parts: lab.run(f"dam_front/{parts}", "validation/dam_front", {"water.spacing": f"{column.width / parts:.8g}"},
                           export=True) for parts in lab.scale((20,), (20, 40))}
    rows, curves = [], [("Martin and Moyce 1952", *zip(*MARTIN_MOYCE), "ks")]
    for parts, result in runs.items():
        times, fronts = column.front(result, parts)
        label = f"a/d = {parts}"
        rows += column.rows_of(times, fronts, label)
        curves.append((f"Weir, {label}", times, fronts, "-"))
    return Outcome(rows, (Chart("The front of a falling column", "t·√(2g/a)", "x/a", tuple(curves)),))


def full_goblet(lab):
    """A goblet is filled to 80 % of its volume through a nozzle and stands until ten seconds are over, once with walls of
    a thickness and once as a single layer of triangles. Sinks wait below and around it, and must get nothing."""
    import numpy
    scene = scenes.read(SCENES / "validation" / "full_goblet.json")
    profile = scenes.parameter(scene, "goblet.profile")
    spacing = lab.scale(0.0125, 0.006)
    runs = []
    for name, settings in (("walls of 10 mm", {}),
                           ("a single layer", {"goblet.thickness": "null", "goblet.caps": "false"})):
        thickness = 0 if settings else scenes.parameter(scene, "goblet.thickness")
        inner = [[max(r - thickness, 0), y + thickness] for r, y in profile]
        volume = volume_of_revolution(inner + [[0, inner[-1][1]]], 96)
        amount = round(0.8 * volume / spacing ** 3)
        result = lab.run(f"full_goblet/{name.replace(' ', '_')}", "validation/full_goblet",
                         {**settings, "water.spacing": str(spacing), "nozzle.max_particles": str(amount)},
                         export=True, pictures=not settings)
        runs.append((name, amount, result))
    rows, charts = [], []
    for name, amount, result in runs:
        last = result.series[-1]
        removed = sum(part["particles_removed"] for part in last["nodes"].values() if part["type"] == "Sink")
        positions = exported(result.folder, -1).positions
        r, y = numpy.hypot(positions[:, 0], positions[:, 2]), positions[:, 1]
        wall = numpy.interp(y, [p[1] for p in profile], [p[0] for p in profile], left=0)
        rows += [Row(f"particles after {last['time']:g} s, {name}", last["particles"], "", amount, 0.0),
                 Row(f"particles that reached the sinks, {name}", removed, below=0.5),
                 Row(f"particles outside of the bowl's outer surface, {name}", int((r > wall).sum()), below=0.5),
                 Row(f"greatest height of water, {name}", float(y.max()), "m", note="the rim is at 0.382 m")]
        charts.append((name, [f["time"] for f in result.series], [f["particles"] for f in result.series], "-"))
    picture = runs[0][2].picture(10 ** 6)
    return Outcome(rows, (Chart("Particles in the goblet", "time (s)", "particles", tuple(charts)),), picture)


def drop(lab):
    """Under surface tension alone a cube becomes a ball. Sphericity is ⟨r²⟩ of the ball of the particles' volume over
    their own ⟨r²⟩ (0.924 for a cube); the cubic moment ⟨x⁴ + y⁴ + z⁴⟩/⟨r⁴⟩ is 0.6 for a ball and 0.474 for a cube."""
    import numpy
    result = lab.run("drop", "validation/drop", export=True, pictures=True)
    shapes = []
    for k in range(len(result.series)):
        at = exported(result.folder, k).positions
        at = at - at.mean(axis=0)
        ball = 3 / 5 * (3 * len(at) * 0.01 ** 3 / (4 * math.pi)) ** (2 / 3)
        second = (at ** 2).mean(axis=0)
        shapes.append((ball / second.sum(), (at ** 4).sum() / ((at ** 2).sum(axis=1) ** 2).sum(),
                       second.min() / second.max()))
    last = [float(value) for value in shapes[-1]]
    times = [frame["time"] for frame in result.series]
    rows = [Row("sphericity", last[0], above=0.98, below=1.03), Row("cubic moment", last[1], "", 0.6, 0.025),
            Row("least over largest of ⟨x²⟩, ⟨y²⟩, ⟨z²⟩", last[2], above=0.95)]
    chart = Chart("A cube becomes a drop", "time (s)", "",
                  (("sphericity", times, [s[0] for s in shapes], "-"),
                   ("cubic moment", times, [s[1] for s in shapes], "-")))
    return Outcome(rows, (chart,), result.picture(10 ** 6))


def momentum(lab):
    """A blob that starts in disorder, far from walls and without gravity, with the conservative update (Eq. 14) and with
    each particle's own terms only (Eq. 12). The speed is that of the centre of mass, and should be 0."""
    scale = lab.scale(0.15, 1)
    figure = figures.find(["fig4"])[0]
    scene = scenes.read(SCENES / "paper" / figure.scene)
    common = {**scenes.scaled(scene, figure.scaling, scale, figure.lengths), "world.duration": "1"}
    runs = [(run, iterations, lab.run(f"momentum/{run.name}_{iterations}", f"paper/{figure.scene.removesuffix('.json')}",
                                      {**common, **run.settings, "water.solver.iterations": str(iterations)}))
            for run in figure.runs if run.name.startswith("free_") for iterations in (3, 50)]
    rows, curves, last = [], [], {}
    for run, iterations, result in runs:
        series = result.series
        times, speeds = quantities.over_time(series[1:], quantities.mean_velocity)
        label = f"{run.title.split(',')[0]}, {iterations} iterations"
        last[run.name, iterations] = speeds[-1]
        inner = math.sqrt(2 * quantities.kinetic(quantities.fluid(series[1])))
        rows.append(Row(f"speed of the centre of mass, {label}", speeds[-1], "m/s",
                        note=f"particles: {inner:.3g} m/s"))
        curves.append((label, times, speeds, "-"))
    rows.append(Row("Eq. 14 over Eq. 12, 50 iterations", last["free_eq14", 50] / last["free_eq12", 50], below=0.1))
    return Outcome(rows, (Chart("Momentum of a free blob", "time (s)", "speed of the centre of mass (m/s)",
                                tuple(curves)),))
