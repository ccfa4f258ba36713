"""Check of a rope of honey that coils on a plate."""

import math

from lab import SCENES, Chart, Outcome, Row, exported, mean  # first: it finds those of tools/paper
from in_motion import interpolated
import scene as scenes

# Of the scene's rope: fall height (m) and angular frequency (rad/s) of steady coiling, by the theory of slender viscous ropes
# (Ribe 2004): python3 engineering/experiments/coiling.py 0.001 0.25 0.01 0.008 0.009 0.01 0.011 0.012 0.013 0.014 0.016 0.018
STEADY = ((0.008, 99.50), (0.009, 90.95), (0.010, 83.48), (0.011, 77.48), (0.012, 73.01), (0.013, 70.03), (0.014, 68.54),
          (0.016, 69.79), (0.018, 73.85))
NOZZLE = 0.002  # m, its width
LET_ALONE = 0.28  # s; nothing leads the rope since 0.265 s
LOW, HIGH = 0.0095, 0.0105  # m: between them, above the pile, the rope is looked at


def rope_of(particles):
    """The rope's middle there, x and z."""
    y = particles.positions[:, 1]
    return particles.positions[(y > LOW) & (y < HIGH)][:, [0, 2]].mean(axis=0)


def speed_at(particles, height):
    """How fast the rope falls through the last radius of the nozzle above this height, m/s."""
    y = particles.positions[:, 1]
    return float(-particles.velocities[(y > height) & (y < height + NOZZLE / 2), 1].mean())


def whirl(times, middles):
    """What a middle (n, 2) does: the angular frequency of the two circles, one in each sense, that together with a steady drift come
    nearest to it, and the difference of the circles' squares over their sum: 1 for a circle, 0 for a line, along which it folds."""
    import numpy
    times = numpy.array(times) - times[0]
    path = middles @ [1, 1j]

    def fit(omega):
        terms = numpy.stack([numpy.exp(1j * omega * times), numpy.exp(-1j * omega * times), 1 + 0 * times, times], axis=1)
        circles = numpy.linalg.lstsq(terms, path, rcond=None)[0]
        return (abs(path - terms @ circles) ** 2).sum(), omega, *(abs(circles[:2]) ** 2)

    _, omega, one, other = min(fit(omega) for omega in numpy.arange(20, 200, 0.2))
    return float(omega), float(abs(one - other) / (one + other))


def turned(middles):
    """The angles through which it has turned, rad, in the sense in which it turns in all."""
    import numpy
    angles = numpy.unwrap(numpy.arctan2(middles[:, 1], middles[:, 0]))
    return (angles - angles[0]) * math.copysign(1, angles[-1] - angles[0])


def top_of_pile(particles, spacing):
    """Height above which liquid falls at least half as fast as the rope at its fastest, in means over layers."""
    import numpy
    layers = numpy.floor(particles.positions[:, 1] / spacing).astype(int)
    lowest = layers.min()
    layers -= lowest
    falls = numpy.bincount(layers, -particles.velocities[:, 1]) / numpy.maximum(numpy.bincount(layers), 1)
    slow = numpy.flatnonzero(falls[:falls.argmax()] < falls.max() / 2)
    return float(lowest + slow[-1] + 1) * spacing


def coiling(lab):
    """A rope of honey of 14 Pa·s, 2 mm thick, falls by 18 mm on a plate, at first under a gravity that leans over and goes round,
    so that it does not fold. Compared with the theory of slender ropes (Ribe 2004) for the fall from the nozzle to the top of the
    pile, in the mean over the time in which nothing leads it."""
    import numpy
    scene = scenes.read(SCENES / "validation" / "coiling.json")
    fall, speed = scene["let"]["fall"], scenes.parameter(scene, "nozzle.speed")
    across = lab.scale((8,), (10, 12))
    runs = [lab.run(f"coiling/{n}", "validation/coiling", {"let.spacing": f"{NOZZLE / n:.6g}"}, export=True) for n in across]
    rows, curves = [], []
    for n, run in zip(across, runs):
        times = [frame["time"] for frame in run.series]
        late = [k for k, t in enumerate(times) if t >= LET_ALONE]
        times = [times[k] for k in late]
        frames = [exported(run.folder, k) for k in late]
        middles = numpy.array([rope_of(frame) for frame in frames])
        omega, roundness = whirl(times, middles)
        angles, piles = turned(middles), [top_of_pile(frame, NOZZLE / n) for frame in frames]
        expected = mean(interpolated(fall - pile, *zip(*STEADY)) for pile in piles)
        label = f"{n} spacings across the nozzle"
        rows += [Row(f"angular frequency, {label}", omega, "rad/s", expected, 0.15),
                 Row(f"turns in that time, {label}", float(angles[-1]) / (2 * math.pi), above=2),
                 Row(f"roundness: 1 for coiling in circles, 0 for folding, {label}", roundness),
                 Row(f"speed at the nozzle, {label}", mean(speed_at(frame, fall) for frame in frames), "m/s", speed),
                 Row(f"height of the pile, mean, {label}", mean(piles), "m")]
        curves += [(label, times, angles, "-"), (f"theory, {label}", times, [expected * (t - times[0]) for t in times], "k--")]
    return Outcome(rows, (Chart("A rope of honey", "time (s)", "turned by (rad)", tuple(curves)),))
