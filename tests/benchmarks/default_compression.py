#!/usr/bin/env python3
"""What scenes that say nothing of their solver leave of compression and cost, as a Markdown table.

  default_compression.py PROGRAM [--device D] [--scenes dam,tank,goblet,jet] [--spacings 0.04,0.02] [--steps-ms 1,3,10]
                         [--duration S] [--solver JSON] [--support-ratio R]

Each scene runs at each spacing and step. "mean" is the largest mean compression of a frame in the second half of the run,
"end" that of the last frame. Warnings of the program are printed below the table. --solver runs another solver, to compare
with: '{"type": "SemiImplicitSolver"}'.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile

SCENES = os.path.join(os.path.dirname(__file__), "../../resources/scenes")
FILES = {"dam": "dam_break", "tank": "tank_at_rest", "goblet": "jet_fills_goblet", "jet": "benchmark_emitter"}


def scene_of(name, spacing, dt, arguments):
    with open(os.path.join(SCENES, FILES[name] + ".json"), encoding="utf-8") as file:
        scene = json.load(file)
    scene["world"] |= {"dt": dt, "duration": arguments.duration, "frame_rate": 20}
    water = scene["nodes"]["water"]
    water["modules"] = {"solver": json.loads(arguments.solver)} if arguments.solver else {}
    water["params"] = {"spacing": spacing}
    if arguments.support_ratio:
        water["params"]["support_ratio"] = arguments.support_ratio
    return scene


def run(scene, arguments, folder):
    """The fluid's numbers at each frame, all statistics, the seconds of processors, and what was printed."""
    paths = {name: os.path.join(folder, name) for name in ("scene.json", "stats.json", "series.jsonl")}
    with open(paths["scene.json"], "w", encoding="utf-8") as file:
        json.dump(scene, file)
    command = [arguments.program, "run", paths["scene.json"], "--quiet", "--device", arguments.device,
               "--stats", paths["stats.json"], "--series", paths["series.jsonl"]]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    if done.returncode:
        raise RuntimeError(done.stderr.strip())
    with open(paths["series.jsonl"], encoding="utf-8") as file:
        frames = [json.loads(line)["nodes"]["water"] for line in file]
    with open(paths["stats.json"], encoding="utf-8") as file:
        return frames, json.load(file), seconds, done.stderr.strip()


def row(name, spacing, dt, arguments, folder):
    frames, stats, seconds, printed = run(scene_of(name, spacing, dt, arguments), arguments, folder)
    water = stats["nodes"]["water"]
    late = [100 * frame["compression"]["mean"] for frame in frames[len(frames) // 2:]]
    iterations = water["solver_iterations"]
    mean, missed = (iterations, 0) if isinstance(iterations, int) else (iterations["mean"], iterations["not_converged"])
    print(f"| {name} | {spacing:g} | {1000 * dt:g} | {water['particles']} | {water['bulk_modulus'] / 1e6:.0f} | "
          f"{max(late):.3f} | {late[-1]:.3f} | {mean:.1f} | {missed} of {stats['steps']} | {seconds:.1f} |", flush=True)
    return printed


def numbers(text):
    return [float(part) for part in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program weir")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--scenes", type=lambda text: text.split(","), default=list(FILES), metavar="NAME,…")
    parser.add_argument("--spacings", type=numbers, default=numbers("0.04,0.025,0.015"), metavar="M,…")
    parser.add_argument("--steps-ms", type=numbers, default=numbers("1,3,10"), metavar="MS,…")
    parser.add_argument("--duration", type=float, default=1, metavar="S")
    parser.add_argument("--solver", metavar="JSON", help="in place of none")
    parser.add_argument("--support-ratio", type=float, metavar="R", help="instead of the default")
    arguments = parser.parse_args()
    columns = ["scene", "d (m)", "dt (ms)", "particles", "K (MPa)", "mean (%)", "end (%)", "iterations a step",
               "steps not converged", "seconds"]
    print("| " + " | ".join(columns) + " |")
    print("|---|" + "---:|" * (len(columns) - 1))
    said = []
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.scenes:
            for spacing in arguments.spacings:
                for step in arguments.steps_ms:
                    try:
                        printed = row(name, spacing, step / 1000, arguments, folder)
                    except RuntimeError as error:
                        printed = str(error)
                    if printed:
                        said.append(f"{name}, {spacing:g} m, {step:g} ms: {printed}")
    print("\n".join(said), file=sys.stderr)


if __name__ == "__main__":
    main()
