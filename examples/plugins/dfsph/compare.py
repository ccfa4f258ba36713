#!/usr/bin/env python3
"""Runs the dam break of scene.json with Dfsph and with SemiImplicitSolver at the same accuracy, and prints a table.

Accuracy is the mean over all particles of max(ρ/ρ0 - 1, 0), the largest of all frames, as Weir measures it itself for
every solver. SemiImplicitSolver is compressible, so its bulk modulus is set high enough for each accuracy.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
# For each accuracy: what is asked of each solver.
ACCURACIES = [1e-3, 1e-4]


def settings(solver, accuracy, bulk_modulus):
    if solver == "Dfsph":
        return [f"water.solver.tolerance={accuracy}", f"water.solver.divergence_tolerance={accuracy}"]
    return [f"water.solver.tolerance={accuracy}", "water.solver.iterations=1000", f"water.bulk_modulus={bulk_modulus}"]


def scene_with(solver):
    scene = json.loads((HERE / "scene.json").read_text())
    scene["nodes"]["water"]["modules"]["solver"] = {"type": solver}
    del scene["render"]
    return scene


def run(args, folder, solver, accuracy):
    scene, stats, series = (folder / name for name in ("scene.json", "stats.json", "series.jsonl"))
    scene.write_text(json.dumps(scene_with(solver)))
    # A tenth of the accuracy is what the largest pressure of the fluid at rest may compress it by.
    bulk_modulus = 1000 * 9.8 * 0.4 / (0.1 * accuracy)
    command = [args.weir, "run", scene, "--plugin", args.plugin, "--stats", stats, "--series", series, "--quiet",
               "--device", args.device, "--frames", str(args.frames)]
    if args.threads:
        command += ["--threads", str(args.threads)]
    for setting in settings(solver, accuracy, bulk_modulus) + [f"water.rest_steps={args.rest_steps}"] + args.set:
        command += ["--set", setting]
    subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)
    frames = [json.loads(line) for line in series.read_text().splitlines()]
    return json.loads(stats.read_text()), [frame["nodes"]["water"] for frame in frames]


def row(solver, accuracy, stats, frames):
    water = stats["nodes"]["water"]
    if solver == "Dfsph":
        iterations = "{:.1f} + {:.1f}".format(*(water[f"{s}_solver"]["iterations"] for s in ("density", "divergence")))
    else:
        iterations = "{:.1f}".format(water["solver_iterations"]["mean"])
    mean = max(frame["compression"]["mean"] for frame in frames[1:])
    most = max(frame["compression"]["max"] for frame in frames[1:])
    per_step = stats["modules_ms"]["water/solver"]["per_step"]
    energies = [frame["kinetic_energy"] + frame["potential_energy"] for frame in frames]
    return (f"| {100 * accuracy:g} % | {solver} | {100 * mean:.3f} % | {100 * most:.2f} % | {iterations} | "
            f"{per_step:.2f} | {per_step * stats['steps'] / 1000:.2f} | {energies[-1] - energies[0]:.1f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--weir", default="weir", help="the program")
    parser.add_argument("--plugin", default=HERE / "build/plugins/weir_dfsph.so", help="the built plugin")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--frames", type=int, default=30)
    parser.add_argument("--rest-steps", type=int, default=200)
    parser.add_argument("--set", action="append", default=[], help="further settings, as for weir run")
    args = parser.parse_args()
    print("| asked | solver | mean density error | largest | iterations a step | solver, ms a step | solver, s in all | "
          "change of energy, J |")
    print("|---|---|---|---|---|---|---|---|")
    for accuracy in ACCURACIES:
        for solver in ("SemiImplicitSolver", "Dfsph"):
            with tempfile.TemporaryDirectory() as folder:
                print(row(solver, accuracy, *run(args, pathlib.Path(folder), solver, accuracy)), flush=True)


if __name__ == "__main__":
    main()
