"""How the pattern of foam goes along with the water.

Cells that stand in space would let foam run through them. So they are looked up where the water came from, by its
velocity, straight on. That is right for a short time only, so there are two patterns which start anew in turn, and of
which each fades out before it does (N. Max and B. Becker, Flow visualization using moving textures, 1995). No frame
needs another one.
"""

import numpy

CYCLE = 0.5  # s, from one start of a pattern to the next
CELL = 1.25  # reaches: patterns that far apart have little in common
MIDDLE = 0.4  # the mean height of the pattern (materials.py)


def carried(vertices, velocities, reach, time):
    """Of each vertex the places of both patterns, m, and (n, 3) shares: of each pattern, and a height that is added,
    so that the mixture varies as much as one of them does."""
    turns = [time / CYCLE + start for start in (0.0, 0.5)]
    places = [vertices - (turn % 1 - 0.5) * CYCLE * velocities for turn in turns]
    first = 1 - abs(2 * (turns[0] % 1) - 1)
    apart = 0.5 * CYCLE * numpy.linalg.norm(velocities, axis=1) / (CELL * reach)
    common = numpy.exp(-(apart**2))
    gain = 1 / numpy.sqrt(first**2 + (1 - first) ** 2 + 2 * first * (1 - first) * common)
    return places, numpy.column_stack([first * gain, (1 - first) * gain, MIDDLE * (1 - gain)])
