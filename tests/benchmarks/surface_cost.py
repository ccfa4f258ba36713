#!/usr/bin/env python3
"""What a FluidSurface costs at each frame.

usage: surface_cost.py WEIR [DEVICE [THREADS [SPACING …]]]
       surface_cost.py build/cpu/bin/weir cpu 4 0.01077 0.0063     about 100,000 and 500,000 particles

Runs resources/scenes/dam_break_surface.json for some frames of one step each, with and without the node. Wall-clock
time is what the node took, from --stats; processor time is the difference of the two runs, so it is of use on a
machine that has other work to do, too.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile

FRAMES = 6
SCENE = os.path.join(os.path.dirname(__file__), "../../resources/scenes/dam_break_surface.json")


def run(weir, scene, folder, options):
    """Statistics and processor seconds."""
    file, stats = os.path.join(folder, "scene.json"), os.path.join(folder, "stats.json")
    with open(file, "w", encoding="utf-8") as out:
        json.dump(scene, out)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([weir, "run", file, "--quiet", "--stats", stats, *options], check=True, stdout=subprocess.DEVNULL)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    with open(stats, encoding="utf-8") as result:
        return json.load(result), seconds


def main(weir, device="cpu", threads="4", *spacings):
    with open(SCENE, encoding="utf-8") as file:
        scene = json.load(file)
    # One step a frame, from a start that takes no steps of its own.
    scene["world"].update(frame_rate=1000, dt=0.001, duration=FRAMES / 1000)
    scene["nodes"]["water"]["params"]["rest_steps"] = 0
    print("| particles | triangles | wall clock a frame | processor time a frame |\n|---:|---:|---:|---:|")
    for spacing in spacings or ("0.01077", "0.0063"):
        scene["nodes"]["water"]["params"]["spacing"] = float(spacing)
        plain = json.loads(json.dumps(scene))
        del plain["nodes"]["surface"]
        plain["links"] = [link for link in plain["links"] if "surface" not in link]
        plain["render"].pop("surfaces")
        options = ["--device", device, "--threads", threads]
        with tempfile.TemporaryDirectory() as folder:
            stats, with_surface = run(weir, scene, folder, options)
            without = run(weir, plain, folder, options)[1]
        frames = FRAMES + 1
        wall = stats["modules_ms"]["surface"]["total"] / frames
        print(
            f"| {stats['particles']:,} | {stats['nodes']['surface']['triangles']:,} | {wall:.0f} ms "
            f"| {1000 * (with_surface - without) / frames:.0f} ms |",
            flush=True,
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
