"""Runs weir bench and writes its results as a page: see ./dev bench --help."""

import argparse
import importlib.util
import json
import shutil
import subprocess
import sys
from pathlib import Path

import page
import results as benchmarks

ROOT = Path(__file__).resolve().parents[2]
MARKER = "<!-- The rest is made by ./dev bench --docs -->"
PLOT = "steps.png"
DIVERGED = 4  # exit code of weir bench where a run diverged


def arguments(argv):
    parser = argparse.ArgumentParser(
        prog="./dev bench", allow_abbrev=False, description="Time steps of scenes with weir bench; write the results as a page, with a plot.",
        epilog="Other options, such as --device, --threads, --cases, --sizes and --quick, are those of weir bench.")
    parser.add_argument("--from", dest="files", nargs="+", type=Path, metavar="FILE",
                        help="run nothing, but take what weir bench --json wrote, on this machine or on others; where several "
                             "are of one device, the later ones' times are taken")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "bench", metavar="DIR", help="where all is written")
    parser.add_argument("--docs", action="store_true",
                        help="keep the results in engineering/benchmarks/, in place of earlier ones of the same device, and write "
                             "the page engineering/benchmarks.md anew from all that is there")
    parser.add_argument("--no-plots", action="store_true", help="do without matplotlib")
    parser.add_argument("--weir", type=Path, required=True, metavar="FILE", help="the program")
    options, rest = parser.parse_known_args(argv)
    if options.files and rest:
        parser.error(f"with --from nothing is run, so {' '.join(rest)} cannot be given")
    if options.docs and "--quick" in rest:
        parser.error("--docs: the page does not show the times of --quick")
    if options.docs and options.no_plots:
        parser.error("--docs: the page has a plot, so --no-plots cannot be given with it")
    if any(word.split("=")[0] == "--json" for word in rest):
        parser.error("--json cannot be given: the file is results.json in the folder of --out")
    options.rest = rest
    return options


def run(options):
    """Results that weir bench writes now."""
    file = options.out / "results.json"
    file.unlink(missing_ok=True)
    code = subprocess.run([str(options.weir), "bench", *options.rest, "--json", str(file)], check=False).returncode
    if not file.exists():
        sys.exit(code or 1)
    return [file], code


def read_peers():
    return json.loads((Path(__file__).parent / "peers.json").read_text(encoding="utf-8"))["peers"]


def write_page(many, options):
    """README.md and the plot in the folder of --out; the text."""
    peers = read_peers()
    drawn = not options.no_plots and importlib.util.find_spec("matplotlib") is not None
    if drawn:
        import plot  # matplotlib is slow to load
        plot.draw(many, peers, options.out / PLOT)
    text = page.markdown(many, peers, PLOT if drawn else None)
    (options.out / "README.md").write_text("# Benchmarks\n\n" + text, encoding="utf-8")
    return text


def keep(files, docs):
    """Puts the files beside those of other devices. Each device's are replaced together."""
    kept = docs / "benchmarks"
    kept.mkdir(exist_ok=True)
    new = [(benchmarks.read(file).key, Path(file).read_text(encoding="utf-8")) for file in files]
    for key in {key for key, _ in new}:
        for old in kept.glob(f"{key}.*.json"):
            old.unlink()
    for index, (key, text) in enumerate(new):
        (kept / f"{key}.{index}.json").write_text(text, encoding="utf-8")


def write_docs(docs, options):
    """Replaces what follows the marker in the page, and its plot."""
    name, images = docs / "benchmarks.md", docs / "images" / "benchmarks"
    before = name.read_text(encoding="utf-8")
    if MARKER not in before:
        raise benchmarks.Unusable(f"{name} has no line {MARKER}")
    # GPUs first: the larger series.
    many = benchmarks.merged([benchmarks.read(file) for file in sorted((docs / "benchmarks").glob("*.json"))])
    text = write_page(sorted(many, key=lambda results: not results.on_cuda), options)
    name.write_text(before[:before.index(MARKER)] + MARKER + "\n\n" + text.replace("](", "](images/benchmarks/"),
                    encoding="utf-8")
    images.mkdir(parents=True, exist_ok=True)
    shutil.copy(options.out / PLOT, images / PLOT)


def main(argv, docs=ROOT / "engineering"):
    options = arguments(argv)
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    files, code = (options.files, 0) if options.files else run(options)
    many = benchmarks.merged([benchmarks.read(file) for file in files])
    write_page(many, options)
    if options.docs and code in (0, DIVERGED):  # which the page then says
        keep(files, docs)
        write_docs(docs, options)
    elif options.docs:
        print(f"weir bench ended with code {code}, so engineering/ is left as it is", file=sys.stderr)
    print(options.out / "README.md")
    return code


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except benchmarks.Unusable as problem:
        sys.exit(f"bench: {problem}")
    except KeyboardInterrupt:
        sys.exit(130)
