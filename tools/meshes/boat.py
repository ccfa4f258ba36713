#!/usr/bin/env python3
"""Writes resources/meshes/boat.ply: the shell of an open boat, pointed at both ends, as one closed mesh. It lies along x, y is up,
and the lowest points of its rim are at y = 0."""
import math
import pathlib

HALF_LENGTH, HALF_BEAM, DEPTH, WALL, SHEER = 0.4, 0.15, 0.15, 0.012, 0.05  # m
STATIONS, RIBS = 33, 17  # points along the boat, ends left out, and from rim to rim


def shell(wall):
    """Rows of points of the hull, drawn in by the wall: (first end, rows from rim to rim, last end)."""
    def station(s):
        x = (HALF_LENGTH - 2 * wall) * s
        rise = SHEER * (x / HALF_LENGTH) ** 2
        beam = (HALF_BEAM - wall) * (1 - abs(s) ** 2.4)
        depth = (DEPTH - wall) * (1 - abs(s) ** 4) ** 0.6
        row = []
        for k in range(RIBS):
            angle = math.pi * k / (RIBS - 1)
            c, sine = math.cos(angle), math.sin(angle)
            # Between an ellipse and a V, with round bilges.
            row.append((x, rise - (depth + rise) * abs(sine) ** 0.8,
                        -beam * math.copysign(abs(c) ** 0.9, c)))
        return row

    end = HALF_LENGTH - 2 * wall
    tip = SHEER * (end / HALF_LENGTH) ** 2
    places = [-math.cos(math.pi * (i + 1) / (STATIONS + 1)) for i in range(STATIONS)]
    return (-end, tip, 0), [station(s) for s in places], (end, tip, 0)


vertices, triangles = [], []


def add(point):
    vertices.append(point)
    return len(vertices) - 1


def skin(hull, outward):
    """Adds the triangles of a hull; returns numbers of its points."""
    first, rows, last = hull
    a, b = add(first), add(last)
    numbers = [[add(p) for p in row] for row in rows]

    def face(i, j, k):
        triangles.append((i, j, k) if outward else (i, k, j))

    for near, far in zip(numbers, numbers[1:]):
        for k in range(RIBS - 1):
            face(near[k], near[k + 1], far[k + 1])
            face(near[k], far[k + 1], far[k])
    for k in range(RIBS - 1):
        face(a, numbers[0][k + 1], numbers[0][k])
        face(b, numbers[-1][k], numbers[-1][k + 1])
    return a, numbers, b


def rim(outer, inner):
    """Adds the strip between the two rims, all the way round."""
    def loop(hull):
        a, rows, b = hull
        return [a] + [row[0] for row in rows] + [b] + [row[-1] for row in reversed(rows)]

    out, within = loop(outer), loop(inner)
    for k in range(len(out)):
        j = (k + 1) % len(out)
        triangles.append((out[k], out[j], within[j]))
        triangles.append((out[k], within[j], within[k]))


outer = skin(shell(0), True)
inner = skin(shell(WALL), False)
rim(outer, inner)


def volume():
    total = 0
    for i, j, k in triangles:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = vertices[i], vertices[j], vertices[k]
        total += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return total / 6


if volume() < 0:
    triangles = [(i, k, j) for i, j, k in triangles]
edges = {}
for t in triangles:
    for edge in zip(t, t[1:] + t[:1]):
        edges[edge] = edges.get(edge, 0) + 1
assert all(count == 1 and edges.get(edge[::-1]) == 1 for edge, count in edges.items()), "the shell is not closed"

header = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", "property float x", "property float y",
          "property float z", f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
lines = header + ["%.6g %.6g %.6g" % v for v in vertices] + ["3 %d %d %d" % t for t in triangles]
root = pathlib.Path(__file__).resolve().parents[2]
(root / "resources/meshes/boat.ply").write_text("\n".join(lines) + "\n")
print(f"a shell of {1000 * abs(volume()):.3f} litres")
