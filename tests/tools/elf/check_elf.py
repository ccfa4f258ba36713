#!/usr/bin/env python3
"""Checks how the programs and libraries of a folder are linked.

usage: check_elf.py --build BUILD FOLDER...

Every ELF file below the folders: no entry of its run path may be empty or relative, as the loader would take libraries
from the folder that the user happens to be in. Weir's own are to have full RELRO, stack protection and checked memory
functions, unless the build folder says that they were built for the debugger or a sanitizer, or WEIR_HARDENING=OFF.
"""

import argparse
import os
import re
import subprocess
import sys

# Those with enough code of all kinds that a stack guard and a checked function must be found in each.
OWN = re.compile(r"^(weir|libweir_(framework|nodes)\.so.*|weir_(assimp|vtkhdf|rendering|mesh_export|openvdb)\.so|"
                 r"_core\..*\.so)$")
# Which functions of the C library others call, and whether these have a checked form, is up to the compiler.
WITH_CHECKED = re.compile(r"^libweir_framework\.so")
# The loader replaces these by folders that do not depend on the current one.
GOOD_ENTRY = re.compile(r"^(/|\$ORIGIN(/|$)|\$\{ORIGIN\}(/|$))")


def elf_files(folder):
    for root, folders, names in os.walk(folder):
        # What CMake tries out while it configures, and objects that are not programs yet.
        folders[:] = [name for name in folders if name != "CMakeFiles"]
        for name in sorted(names):
            path = os.path.join(root, name)
            if os.path.islink(path) or not os.path.isfile(path) or name.endswith(".o"):
                continue
            with open(path, "rb") as file:
                if file.read(4) == b"\x7fELF":
                    yield path


def readelf(*arguments):
    environment = dict(os.environ, LC_ALL="C")
    return subprocess.run(["readelf", "-W", *arguments], check=True, capture_output=True, text=True, errors="replace",
                          env=environment).stdout


def run_path_mistakes(dynamic):
    for kind, path in re.findall(r"\((RPATH|RUNPATH)\)\s+Library r(?:un)?path: \[(.*)\]", dynamic):
        for entry in path.split(":"):
            if not GOOD_ENTRY.match(entry):
                yield f"{kind} '{path}' has the entry '{entry}'"


def hardening_mistakes(path, dynamic):
    if "GNU_RELRO" not in readelf("-l", path):
        yield "has no RELRO segment"
    if not re.search(r"\((FLAGS|FLAGS_1)\).*\b(BIND_NOW|NOW)\b|\(BIND_NOW\)", dynamic):
        yield "binds functions when they are called first, so RELRO is partial"
    symbols = set(re.findall(r" UND (\w+)", readelf("--dyn-syms", path)))
    if "__stack_chk_fail" not in symbols:
        yield "has no stack protection"
    checked = [name for name in symbols if name.endswith("_chk")]
    if not checked and WITH_CHECKED.match(os.path.basename(path)):
        yield "calls no checked function of the C library (_FORTIFY_SOURCE)"


def is_hardened(build):
    with open(os.path.join(build, "CMakeCache.txt")) as file:
        cache = dict(re.findall(r"^(\w+):\w+=(.*)$", file.read(), re.MULTILINE))
    return (cache.get("WEIR_HARDENING") == "ON" and not cache.get("WEIR_SANITIZE")
            and cache.get("CMAKE_BUILD_TYPE") in ("Release", "RelWithDebInfo", "MinSizeRel"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True)
    parser.add_argument("folders", nargs="+")
    options = parser.parse_args()
    hardened = is_hardened(options.build)
    files, own, mistakes = 0, 0, []
    for folder in options.folders:
        for path in elf_files(folder):
            dynamic = readelf("-d", path)
            found = list(run_path_mistakes(dynamic))
            files += 1
            if hardened and OWN.match(os.path.basename(path)):
                own += 1
                found += hardening_mistakes(path, dynamic)
            mistakes += [f"{path}: {text}" for text in found]
    for text in mistakes:
        print(text)
    if files == 0 or (hardened and own == 0):
        sys.exit("check_elf: there is nothing to check in " + ", ".join(options.folders))
    print(f"{files} ELF files, {own} of them checked for hardening, {len(mistakes)} mistakes")
    sys.exit(1 if mistakes else 0)


if __name__ == "__main__":
    main()
