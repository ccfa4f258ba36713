#!/usr/bin/env python3
"""Runs the dam break of scene.json with Dfsph and with AcceleratedSolver at the same accuracy, and prints a table.

Accuracy is the mean over all particles of max(ρ/ρ0 - 1, 0), the largest of all frames, as Weir measures it itself for
every solver. AcceleratedSolver is compressible, so its bulk modulus is set high enough for each accuracy. Times are those of
the CPU for a whole step, so other programs of a busy machine count little.
"""
import argparse
import json
import pathlib
import resource
import subprocess
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ACCURACIES = [1e-3, 1e-4]
# A column of the table each: the solver's name, its type, and settings of it beside the accuracy.
SOLVERS = [
    ("AcceleratedSolver, none", "AcceleratedSolver", ["water.solver.acceleration=none"]),
    ("AcceleratedSolver, conjugate", "AcceleratedSolver", ["water.solver.acceleration=conjugate"]),
    ("Dfsph", "Dfsph", []),
]


def settings(solver, accuracy):
    if solver == "Dfsph":
        return [f"water.solver.tolerance={accuracy}", f"water.solver.divergence_tolerance={accuracy}"]
    # A tenth of the accuracy is what the largest pressure of the fluid at rest, 0.4 m deep, may compress it by.
    bulk_modulus = 1000 * 9.8 * 0.4 / (0.1 * accuracy)
    return [f"water.solver.tolerance={accuracy}", f"water.bulk_modulus={bulk_modulus}"]


def scene_with(solver):
    scene = json.loads((HERE / "scene.json").read_text())
    scene["nodes"]["water"]["modules"]["solver"] = {"type": solver}
    del scene["render"]
    return scene


def run(args, folder, solver, accuracy, more, frames):
    """The statistics at the end, those of the water at each frame, and the CPU's time in s."""
    scene, stats, series = (folder / name for name in ("scene.json", "stats.json", "series.jsonl"))
    scene.write_text(json.dumps(scene_with(solver)))
    command = [args.weir, "run", scene, "--plugin", args.plugin, "--stats", stats, "--series", series, "--quiet",
               "--device", args.device, "--frames", frames, "--threads", args.threads]
    for setting in settings(solver, accuracy) + more + [f"water.rest_steps={args.rest_steps}"]:
        command += ["--set", setting]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    lines = [json.loads(line) for line in series.read_text().splitlines()]
    return json.loads(stats.read_text()), [line["nodes"]["water"] for line in lines], after.ru_utime - before.ru_utime


def row(args, name, solver, accuracy, more):
    with tempfile.TemporaryDirectory() as folder:
        start = run(args, pathlib.Path(folder), solver, accuracy, more, 0)[2]
        stats, frames, seconds = run(args, pathlib.Path(folder), solver, accuracy, more, args.frames)
    water = stats["nodes"]["water"]
    if solver == "Dfsph":
        iterations = "{:.1f} + {:.1f}".format(*(water[f"{s}_solver"]["iterations"] for s in ("density", "divergence")))
    else:
        iterations = "{:.1f}".format(water["solver_iterations"]["mean"])
    mean = max(frame["compression"]["mean"] for frame in frames[1:])
    most = max(frame["compression"]["max"] for frame in frames[1:])
    energies = [frame["kinetic_energy"] + frame["potential_energy"] for frame in frames]
    return (f"| {100 * accuracy:g} % | {name} | {100 * mean:.3f} % | {100 * most:.2f} % | {iterations} | "
            f"{1000 * (seconds - start) / stats['steps']:.1f} | {energies[-1] - energies[0]:.1f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--weir", default="weir", help="the program")
    parser.add_argument("--plugin", default=HERE / "build/plugins/weir_dfsph.so", help="the built plugin")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--frames", type=int, default=15)
    parser.add_argument("--rest-steps", type=int, default=200)
    args = parser.parse_args()
    print("| asked | solver | mean density error | largest | iterations a step | CPU's ms a step | change of energy, J |")
    print("|---|---|---|---|---|---|---|")
    for accuracy in ACCURACIES:
        for name, solver, more in SOLVERS:
            print(row(args, name, solver, accuracy, more), flush=True)


if __name__ == "__main__":
    main()
