"""Runs scenes whose answers are known and compares: see ./dev validate --help."""

import argparse
import datetime
import json
import math
import shlex
import shutil
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

from lab import ROOT, Lab, Outcome, Row
import at_rest
import coiling
import confined
import defaults
import floating
import in_motion
import kept
import program
import report
import surfaces
import waves
import without_ends


PAGE = ROOT / "engineering" / "validation.md"
IMAGES = ROOT / "engineering" / "images" / "validation"  # of the page
MARKER = "<!-- The rest is made by ./dev validate --docs -->"


@dataclass(frozen=True)
class Check:
    key: str
    title: str
    run: Callable
    long: bool = False  # among those that take most of the time: begun first where several run at a time

    @property
    def about(self):
        return " ".join(self.run.__doc__.split())


CHECKS = [
    Check("settled_volume", "Settled volume", at_rest.settled_volume),
    Check("block_at_rest", "A block at rest", at_rest.block_at_rest),
    Check("wall_force", "Hydrostatic pressure", at_rest.wall_force),
    Check("held_sphere", "Buoyancy", at_rest.held_sphere, long=True),
    Check("moving_tank", "A tank that moves", at_rest.moving_tank),
    Check("sloshing", "Energy", at_rest.sloshing),
    Check("rotating_tank", "A tank that turns", in_motion.rotating_tank),
    Check("efflux", "Efflux from a hole", in_motion.efflux, long=True),
    Check("dam_front", "The front of a dam break", in_motion.dam_front),
    Check("full_goblet", "A full goblet", in_motion.full_goblet, long=True),
    Check("small_wave", "A small wave", waves.small_wave),
    Check("round_tank", "Waves in a round tank", waves.round_tank, long=True),
    Check("u_tube", "Water in a U", confined.u_tube, long=True),
    Check("cavity", "A lid-driven cavity", confined.cavity, long=True),
    Check("drop", "A drop", in_motion.drop),
    Check("laplace", "Pressure in drops", surfaces.laplace),
    Check("swinging_drop", "A drop that swings", surfaces.swinging_drop),
    Check("sessile_drop", "Drops on a table", surfaces.sessile_drop),
    Check("default_solver", "The default solver", defaults.default_solver, long=True),
    Check("default_wall_force", "Hydrostatic pressure, by default", defaults.default_wall_force, long=True),
    Check("default_held_sphere", "Buoyancy, by default", defaults.default_held_sphere, long=True),
    Check("default_rotating_tank", "A tank that turns, by default", defaults.default_rotating_tank, long=True),
    Check("default_efflux", "Efflux from a hole, by default", defaults.default_efflux, long=True),
    Check("default_dam_front", "The front of a dam break, by default", defaults.default_dam_front),
    Check("momentum", "Momentum", in_motion.momentum),
    Check("poiseuille", "Poiseuille flow", without_ends.poiseuille),
    Check("couette", "Couette flow", without_ends.couette),
    Check("taylor_green", "Taylor–Green vortices", without_ends.taylor_green),
    Check("coiling", "A rope of honey", coiling.coiling, long=True),
    Check("released_ball", "Added mass", floating.released_ball),
    Check("floating_cube", "Draught of floating bodies", floating.floating_cube, long=True),
    Check("floating_beam", "Attitudes of a floating beam", floating.floating_beam, long=True),
    Check("heaving_ball", "A ball that heaves", floating.heaving_ball, long=True),
    Check("wedge_entry", "Water entry of a wedge", floating.wedge_entry, long=True),
]


def all_keys():
    return ", ".join(check.key for check in CHECKS)


