#!/usr/bin/env python3
"""Runs many frames of a small scene with pictures, video, export and checkpoints, and prints how much memory the
program holds over the frames.

usage: memory_over_frames.py WEIR [--frames 1000] [--threads 2] [--set NAME=VALUE]…

What is printed is the resident set (VmRSS, sampled each twentieth of a second) at every tenth of the run, the means of
its quarters, and how much the last of them holds more than the third. --set goes to the program, for other looks. The
number of particles is the same in all frames. Needs nothing but Python; the frame is taken from the progress that the
program shows.
"""

import argparse
import json
import os
import re
import subprocess
import tempfile
import threading

RATE = 100

SCENE = {
    "weir": 1,
    "world": {"dt": 0.01, "frame_rate": RATE},
    "nodes": {
        "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.2, 0.2, 0.2]}},
        "tank": {
            "type": "StaticBoundary",
            "params": {"shape": "box", "min": [0, 0, 0], "max": [0.4, 0.4, 0.2], "inverted": True},
        },
        "water": {"type": "ParticleFluid", "params": {"spacing": 0.025}},
    },
    "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"],
    "render": {"width": 160, "height": 120},
}


def resident_kib(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as lines:
        for line in lines:
            if line.startswith("VmRSS:"):
                return int(line.split()[1])
    return None


class Samples:
    """Memory by frame, taken while the program runs."""

    def __init__(self, process):
        self.process, self.frame, self.done, self.taken = process, 0, threading.Event(), []
        self.thread = threading.Thread(target=self.sample)
        self.thread.start()

    def sample(self):
        while not self.done.wait(0.05):
            try:
                kib = resident_kib(self.process.pid)
            except OSError:
                return
            if kib is not None:
                self.taken.append((self.frame, kib))

    def read_progress(self, stream):
        for line in stream:
            found = re.match(r"frame (\d+)/", line)
            if found:
                self.frame = int(found.group(1))
        self.done.set()
        self.thread.join()


def run(options, folder):
    scene = os.path.join(folder, "scene.json")
    with open(scene, "w", encoding="utf-8") as file:
        json.dump(SCENE, file)
    command = [options.weir, "run", scene, "--device", "cpu", "--threads", str(options.threads)]
    command += ["--duration", str(options.frames / RATE)]
    command += ["--video", f"{folder}/run.mp4", "--images", f"{folder}/images", "--export", f"{folder}/run.vtkhdf"]
    command += ["--checkpoint", f"{folder}/run.h5", "--checkpoint-every", "100"]
    for setting in options.set:
        command += ["--set", setting]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        samples = Samples(process)
        samples.read_progress(process.stderr)
    if process.returncode != 0:
        raise SystemExit(f"the run ended with exit code {process.returncode}")
    return samples.taken


def mean(samples):
    return sum(kib for _, kib in samples) / len(samples)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("weir")
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        samples = run(options, folder)
    # What the end does, such as closing files, is not a frame.
    samples = [(frame, kib) for frame, kib in samples if frame < options.frames]
    print("samples      MiB")
    for tenth in range(1, 11):
        frame, kib = samples[len(samples) * tenth // 10 - 1]
        print(f"{tenth * 10:5} %  {kib / 1024:8.1f}   (shown: frame {frame})")
    means = [mean(samples[len(samples) * k // 4 : len(samples) * (k + 1) // 4]) / 1024 for k in range(4)]
    print(f"{len(samples)} samples; means of the quarters: {', '.join(f'{each:.1f}' for each in means)} MiB")
    print(f"the last quarter holds {means[3] - means[2]:+.2f} MiB against the third one")


if __name__ == "__main__":
    main()
