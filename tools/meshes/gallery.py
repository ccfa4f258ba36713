#!/usr/bin/env python3
"""Writes meshes of gallery scenes, each of closed parts that do not touch: mill_wheel.ply (buckets between two rims, about the z axis),
ship_hull.ply and ship_house.ply (a cutter along x, its waterline at y = 0), sea_rock.ply (1 m in radius, to be scaled) and islet.ply
(a rock with room for a tower of 1.5 m in radius on it, at y = 4.3). Metres."""
import math
import pathlib
import random

GAP = 0.004  # m, between parts
MESHES = pathlib.Path(__file__).resolve().parents[2] / "resources/meshes"


class Mesh:
    def __init__(self):
        self.vertices, self.triangles = [], []

    def loops(self, loops, ends):
        """A tube through loops of as many points each, the first and the last of them closed by fans; open for rings."""
        numbers = []
        for loop in loops:
            numbers.append(range(len(self.vertices), len(self.vertices) + len(loop)))
            self.vertices += loop
        pairs = list(zip(numbers, numbers[1:])) + ([] if ends else [(numbers[-1], numbers[0])])
        for near, far in pairs:
            for i in range(len(near)):
                j = (i + 1) % len(near)
                self.triangles += [(near[i], near[j], far[j]), (near[i], far[j], far[i])]
        if ends:
            self._fan(loops[0], numbers[0], True)
            self._fan(loops[-1], numbers[-1], False)

    def _fan(self, loop, numbers, first):
        self.vertices.append(tuple(sum(axis) / len(loop) for axis in zip(*loop)))
        middle = len(self.vertices) - 1
        for i in range(len(loop)):
            j = (i + 1) % len(loop)
            self.triangles.append((middle, numbers[j], numbers[i]) if first else (middle, numbers[i], numbers[j]))

    def box(self, low, high):
        (a, b, c), (d, e, f) = low, high
        self.loops([[(a, b, z), (d, b, z), (d, e, z), (a, e, z)] for z in (c, f)], True)

    def cylinder(self, radius, corners, start, end):
        """Along y, from the place `start` to the place `end`."""
        ring = [(radius * math.cos(2 * math.pi * k / corners), radius * math.sin(2 * math.pi * k / corners)) for k in range(corners)]
        self.loops([[(x + a, y, b - z) for a, b in ring] for x, y, z in ((start[0], start[1], -start[2]), (end[0], end[1], -end[2]))], True)

    def check(self, name):
        """Each part has to be closed and to face outwards."""
        edges = {}
        for t in self.triangles:
            for edge in zip(t, t[1:] + t[:1]):
                edges[edge] = edges.get(edge, 0) + 1
        if not all(n == 1 and edges.get(edge[::-1]) == 1 for edge, n in edges.items()):
            raise SystemExit(f"{name} is not closed")

    def turn_outwards(self, first):
        """Of the triangles from `first` on, which are one part."""
        total = 0
        for i, j, k in self.triangles[first:]:
            (ax, ay, az), (bx, by, bz), (cx, cy, cz) = self.vertices[i], self.vertices[j], self.vertices[k]
            total += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        if total < 0:
            self.triangles[first:] = [(i, k, j) for i, j, k in self.triangles[first:]]

    def part(self, add):
        first = len(self.triangles)
        add()
        self.turn_outwards(first)

    def write(self, name):
        self.check(name)
        header = ["ply", "format ascii 1.0", f"element vertex {len(self.vertices)}", "property float x", "property float y",
                  "property float z", f"element face {len(self.triangles)}", "property list uchar int vertex_indices", "end_header"]
        lines = header + ["%.5g %.5g %.5g" % v for v in self.vertices] + ["3 %d %d %d" % t for t in self.triangles]
        (MESHES / name).write_text("\n".join(lines) + "\n")


