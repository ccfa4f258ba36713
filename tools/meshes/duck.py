#!/usr/bin/env python3
"""Writes a rubber duck as a closed triangle mesh: resources/meshes/duck.obj, unless another file is named.

The duck is a smooth union of implicit ellipsoids. Its surface is meshed by surface nets: a cell of a grid that the surface crosses
has one vertex, and an edge of the grid that it crosses one quadrilateral between the four cells around it. The duck looks along
+x, y is up, it is about one unit long, and its triangles face outward.
"""

import argparse
import math
import sys
from collections import Counter
from itertools import product
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CELL = 0.0325  # edge of the cells of the grid

# Centre, radii, angle about the z axis in degrees, and width of the blend with all before it.
PARTS = [
    ((0.00, 0.00, 0.00), (0.44, 0.27, 0.33), 0, 0.0),  # body
    ((-0.37, 0.16, 0.00), (0.19, 0.08, 0.17), -38, 0.16),  # tail
    ((0.21, 0.25, 0.00), (0.17, 0.17, 0.17), 0, 0.10),  # neck
    ((0.25, 0.45, 0.00), (0.22, 0.21, 0.21), 0, 0.06),  # head
    ((0.46, 0.43, 0.00), (0.15, 0.060, 0.115), -4, 0.03),  # upper beak
    ((0.44, 0.37, 0.00), (0.12, 0.050, 0.090), 6, 0.03),  # lower beak
    ((-0.06, 0.05, 0.31), (0.25, 0.13, 0.07), -14, 0.03),  # wings
    ((-0.06, 0.05, -0.31), (0.25, 0.13, 0.07), -14, 0.03),
    ((0.415, 0.51, 0.10), (0.050, 0.055, 0.045), 0, 0.005),  # eyes
    ((0.415, 0.51, -0.10), (0.050, 0.055, 0.045), 0, 0.005),
]
FLOOR, FLOOR_BLEND = -0.21, 0.06  # it stands on a flat bottom
LOW, HIGH = (-0.65, -0.35, -0.45), (0.70, 0.75, 0.45)


def ellipsoid(point, centre, radii, angle):
    """About the distance from an ellipsoid, exact to first order at its surface."""
    x, y, z = (p - c for p, c in zip(point, centre))
    cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    local = (cosine * x + sine * y, cosine * y - sine * x, z)
    k0 = math.sqrt(sum((p / r) ** 2 for p, r in zip(local, radii)))
    k1 = math.sqrt(sum((p / r**2) ** 2 for p, r in zip(local, radii)))
    return k0 * (k0 - 1) / k1 if k1 > 0 else -min(radii)


def smooth_min(a, b, width):
    if width == 0:
        return min(a, b)
    h = max(width - abs(a - b), 0) / width
    return min(a, b) - h * h * width / 4


def duck(point):
    """Negative inside."""
    inside = math.inf
    for centre, radii, angle, blend in PARTS:
        inside = smooth_min(inside, ellipsoid(point, centre, radii, angle), blend)
    return -smooth_min(-inside, point[1] - FLOOR, FLOOR_BLEND)


def gradient(point, step=1e-5):
    values = []
    for axis in range(3):
        ends = [tuple(p + side * step * (i == axis) for i, p in enumerate(point)) for side in (1, -1)]
        values.append((duck(ends[0]) - duck(ends[1])) / (2 * step))
    return values


def onto_surface(point):
    for _ in range(3):
        slope = gradient(point)
        scale = duck(point) / max(sum(s * s for s in slope), 1e-6)
        point = tuple(p - scale * s for p, s in zip(point, slope))
    return point


def crossing(a, b, values):
    t = values[a] / (values[a] - values[b])
    return [p + t * (q - p) for p, q in zip(a, b)]


def cell_vertex(cell, values):
    """The mean of the points where the surface crosses the cell's edges, moved onto the surface; in units of the duck."""
    corners = [tuple(c + o for c, o in zip(cell, offset)) for offset in product((0, 1), repeat=3)]
    edges = [(a, b) for a in corners for b in corners if a < b and sum(abs(p - q) for p, q in zip(a, b)) == 1]
    points = [crossing(a, b, values) for a, b in edges if (values[a] < 0) != (values[b] < 0)]
    mean = [sum(p[axis] for p in points) / len(points) for axis in range(3)]
    return onto_surface(tuple(low + CELL * m for low, m in zip(LOW, mean)))


def surface_nets():
    """Vertices and triangles of the duck."""
    counts = [math.ceil((high - low) / CELL) for low, high in zip(LOW, HIGH)]
    grid = product(*(range(count + 1) for count in counts))
    values = {node: duck(tuple(low + CELL * n for low, n in zip(LOW, node))) for node in grid}
    numbers, vertices, triangles = {}, [], []

    def number(cell):
        if cell not in numbers:
            numbers[cell] = len(vertices)
            vertices.append(cell_vertex(cell, values))
        return numbers[cell]

    for node, axis in product(values, range(3)):
        end = tuple(n + (i == axis) for i, n in enumerate(node))
        if end not in values or (values[node] < 0) == (values[end] < 0):
            continue
        u, v = (axis + 1) % 3, (axis + 2) % 3
        around = [tuple(n - (i == u) * du - (i == v) * dv for i, n in enumerate(node)) for du, dv in ((1, 1), (0, 1), (0, 0), (1, 0))]
        quad = [number(cell) for cell in around]
        triangles += split(quad if values[node] < 0 else quad[::-1], vertices)
    return vertices, triangles


def split(quad, vertices):
    """Two triangles of a quadrilateral, along its shorter diagonal."""
    a, b, c, d = quad
    if math.dist(vertices[a], vertices[c]) <= math.dist(vertices[b], vertices[d]):
        return [(a, b, c), (a, c, d)]
    return [(b, c, d), (b, d, a)]


def check_closed(vertices, triangles):
    """Each edge must occur once in each direction, and the volume be positive, which it is where triangles face outward."""
    edges = Counter(edge for t in triangles for edge in zip(t, t[1:] + t[:1]))
    open_edges = [edge for edge, count in edges.items() if count != 1 or edges[edge[::-1]] != 1]
    if open_edges:
        sys.exit(f"the mesh is not closed: {len(open_edges)} edges have not exactly two triangles")
    volume = sum(determinant(*(vertices[i] for i in t)) for t in triangles) / 6
    if volume <= 0:
        sys.exit("the mesh faces inward")


def determinant(a, b, c):
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]))


def write(path, vertices, triangles):
    lines = ["# A rubber duck, closed, y up. Made by tools/meshes/duck.py."]
    lines += ["v " + " ".join(f"{p:.4f}" for p in vertex) for vertex in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in triangle) for triangle in triangles]
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("file", nargs="?", type=Path, default=ROOT / "resources" / "meshes" / "duck.obj")
    path = parser.parse_args().file
    vertices, triangles = surface_nets()
    check_closed(vertices, triangles)
    path.parent.mkdir(parents=True, exist_ok=True)
    write(path, vertices, triangles)
    print(f"{path}: {len(vertices)} vertices, {len(triangles)} triangles, {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
