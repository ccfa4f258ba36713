"""Runs the paper's figures and writes pictures, plots and a page: see ./dev paper --help."""

import argparse
import importlib.util
import math
import shlex
import sys
import time
from pathlib import Path

import figures
import page
import program
import quantities
import scene as scenes

ROOT = Path(__file__).resolve().parents[2]


def arguments(argv):
    parser = argparse.ArgumentParser(
        prog="./dev paper", description="Run the paper's figures; write pictures, plots and a page.")
    parser.add_argument("--scale", type=float, metavar="S",
                        help="particles, as a part of the paper's number: 1 is the paper's; "
                             "without it, each figure's own, for a CPU")
    parser.add_argument("--device", default="auto", metavar="D", help="auto, cpu, cuda or cuda:N")
    parser.add_argument("--only", default="", metavar="FIGS", help="some figures, such as fig4,fig6")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "paper", metavar="DIR",
                        help="where all is written; runs that are there already are not repeated")
    parser.add_argument("--threads", type=int, metavar="N", help="threads on the CPU")
    parser.add_argument("--no-plots", action="store_true",
                        help="run and write numbers only; the same command without this draws later, on any machine "
                             "that has the folder, and repeats no run")
    parser.add_argument("--no-pictures", action="store_true",
                        help="as --no-plots, and no run renders anything: for the times of steps alone")
    parser.add_argument("--weir", type=Path, required=True, metavar="FILE", help="the program")
    parsed = parser.parse_args(argv)
    parsed.no_plots = parsed.no_plots or parsed.no_pictures
    if parsed.scale is not None and not 0 < parsed.scale <= 1:
        parser.error(f"--scale is {parsed.scale}; allowed: above 0 to 1")
    try:
        parsed.figures = figures.find([key.strip() for key in parsed.only.split(",") if key.strip()])
    except ValueError as e:
        parser.error(f"--only: {e}")
    return parsed


def duration(scene, times, factor):
    """Simulated seconds: as long as the scene says, or as the last picture needs, in a smaller world."""
    rate = scene["world"]["frame_rate"]
    longest = max(times) if times else scene["world"]["duration"]
    return math.ceil(longest * factor * rate - 1e-6) / rate


def run_figure(figure, options, say):
    """All runs of a figure; {name: Result} and the frames of its pictures."""
    path = ROOT / "resources" / "scenes" / "paper" / figure.scene
    scene = scenes.read(path)
    scale = options.scale or figure.reduced
    factor = scenes.time_factor(figure.scaling, scale)
    times = figure.reduced_times if scale < 1 and figure.reduced_times else figure.times
    common = scenes.scaled(scene, figure.scaling, scale, figure.lengths)
    common["world.duration"] = scenes.text(duration(scene, times, factor))
    if scale < 1:
        common.update(figure.reduced_settings)
    results = {}
    for run in figure.runs:
        settings = {**common, **scenes.scaled_overrides(run.settings, figure.scaling, scale, figure.lengths)}
        spacing = run.settings.get("water.spacing")
        if spacing is not None and figure.scaling == "spacing":
            settings["water.spacing"] = scenes.text(float(spacing) / scale ** (1 / 3))
        result, seconds = program.run(options.weir, path, options.out / figure.key / run.name, settings,
                                      options.device, pictures=figure.pictures and run.shown and not options.no_pictures,
                                      frames=run.frames, threads=options.threads)
        results[run.name] = result
        say(f"{figure.key}/{run.name}: {seconds:.0f} s" + (", diverged" if result.error else ""))
    rate = scene["world"]["frame_rate"]
    return scale, results, [round(t * factor * rate) for t in times]


def montages(figure, results, frames):
    """(file name, panels) of each montage: one for each moment, or one of all moments where there is but one run."""
    shown = [run for run in figure.runs if run.shown]
    if len(shown) == 1 and frames:
        run, result = shown[0], results[shown[0].name]
        return [(f"{figure.key}.jpg",
                 [(0, column, run.title, result.picture(frame), "") for column, frame in enumerate(frames)])]
    made = []
    for index, frame in enumerate(frames):
        name = f"{figure.key}_{index + 1}.jpg" if len(frames) > 1 else f"{figure.key}.jpg"
        made.append((name, [(run.row, run.column, run.title, results[run.name].picture(frame),
                             "diverged" if results[run.name].error else "") for run in shown]))
    return made


def draw(figure, results, frames, out):
    """Writes the figure's montages and plot; their names."""
    import montage  # matplotlib is slow to load
    import plots
    names = []
    for name, panels in montages(figure, results, frames):
        montage.montage(panels, out / name)
        names.append(name)
    if figure.plot:
        names.append(f"{figure.key}_plot.png")
        getattr(plots, figure.plot)(figure, results, out / names[-1])
    return names


def can_draw():
    return importlib.util.find_spec("matplotlib") is not None


def main(argv):
    options = arguments(argv)
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    started = time.monotonic()

    def say(text):
        print(text, file=sys.stderr, flush=True)

    drawn = not options.no_plots and can_draw()
    if not drawn and not options.no_plots:
        say("paper: Python has no matplotlib here, so nothing is drawn; the same command draws where there is one")
    done, times, device = [], [], options.device
    for figure in options.figures:
        scale, results, frames = run_figure(figure, options, say)
        done.append((figure, scale, results, draw(figure, results, frames, options.out) if drawn else []))
        for run in figure.runs:
            stats = results[run.name].stats
            if figure.timed and run.name.startswith(figure.timed) and stats.get("end") == "finished":
                times.append((figure.key, *quantities.step_time(stats)))
                device = stats["device"]["description"]
    if times and drawn:
        import plots
        plots.step_times(times, device, options.out / "table1.png")
    command = shlex.join(["./dev", "paper", *argv[2:]])
    page.write(options.out / "README.md", command, device, done, times, drawn)
    say(f"{time.monotonic() - started:.0f} s in all")
    print(options.out / "README.md")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except program.RunFailed as failure:
        sys.exit(f"paper: {failure}")
    except KeyboardInterrupt:
        sys.exit(130)