def with_edges(outline, size=0.012):
    """A closed outline with small chamfers, and points beside them, so that what is shaded smoothly looks flat up to its edges."""
    points = []
    for i, (x, y) in enumerate(outline):
        for (a, b), sizes in ((outline[i - 1], (2 * size, size)), (outline[(i + 1) % len(outline)], (size, 2 * size))):
            length = math.hypot(a - x, b - y)
            points += [(x + s / length * (a - x), y + s / length * (b - y)) for s in sizes]
    return points


def mill_wheel():
    buckets, tip, floor, inner, half, board = 20, 2.0, 1.52, 1.42, 0.5, 0.05
    mesh = Mesh()
    outer = []
    for k in range(buckets):
        start = 2 * math.pi * k / buckets
        # A board leans forwards, so that its bucket holds water above the axle.
        for r, turn in ((floor, 0.0), (0.5 * (floor + tip), 0.015), (tip, 0.15), (tip, 0.15 + board / tip),
                        (0.5 * (floor + tip), 0.015 + board / 1.7), (floor, board / floor)):
            outer.append((r * math.cos(start + turn), r * math.sin(start + turn)))
    count = len(outer)
    # The inner side has as many points, spread evenly.
    within = [(inner * math.cos(2 * math.pi * i / count), inner * math.sin(2 * math.pi * i / count)) for i in range(count)]
    mesh.part(lambda: mesh.loops([[(x, y, -half) for x, y in outer], [(x, y, half) for x, y in outer],
                                  [(x, y, half) for x, y in within], [(x, y, -half) for x, y in within]], False))
    corners = 60
    for side in (-1, 1):
        near, far = side * (half + GAP), side * (half + 0.08)
        rings = [[(r * math.cos(2 * math.pi * k / corners), r * math.sin(2 * math.pi * k / corners), z) for k in range(corners)]
                 for r, z in with_edges([(inner, near), (tip + 0.04, near), (tip + 0.04, far), (inner, far)])]
        mesh.part(lambda: mesh.loops(rings, False))
        for k in range(8):
            mesh.part(lambda: spoke(mesh, 2 * math.pi * (k + 0.5) / 8, 0.24, inner - GAP, side * (half - 0.1)))
    hub = [[(r * math.cos(2 * math.pi * k / 32), r * math.sin(2 * math.pi * k / 32), z) for k in range(32)]
           for r, z in ((0.16, -0.9), (0.16, -half), (0.22, -half), (0.22, half), (0.16, half), (0.16, 0.9))]
    mesh.part(lambda: mesh.loops(hub, True))
    mesh.write("mill_wheel.ply")


def spoke(mesh, angle, start, end, place):
    c, s = math.cos(angle), math.sin(angle)
    wide, thick = 0.05, 0.04

    def at(r):
        return [(r * c - a * s, r * s + a * c, place + b) for a, b in ((-wide, -thick), (wide, -thick), (wide, thick), (-wide, thick))]

    mesh.loops([at(start), at(end)], True)


def ship_hull():
    length, beam, draught, deck, stations, points = 12.0, 1.9, 1.25, 1.15, 40, 14
    mesh = Mesh()
    loops = []
    for i in range(stations + 1):
        s = -1 + 2 * i / stations
        front = max(0.0, s)
        half = beam * (1 - 0.28 * max(0.0, -s) ** 2) * max(0.015, 1 - front ** 2.3)
        rim = deck + 0.75 * front ** 2
        keel = -draught * (1 - 0.55 * max(0.0, -s) ** 4 - 0.25 * front ** 6)
        side = []
        for k in range(points + 1):
            t = k / points
            width = half * t ** (0.33 + 0.75 * front ** 1.5)
            side.append((0.5 * length * s + 1.1 * front ** 3 * t, keel + (rim - keel) * t, width))
        loops.append(side + [(x, y, -z) for x, y, z in reversed(side[1:])])
    mesh.part(lambda: mesh.loops(loops, True))
    mesh.write("ship_hull.ply")


