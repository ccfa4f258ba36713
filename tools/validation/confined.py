"""Checks of flows that walls lead around corners."""

import math

from lab import GRAVITY, Chart, Outcome, Row, exported, node
from waves import zeros_of

ARM, BETWEEN, DEPTH = 0.1, 0.2, 0.4  # m: width of each arm and of what joins them, the way between the arms, their depth
# Of a channel that turns by a right angle, in its widths: what the square at the corner counts for a potential flow.
CORNER = 1 - 2 * math.log(2) / math.pi

SIDE, LID = 0.12, 0.8333333  # m and m/s, of the cavity; with 1 Pa·s, a Reynolds number of 100
# Places in the cavity, from the wall that stands opposite to the lid, in its sides, and velocities there, in the lid's: U. Ghia,
# K. N. Ghia, C. T. Shin (1982), tables I and II, Reynolds number 100.
ALONG_LID = ((0.0547, -0.03717), (0.1016, -0.06434), (0.1719, -0.10150), (0.2813, -0.15662), (0.4531, -0.21090),
             (0.5, -0.20581), (0.6172, -0.13641), (0.7344, 0.00332), (0.8516, 0.23151), (0.9531, 0.68717))
ACROSS = ((0.0625, 0.09233), (0.0938, 0.12317), (0.1563, 0.16077), (0.2266, 0.17507), (0.2344, 0.17527), (0.5, 0.05454),
          (0.8047, -0.24533), (0.8594, -0.22445), (0.9063, -0.16914), (0.9531, -0.08864))


def u_tube(lab):
    """Water swings between two arms that a channel of the same width joins, let go from 1.5 spacings of 12.5 mm. Closed form of
    potential flow for small swings: T = 2π·sqrt(L/2g), where each corner counts as 1 − 2·ln 2/π = 0.559 of a width in L.
    TwoProjections is held to it, the default solver stands beside."""
    length = 2 * (DEPTH - ARM) + BETWEEN + 2 * CORNER * ARM
    period = 2 * math.pi * math.sqrt(length / (2 * GRAVITY))
    spacing = lab.scale(0.0125, 0.00625)
    cases = (("TwoProjections", 0.03), ("AcceleratedSolver", None))
    runs = [lab.run(f"u_tube/{solver}", "validation/u_tube", {"let.spacing": str(spacing), "water.solver.type": solver})
            for solver, _ in cases]
    rows, curves = [], []
    for (solver, within), run in zip(cases, runs):
        times = [frame["time"] for frame in run.series]
        flows = [node(frame, "water")["linear_momentum"][0] for frame in run.series]
        highest = max(abs(flow) for flow in flows)
        zeros = [t for t in zeros_of(times, flows) if t > 0.25 * period]
        swings = [max(abs(flow) for t, flow in zip(times, flows) if after <= t <= before)
                  for after, before in zip([0] + zeros, zeros)]
        rows += [Row(f"period, {solver}", 2 * zeros[0], "s", period, within),
                 Row(f"share of the speed that half a period takes, {solver}", 1 - swings[1] / swings[0])]
        curves.append((solver, times, [flow / highest for flow in flows], "--"))
    curves.append(("closed form", [period * k / 100 for k in range(101)],
                   [math.sin(2 * math.pi * k / 100) for k in range(101)], "k-"))
    return Outcome(rows, (Chart("Water in a U", "time (s)", "momentum along the channel", tuple(curves)),))


def velocities_at(frames, places, spacing):
    """At places in the plane, by fits of second order to the particles around each, in the frames together."""
    import numpy
    positions = numpy.concatenate([frame.positions for frame in frames])[:, :2]
    velocities = numpy.concatenate([frame.velocities for frame in frames])
    found = []
    for place in places:
        way = positions - place
        weights = numpy.exp(-(way ** 2).sum(axis=1) / (2 * (0.75 * spacing) ** 2))
        near = weights > 1e-3
        way, root = way[near], numpy.sqrt(weights[near])[:, None]
        terms = numpy.hstack([numpy.ones((len(way), 1)), way, way ** 2, way[:, :1] * way[:, 1:]])
        found.append(numpy.linalg.lstsq(terms * root, velocities[near] * root, rcond=None)[0][0])
    return found


def cavity(lab):
    """Liquid in a square cavity, whose lid glides: in a slab of 4 spacings, periodic along its third axis, at a Reynolds number of
    100. Compared with the velocities along both lines through the middle by U. Ghia, K. N. Ghia and C. T. Shin (1982), as a root of
    the mean square over their places."""
    spacings = lab.scale((0.01, 0.005), (0.01, 0.005, 0.0025))
    runs = [lab.run(f"cavity/{d}", "validation/cavity", {"let.spacing": str(d)}, export=True) for d in spacings]
    rows, curves = [], []
    for d, run in zip(spacings, runs):
        last = [exported(run.folder, k) for k in range(-5, 0)]
        # The lid is the floor of the scene.
        u = [v[0] / LID for v in velocities_at(last, [(SIDE / 2, SIDE * (1 - y)) for y, _ in ALONG_LID], d)]
        v = [-v[1] / LID for v in velocities_at(last, [(SIDE * x, SIDE / 2) for x, _ in ACROSS], d)]
        for what, found, table in (("along the lid", u, ALONG_LID), ("across", v, ACROSS)):
            off = math.sqrt(sum((value - expected) ** 2 for value, (_, expected) in zip(found, table)) / len(table))
            rows.append(Row(f"deviation of velocities {what} over the lid's, {SIDE / d:.0f} spacings a side", off,
                            below=0.05 if d == spacings[-1] else None))
        curves.append((f"{SIDE / d:.0f} spacings", u, [y for y, _ in ALONG_LID], "--"))
    curves.append(("Ghia", [u for _, u in ALONG_LID], [y for y, _ in ALONG_LID], "ko"))
    return Outcome(rows, (Chart("A cavity with a lid that glides", "velocity along the lid, over its own",
                                "height over the side", tuple(curves)),))
