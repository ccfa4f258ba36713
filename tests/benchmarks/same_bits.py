#!/usr/bin/env python3
"""Do two builds of Weir compute the same bits? Runs each scene for some steps with both and compares the exports.

    same_bits.py OLD NEW [SCENE...] [--steps 20] [--device cpu] [--threads 1,4] [--isa baseline,avx2,avx512]

Without scenes: all of resources/scenes. Two programs, or one with different environments: NEW may be given as
"NAME=VALUE... PROGRAM". Needs h5py. Ends with 1 if anything differs.
"""

import argparse
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "resources/scenes"
MESH = ROOT / "resources/meshes/duck.obj"


def program_of(text):
    words = shlex.split(text)
    split = next(i for i, word in enumerate(words) if "=" not in word)
    return words[split:], dict(word.split("=", 1) for word in words[:split])


def step_of(scene):
    """world.dt in s, which scenes write as a number or in ms."""
    found = re.search(r'"dt": *"?([-+.\de]+)( ms)?', scene)
    return float(found[1]) * (1e-3 if found[2] else 1) if found else 0.001


def run(program, scene, options, out):
    command, environment = program
    frame = options.steps * step_of(scene.read_text())
    arguments = ["run", str(scene), "--device", options.device, "--export", str(out), "--quiet", "--frames", "1",
                 "--set", f"world.frame_rate={1 / frame:.9g}", "--set", f"world.duration={frame:.9g}"]
    if options.device == "cpu":
        arguments += ["--threads", str(options.thread)]
    for setting in options.set:
        arguments += ["--set", setting]
    if '"MeshFile"' in scene.read_text() and MESH.exists():
        arguments += ["--set", f"mesh.file={MESH}"]
    done = subprocess.run(command + arguments, env={**os.environ, **environment, **options.environment}, check=False,
                          capture_output=True, text=True, timeout=options.timeout, stdin=subprocess.DEVNULL)
    return done.returncode, done.stderr.strip().splitlines()[-1:] or [""]


def arrays(path):
    found = {}
    with h5py.File(path) as file:
        file["VTKHDF"].visititems(lambda name, item: found.__setitem__(name, item[()])
                                  if isinstance(item, h5py.Dataset) else None)
    return found


def files(folder):
    return sorted(p.relative_to(folder) for p in folder.rglob("*.vtkhdf"))


def same(a, b):
    """The same bits, or the same whole numbers: ids had 32 of them once."""
    whole = a.dtype.kind in "iu" and b.dtype.kind in "iu"
    return a.shape == b.shape and (numpy.array_equal(a, b) if whole else a.tobytes() == b.tobytes())


def differences(old, new):
    if files(old) != files(new):
        return [f"files {files(old)} and {files(new)}"]
    found = []
    for name in files(old):
        a, b = arrays(old / name), arrays(new / name)
        for key in sorted(set(a) | set(b)):
            if key not in a or key not in b:
                found.append(f"{name}:{key} is in one only")
            elif not same(a[key], b[key]):
                same_shape = a[key].shape == b[key].shape and a[key].dtype.kind == "f"
                by = f" by up to {numpy.nanmax(numpy.abs(a[key] - b[key])):.3g}" if same_shape else ""
                found.append(f"{name}:{key}{by}")
    return found


def compare(old, new, scene, options):
    with tempfile.TemporaryDirectory() as folder:
        codes = []
        for name, program in (("old", old), ("new", new)):
            (Path(folder) / name).mkdir()
            codes.append(run(program, scene, options, Path(folder) / name / "export.vtkhdf"))
        if codes[0][0] != codes[1][0]:
            return f"DIFFERS: ended with {codes[0]} and {codes[1]}"
        if codes[0][0] != 0:
            return f"not compared: both end with {codes[0]}"
        found = differences(Path(folder) / "old", Path(folder) / "new")
        return "DIFFERS: " + ", ".join(found) if found else "same"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("old", type=program_of)
    parser.add_argument("new", type=program_of)
    parser.add_argument("scenes", nargs="*", type=Path)
    parser.add_argument("--steps", type=int, default=20)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--threads", default="1,4")
    parser.add_argument("--isa", default="", help="sets WEIR_CPU_ISA to each of these")
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--timeout", type=float, default=600, help="seconds that a run may take")
    options = parser.parse_args()
    scenes = options.scenes or sorted(p for p in SCENES.rglob("*.json") if p.parent.name != "templates")
    bad = 0
    for scene in scenes:
        for isa in options.isa.split(","):
            for thread in options.threads.split(",") if options.device == "cpu" else [""]:
                options.thread, options.environment = thread, {"WEIR_CPU_ISA": isa} if isa else {}
                result = compare(options.old, options.new, scene, options)
                bad += result.startswith("DIFFERS")
                print(f"{scene.name} {isa} {thread and thread + ' threads'}: {result}", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
