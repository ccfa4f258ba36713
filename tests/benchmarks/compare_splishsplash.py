#!/usr/bin/env python3
"""Times the same dam break with Weir and with SPlisHSPlasH, one after the other on this machine, and prints Markdown tables.

  compare_splishsplash.py PROGRAM [--python PYTHON] [--size N] [--threads N] [--late-after S] [--json FILE]

Both have support radii of two spacings, steps of 1 ms and the same block in the same tank; SPlisHSPlasH's walls are particles
(Akinci 2012). Compared are, by the clock and in developed flow:

  PBF         SPlisHSPlasH's PBF with 3 iterations, and Weir with 3 iterations
  DFSPH       SPlisHSPlasH's DFSPH whose tolerance of density is the mean compression that Weir has with 3 iterations, and
              Weir with these. DFSPH makes one iteration at least, and may come out less compressed than was asked for; so there is
  DFSPH, its compression
              the same run of DFSPH, and Weir made so stiff, and with such a tolerance, that its mean compression is no more
              than DFSPH's

Mean compression is the mean of max(density / rest density - 1, 0), as each program has densities.

SPlisHSPlasH is a package of PyPI, which PYTHON must have (by default, the one that runs this):
  python3 -m venv splishsplash && splishsplash/bin/pip install pysplishsplash==2.18.1
Its wheels for Python 3.9 to 3.11 need a processor with AVX-512 (an import ends with code -4 elsewhere); those for
3.12 and 3.13 need AVX2.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

WORKER = Path(__file__).with_name("splishsplash_run.py")
ROOT = Path(__file__).resolve().parents[2]
INSTALL = "python3 -m venv splishsplash && splishsplash/bin/pip install pysplishsplash==2.18.1"
DEMANDS = {"PBF": 10, "DFSPH": 5, "DFSPH, its compression": 5}  # how many times faster
# Fluid at the bottom of the block is compressed by ρ·g·h/K of itself, that in developed flow by a third of it or less.
PRESSURE = 1000 * 9.8 * 0.81
MOST_ITERATIONS = 300


class Failed(Exception):
    pass


def environment_for(python):
    """The environment in which this Python can import pysplishsplash; raises Failed where none is found."""
    # Where a newer OpenGL is installed, the package's own library and the system's meet; one of them must come first.
    attempts = ({}, {"LD_PRELOAD": "libGLX.so.0"})
    said = ""
    for more in attempts:
        try:
            done = subprocess.run([python, "-c", "import numpy, pysplishsplash"], env=os.environ | more,
                                  capture_output=True, text=True, check=False)
        except OSError as e:
            raise Failed(f"{python} cannot be run: {e}") from e
        if done.returncode == 0:
            return more
        said = done.stderr.strip().splitlines()[-1:] or [f"it ended with code {done.returncode}"]
    raise Failed(f"{python} cannot import pysplishsplash ({said[0]}). To install it:\n  {INSTALL}\n"
                 "then give --python splishsplash/bin/python")


def setting(result, name):
    for text in result["set"]:
        if text.startswith(name + "="):
            return json.loads(text[len(name) + 1:])
    raise Failed(f"weir bench does not say {name}")


class Comparison:
    def __init__(self, options, environment, folder):
        self.options, self.environment, self.folder = options, environment, Path(folder)
        self.machine = None

    def weir(self, name, settings):
        """The result, and as weir bench wrote it."""
        file = self.folder / "weir.json"
        command = [self.options.program, "bench", "--device", "cpu", "--threads", str(self.options.threads),
                   "--cases", "dam-packing", "--sizes", str(self.options.size),
                   "--late-after", f"{self.options.late_after:g}", "--json", str(file),
                   "--set", "water.support_ratio=2"]
        for setting_ in settings:
            command += ["--set", setting_]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise Failed(f"weir bench ended with code {done.returncode}:\n{done.stdout}{done.stderr}")
        written = json.loads(file.read_text(encoding="utf-8"))
        self.machine = written["machine"]
        result = written["results"][0]
        moments = {moment["moment"]: moment for moment in result["moments"]}
        return {"program": "Weir", "method": name, "settings": settings, "moments": moments}, result

    def splishsplash(self, method, like, iterations, max_error_percent):
        """`like`: a result of weir bench; `iterations`: least and most."""
        scene = json.loads((ROOT / like["scene"]).read_text(encoding="utf-8"))
        tank = scene["nodes"]["tank"]["params"]["max"]
        file = self.folder / "splishsplash.json"
        file.unlink(missing_ok=True)
        task = {"method": method, "spacing": setting(like, "water.spacing"), "block": setting(like, "block.max"),
                "tank": tank, "dt": scene["world"]["dt"], "late_after": self.options.late_after,
                "min_iterations": iterations[0], "max_iterations": iterations[1],
                "max_error_percent": max_error_percent, "folder": str(self.folder), "result": str(file)}
        environment = os.environ | self.environment | {"OMP_NUM_THREADS": str(self.options.threads)}
        done = subprocess.run([self.options.python, str(WORKER)], input=json.dumps(task), env=environment,
                              capture_output=True, text=True, check=False)
        if done.returncode or not file.exists():
            raise Failed(f"SPlisHSPlasH ended with code {done.returncode}:\n{(done.stdout + done.stderr)[-2000:]}")
        written = json.loads(file.read_text(encoding="utf-8"))
        moments = {moment["moment"]: moment for moment in written["moments"]}
        for moment in moments.values():
            if moment["particles"] != like["size"] or not moment["finite"]:
                raise Failed(f"SPlisHSPlasH's {method} holds {moment['particles']} particles, of {like['size']}"
                             + ("" if moment["finite"] else ", and positions that are NaN or infinite"))
        return {"program": "SPlisHSPlasH", "method": method, "moments": moments}

    def all(self, say):
        """(results, pairs): pairs are (name, Weir's result, the other's) of what is compared."""
        say("Weir, 3 iterations")
        ours, like = self.weir("3 iterations", ["water.solver.iterations=3"])
        tell(say, ours)
        say("SPlisHSPlasH, PBF, 3 iterations")
        pbf = self.splishsplash("PBF", like, (3, 3), 0.01)
        tell(say, pbf)
        percent = 100 * compression(ours)
        say(f"SPlisHSPlasH, DFSPH, density error of at most {percent:.3g} %")
        dfsph = self.splishsplash("DFSPH", like, (1, 100), percent)
        tell(say, dfsph)
        tolerance = compression(dfsph)
        say(f"Weir, mean compression of at most {tolerance:.3g}")
        equal, _ = self.weir(f"tolerance {tolerance:.2g}", as_incompressible_as(tolerance))
        tell(say, equal)
        pairs = [("PBF", ours, pbf), ("DFSPH", ours, dfsph), ("DFSPH, its compression", equal, dfsph)]
        return [ours, equal, pbf, dfsph], pairs


def compression(result):
    return result["moments"]["late"]["compression_mean"]


def tell(say, result):
    say(f"  late: {result['moments']['late']['step_ms_median']:.3f} ms a step, "
        f"mean compression {compression(result):.3g}")


def as_incompressible_as(tolerance):
    """Settings of a fluid that can have, and is iterated to, at most this mean compression."""
    return [f"water.bulk_modulus={max(1e6, PRESSURE / tolerance):.3g}",
            "water.solver.type=AcceleratedSolver", f"water.solver.tolerance={max(1e-6, tolerance):.3g}",
            f"water.solver.max_iterations={MOST_ITERATIONS}",
            "water.solver.acceleration=conjugate", "water.solver.neighbor_searches=1"]


def table(results):
    lines = ["| program | method | moment | step (ms) | mean compression |", "|---|---|---|---:|---:|"]
    for result in results:
        for name, moment in result["moments"].items():
            lines.append(f"| {result['program']} | {result['method']} | {name} | {moment['step_ms_median']:.3f} | "
                         f"{moment['compression_mean']:.3g} |")
    return lines


def verdicts(pairs):
    """Rows of what is demanded, in developed flow."""
    rows = []
    for name, ours, theirs in pairs:
        here, there = (result["moments"]["late"]["step_ms_median"] for result in (ours, theirs))
        rows.append({"than": name, "weir": ours["method"], "weir_ms": here, "splishsplash_ms": there,
                     "weir_compression": compression(ours), "splishsplash_compression": compression(theirs),
                     "times_faster": there / here, "demanded": DEMANDS[name], "met": there / here >= DEMANDS[name]})
    return rows


def verdict_table(rows):
    lines = ["| than | Weir with | Weir (ms) | SPlisHSPlasH (ms) | compression | its | times faster | demanded | |",
             "|---|---|---:|---:|---:|---:|---:|---:|---|"]
    for row in rows:
        verdict = "met" if row["met"] else "**not met**"
        lines.append(f"| {row['than']} | {row['weir']} | {row['weir_ms']:.3f} | {row['splishsplash_ms']:.3f} | "
                     f"{row['weir_compression']:.2g} | {row['splishsplash_compression']:.2g} | "
                     f"{row['times_faster']:.1f} | {row['demanded']} | {verdict} |")
    return lines


def arguments(argv):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program weir")
    parser.add_argument("--python", default=sys.executable, metavar="PYTHON", help="a Python that has pysplishsplash")
    parser.add_argument("--size", type=int, default=135252, metavar="N", help="particles: a size of weir bench")
    parser.add_argument("--threads", type=int, default=4, metavar="N", help="threads of both")
    parser.add_argument("--late-after", type=float, default=1, metavar="S", help="simulated seconds before developed flow")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all numbers here")
    return parser.parse_args(argv)


def main(argv):
    options = arguments(argv)
    environment = environment_for(options.python)
    load = os.getloadavg()[0]
    if load > 0.2 * options.threads:
        print(f"warning: the load of this machine is {load:.1f} before this begins: times will mean little",
              file=sys.stderr)
    with tempfile.TemporaryDirectory() as folder:
        comparison = Comparison(options, environment, folder)
        results, pairs = comparison.all(lambda text: print(text, file=sys.stderr, flush=True))
    rows = verdicts(pairs)
    machine = comparison.machine
    print(f"{options.size} particles, {options.threads} threads, {machine['device']['description']}, {machine['date'][:10]}, "
          f"commit {machine['commit']}, load {load:.1f} at the start\n")
    print("\n".join(table(results) + [""] + verdict_table(rows)))
    if options.json:
        content = {"machine": machine, "load_at_start": load, "results": results, "verdicts": rows}
        options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Failed as failure:
        sys.exit(f"compare_splishsplash: {failure}")
    except KeyboardInterrupt:
        sys.exit(130)
