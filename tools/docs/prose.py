#!/usr/bin/env python3
"""Measures the prose of the documentation: words, long sentences, commit hashes, and terms that the glossary lacks.

    tools/docs/prose.py [FOLDER]      docs/ and README.md where no folder is named

check.py uses it to hold the pages to their limits.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MAX_WORDS = 15_000  # of all pages of docs/ together; the reference is generated and does not count
LONG = 30  # words of a sentence

HASH = re.compile(r"\b(?=[0-9a-f]*\d)(?=[0-9a-f]*[a-f])[0-9a-f]{7,12}\b")

# Words of the field that a reader may have to look up. A page may use those that the glossary explains.
TERMS = """acceleration;animated;artificial viscosity;attribute;back end;bulk modulus;buoyancy;calibration;CFL;checkpoint;
compression;converged;Coulomb friction;DFSPH;density error;deterministic;device;displacement;DLPack;emitter;FLIP;
fog volume;frame;glTF;graph;headless;hydrostatic;ISA;iterations;Jacobi;jitter;kernel;keyframe;lattice;link;mesh;module;momentum;
neighbour;neighbour list;Nesterov;no-slip;node;open mesh;OpenVDB;packing;particle;PBF;pipeline;plugin;port;predicted position;PLY;
relaxed;rest density;restitution;resume;sampler;scene;semi-analytical;semi-implicit;SFI;sheet;signed distance;sink;spacing;speed of sound;SPH;
statistics;step;substitution;support radius;support ratio;surface tension;terrain;tolerance;truncated;vector instructions;
vorticity;VTKHDF;watertight;XSPH""".replace("\n", "").split(";")


def words(text):
    """Tokens with a letter or a digit, code included, comments not."""
    return sum(1 for token in re.sub(r"(?s)<!--.*?-->", "", text).split() if re.search(r"\w", token))


def prose(text):
    """The paragraphs and list items of a page: no code, no tables, no headings, no comments."""
    text = re.sub(r"(?ms)^ *```.*?^ *```", "", text)
    text = re.sub(r"(?s)<!--.*?-->", "", text)
    parts, part = [], []
    for line in [*text.split("\n"), ""]:
        starts = re.match(r"\s*([-*] |\d+\. )", line)
        if not line.strip() or starts or line.lstrip().startswith(("|", "#", "!", "    ")):
            parts.append(" ".join(part))
            part = []
        if line.strip() and not line.lstrip().startswith(("|", "#", "![")) and not line.startswith("    "):
            part.append(line.strip())
    return [p for p in parts if p]


def sentences(text):
    for part in prose(text):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"`[^`]*`", "code", part))
        yield from (s for s in re.split(r"(?<=[.!?])\s+", re.sub(r"^([-*]|\d+\.)\s+", "", plain)) if s)


def long_sentences(text):
    return [s for s in sentences(text) if len(s.split()) > LONG]


def lines_with_hashes(text):
    return [number for number, line in enumerate(text.split("\n"), 1) if HASH.search(line)]


def lacking_terms(text, glossary):
    used = " ".join(prose(text)).lower()
    return [t for t in TERMS if re.search(rf"\b{re.escape(t.lower())}", used) and t.lower() not in glossary.lower()]


def pages(folder):
    return [*([ROOT / "README.md"] if folder == ROOT / "docs" else []), *sorted(folder.glob("*.md"))]


def main():
    folder = Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT / "docs"
    glossary = ROOT / "docs" / "glossary.md"
    known = glossary.read_text() if glossary.exists() else ""
    print("| page | words | sentences | over 30 words | lines with hashes | terms not in the glossary |\n|---|---:|---:|---:|---:|---|")
    sums = [0, 0, 0, 0]
    for page in pages(folder):
        text = page.read_text()
        row = [words(text), len(list(sentences(text))), len(long_sentences(text)), len(lines_with_hashes(text))]
        sums = [a + b for a, b in zip(sums, row)]
        lacking = lacking_terms(text, known)
        print(f"| {page.name} | {' | '.join(f'{n:,}' for n in row)} | {', '.join(lacking)} |")
    print(f"| all | {' | '.join(f'{n:,}' for n in sums)} | |")


if __name__ == "__main__":
    main()
