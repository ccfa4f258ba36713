#!/usr/bin/env python3
"""Compares what the libraries offer to plugins with what they offered when the interface's version was last raised.

usage: check_abi.py [--update] BUILD BASELINE

Of what lib/libweir_framework.so and lib/libweir_nodes.so in BUILD export, functions and variables count that public headers
declare (include/weir and what it includes), with all types that they lead to. These are read from the debug information of
interface/libweir_framework_interface.so and the like (tools/abi/CMakeLists.txt). BASELINE is a folder: an abixml file of
each library (packed by xz: they are megabytes of text), and `version`, the version of the interface that it stands for. A change that is no mere addition fails,
unless WEIR_INTERFACE_VERSION in CMakeLists.txt has a greater first number than the baseline; --update then writes the
baseline anew. Needs abidw and abidiff (Debian: abigail-tools).
"""

import argparse
import lzma
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LIBRARIES = ("framework", "nodes")
DIFFERS, BROKEN = 4, 1 | 2  # bits of abidiff's exit status
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
TYPE = re.compile(r"\b(?:class|struct)\s+(?:WEIR_API\s+|\[\[.*?\]\]\s*)?(\w+)(?:\s+final)?\s*(?::[^;{]*)?\{")
FUNCTION = re.compile(r"[\w>&*\]]\s+[&*]?(\w+)\s*\(")
VARIABLE = re.compile(r"\bextern\b[^;(]*?(\w+)(?:\[\w*\])?;")


class Failure(Exception):
    """Said to whoever called."""


def run(*arguments):
    try:
        return subprocess.run([str(argument) for argument in arguments], capture_output=True, text=True)
    except FileNotFoundError as error:
        raise Failure(f"there is no {error.filename}: ./dev setup-gate installs it") from error


def version_of(build):
    """The two numbers of the interface's version, from the header that the build wrote."""
    text = (build / "generated/framework/graph/interface_digest.h").read_text()
    found = re.search(r"interface (\d+)\.(\d+)", text)
    if not found:
        raise Failure("generated/framework/graph/interface_digest.h names no version of the interface")
    return int(found.group(1)), int(found.group(2))


def declared_names(headers):
    """What the headers define or declare: types, functions and variables, without their namespaces. Headers that only CUDA
    sources read have no part in these libraries."""
    texts = [header.read_text() for header in headers]
    text = COMMENT.sub(" ", "\n".join(text for text in texts if "cuda_runtime.h" not in text))
    return set(TYPE.findall(text)), set(FUNCTION.findall(text)) | set(VARIABLE.findall(text))


def without_arguments(name):
    """weir::Array<int>::resize(long) becomes weir::Array::resize."""
    kept, depth = "", 0
    for letter in name.replace("[abi:cxx11]", ""):
        depth += letter == "<"
        if depth == 0 and letter == "(":
            break
        if depth == 0:
            kept += letter
        depth -= letter == ">"
    return kept.split(" ")[-1]


def is_instance(name):
    """Whether a name is that of a function template's instance: weir::ParticleSet::moveOn<weir::CpuAvx2>(...)."""
    depth = 0
    for at, letter in enumerate(name):
        if depth == 0 and letter == "(":
            return name[:at].endswith(">") and not re.search(r"operator\W*>$", name[:at])
        depth += (letter == "<") - (letter == ">")
    return False


def is_public(name, types, functions):
    """Whether a name that the linker knows, as c++filt has it, comes from a public header. Instances of function templates
    do not count: those that are no weak symbols are kernels for one set of the processor's instructions."""
    if is_instance(name):
        return False
    first, *rest = without_arguments(name).split("::")
    rest = [part for part in rest if part != "detail"]
    if first != "weir" or not rest:
        return False
    return rest[0] in types if len(rest) > 1 else rest[0] in functions


def public_symbols(library, types, functions):
    # What is weak, of inline functions and types, every library has itself.
    symbols = [line.split()[2] for line in run("nm", "-D", "--defined-only", library).stdout.splitlines()
               if line.split()[1] in "TBDR"]
    names = subprocess.run(["c++filt"], input="\n".join(symbols), capture_output=True, text=True, check=True).stdout.splitlines()
    return [symbol for symbol, name in zip(symbols, names) if is_public(name, types, functions)]


def check_whole(described, types):
    """Fails where abidw took public types for private ones, whose members do not count."""
    classes = re.findall(r"<class-decl name='(\w+)'([^>]*)>", described.read_text())
    whole = {name for name, about in classes if "is-declaration-only" not in about}
    opaque = sorted({name for name, _ in classes} & types - whole)
    if opaque:
        raise Failure(f"abidw sees no members of types of public headers: {', '.join(opaque)}")


