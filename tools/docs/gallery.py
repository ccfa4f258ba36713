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
LARGEST = 1 << 20  # bytes of a file of the repository


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


def make(image, command, build, jpeg_quality):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "resources").symlink_to(ROOT / "resources")
        environment = {**os.environ, "PATH": f"{build / 'bin'}:{os.environ['PATH']}"}
        subprocess.run(["sh", "-ec", command], cwd=folder, env=environment, check=True)
        if image.suffix == ".jpg":
            last = max((folder / "out").glob("*.png"))
            made = folder / image.name
            subprocess.run(["ffmpeg", "-loglevel", "error", "-i", last, "-q:v", str(jpeg_quality), made], check=True)
        else:
            made = folder / image.name
        size = made.stat().st_size
        if size > LARGEST:
            sys.exit(f"{image.name} has {size} bytes: at most {LARGEST} are wanted")
        image.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(made, image)
    return size


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("names", nargs="*", help="pictures to be made, such as honey.gif; all without names")
    parser.add_argument("--build", type=Path, default=ROOT / "build" / "cpu", help="folder of the build whose program runs")
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "gallery.md", help="the page with the commands")
    parser.add_argument("--jpeg-quality", type=int, default=3, help="of ffmpeg: 2 is the best")
    options = parser.parse_args()
    pictures = list(wanted(options.page.resolve()))
    if unknown := set(options.names) - {image.name for image, _ in pictures}:
        sys.exit(f"{options.page.name} shows no {', '.join(sorted(unknown))}")
    for image, command in pictures:
        if options.names and image.name not in options.names:
            continue
        start = time.monotonic()
        size = make(image, command, options.build.resolve(), options.jpeg_quality)
        print(f"{image.name}: {time.monotonic() - start:.0f} s, {size / 1e3:.0f} kB", flush=True)


if __name__ == "__main__":
    main()
