#!/usr/bin/env python3
"""Makes the pictures of docs/gallery.md anew, by the commands that stand there, so that page and pictures agree.

Each command runs as it stands, in a fresh folder that sees `resources` and, first on the PATH, the program of a build. The picture below it on
the page is its clip, or else the last of its pictures, as a JPEG.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import documents  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
LARGEST_CLIP, LARGEST_STILL = 3_000_000, 300_000  # bytes


def wanted(page):
    """Pairs of a picture's path and the command above it."""
    lines = page.read_text().split("\n")
    images = [(i + 1, page.parent / m[1]) for i, line in enumerate(lines) if (m := re.match(r"!\[.*\]\((.*)\)", line))]
    blocks = [block for block in documents.read_page(page, page.name).blocks if block.language == "sh"]
    for line, image in images:
        above = [block for block in blocks if block.line < line]
        if not above:
            sys.exit(f"{page.name}:{line}: no command is above this picture")
        yield image, above[-1].text


def to_jpeg(picture, made, size=LARGEST_STILL):
    """At the best quality that fits into so many bytes."""
    for quality in range(2, 32):  # of ffmpeg: 2 is the best
        subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-i", picture, "-q:v", str(quality), made], check=True)
        if made.stat().st_size <= size:
            return
    sys.exit(f"{made.name} does not fit into {size} bytes")


def make(image, command, build):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "resources").symlink_to(ROOT / "resources")
        environment = {**os.environ, "PATH": f"{build / 'bin'}:{os.environ['PATH']}"}
        subprocess.run(["sh", "-ec", command], cwd=folder, env=environment, check=True)
        if image.suffix == ".jpg":
            last = max((folder / "out").glob("*.png"))
            made = folder / image.name
            to_jpeg(last, made)
        else:
            made = folder / image.name
        size = made.stat().st_size
        if size > LARGEST_CLIP:
            sys.exit(f"{image.name} has {size} bytes: at most {LARGEST_CLIP} are wanted")
        image.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(made, image)
    return size


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("names", nargs="*", help="pictures to be made, such as honey.gif; all without names")
    parser.add_argument("--build", type=Path, default=ROOT / "build" / "cpu", help="folder of the build whose program runs")
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "gallery.md", help="the page with the commands")
    options = parser.parse_args()
    pictures = list(wanted(options.page.resolve()))
    if unknown := set(options.names) - {image.name for image, _ in pictures}:
        sys.exit(f"{options.page.name} shows no {', '.join(sorted(unknown))}")
    for image, command in pictures:
        if options.names and image.name not in options.names:
            continue
        start = time.monotonic()
        size = make(image, command, options.build.resolve())
        print(f"{image.name}: {time.monotonic() - start:.0f} s, {size / 1e3:.0f} kB", flush=True)


if __name__ == "__main__":
    main()