def describe(library, headers, symbols, types, target):
    """abixml of these symbols and of what they lead to."""
    missing = sorted(set(symbols) - {line.split()[-1] for line in run("nm", "-D", "--defined-only", library).stdout.splitlines()})
    if missing or not symbols:
        raise Failure(f"{library} defines no {', '.join(missing) or 'symbol of a public header'}: tools/abi/CMakeLists.txt must "
                      "name its source")
    with tempfile.NamedTemporaryFile("w", suffix=".suppr") as rules:
        pattern = "^(" + "|".join(symbols) + ")$"
        for kind in ("function", "variable"):
            rules.write(f"[suppress_{kind}]\n  symbol_name_not_regexp = {pattern}\n  drop = yes\n")
        rules.flush()
        done = run("abidw", "--suppr", rules.name, *(word for header in headers for word in ("--hf", header)),
                   "--type-id-style", "hash",  # so that a change of one type does not number all others anew
                   "--no-corpus-path", "--no-comp-dir-path", "--no-show-locs", "--no-elf-needed", "--no-parameter-names",
                   "--exported-interfaces-only", "--drop-private-types", "--out-file", target, library)
    if done.returncode != 0:
        raise Failure(f"abidw cannot read {library}: {done.stderr.strip()}")
    target.write_text(target.read_text().replace(f"path='{ROOT}/", "path='"))
    check_whole(target, types)


def differences(before, after):
    """What abidiff says of anything but additions; None if there is nothing."""
    done = run("abidiff", "--no-added-syms", before, after)
    if done.returncode & BROKEN:
        raise Failure(f"abidiff cannot compare {before.name}: {(done.stderr or done.stdout).strip()}")
    return done.stdout if done.returncode & DIFFERS else None


def stored_description(baseline, library, folder):
    packed, file = baseline / f"{library}.abi.xz", folder / f"{library}_before.abi"
    if not packed.exists():
        raise Failure(f"there is no {packed}: ./dev check-abi --update writes it")
    try:
        file.write_bytes(lzma.decompress(packed.read_bytes()))
    except lzma.LZMAError as error:
        raise Failure(f"{packed} is damaged: {error}") from error
    return file


def write_baseline(baseline, version, described):
    baseline.mkdir(parents=True, exist_ok=True)
    for library, file in described.items():
        (baseline / f"{library}.abi.xz").write_bytes(lzma.compress(file.read_bytes()))
    (baseline / "version").write_text("{}.{}\n".format(*version))


def check(build, baseline, update):
    headers = [Path(line) for line in (build / "generated/public_headers.txt").read_text().split()]
    types, functions = declared_names(headers)
    version, stored = version_of(build), baseline / "version"
    before = tuple(map(int, stored.read_text().split("."))) if stored.exists() else None
    with tempfile.TemporaryDirectory() as name:
        folder, described, changed = Path(name), {}, {}
        for library in LIBRARIES:
            symbols = public_symbols(build / f"lib/libweir_{library}.so", types, functions)
            described[library] = folder / f"{library}.abi"
            describe(build / f"interface/libweir_{library}_interface.so", headers, symbols, types,
                     described[library])
            print(f"libweir_{library}.so: {len(symbols)} symbols of public headers")
            if before is not None:
                changed[library] = differences(stored_description(baseline, library, folder), described[library])
        broken = "".join(f"\nlibweir_{library}.so:\n{text}" for library, text in changed.items() if text)
        if broken and version[0] <= before[0]:
            raise Failure(f"{broken}\nPlugins of interface {before[0]}.{before[1]} would break by what stands above. Take it back, or "
                          f"raise WEIR_INTERFACE_VERSION in CMakeLists.txt to {before[0] + 1}.0 and run ./dev check-abi --update")
        if update:
            write_baseline(baseline, version, described)
        elif version != before:
            raise Failure(f"the interface is {version[0]}.{version[1]}, and {baseline} is of "
                          f"{'nothing' if before is None else '{}.{}'.format(*before)}: run ./dev check-abi --update")
    print("Interface {}.{}: {}".format(*version, "written" if update else "nothing that plugins use was changed or taken away"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("baseline", type=Path)
    parser.add_argument("--update", action="store_true")
    options = parser.parse_args()
    try:
        check(options.build, options.baseline, options.update)
    except Failure as failure:
        sys.exit(f"check_abi: {failure}")


if __name__ == "__main__":
    main()
