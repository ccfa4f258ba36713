#!/usr/bin/env python3
"""Makes the pictures of docs/gallery.md anew, by the commands that stand there, so that page and pictures agree.

Each command runs as it stands, in a fresh folder that sees `resources` and, first on the PATH, the program of a build. The picture below it on
the page is its clip, or else the last of its pictures, as a JPEG. Loops, NAME.webp, are of the scene gallery/NAME with the settings below, by
Cycles. With --frames, their pictures are in the folder NAME already, as PNG or JPEG files, such as from a machine with a GPU and without
ffmpeg.
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
LOOP_RATE = 15  # frames a second; what is to be seen slowed down has more of them
LOOPS = {  # the last frame, and what is set
    "lighthouse": (34, "let.spacing=0.13", "world.frame_rate=15"),
    "garden": (21, "let.spacing=0.012", "world.frame_rate=15"),
    "wine": (42, "let.spacing=0.0025", "world.frame_rate=40"),
    "pancakes": (58, "let.spacing=0.001", "world.frame_rate=60", "world.dt=0.0003"),
    "mill": (57, "let.spacing=0.03", "world.frame_rate=15"),
    "ship": (42, "let.spacing=0.1", "world.frame_rate=15"),
    "village": (39, "let.spacing=0.1", "world.frame_rate=12"),
    "paint": (30, "let.spacing=0.004", "world.frame_rate=15"),
}
LOOP_LOOK = "render.width=800", "render.height=450", "render.cycles.samples=32"


def wanted(page):
    """Pairs of a picture's path and the command above it."""
    lines = page.read_text().split("\n")
    images = [(i + 1, page.parent / m[1]) for i, line in enumerate(lines) if (m := re.match(r"!\[.*\]\((.*)\)", line))]
    blocks = [block for block in documents.read_page(page, page.name).blocks if block.language == "sh"]
    for line, image in images:
        if image.suffix == ".webp":
            yield image, loop_command(image.stem)
            continue
        above = [block for block in blocks if block.line < line]
        if not above:
            sys.exit(f"{page.name}:{line}: no command is above this picture")
        yield image, above[-1].text


def loop_command(name):
    last, *settings = LOOPS[name]
    return " ".join(["weir run", f"gallery/{name}", f"--frames {last} --images out",
                     *(f"--set {setting}" for setting in (*settings, *LOOP_LOOK))])


def to_jpeg(picture, made, size=LARGEST_STILL):
    """At the best quality that fits into so many bytes."""
    for quality in range(2, 32):  # of ffmpeg: 2 is the best
        subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-i", picture, "-q:v", str(quality), made], check=True)
        if made.stat().st_size <= size:
            return
    sys.exit(f"{made.name} does not fit into {size} bytes")


def to_loop(folder, made, size=LARGEST_CLIP):
    """An animation of all pictures in the folder, at the best quality that fits into so many bytes."""
    frames = sorted(entry for entry in folder.iterdir() if entry.suffix in (".png", ".jpg"))
    listing = made.with_suffix(".txt")
    listing.write_text("".join(f"file '{frame.resolve()}'\nduration {1 / LOOP_RATE}\n" for frame in frames))
    for quality in range(85, 20, -10):
        subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-f", "concat", "-safe", "0", "-i", listing, "-r", str(LOOP_RATE), "-c:v",
                        "libwebp_anim", "-quality", str(quality), "-compression_level", "6", "-loop", "0", made], check=True)
        if made.stat().st_size <= size:
            return
    sys.exit(f"{made.name} does not fit into {size} bytes")


def make(image, command, build, frames):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "resources").symlink_to(ROOT / "resources")
        environment = {**os.environ, "PATH": f"{build / 'bin'}:{os.environ['PATH']}"}
        if frames is None:
            subprocess.run(["sh", "-ec", command], cwd=folder, env=environment, check=True)
        made = folder / image.name
        if image.suffix == ".jpg":
            to_jpeg(max((folder / "out").glob("*.png")), made)
        elif image.suffix == ".webp":
            to_loop(folder / "out" if frames is None else frames / image.stem, made)
        size = made.stat().st_size
        if size > LARGEST_CLIP:
            sys.exit(f"{image.name} has {size} bytes: at most {LARGEST_CLIP} are wanted")
        image.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(made, image)
    return size


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("names", nargs="*", help="pictures to be made, such as ship.webp; all without names")
    parser.add_argument("--build", type=Path, default=ROOT / "build" / "cpu", help="folder of the build whose program runs")
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "gallery.md", help="the page with the commands")
    parser.add_argument("--frames", type=Path, help="a folder that holds the frames of loops: nothing runs")
    options = parser.parse_args()
    pictures = list(wanted(options.page.resolve()))
    if unknown := set(options.names) - {image.name for image, _ in pictures}:
        sys.exit(f"{options.page.name} shows no {', '.join(sorted(unknown))}")
    for image, command in pictures:
        if options.names and image.name not in options.names or options.frames and image.suffix != ".webp":
            continue
        start = time.monotonic()
        size = make(image, command, options.build.resolve(), options.frames)
        print(f"{image.name}: {time.monotonic() - start:.0f} s, {size / 1e3:.0f} kB", flush=True)


if __name__ == "__main__":
    main()