def options_parser():
    parser = argparse.ArgumentParser(
        prog="./dev validate", description="Run scenes whose answers are known, and compare. Exit code 1 if one differs.",
        epilog=f"The checks: {all_keys()}.")
    parser.add_argument("--scale", choices=("quick", "full"), default="quick",
                        help="quick: minutes on a CPU, the default; full: finer, for a GPU")
    parser.add_argument("--device", default="auto", metavar="D", help="auto, cpu, cuda or cuda:N; of several, as cpu,cuda, "
                        "the numbers stand side by side, and the pictures are of the first")
    parser.add_argument("--beside", type=Path, action="append", default=[], metavar="FILE",
                        help="a results.json that this command left on another machine: its numbers stand beside, too")
    parser.add_argument("--only", default="", metavar="CHECKS", help="some checks, such as efflux,drop")
    parser.add_argument("--solver", metavar="TYPE", help="a solver for all scenes in place of their own, such as TwoProjections, "
                        "with its defaults and without artificial viscosity; results go to a folder of its name")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "validation", metavar="DIR",
                        help="where all is written")
    parser.add_argument("--reuse", action="store_true",
                        help="do not repeat runs that are there already, maybe by another build")
    parser.add_argument("--resume", action="store_true",
                        help="after a call that was cut off: take the checks that the same commit has done on the same device at "
                        "the same scale, and do the rest")
    parser.add_argument("--commit", metavar="C", help="the commit of the program, where this folder is no clone of git")
    parser.add_argument("--threads", type=int, metavar="N", help="threads on the CPU")
    parser.add_argument("--jobs", type=int, default=1, metavar="N",
                        help="run that many simulations at a time, with --threads of a part of the cores each")
    parser.add_argument("--limit", type=float, metavar="S",
                        help="end a simulation that takes longer than this many seconds; its check then fails")
    parser.add_argument("--no-plots", action="store_true",
                        help="numbers only, on a machine without Python's matplotlib; with --docs the page keeps its pictures")
    parser.add_argument("--docs", action="store_true",
                        help="write the table and the pictures into engineering/validation.md, too; needs all checks")
    parser.add_argument("--weir", type=Path, required=True, metavar="FILE", help="the program")
    return parser


def arguments(argv):
    parser = options_parser()
    parsed = parser.parse_args(argv)
    wanted = [key.strip() for key in parsed.only.split(",") if key.strip()]
    unknown = set(wanted) - {check.key for check in CHECKS}
    if unknown:
        parser.error(f"--only: there is no check {', '.join(sorted(unknown))}; allowed: {all_keys()}")
    if wanted and parsed.docs:
        parser.error("--docs: the page shows all checks, so --only cannot be given with it")
    parsed.devices = [device.strip() for device in parsed.device.split(",")]
    if not all(parsed.devices) or len(set(parsed.devices)) < len(parsed.devices):
        parser.error(f"--device: {parsed.device!r} is not allowed; devices, each once, with commas between them")
    if parsed.docs and parsed.solver:
        parser.error("--docs: the page shows the solvers of the scenes, so --solver cannot be given with it")
    if parsed.jobs < 1:
        parser.error(f"--jobs: {parsed.jobs} is not allowed; at least 1")
    if parsed.limit is not None and parsed.limit <= 0:
        parser.error(f"--limit: {parsed.limit:g} s is not allowed; more than 0")
    if parsed.resume and parsed.reuse:
        parser.error("--reuse: runs of it may be another build's, so it cannot be given with --resume")
    parsed.commit = parsed.commit or kept.commit_of(ROOT)
    if parsed.resume and (not parsed.commit or parsed.commit.endswith(kept.CHANGED)):
        parser.error(f"--resume: the commit is {parsed.commit or 'not known'}, so checks of this program cannot be told from "
                     "others; commit the changes, or name the commit by --commit")
    parsed.checks = [check for check in CHECKS if not wanted or check.key in wanted]
    return parsed


def outcome_of(check, lab):
    """A run that diverged, or a result that cannot be told, is a failed check and no end of the others."""
    try:
        return check.run(lab)
    except (KeyError, IndexError, ValueError, ZeroDivisionError) as e:
        return Outcome([Row(f"the results cannot be judged ({type(e).__name__}: {e})", math.nan, below=0)], judged=False)


def result_of(check, lab, store, resume):
    """Taken from the store where that is asked for and it is there, or else made. What may be of another build, and what
    cannot be judged, as a run that took too long cannot, is not stored."""
    if resume and (found := store.read(check.key)):
        lab.say(f"  {check.title}: made before, {found.day}")
        return found
    outcome = outcome_of(check, lab)
    result = kept.Result(outcome, lab.seconds, lab.machine, str(datetime.date.today()))
    if outcome.judged and not lab.reuse:
        store.write(check.key, result)
    return result


