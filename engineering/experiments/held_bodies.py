"""Lift of a cube or a ball that is held in still water, by TwoProjections or the default solver, over the weight of the water
that it displaces; and how fast water rises beside it and at the walls of the tank (engineering/bodies.md). Needs weir as a
Python module and numpy.

  PYTHONPATH=build/cpu/python python3 engineering/experiments/held_bodies.py [NAME=VALUE…] [SOLVER.NAME=VALUE…]
"""
import sys
import time

import numpy as np
import weir

# Sizes in spacings; m, s. ball=1: a ball of that diameter; size=0: none. mean: over the end of the run.
SETTINGS = dict(size=5.0, ball=0.0, tank=20.0, spacing=0.02, ratio=2.0, dt=2e-3, duration=1.0, mean=0.7, rest=300.0,
                default=0.0)


def volume_of(s):
    size = s["size"] * s["spacing"]
    if not s["ball"]:
        return size ** 3
    t = np.linspace(0, np.pi, 33)  # of the cones between the rings that the mesh has, as 96 turns about
    r, z = size / 2 * np.sin(t), size / 2 * np.cos(t)
    return float(np.sum(np.pi / 3 * (r[1:] ** 2 + r[1:] * r[:-1] + r[:-1] ** 2) * (z[:-1] - z[1:])))


def scene_of(s, solver):
    side, half = s["tank"] * s["spacing"], s["size"] * s["spacing"] / 2
    scene = weir.Scene("a held body")
    scene.world.set(duration=s["duration"], frame_rate=10, dt=s["dt"])
    block = scene.add("BoxSampler", "block", min=(0, 0, 0), max=(side, side, side))
    water = scene.add("ParticleFluid", "water", spacing=s["spacing"], support_ratio=s["ratio"], rest_steps=int(s["rest"]))
    if not s["default"]:
        water.modules.replace("solver", "TwoProjections", **solver)
    water.modules["viscosity"].enabled = False
    block.particles >> water.initial
    tank = scene.add("StaticBoundary", "tank", shape="box", min=(0, 0, 0), max=(side, 2 * side, side), inverted=True,
                     report_forces=True)
    tank.boundary >> water.boundaries
    if s["size"]:
        middle = side / 2
        held = scene.add("SemiAnalyticalSFI", "held")
        if s["ball"]:
            t = np.linspace(0, np.pi, 33)
            profile = [(float(half * np.sin(a)) if 0 < a < np.pi else 0.0, float(-half * np.cos(a))) for a in t]
            mesh = scene.add("TurningModel", "mesh", profile=profile, position=(middle, middle, middle))
        else:
            mesh = scene.add("BoxMesh", "mesh", min=(middle - half,) * 3, max=(middle + half,) * 3)
        mesh.surface >> held.solids
        water.fluid >> held.fluid
    return scene, water


class Rising:
    """Mean velocity upwards in layers of half a spacing beside walls."""

    def __init__(self, s):
        self.s, self.sums = s, {}

    def add(self, name, near, v):
        layers = np.floor(near / (0.5 * self.s["spacing"])).astype(int)
        for k in range(4):
            found = self.sums.setdefault((name, k), [0, 0.0])
            found[0] += int(np.sum(layers == k))
            found[1] += float(np.sum(v[layers == k, 1]))

    def look(self, x, v):
        d, side = self.s["spacing"], self.s["tank"] * self.s["spacing"]
        mid, half = side / 2, self.s["size"] * self.s["spacing"] / 2
        depths = (x[:, 1] > 0.15 * side) & (x[:, 1] < 0.7 * side)
        walls = np.sort(np.stack([x[:, 0], side - x[:, 0], x[:, 2], side - x[:, 2]]), axis=0)
        flat, edge = depths & (walls[1] > 2.5 * d), depths & (walls[1] < 2 * d)
        self.add("tank", walls[0][flat], v[flat])
        self.add("edges", np.maximum(walls[0], walls[1])[edge], v[edge])
        if not self.s["size"]:
            return
        if self.s["ball"]:
            beside = np.abs(x[:, 1] - mid) < 0.4 * half
            self.add("body", np.linalg.norm(x[beside] - mid, axis=1) - half, v[beside])
            return
        off = np.abs(x - mid)
        beside = (off[:, 1] < 0.7 * half) & (np.minimum(off[:, 0], off[:, 2]) < 0.8 * half)
        far = np.maximum(off[:, 0], off[:, 2])[beside] - half
        self.add("body", far, v[beside])

    def __str__(self):
        def mean(name, k):
            count, total = self.sums[name, k]
            return f"{total / max(count, 1):+.3f}"

        names = dict.fromkeys(name for name, _ in self.sums)
        return "; ".join(f"{name} " + ", ".join(mean(name, k) for k in range(4)) for name in names)


def main():
    s, solver = dict(SETTINGS), {}
    for word in sys.argv[1:]:
        name, value = word.split("=")
        if name.startswith("solver."):
            solver[name[7:]] = float(value) if "." in value or "e" in value else int(value)
        else:
            s[name] = float(value)
    (scene, water), began, rising = scene_of(s, solver), time.process_time(), Rising(s)
    sim = weir.Simulation(scene, device="cpu", threads=1)
    sim.refresh()
    x = np.array(water.positions, dtype=float)
    start, lifts, floor, speeds = float(np.mean(x[:, 1])), [], [], []
    while sim.time < s["duration"] - 1e-9:
        sim.step()
        if sim.time < s["duration"] - s["mean"]:
            continue
        sim.refresh()
        x, v = np.array(water.positions, dtype=float), np.array(water.velocities, dtype=float)
        rising.look(x, v)
        speeds.append(np.mean(np.sum(v ** 2, 1)))
        nodes = sim.statistics["nodes"]
        floor.append(nodes["tank"]["force"][1])
        if s["size"]:
            lifts.append(nodes["held"]["solids"][0]["force"][1])
    side, weight = s["tank"] * s["spacing"], 9.8 * len(x) * s["spacing"] ** 3 * 1000
    lift = 9.8 * 1000 * volume_of(s) if s["size"] else 0
    high = [100 * (2 * height / side - 1) for height in (np.mean(x[:, 1]), start)]  # of a tank without a body
    if lifts:
        print(f"lift {np.mean(lifts) / lift:.3f} of {lift:.1f} N;", end=" ")
    print(f"tank {-np.mean(floor) / (weight + lift):.4f} of {weight + lift:.0f} N; "
          f"all speeds {np.sqrt(np.mean(speeds)):.4f} m/s; rises, by half spacings: {rising}; "
          f"height {high[0]:+.2f} % (first {high[1]:+.2f}); {len(x)} particles, {time.process_time() - began:.0f} s",
          flush=True)


if __name__ == "__main__":
    main()
