"""Check of a rope of honey that coils on a plate."""

import math

from lab import SCENES, Chart, Outcome, Row, exported, mean, node  # first: it finds those of tools/paper
from in_motion import interpolated, line
import scene as scenes

# Of the scene's rope: fall height (m) and angular frequency (rad/s) of steady coiling, by the theory of slender viscous ropes
# (Ribe 2004): python3 engineering/experiments/coiling.py 0.001 0.25 0.01 0.008 0.009 0.01 0.011 0.012 0.013 0.014 0.016 0.018
STEADY = ((0.008, 99.50), (0.009, 90.95), (0.010, 83.48), (0.011, 77.48), (0.012, 73.01), (0.013, 70.03), (0.014, 68.54),
          (0.016, 69.79), (0.018, 73.85))
NOZZLE = 0.002  # m, its width
LET_ALONE = 0.28  # s; nothing leads the rope since 0.265 s


def turned(series, fluid):
    """Times, and the angles in rad through which the rope has turned until then: those of the liquid's horizontal momentum, of
    which the pile has next to none."""
    import numpy
    momenta = [node(frame, fluid)["linear_momentum"] for frame in series]
    angles = numpy.unwrap([math.atan2(x, z) for x, _, z in momenta])
    sense = math.copysign(1, angles[-1] - angles[0])
    return [frame["time"] for frame in series], [float(angle) for angle in sense * (angles - angles[0])]


def top_of_pile(particles, spacing):
    """Height above which liquid falls at least half as fast as the rope at its fastest, in means over layers."""
    import numpy
    layers = numpy.floor(particles.positions[:, 1] / spacing).astype(int)
    layers -= layers.min()
    falls = numpy.bincount(layers, -particles.velocities[:, 1]) / numpy.maximum(numpy.bincount(layers), 1)
    slow = numpy.flatnonzero(falls[:falls.argmax()] < falls.max() / 2)
    return float(numpy.floor(particles.positions[:, 1].min() / spacing) + slow[-1] + 1) * spacing


def coiling(lab):
    """A rope of honey of 14 Pa·s, 2 mm thick, falls by 18 mm on a plate, at first under a gravity that leans over and goes round,
    so that it does not fold. Compared with the theory of slender ropes (Ribe 2004) for the fall from the nozzle to the top of the
    pile, in the mean over the time in which nothing leads it."""
    fall = scenes.read(SCENES / "validation" / "coiling.json")["let"]["fall"]
    across = lab.scale((8,), (10, 12))
    runs = [lab.run(f"coiling/{n}", "validation/coiling", {"let.spacing": f"{NOZZLE / n:.6g}"}, export=True) for n in across]
    rows, curves = [], []
    for n, run in zip(across, runs):
        times, angles = turned(run.series, "honey")
        first = next(k for k, t in enumerate(times) if t >= LET_ALONE)
        late = times[first:]
        slope, start = line(late, angles[first:])
        piles = [top_of_pile(exported(run.folder, k), NOZZLE / n) for k in range(first, len(times))]
        expected = mean(interpolated(fall - pile, *zip(*STEADY)) for pile in piles)
        label = f"{n} spacings across the nozzle"
        rows += [Row(f"angular frequency, {label}", slope, "rad/s", expected, 0.15),
                 Row(f"turns in that time, {label}", (angles[-1] - angles[first]) / (2 * math.pi), above=2),
                 Row(f"height of the pile, mean, {label}", mean(piles), "m")]
        curves += [(label, times, angles, "-"),
                   (f"theory, {label}", late, [start + slope * LET_ALONE + expected * (t - LET_ALONE) for t in late], "k--")]
    return Outcome(rows, (Chart("A rope of honey", "time (s)", "turned by (rad)", tuple(curves)),))