def pictures_of(check, outcome, out):
    """The names of those that are drawn."""
    names = []
    if outcome.picture is not None:
        names.append(f"{check.key}.jpg")
        report.shrink(outcome.picture, out / names[-1])
    if outcome.charts:
        names.append(f"{check.key}_plot.png")
        report.draw(outcome.charts, out / names[-1])
    return names


def pictures_of_page(check):
    """The names of those that the page has."""
    return [name for name in (f"{check.key}.jpg", f"{check.key}_plot.png") if (IMAGES / name).exists()]


def write_docs(results, done, out, drawn):
    """Replaces what follows the marker in the page, and its pictures where there are new ones."""
    text = PAGE.read_text(encoding="utf-8")
    if MARKER not in text:
        raise program.RunFailed(f"{PAGE} has no line {MARKER}")
    results = results.replace("](", "](images/validation/")
    PAGE.write_text(text[:text.index(MARKER)] + MARKER + "\n\n" + results, encoding="utf-8")
    IMAGES.mkdir(parents=True, exist_ok=True)
    for _, _, names in done if drawn else ():
        for name in names:
            shutil.copy(out / name, IMAGES / name)


def judged(options, device, out, drawn, say):
    """All checks on a device: [(check, outcome, names of pictures)], and the result of each."""
    out.mkdir(parents=True, exist_ok=True)
    store = kept.Kept(out, options.commit, device, options.scale, drawn)
    done, results = [], []
    with ThreadPoolExecutor(len(options.checks) if options.jobs > 1 else 1) as checking, \
            Lab(options.weir, out, device, options.threads, options.scale == "full", say, options.reuse,
                options.jobs, drawn, options.limit, options.solver) as lab:  # left first: the checks of a run that failed wait for no others
        begun = sorted(options.checks, key=lambda check: options.jobs > 1 and not check.long)
        pending = {check.key: checking.submit(result_of, check, lab.of_one_check(), store, options.resume) for check in begun}
        for check in options.checks:
            say(f"{check.title}, {device}")
            results.append(pending[check.key].result())
            outcome = results[-1].outcome
            for row in outcome.rows:
                say(f"  {report.verdict(row.passed):6} {row.what}: {report.number(row.measured)} {row.unit}")
            undrawn = pictures_of_page(check) if options.docs else []
            done.append((check, outcome, pictures_of(check, outcome, out) if drawn else undrawn))
    return done, results


def results_as_json(done, results, command, device, commit):
    """What report.as_json says of them all, as one run's."""
    machines = dict.fromkeys(result.machine for result in results if result.machine)
    made = ", ".join(filter(None, [max(result.day for result in results), commit]))
    return report.as_json(done, command, "; ".join(machines) or device, sum(result.seconds for result in results), made)


def results_of(path):
    """What this command wrote elsewhere."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        report.summary(found)
        return found
    except (OSError, ValueError, KeyError, TypeError) as e:
        raise program.RunFailed(f"--beside {path}: these are not results of ./dev validate ({type(e).__name__}: {e})") from e


def main(argv):
    options = arguments(argv)
    beside = [results_of(path) for path in options.beside]
    command = shlex.join(["./dev", "validate", *(word for word in argv[2:] if word != "--resume")])
    base = options.out.resolve() / options.scale / (options.solver or "")

    def say(text):
        print(text, file=sys.stderr, flush=True)

    pages = []
    for k, device in enumerate(options.devices):
        out = base / device if k else base
        done, made = judged(options, device, out, not (k or options.no_plots), say)
        results = results_as_json(done, made, command, device, options.commit)
        (out / "results.json").write_text(results, encoding="utf-8")
        pages.append((done, json.loads(results)))
    done, first = pages[0]
    page = report.markdown(done, [first] + [results for _, results in pages[1:]] + beside)
    (base / "README.md").write_text("# Validation\n\n" + page, encoding="utf-8")
    if options.docs:
        write_docs(page, done, base, not options.no_plots)
    print(base / "README.md")
    return 1 if any(not check["passed"] for _, results in pages for check in results["checks"]) else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except program.RunFailed as failure:
        sys.exit(f"validate: {failure}")
    except KeyboardInterrupt:
        sys.exit(130)
