"""What a module in Python costs beside its own kernel: prints one line a measurement, and fails beyond a bound.

    PYTHONPATH=build/cpu/python .deps/python/bin/python tests/benchmarks/python_module.py [--spacing 0.01] [--rounds 12] [--threads N] [--clock cpu]

Three simulations of one scene, 100,000 particles at rest in a tank, are advanced in turns: one as it is, one with a
module in Python, and one with a callback after each step. The module reads positions, writes velocities and an
attribute of its own. Its kernel is timed where it runs and subtracted; what remains over the first simulation is the
cost of crossing to Python and back. The kernel adds 0, so all simulations do the same otherwise. Of all rounds the
fastest counts, as it was disturbed least; on a busy machine `--clock cpu --threads 1` compares processor time.
"""

import argparse
import sys
import time

import numpy as np

import weir


class Swirl(weir.Module):
    """Swirls the fluid about the y axis."""

    rate = weir.Param(0.0, unit="1/s^2", doc="Acceleration per distance.")
    spent = 0.0
    clock = staticmethod(time.perf_counter)

    def reset(self, fluid):
        fluid.particles.add("distance", unit="m", doc="From the axis.")

    def step(self, fluid, dt):
        positions, velocities, distance = fluid.positions, fluid.velocities, fluid["distance"]
        start = self.clock()
        velocities[:, 0] += (self.rate * dt) * positions[:, 2]
        velocities[:, 2] -= (self.rate * dt) * positions[:, 0]
        np.hypot(positions[:, 0], positions[:, 2], out=distance)
        self.spent += self.clock() - start


def scene_of(spacing: float) -> weir.Scene:
    scene = weir.Scene("100,000 particles")
    scene.world.set(dt=0.001, frame_rate=200, duration=1000)
    size = 46.5 * 0.01
    block = scene.add("BoxSampler", "block", max=(size, size, size))
    tank = scene.add("StaticBoundary", "tank", shape="box", max=(size, 2 * size, size), inverted=True)
    water = scene.add("ParticleFluid", "water", spacing=spacing, rest_steps=0)
    block.particles >> water.initial
    tank.boundary >> water.boundaries
    return scene


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--spacing", type=float, default=0.01)
    parser.add_argument("--rounds", type=int, default=12)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--clock", choices=["wall", "cpu"], default="wall")
    parser.add_argument("--bound", type=float, default=5, help="percent that a module and a callback may cost")
    options = parser.parse_args()

    clock = time.process_time if options.clock == "cpu" else time.perf_counter
    Swirl.clock = staticmethod(clock)
    scenes = {name: scene_of(options.spacing) for name in ("c++", "module", "callback")}
    swirl = scenes["module"].water.modules.insert("swirl", Swirl(), before="predict")
    simulations = {name: weir.Simulation(scene, device="cpu", threads=options.threads) for name, scene in scenes.items()}
    steps_seen = []

    def advance(name: str) -> float:
        """Seconds of the steps to the next frame, without the module's kernel."""
        simulation, swirl.spent = simulations[name], 0.0
        before, start = simulation.steps, clock()
        simulation.advance(1, callback=(lambda s: steps_seen.append(s.steps)) if name == "callback" else None)
        return (clock() - start - swirl.spent) / (simulation.steps - before)

    for name in simulations:
        advance(name)
    rounds = [{name: advance(name) for name in simulations} for _ in range(options.rounds)]
    fastest = {name: min(r[name] for r in rounds) for name in simulations}
    plain = fastest["c++"]
    print(f"{scenes['c++'].water.count} particles, c++ alone: {1e3 * plain:.2f} ms a step")
    worst = 0.0
    for name in ("module", "callback"):
        cost = 100 * (fastest[name] / plain - 1)
        worst = max(worst, cost)
        print(f"with a {name} in Python: {cost:+.2f} % beside its own kernel (bound {options.bound:g} %)")
    assert np.array_equal(scenes["c++"].water.positions, scenes["module"].water.positions)
    return 0 if worst < options.bound else 1


if __name__ == "__main__":
    sys.exit(main())
