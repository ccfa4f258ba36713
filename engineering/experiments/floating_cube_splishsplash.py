"""A cube floats in a small pool by SPlisHSPlasH's DFSPH with boundaries of particles that move (Akinci et al. 2012), for
engineering/bodies.md. Prints time and draught over the side.

  floating_cube_splishsplash.py SPACINGS DENSITY [SECONDS] [DEPTH]

The cube has a side of 0.1 m and that many spacings; the pool is two sides wide and DEPTH sides deep (2). Needs
pysplishsplash of PyPI; where its import ends in libGLdispatch, preload the system's. Boundary particles are half a spacing
inside of surfaces, as those of the pool are half a spacing outside, and the body has the mass of the whole cube."""

import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests" / "benchmarks"))
import pysplishsplash as sph  # noqa: E402
from splishsplash_run import box_obj  # noqa: E402

SIDE, WIDTH, AKINCI_2012, DFSPH = 0.1, 0.2, 0, 4


def scene(folder, count, density, depth):
    d = SIDE / count
    low, high = -WIDTH / 2 - d / 2, WIDTH / 2 + d / 2
    (folder / "tank.obj").write_text(box_obj([low, -d / 2, low], [high, 3 * depth, high]))
    (folder / "cube.obj").write_text(box_obj([(d - SIDE) / 2] * 3, [(SIDE - d) / 2] * 3))
    place = {"rotationAxis": [1, 0, 0], "rotationAngle": 0, "scale": [1, 1, 1], "collisionObjectType": 2}
    return {
        "Configuration": {"particleRadius": d / 2, "timeStepSize": 0.001, "cflMethod": 1, "cflMaxTimeStepSize": 0.002,
                          "cflFactor": 0.5, "density0": 1000, "simulationMethod": DFSPH, "gravitation": [0, -9.8, 0],
                          "boundaryHandlingMethod": AKINCI_2012, "maxError": 0.01, "maxErrorV": 0.1, "maxIterations": 100},
        "Materials": [{"id": "Fluid", "density0": 1000, "viscosityMethod": 1, "viscosity": 0.01}],
        "RigidBodies": [
            place | {"id": 1, "geometryFile": str(folder / "tank.obj"), "translation": [0, 0, 0], "isDynamic": False,
                     "isWall": True, "collisionObjectScale": [WIDTH, 6 * depth, WIDTH], "invertSDF": True},
            place | {"id": 2, "geometryFile": str(folder / "cube.obj"), "translation": [0, depth + SIDE / 2 + d, 0],
                     "isDynamic": True, "isWall": False, "density": density * (count / (count - 1)) ** 3,
                     "velocity": [0, 0, 0], "restitution": 0, "friction": 0, "collisionObjectScale": [SIDE] * 3}],
        "FluidBlocks": [{"id": "Fluid", "denseMode": 0, "start": [low, -d / 2, low], "end": [high, depth + d / 2, high],
                         "translation": [0, 0, 0], "scale": [1, 1, 1]}]}


def main():
    count, density = int(sys.argv[1]), float(sys.argv[2])
    seconds, depth = [float(given) for given in sys.argv[3:5] + ["1.5", "2"][len(sys.argv[3:5]):]]
    depth *= SIDE
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scene.json").write_text(json.dumps(scene(folder, count, density, depth)))
        base = sph.Exec.SimulatorBase()
        base.init(["weir", "--no-gui", "--no-cache", "--scene-file", str(folder / "scene.json"), "--output-dir", name],
                  "cube")
        base.initSimulation()
        base.setValueFloat(base.STOP_AT, seconds)
        simulation, told = sph.Simulation.getCurrent(), [0.0]

        def tell():
            time = sph.TimeManager.getCurrent().getTime()
            if time < told[0]:
                return
            told[0] += 0.05
            cube = simulation.getBoundaryModel(1).getRigidBodyObject()
            # The level by volume: of the particles, and of the water that the weight displaces.
            water = simulation.getFluidModel(0).numActiveParticles() * (SIDE / count) ** 3
            level = (water + cube.getMass() / 1000) / WIDTH ** 2
            print(f"cube {time:.3f} s, {(level - cube.getPosition()[1] + SIDE / 2) / SIDE:.3f}", flush=True)

        base.setTimeStepCB(tell)
        base.runSimulation()


if __name__ == "__main__":
    main()
