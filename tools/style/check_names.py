#!/usr/bin/env python3
"""Checks the names in all headers by the rules of .clang-tidy.

The headers that stand beside the sources of one target are read together, with that target's options, as most of the
time goes into what they include: check_names.py BUILD_FOLDER CLANG_TIDY, where BUILD_FOLDER was configured.
"""
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOMS = ("framework", "nodes", "plugins", "apps", "python", "tests", "examples", "resources")
CUDA = ("cuda_runtime.h", "__device__", "<cub/")  # only nvcc reads those


def options_of(command):
    """What includes and definitions need; no output, no precompiled header."""
    words = shlex.split(command)[1:]
    return [word for at, word in enumerate(words)
            if word.startswith(("-I", "-D", "-std", "-isystem")) or words[at - 1] == "-isystem"]


def commands(build):
    """The options of a source, by the folder that holds it."""
    folders = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        folders.setdefault(pathlib.Path(entry["file"]).parent, options_of(entry["command"]))
    return folders


def is_for_cuda(header):
    text = header.read_text()
    return any(word in text for word in CUDA)


def headers_by_options(build):
    """Each header goes with the sources of its folder, or of the nearest above or below."""
    folders = commands(build)
    groups, left_out = {}, []
    for room in ROOMS:
        for header in sorted((ROOT / room).rglob("*.h")):
            if "node_modules" in header.parts or is_for_cuda(header):
                continue
            near = [folder for folder in [header.parent, *header.parent.parents] if folder in folders]
            near += sorted(folder for folder in folders if header.parent in folder.parents)
            if near:
                groups.setdefault(tuple(folders[near[0]]), []).append(header)
            else:
                left_out.append(header)
    return groups, left_out


def check(clang_tidy, options, headers):
    with tempfile.NamedTemporaryFile("w", suffix=".cpp") as source:
        source.write("".join(f'#include "{header}"\n' for header in headers))
        source.flush()
        folders = "|".join(sorted({re.escape(str(header.parent)) for header in headers}))
        done = subprocess.run([clang_tidy, f"--config-file={ROOT / '.clang-tidy'}", f"--header-filter=({folders})/[^/]*$",
                               "--quiet", source.name, "--", *options, "-w"], capture_output=True, text=True)
    return done.returncode, done.stdout if done.returncode == 0 else done.stdout + done.stderr


def main():
    build, clang_tidy = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    groups, left_out = headers_by_options(build)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda group: check(clang_tidy, *group), groups.items()))
    failed = [text for code, text in results if code != 0]
    print("".join(failed), end="")
    print(f"{sum(map(len, groups.values()))} headers read, in {len(groups)} groups")
    for header in left_out:
        print(f"left out, as no source stands near: {header.relative_to(ROOT)}")
    return 1 if failed or not groups else 0


if __name__ == "__main__":
    sys.exit(main())
