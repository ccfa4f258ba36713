#!/usr/bin/env python3
"""Writes resources/meshes/water_wheel.ply: a hub with flat paddles about the z axis, as one closed mesh."""
import math
import pathlib

PADDLES, TIP, HUB, HALF_WIDTH, HALF_THICKNESS = 8, 0.12, 0.035, 0.05, 0.006  # m

outline = []
for k in range(PADDLES):
    c, s = math.cos(2 * math.pi * k / PADDLES), math.sin(2 * math.pi * k / PADDLES)
    for r, t in ((HUB, -1), (TIP, -1), (TIP, 1), (HUB, 1)):
        outline.append((r * c - t * HALF_THICKNESS * s, r * s + t * HALF_THICKNESS * c))

n = len(outline)
# Each face is a fan about its middle.
vertices = [(0, 0, -HALF_WIDTH)] + [(x, y, -HALF_WIDTH) for x, y in outline]
vertices += [(0, 0, HALF_WIDTH)] + [(x, y, HALF_WIDTH) for x, y in outline]
back, front = 0, n + 1
triangles = []
for i in range(n):
    j = (i + 1) % n
    low, low_next, high, high_next = back + 1 + i, back + 1 + j, front + 1 + i, front + 1 + j
    triangles += [(front, high, high_next), (back, low_next, low), (low, low_next, high_next), (low, high_next, high)]

header = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", "property float x", "property float y",
          "property float z", f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
lines = header + ["%.6g %.6g %.6g" % v for v in vertices] + ["3 %d %d %d" % t for t in triangles]
root = pathlib.Path(__file__).resolve().parents[2]
(root / "resources/meshes/water_wheel.ply").write_text("\n".join(lines) + "\n")