def ship_house():
    """Stands on the deck."""
    mesh = Mesh()
    deck = 1.15 + GAP
    for low, high in (((-4.2, deck, -1.15), (-0.4, deck + 1.35, 1.15)),
                      ((-2.2, deck + 1.35 + GAP, -0.95), (-0.7, deck + 2.6, 0.95)),
                      ((-2.35, deck + 2.6 + GAP, -1.1), (-0.5, deck + 2.7, 1.1))):
        mesh.part(lambda: mesh.box(low, high))
    mesh.part(lambda: mesh.cylinder(0.4, 24, (-3.1, deck + 1.35 + GAP, 0), (-3.25, deck + 3, 0)))
    mesh.part(lambda: mesh.cylinder(0.06, 8, (-1.5, deck + 2.7 + GAP, 0), (-1.6, deck + 5.6, 0)))
    mesh.write("ship_house.ply")


def sphere(times):
    """(directions, triangles): an octahedron whose triangles are cut into four that many times."""
    points = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    triangles = [(x, y, z) if (x + y + z) % 2 == 0 else (x, z, y) for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    for _ in range(times):
        middles = {}

        def middle(i, j):
            key = min(i, j), max(i, j)
            if key not in middles:
                between = [a + b for a, b in zip(points[i], points[j])]
                middles[key] = len(points)
                points.append(tuple(a / math.hypot(*between) for a in between))
            return middles[key]

        triangles = [part for i, j, k in triangles for a, b, c in [(middle(i, j), middle(j, k), middle(k, i))]
                     for part in ((i, a, c), (a, j, b), (c, b, k), (a, b, c))]
    return points, triangles


def noise(at, seed):
    """From -1 to 1, smooth over lengths of 1: values at whole places, and between them by x²(3 − 2x)."""
    low = [math.floor(a) for a in at]
    shares = [(a - b) ** 2 * (3 - 2 * (a - b)) for a, b in zip(at, low)]
    total = 0.0
    for corner in range(8):
        bits = corner & 1, corner >> 1 & 1, corner >> 2
        share = math.prod(s if bit else 1 - s for s, bit in zip(shares, bits))
        number = sum((a + bit) * prime for a, bit, prime in zip(low, bits, (73856093, 19349663, 83492791))) ^ seed * 2654435761
        number = (number ^ number >> 13) * 1274126177 & 0xffffffff
        total += share * ((number ^ number >> 16) / 0x7fffffff - 1)
    return total


def crags(at, seed):
    """From 0 to 1, with sharp ridges, in five octaves."""
    return sum((1 - abs(noise([a * 2 ** k for a in at], seed + k))) ** 2 / 2 ** k for k in range(5)) / 1.94


def rock(name, times, size, cuts, rough, top, seed):
    """What random planes leave of an ellipsoid of half axes `size`, with crags of `rough` m on it; flat above `top`."""
    chance = random.Random(seed)
    planes = []
    for _ in range(cuts):
        normal = [chance.gauss(0, 1) for _ in range(3)]
        planes.append(([a / math.hypot(*normal) for a in normal], chance.uniform(0.72, 0.98)))
    points, triangles = sphere(times)
    mesh = Mesh()
    for point in points:
        radius = min([1.0] + [far / along for normal, far in planes if (along := sum(a * b for a, b in zip(normal, point))) > 0.3])
        at = [radius * a * b for a, b in zip(point, size)]
        grown = rough * (2 * crags([0.9 * a / max(size) ** 0.5 for a in at], seed) - 1.2)
        at = [a + grown * b for a, b in zip(at, point)]
        at[1] = min(at[1], top + 0.25 * (at[1] - top) / (1 + at[1] - top)) if at[1] > top else at[1]
        mesh.vertices.append(tuple(at))
    mesh.part(lambda: mesh.triangles.extend(triangles))
    mesh.write(name)


mill_wheel()
ship_hull()
ship_house()
rock("sea_rock.ply", 5, (1.0, 0.8, 0.9), 26, 0.12, 9.0, 5)
rock("islet.ply", 6, (6.6, 4.9, 5.8), 60, 0.9, 4.3, 11)
