"""Runs one dam break of SPlisHSPlasH and times its steps; compare_splishsplash.py calls it with the Python that has
pysplishsplash. One JSON object comes on stdin and the result goes to the file that it names, because the library writes
to stdout as it likes."""

import json
import sys
import time
from pathlib import Path

import numpy
import pysplishsplash as sph

METHODS = {"PBF": 2, "DFSPH": 4}
AKINCI_2012 = 0
WARM_STEPS, TIMED_STEPS, MOMENT_STEPS = 20, 40, 100  # as `weir bench` has them


def box_obj(low, high):
    """A closed box as the text of an OBJ file."""
    corners = [(x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
    faces = ((1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6))
    lines = ["v {:.9g} {:.9g} {:.9g}".format(*corner) for corner in corners]
    for a, b, c, d in faces:
        lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    return "\n".join(lines) + "\n"


def scene(task, folder):
    """The dam break as SPlisHSPlasH describes it. Its walls are particles; they are half a spacing outside of the tank, so
    that fluid at rest lies on them as it lies on itself."""
    d = task["spacing"]
    obj = folder / "tank.obj"
    obj.write_text(box_obj([-0.5 * d] * 3, [size + 0.5 * d for size in task["tank"]]), encoding="utf-8")
    return {
        "Configuration": {
            "particleRadius": 0.5 * d, "timeStepSize": task["dt"], "cflMethod": 0, "density0": 1000,
            "simulationMethod": METHODS[task["method"]], "gravitation": [0, -9.8, 0],
            "boundaryHandlingMethod": AKINCI_2012, "enableZSort": True},
        "Materials": [{"id": "Fluid", "density0": 1000, "viscosityMethod": 1, "viscosity": 0.01}],
        "RigidBodies": [{"id": 1, "geometryFile": str(obj), "translation": [0, 0, 0], "rotationAxis": [1, 0, 0],
                         "rotationAngle": 0, "scale": [1, 1, 1], "isDynamic": False, "isWall": True}],
        # A block holds one particle less along an edge than its length says.
        "FluidBlocks": [{"id": "Fluid", "denseMode": 0, "start": [-0.5 * d] * 3,
                         "end": [size + 0.5 * d for size in task["block"]], "translation": [0, 0, 0],
                         "scale": [1, 1, 1]}]}


class Stopwatch:
    """Called after each step; times those of two moments."""

    def __init__(self, fluid, method, late_step):
        self.fluid, self.method = fluid, method
        self.starts = {"early": WARM_STEPS, "late": max(late_step, WARM_STEPS + MOMENT_STEPS) + WARM_STEPS}
        self.steps, self.times, self.iterations, self.moments = 0, [], [], []
        self.last = time.perf_counter()

    @property
    def all_steps(self):
        return self.starts["late"] + MOMENT_STEPS

    def __call__(self):
        elapsed = time.perf_counter() - self.last
        for name, start in self.starts.items():
            if start <= self.steps < start + TIMED_STEPS:
                self.times.append(1e3 * elapsed)
                self.iterations.append(self.method.getNumIterations())
            if self.steps + 1 == start + MOMENT_STEPS:
                self.moments.append({"moment": name} | self.numbers())
        self.steps += 1
        self.last = time.perf_counter()

    def numbers(self):
        times, iterations, self.times, self.iterations = sorted(self.times), self.iterations, [], []
        count = self.fluid.numActiveParticles()
        position = numpy.array(self.fluid.getFieldBuffer("position"))[:count].astype(float)
        density = numpy.array(self.fluid.getFieldBuffer("density"))[:count].astype(float)
        return {"particles": count, "step_ms_median": times[(len(times) - 1) // 2], "timed_steps": len(times),
                "iterations_mean": sum(iterations) / len(iterations),
                "compression_mean": float(numpy.maximum(density / 1000 - 1, 0).mean()),
                "center_of_mass": position.mean(axis=0).tolist(), "finite": bool(numpy.isfinite(position).all())}


def main():
    task = json.load(sys.stdin)
    folder = Path(task["folder"])
    scene_file = folder / "scene.json"
    scene_file.write_text(json.dumps(scene(task, folder)), encoding="utf-8")
    base = sph.Exec.SimulatorBase()
    base.init(["weir", "--no-gui", "--no-cache", "--scene-file", str(scene_file), "--output-dir", str(folder / "out")],
              "comparison")
    base.initSimulation()
    simulation = sph.Simulation.getCurrent()
    method = simulation.getTimeStep()
    method.setValueUInt(method.MIN_ITERATIONS, task["min_iterations"])
    method.setValueUInt(method.MAX_ITERATIONS, task["max_iterations"])
    method.setValueFloat(method.MAX_ERROR, task["max_error_percent"])
    watch = Stopwatch(simulation.getFluidModel(0), method, round(task["late_after"] / task["dt"]))
    base.setValueFloat(base.STOP_AT, (watch.all_steps - 0.5) * task["dt"])
    base.setTimeStepCB(watch)
    base.runSimulation()
    result = {"moments": watch.moments, "support_ratio": simulation.getSupportRadius() / task["spacing"]}
    Path(task["result"]).write_text(json.dumps(result), encoding="utf-8")


if __name__ == "__main__":
    main()
