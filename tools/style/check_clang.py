#!/usr/bin/env python3
"""Fails where Clang warns of a C++ source: check_clang.py BUILD_FOLDER CLANG [PART_OF_A_PATH...].

Each source is read with the options that BUILD_FOLDER has for it, and nothing is made of it: a third of the time of a
build. What the build generates must be there. Variants of kernels for processors are left out, as their sources are read
for the baseline; so is what Clang compiled for the TARGETs of another folder: --compiled FOLDER TARGET [TARGET...];
and what has another part in its path: --but PART_OF_A_PATH.
"""
import argparse
import json
import os
import pathlib
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

# Warnings that GCC alone knows, and constants that nvcc alone reads.
EXTRA = ["-fsyntax-only", "-Werror", "-Wno-unknown-warning-option", "-Wno-unused-const-variable"]
GCC_ALONE = ("-Winvalid-pch", "-DWEIR_HAS_AVX2", "-DWEIR_HAS_AVX512", "-femit-class-debug-always")
LEFT_OUT = ("/isa/", "nanobind/src", "_interface.dir/")  # the last: once more, for check_abi.py


def command_of(entry, clang):
    words, kept, at = shlex.split(entry["command"])[1:], [], 0
    while at < len(words):
        if words[at] in ("-o", "-include"):  # objects, and precompiled headers
            at += 2
            continue
        if words[at] not in GCC_ALONE:
            kept.append(words[at])
        at += 1
    return [clang, *kept, *EXTRA]


def check(entry, clang):
    done = subprocess.run(command_of(entry, clang), cwd=entry["directory"], capture_output=True, text=True)
    return entry["file"], done.returncode, done.stdout + done.stderr


def inputs_of(folder, targets):
    """The files that Ninja needs for these targets."""
    done = subprocess.run(["ninja", "-C", folder, "-t", "inputs", *targets], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"check_clang: ninja knows no inputs of {' '.join(targets)} in {folder}:\n{done.stdout}{done.stderr}")
    return set(done.stdout.split("\n"))


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("clang")
    parser.add_argument("parts", nargs="*")
    parser.add_argument("--compiled", nargs="+", default=[])
    parser.add_argument("--but")
    return parser.parse_args()


def main():
    given = arguments()
    build, clang, parts = given.build, given.clang, given.parts
    compiled = inputs_of(given.compiled[0], given.compiled[1:]) if given.compiled else set()
    entries = [entry for entry in json.loads((build / "compile_commands.json").read_text())
               if entry["file"].endswith(".cpp") and not any(part in entry["command"] for part in LEFT_OUT)
               and (not parts or any(part in entry["file"] for part in parts)) and entry["file"] not in compiled
               and not (given.but and given.but in entry["file"])]
    failed = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for file, code, text in pool.map(lambda entry: check(entry, clang), entries):
            if code != 0:
                failed += 1
                print(f"{file}:\n{text}", flush=True)
    print(f"{len(entries)} sources read, {failed} with warnings")
    return 1 if failed or not entries else 0


if __name__ == "__main__":
    sys.exit(main())
