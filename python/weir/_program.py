"""The program `weir` of an installed package."""

import os
import sys
from pathlib import Path


def main() -> None:
    program = Path(__file__).parent / "bin" / "weir"
    if not program.exists():
        sys.exit(f"weir: there is no program at {program}; in a build tree it is in the folder bin")
    os.execv(program, [str(program), *sys.argv[1:]])
