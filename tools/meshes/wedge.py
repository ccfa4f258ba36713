#!/usr/bin/env python3
"""Writes resources/meshes/wedge_15.ply, wedge_20.ply and wedge_30.ply: prisms along z whose bottom rises from the keel, at
the origin, by that many degrees to both sides."""
import math
import pathlib

HALF_WIDTH, HALF_LENGTH, FREEBOARD = 0.5, 0.1, 0.05  # m


def prism(outline):
    """Vertices and triangles between two copies of an outline, which runs counter-clockwise about the z axis."""
    n = len(outline)
    vertices = [(x, y, z) for z in (-HALF_LENGTH, HALF_LENGTH) for x, y in outline]
    triangles = []
    for i in range(n):
        j = (i + 1) % n
        triangles += [(i, j, n + j), (i, n + j, n + i)]
    for i in range(1, n - 1):
        triangles += [(0, i + 1, i), (n, n + i, n + i + 1)]
    return vertices, triangles


def ply(vertices, triangles):
    header = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", "property float x", "property float y",
              "property float z", f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    lines = header + ["%.7g %.7g %.7g" % v for v in vertices] + ["3 %d %d %d" % t for t in triangles]
    return "\n".join(lines) + "\n"


folder = pathlib.Path(__file__).resolve().parents[2] / "resources" / "meshes"
for angle in (15, 20, 30):
    rise = HALF_WIDTH * math.tan(math.radians(angle))
    top = rise + FREEBOARD
    outline = [(0, 0), (HALF_WIDTH, rise), (HALF_WIDTH, top), (-HALF_WIDTH, top), (-HALF_WIDTH, rise)]
    (folder / f"wedge_{angle}.ply").write_text(ply(*prism(outline)))
