"""The logic of tools/paper: scales, command lines, and the numbers of the plots. No simulation is run, but that of a
stand-in for the program. Called by ctest with the folder of the sources; needs nothing but Python."""

import os
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools" / "paper"))

import figures  # noqa: E402
import paper  # noqa: E402
import program  # noqa: E402
import quantities  # noqa: E402
import scene as scenes  # noqa: E402

SCENES = ROOT / "resources" / "scenes" / "paper"
SMALL = {
    "world": {"frame_rate": 20, "duration": 1},
    "nodes": {"block": {"params": {"max": [1, 2, 3]}}, "water": {"params": {"spacing": 0.01}}},
    "render": {"camera": {"eye": [4, 0, -2]}, "color": {"range": [0, 2]}},
}


class Scale(unittest.TestCase):
    def test_size_shrinks_lengths_by_the_cube_root(self):
        settings = scenes.scaled(SMALL, "size", 0.125, ("block.max", "render.camera.eye"))
        self.assertEqual(settings["block.max"], "[0.5, 1, 1.5]")
        self.assertEqual(settings["render.camera.eye"], "[2, 0, -1]")
        self.assertNotIn("water.spacing", settings)

    def test_spacing_grows_by_the_cube_root(self):
        self.assertEqual(scenes.scaled(SMALL, "spacing", 0.125), {"water.spacing": "0.02"})

    def test_the_whole_scale_changes_nothing(self):
        for scaling in ("size", "spacing"):
            self.assertEqual(scenes.scaled(SMALL, scaling, 1, ("block.max",)), {})
            self.assertEqual(scenes.time_factor(scaling, 1), 1)

    def test_times_and_speeds_go_with_the_root_of_a_length(self):
        self.assertAlmostEqual(scenes.time_factor("size", 0.125) ** 2, 0.5)
        self.assertEqual(scenes.time_factor("spacing", 0.125), 1)
        self.assertEqual(scenes.scaled(SMALL, "size", 1 / 64, ())["render.color.range"], "[0, 1]")

    def test_lengths_that_a_run_sets_shrink_too(self):
        settings = {"block.max": "[0.4, 0.2, 0]", "water.spacing": "0.02"}
        scaled = scenes.scaled_overrides(settings, "size", 0.125, ("block.max",))
        self.assertEqual(scaled, {"block.max": "[0.2, 0.1, 0]", "water.spacing": "0.02"})
        self.assertEqual(scenes.scaled_overrides(settings, "spacing", 0.125, ("block.max",)), settings)
        self.assertEqual(scenes.scaled_overrides(settings, "size", 1, ("block.max",)), settings)

    def test_wrong_scales_and_paths_are_refused(self):
        for scale in (0, -1, 1.5):
            self.assertRaises(ValueError, scenes.scaled, SMALL, "size", scale)
        with self.assertRaisesRegex(KeyError, "block.maxx"):
            scenes.scaled(SMALL, "size", 0.5, ("block.maxx",))


class Figures(unittest.TestCase):
    def test_every_scene_and_every_length_is_there(self):
        for figure in figures.FIGURES:
            scene = scenes.read(SCENES / figure.scene)
            scenes.scaled(scene, figure.scaling, 0.5, figure.lengths)
            for run in figure.runs:
                for path in run.settings:
                    self.assertTrue(path.split(".")[0] in (*scene["nodes"], "world", "render"), path)

    def test_names_are_unique_and_places_in_the_montage_too(self):
        for figure in figures.FIGURES:
            names = [run.name for run in figure.runs]
            self.assertEqual(len(names), len(set(names)), figure.key)
            if figure.pictures:
                places = [(run.row, run.column) for run in figure.runs if run.shown]
                self.assertEqual(len(places), len(set(places)), figure.key)

    def test_find(self):
        self.assertEqual([f.key for f in figures.find(["fig6", "fig4"])], ["fig4", "fig6"])
        self.assertEqual(figures.find([]), figures.FIGURES)
        with self.assertRaisesRegex(ValueError, "fig99.*allowed: fig1"):
            figures.find(["fig99"])

    def test_the_same_relative_stiffness_at_every_spacing(self):
        for run in figures.same_stiffness((0.005, 0.0075, 0.01, 0.02)):
            d, mu = float(run.settings["water.spacing"]), float(run.settings["water.mu"])
            self.assertAlmostEqual(mu * 0.001 ** 2 / (1000 * d ** 5), 10, places=3)  # K = mu/d³, c² = K/ρ0, dt = 1 ms


