#!/usr/bin/env python3
"""Checks that libraries show no more than they mean to.

usage: check_exports.py BUILD

What libweir_framework.so and libweir_nodes.so export is of Weir's namespace, or of the C++ library's: nothing of fmt,
spdlog, nlohmann-json or oneTBB, with which a plugin could mix up its own. A plugin exports its two symbols; beside them
there are only copies of inline functions and types, which each library may have. GCC 12 makes common symbols of the C++
library's inline constants in variants for processors (std::ranges::lexicographical_compare), so its names may be strong.
"""

import os
import re
import subprocess
import sys

# Mangled: virtual tables, thunks, type information, guards, then the namespaces weir, std or __gnu_cxx, or a plain type.
OWN = re.compile(r"_Z(GV|T[ISTV]|Th\w+?_|Tv\w+?_)?Z?(N[KVRO]*)?(4weir|St|S[absiod]|9__gnu_cxx|[FPR])|_Z(n[wa]|d[la])")
PLUGIN = {"weirPluginHeader", "weirRegisterPlugin"}
STANDARD = re.compile(r"_ZN?K?St")


def symbols(*arguments):
    """(kind, name) of what a library defines."""
    text = subprocess.run(["nm", "--defined-only", *arguments], check=True, capture_output=True, text=True).stdout
    return [tuple(line.split()[1:]) for line in text.splitlines()]


def library_mistakes(library):
    for kind, name in symbols("-D", library):
        if not OWN.match(name):
            yield f"exports {name}"
    if not any(kind == "t" and name.startswith("_ZN4weir") for kind, name in symbols(library)):
        yield "hides nothing"


def plugin_mistakes(library):
    strong = {name for kind, name in symbols("-D", library) if kind in "TBDR"}
    for name in sorted(PLUGIN - strong):
        yield f"does not export {name}"
    for name in sorted(strong - PLUGIN):
        if not STANDARD.match(name):
            yield f"exports {name}"


def main(build):
    lib = os.path.join(build, "lib")
    plugins = os.path.join(lib, "weir", "plugins")
    checked = [(os.path.join(lib, f"libweir_{name}.so"), library_mistakes) for name in ("framework", "nodes")]
    checked += [(os.path.join(plugins, name), plugin_mistakes) for name in sorted(os.listdir(plugins)) if name.endswith(".so")]
    mistakes = [f"{path} {text}" for path, find in checked for text in find(path)]
    for text in mistakes:
        print(text)
    print(f"{len(checked)} libraries, {len(mistakes)} mistakes")
    sys.exit(1 if mistakes else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
