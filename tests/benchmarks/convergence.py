#!/usr/bin/env python3
"""Settles one dam break at several spacings and time steps, to a tolerance and otherwise, and prints a Markdown table.

  convergence.py PROGRAM [--device D] [--threads N] [--spacings 0.04,0.02] [--steps-ms 1,2,5,10]
                 [--duration S] [--short S] [--tolerance T] [--most N] [--bulk-modulus PA] [--keep FILE]
                 [--acceleration nesterov|conjugate] [--support-ratio R] [--heights]

Of every spacing and step it runs, over --duration:
  the solver with a tolerance and acceleration   iterations and stages a step, steps that did not meet it, compression, height
  SemiImplicitSolver without any setting         compression, height
  position based fluids                          compression, height; as many iterations as the first on average
and, over --short alone, the first with and without acceleration, which compares their iterations. These start from a lattice
at rest density (calibration: lattice): one that must expand first takes the most iterations in either way.
With --heights only the first of these is run.
Height is twice that of the centre of mass over the volume's own, so 1 is fluid at rest that kept its volume.

With --keep, every run's outcome and its seconds are written to FILE as soon as they are there, and what FILE holds of
earlier calls, with the same scene, settings and device, is not run again. It knows nothing of changes of the program:
then delete it. Runs that fail are told of on stderr and not kept.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

SCENE = os.path.join(os.path.dirname(__file__), "../../resources/scenes/paper/convergence_dam_break.json")


class Kept:
    """Outcomes of runs by what decides them: in a file, if one is given."""

    def __init__(self, path):
        self.path = path
        self.outcomes = {}
        if path and os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                self.outcomes = json.load(file)

    def put(self, key, outcome):
        self.outcomes[key] = outcome
        if not self.path:
            return
        # Whole or not at all, so that a run that is cut off leaves the others.
        with open(self.path + ".new", "w", encoding="utf-8") as file:
            json.dump(self.outcomes, file, indent=1)
        os.replace(self.path + ".new", self.path)


class Runner:
    def __init__(self, arguments, folder):
        self.arguments = arguments
        self.folder = folder
        self.kept = Kept(arguments.keep)
        with open(SCENE, encoding="utf-8") as file:
            self.scene = json.load(file)
        box = self.scene["nodes"]["tank"]["params"]
        self.area = (box["max"][0] - box["min"][0]) * (box["max"][2] - box["min"][2])

    def run(self, spacing, dt, duration, solver, calibration="packing"):
        """What the fluid reports at the end; None if the run failed."""
        scene = json.loads(json.dumps(self.scene))
        scene["world"] |= {"dt": dt, "duration": duration}
        scene["nodes"]["water"]["modules"] = {"solver": solver}
        scene["nodes"]["water"]["params"] |= {"spacing": spacing, "calibration": calibration,
                                              "bulk_modulus": self.arguments.bulk_modulus}
        if self.arguments.support_ratio:
            scene["nodes"]["water"]["params"]["support_ratio"] = self.arguments.support_ratio
        key = json.dumps([self.arguments.device, scene], sort_keys=True)
        if key not in self.kept.outcomes:
            outcome = self.outcome_of(scene)
            if outcome is None:
                return None
            self.kept.put(key, outcome)
        return self.kept.outcomes[key]["water"]

    def outcome_of(self, scene):
        scene_file = os.path.join(self.folder, "scene.json")
        stats_file = os.path.join(self.folder, "stats.json")
        with open(scene_file, "w", encoding="utf-8") as file:
            json.dump(scene, file)
        command = [self.arguments.program, "run", scene_file, "--quiet", "--stats", stats_file,
                   "--device", self.arguments.device]
        if self.arguments.threads:
            command += ["--threads", str(self.arguments.threads)]
        began = time.monotonic()
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
        seconds = round(time.monotonic() - began, 1)
        if done.returncode:
            print(f"spacing {scene['nodes']['water']['params']['spacing']:g}, dt {scene['world']['dt']:g}: "
                  f"{done.stderr.strip()}", file=sys.stderr, flush=True)
            return None
        with open(stats_file, encoding="utf-8") as file:
            return {"seconds": seconds, "water": json.load(file)["nodes"]["water"]}

    def row(self, spacing, dt):
        a = self.arguments
        def solver(acceleration):
            return {"type": "AcceleratedSolver",
                    "params": {"max_iterations": a.most, "tolerance": a.tolerance, "acceleration": acceleration}}
        settled = self.run(spacing, dt, a.duration, solver(a.acceleration))
        if a.heights:
            return " | ".join([f"| {spacing:g} | {1000 * dt:g}", iterations(settled), stages(settled), unmet(settled),
                               self.outcome(settled)]) + " |"
        plain = self.run(spacing, dt, a.short, solver("none"), "lattice")
        quick = self.run(spacing, dt, a.short, solver(a.acceleration), "lattice")
        untuned = self.run(spacing, dt, a.duration, {"type": "SemiImplicitSolver"})
        count = max(1, round(settled["solver_iterations"]["mean"])) if settled else 3
        pbf = self.run(spacing, dt, a.duration, {"type": "Pbf", "params": {"iterations": count}})
        return " | ".join([f"| {spacing:g} | {1000 * dt:g}", iterations(plain), iterations(quick), iterations(settled),
                           stages(settled), unmet(settled), self.outcome(settled), self.outcome(untuned), self.outcome(pbf)]) + " |"

    def outcome(self, water):
        """Mean compression in per cent, and height."""
        if water is None:
            return "failed | failed"
        height = 2 * water["center_of_mass"][1] / (water["fluid_volume"] / self.area)
        return f"{100 * water['compression']['mean']:.3f} | {height:.4f}"


def iterations(water):
    return f"{water['solver_iterations']['mean']:.1f}" if water else "failed"


def stages(water):
    return f"{water['solver_stages']['mean']:.1f}" if water else "failed"


def unmet(water):
    return str(water["solver_iterations"]["not_converged"]) if water else "failed"


def numbers(text):
    return [float(part) for part in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program weir")
    parser.add_argument("--device", default="auto")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--spacings", type=numbers, default=numbers("0.04,0.02,0.015,0.01"), metavar="M,…")
    parser.add_argument("--steps-ms", type=numbers, default=numbers("1,2,5,10"), metavar="MS,…")
    parser.add_argument("--duration", type=float, default=4, metavar="S")
    parser.add_argument("--short", type=float, default=0.2, metavar="S")
    parser.add_argument("--tolerance", type=float, default=0.001)
    parser.add_argument("--most", type=int, default=2000, help="iterations after each search for neighbours")
    parser.add_argument("--bulk-modulus", type=float, default=1e7, metavar="PA")
    parser.add_argument("--acceleration", default="nesterov", choices=["nesterov", "conjugate"])
    parser.add_argument("--support-ratio", type=float, metavar="R", help="instead of the scene's")
    parser.add_argument("--heights", action="store_true", help="with the tolerance and acceleration alone")
    parser.add_argument("--keep", metavar="FILE", help="outcomes, to go on from in another call")
    arguments = parser.parse_args()
    columns = ["d (m)", "dt (ms)"]
    if not arguments.heights:
        columns += ["iterations, plain, first part", "accelerated, first part"]
    columns += ["accelerated, all", "stages", "steps not converged", "compression (%)", "height"]
    if not arguments.heights:
        columns += ["untuned: compression (%)", "height", "PBF: compression (%)", "height"]
    print("| " + " | ".join(columns) + " |")
    print("|" + "---:|" * len(columns))
    with tempfile.TemporaryDirectory() as folder:
        runner = Runner(arguments, folder)
        for spacing in arguments.spacings:
            for step in arguments.steps_ms:
                print(runner.row(spacing, step / 1000), flush=True)


if __name__ == "__main__":
    main()