class Montages(unittest.TestCase):
    def test_a_montage_a_moment_or_one_of_all_moments_of_a_single_run(self):
        def made(key, frames):
            figure = figures.find([key])[0]
            results = {run.name: program.Result(Path("none")) for run in figure.runs}
            return [(name, len(panels)) for name, panels in paper.montages(figure, results, frames)]

        self.assertEqual(made("fig2", [1, 5]), [("fig2.jpg", 2)])
        self.assertEqual(made("fig6", [4, 8]), [("fig6_1.jpg", 15), ("fig6_2.jpg", 15)])
        self.assertEqual(made("fig4", [9]), [("fig4.jpg", 2)])  # the free blobs are not shown
        self.assertEqual(made("fig8", []), [])


class Program(unittest.TestCase):
    """With a shell script in the program's place."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.weir = Path(self.folder.name) / "weir"
        self.out = Path(self.folder.name) / "out"
        self.scene = Path(self.folder.name) / "s.json"
        self.scene.write_text("{}")

    def stand_in(self, script):
        self.weir.write_text("#!/bin/sh\n" + script)
        self.weir.chmod(self.weir.stat().st_mode | stat.S_IXUSR)

    def run_it(self, **settings):
        return program.run(self.weir, self.scene, self.out, settings, "cpu", pictures=False)

    def test_the_command_line_holds_every_setting(self):
        line = program.command_line("weir", "s.json", Path("o"), {"water.spacing": "0.02"}, "cuda", frames=3, threads=2)
        self.assertEqual(line[:3], ["weir", "run", "s.json"])
        for pair in (["--set", "water.spacing=0.02"], ["--device", "cuda"], ["--frames", "3"], ["--threads", "2"],
                     ["--images", "o/frames"], ["--stats", "o/stats.json"], ["--series", "o/series.jsonl"]):
            at = line.index(pair[0])
            self.assertEqual(line[at:at + 2], pair)

    def test_the_same_run_is_not_repeated_another_is(self):
        self.stand_in(f'echo x >> {self.folder.name}/count\n')
        count = lambda: len((Path(self.folder.name) / "count").read_text().split())  # noqa: E731
        self.run_it(a="1")
        self.run_it(a="1")
        self.assertEqual(count(), 1)
        self.run_it(a="2")
        self.assertEqual(count(), 2)
        self.scene.write_text('{"title": "changed"}')
        self.run_it(a="2")
        self.assertEqual(count(), 3)

    def test_results_from_another_place_and_program_are_not_repeated(self):
        self.stand_in("")
        self.run_it(a="1")
        elsewhere = Path(self.folder.name) / "elsewhere"
        (elsewhere / "scenes").mkdir(parents=True)
        shutil.copytree(self.out, elsewhere / "out")
        shutil.copy(self.scene, elsewhere / "scenes")
        result, seconds = program.run(elsewhere / "no_program", elsewhere / "scenes" / self.scene.name,
                                      elsewhere / "out", {"a": "1"}, "cpu", pictures=False, threads=2)
        self.assertEqual((result.folder, seconds), (elsewhere / "out", 0.0))

    def test_a_simulation_that_diverges_is_a_result_other_failures_are_not(self):
        self.stand_in("echo 'error: it diverged' >&2\nexit 4\n")
        result, _ = self.run_it()
        self.assertIn("diverged", result.error)
        self.assertEqual(result.series, [])
        self.stand_in("echo 'no such file' >&2\nexit 5\n")
        with self.assertRaisesRegex(program.RunFailed, "(?s)exit code 5.*no such file"):
            self.run_it(b="1")
        self.assertFalse((self.out / "command.txt").exists())

    def test_the_picture_of_a_frame_or_the_last_before_it(self):
        result = program.Result(self.out)
        self.assertIsNone(result.picture(0))
        os.makedirs(self.out / "frames")
        for k in range(3):
            (self.out / "frames" / f"frame_{k:05}.png").touch()
        self.assertEqual(result.picture(1).name, "frame_00001.png")
        self.assertEqual(result.picture(7).name, "frame_00002.png")


class Quantities(unittest.TestCase):
    def test_relative_errors_are_equation_18(self):
        self.assertEqual(quantities.relative_errors([9, 5, 2, 1]), [1.0, 0.5, 0.125])
        self.assertIsNone(quantities.relative_errors([3, 3]))

    def test_iterations_to_a_level_count_from_where_it_stays_below(self):
        self.assertEqual(quantities.iterations_to([1, 0.05, 0.2, 0.05, 0.01], 0.1), 3)
        self.assertIsNone(quantities.iterations_to([1, 0.5], 0.1))

    def test_per_mass(self):
        report = {"fluid_volume": 0.002, "linear_momentum": [3, 0, 4], "kinetic_energy": 8}
        self.assertAlmostEqual(quantities.mean_velocity(report), 2.5)
        self.assertAlmostEqual(quantities.kinetic(report), 4)

    def test_the_energy_that_was_gained(self):
        def frame(kinetic, potential):
            return {"nodes": {"water": {"linear_momentum": [0, 0, 0], "kinetic_energy": kinetic,
                                        "potential_energy": potential}}}

        self.assertEqual(quantities.energy_gain([frame(0, 4), frame(6, 2), frame(1, 1)]), 2)
        self.assertIsNone(quantities.energy_gain([frame(0, 0), frame(1, 0)]))
        self.assertIsNone(quantities.energy_gain([]))

    def test_over_time_leaves_out_frames_without_fluid(self):
        series = [{"time": 0.0, "nodes": {"water": {"type": "ParticleFluid"}}},
                  {"time": 0.5, "nodes": {"water": {"linear_momentum": [1, 0, 0], "objective_by_iteration": [2, 1]}}}]
        self.assertEqual(quantities.over_time(series, lambda r: r["linear_momentum"][0]), ([0.5], [1]))
        self.assertEqual(quantities.last_objective(series), [2, 1])
        self.assertIsNone(quantities.last_objective(series[:1]))


class WithoutDrawing(unittest.TestCase):
    def test_a_page_of_numbers_needs_no_matplotlib(self):
        """The stand-in writes statistics; matplotlib must not even be looked for."""
        with tempfile.TemporaryDirectory() as folder:
            weir, out = Path(folder) / "weir", Path(folder) / "out"
            weir.write_text(STATISTICS_WRITER)
            weir.chmod(0o755)
            blocked = {**os.environ, "PYTHONPATH": str(Path(folder) / "blocked")}
            (Path(folder) / "blocked").mkdir()
            (Path(folder) / "blocked" / "matplotlib.py").write_text("raise RuntimeError('it was imported')")
            done = subprocess.run(
                [sys.executable, str(ROOT / "tools" / "paper" / "paper.py"), "--weir", str(weir), "--no-plots",
                 "--only", "fig1", "--out", str(out)], env=blocked, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            page = (out / "README.md").read_text()
            self.assertIn("| d = 10 mm | 7 |", page)
            self.assertNotIn("![", page)

    def test_runs_render_nothing_where_times_alone_are_asked_for(self):
        with tempfile.TemporaryDirectory() as folder:
            weir = Path(folder) / "weir"
            weir.write_text(STATISTICS_WRITER)
            weir.chmod(0o755)
            for option, rendered in (("--no-plots", True), ("--no-pictures", False)):
                out = Path(folder) / option
                done = subprocess.run([sys.executable, str(ROOT / "tools" / "paper" / "paper.py"), "--weir", str(weir), option,
                                       "--only", "fig1", "--out", str(out)], capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIs("--images" in (out / "fig1" / "ours_0.01" / "command.txt").read_text(), rendered)
                self.assertNotIn("![", (out / "README.md").read_text())


STATISTICS_WRITER = """#!/bin/sh
while [ $# -gt 0 ]; do
  [ "$1" = --stats ] && echo '{"particles": 7, "end": "finished", "step_ms": {"mean": 2}, "device": {"description": "x"}}' > "$2"
  shift
done
"""

if __name__ == "__main__":
    unittest.main()
