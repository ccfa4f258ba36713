"""A cube of 0.1 m floats in a pool two sides wide and two deep, for engineering/bodies.md: time, and draught over the side.

  PYTHONPATH=build/cpu/python python3 engineering/experiments/floating_cube.py SPACINGS DENSITY [SECONDS [THREADS]]

The cube has so many spacings along its side and is let go one above the water. The level is that of the particles' volume and
of what the cube displaces by its weight."""
import json
import sys

import weir

SIDE, POOL, DEPTH, LATE = 0.1, 0.2, 0.2, 0.8  # m; s


def scene_of(spacings, density):
    d, half = SIDE / spacings, POOL / 2
    return {"weir": 1,
            "world": {"gravity": [0, -9.8, 0], "dt": 0.001 if spacings > 10 else 0.002, "frame_rate": 20, "duration": 5},
            "nodes": {
                "block": {"type": "BoxSampler", "params": {"min": [-half, 0, -half], "max": [half, DEPTH, half]}},
                "tank": {"type": "StaticBoundary",
                         "params": {"shape": "box", "inverted": True, "min": [-half, 0, -half], "max": [half, 2, half]}},
                "cube": {"type": "BoxMesh", "params": {"min": [-SIDE / 2] * 3, "max": [SIDE / 2] * 3}},
                "body": {"type": "RigidBody",
                         "params": {"position": [0, DEPTH + SIDE / 2 + d, 0], "density": density, "fixed_rotation": "xyz",
                                    "fixed": "xz"}},
                "water": {"type": "ParticleFluid", "params": {"spacing": d, "rest_steps": 200}}},
            "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries", "tank.boundary -> body.walls",
                      "water.fluid -> body.fluid", "cube.surface -> body.mesh"]}


def main():
    spacings, density = int(sys.argv[1]), float(sys.argv[2])
    seconds, threads = [float(given) for given in sys.argv[3:5] + ["1.5", "1"][len(sys.argv[3:5]):]]
    scene = weir.loads(json.dumps(scene_of(spacings, density)))
    run, late = weir.Simulation(scene, device="cpu", threads=int(threads)), []
    while run.time < seconds - 1e-9:
        run.advance()
        water = run.statistics["nodes"]["water"]["particles"] * (SIDE / spacings) ** 3
        level = (water + density / 1000 * SIDE ** 3) / POOL ** 2
        draught = (level - scene.body.pose().translation[1] + SIDE / 2) / SIDE
        if run.time > LATE:
            late.append(draught)
        print(f"{run.time:.2f} s {draught:.4f}", flush=True)
    if late:
        print(f"mean from {LATE} s on: {sum(late) / len(late):.4f}, {density / 1000:g} is right")


if __name__ == "__main__":
    main()
