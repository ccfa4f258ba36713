"""Water at rest in a box, by TwoProjections (engineering/jelly.md): how high it stands against one particle in d³, and
how calm it is. Needs weir as a Python module and numpy.

  python3 engineering/experiments/water_in_boxes.py [NAME=VALUE…] [SOLVER.NAME=VALUE…]
"""

import sys

import numpy as np
import weir

# width and depth in spacings; m, s. mesh=1: walls by a mesh of SemiAnalyticalSFI.
SETTINGS = dict(width=8.0, depth=8.0, spacing=0.025, ratio=2.0, dt=2e-3, duration=0.5, rest=3000.0, mesh=0.0)


def main():
    s, solver = dict(SETTINGS), {}
    for word in sys.argv[1:]:
        name, value = word.split("=")
        if name.startswith("solver."):
            solver[name[7:]] = float(value) if "." in value else int(value)
        else:
            s[name] = float(value)
    wide, depth = s["width"] * s["spacing"], s["depth"] * s["spacing"]
    scene = weir.Scene("water in a box")
    scene.world.set(duration=s["duration"], frame_rate=10, dt=s["dt"])
    block = scene.add("BoxSampler", "block", min=(0, 0, 0), max=(wide, depth, wide))
    water = scene.add("ParticleFluid", "water", spacing=s["spacing"], support_ratio=s["ratio"], rest_steps=int(s["rest"]))
    water.modules.replace("solver", "TwoProjections", **solver)
    water.modules["viscosity"].enabled = False
    block.particles >> water.initial
    low, high = (0, 0, 0), (wide, 2 * depth, wide)
    if s["mesh"]:
        walls = scene.add("SemiAnalyticalSFI", "tank", fill="container")
        scene.add("BoxMesh", "box", min=low, max=high).surface >> walls.solids
        water.fluid >> walls.fluid
    else:
        walls = scene.add("StaticBoundary", "tank", shape="box", min=low, max=high, inverted=True, report_forces=True)
        walls.boundary >> water.boundaries
    sim = weir.Simulation(scene, device="cpu")
    sim.refresh()
    heights, squares, energy, fastest = [], [], [], 0
    while sim.time < s["duration"]:
        x, v = np.array(water.positions, dtype=float), np.array(water.velocities, dtype=float)
        heights.append(2 * np.mean(x[:, 1]))
        squares.append(np.mean(np.sum(v ** 2, 1)))
        fastest = max(fastest, np.sqrt(np.max(np.sum(v ** 2, 1))))
        energy.append(np.mean(np.sum(v ** 2, 1) / 2 + 9.8 * x[:, 1]))
        sim.step()
    later = len(heights) // 2
    full = len(x) * s["spacing"] ** 3 / wide ** 2
    print(*sys.argv[1:], f"({len(x)} particles): height {100 * (np.mean(heights[later:]) / full - 1):+.2f} %, at first "
          f"{100 * (heights[0] / full - 1):+.2f} %; velocities {np.sqrt(np.mean(squares[later:])):.3f} m/s, the fastest "
          f"{fastest:.2f}; energy gained {energy[-1] - energy[0]:+.4f} J/kg")


if __name__ == "__main__":
    main()
