"""CPU time that outputs add to a run, of two checkouts in turns, for engineering/reliability.md. One thread, without kernels for
other processors; run it in the newer checkout:

  output_cost_in_turns.py OLD_CHECKOUT OLD_PROGRAM NEW_PROGRAM ROUNDS SIDE SECONDS     SIDE: particles along an edge of the cube
"""
import os
import resource
import statistics
import subprocess
import sys
import tempfile

SCENE = "resources/scenes/benchmark_dam_break.json"
OUTPUTS = {"none": [], "images": ["--images", "images"], "export": ["--export", "run.vtkhdf"],
           "checkpoint": ["--checkpoint", "run.h5", "--checkpoint-every", "1"]}


def cpu_seconds(command):
    """Of the command and its children, in an empty folder."""
    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    before = used()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(command, cwd=folder, env=dict(os.environ, WEIR_CPU_ISA="baseline"), stdout=subprocess.DEVNULL, check=True)
    return used() - before


def main():
    checkout, old, new = map(os.path.abspath, sys.argv[1:4])
    rounds, side, seconds = int(sys.argv[4]), int(sys.argv[5]), sys.argv[6]
    runs = {"old": (old, f"{checkout}/{SCENE}"), "new": (new, os.path.abspath(SCENE))}
    options = ["--device", "cpu", "--threads", "1", "--set", f"water.spacing={0.81 / side:.9g}", "--set", "world.frame_rate=30",
               "--duration", seconds, "--stats", "stats.json", "--quiet"]
    taken = {}
    for number in range(rounds):
        for output, more in OUTPUTS.items():
            for which in sorted(runs, reverse=number % 2 == 0):
                program, scene = runs[which]
                taken.setdefault((output, which), []).append(cpu_seconds([program, "run", scene, *options, *more]))
    for (output, which), seconds_taken in sorted(taken.items()):
        print(f"{output:10} {which}: {statistics.median(seconds_taken):.3f} s, least {min(seconds_taken):.3f} s")


if __name__ == "__main__":
    main()
