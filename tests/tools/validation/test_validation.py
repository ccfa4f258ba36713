"""The logic of tools/validation: verdicts, closed forms, and what becomes of runs that fail. No simulation is run. Called
by ctest; needs nothing but Python, and does more with numpy."""

import contextlib
import io
import json
import math
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools" / "validation"))

import validate  # noqa: E402  (it finds all others)
import at_rest  # noqa: E402
import in_motion  # noqa: E402
import program  # noqa: E402
import report  # noqa: E402
import scene as scenes  # noqa: E402
from lab import SCENES, Lab, Outcome, Row, mean_force  # noqa: E402

try:
    import numpy
except ImportError:
    numpy = None


class Verdicts(unittest.TestCase):
    def test_deviations_are_judged_on_both_sides(self):
        for measured, passed in ((1.9, False), (1.95, True), (2.05, True), (2.1, False)):
            self.assertIs(Row("x", measured, expected=2, within=0.03).passed, passed)
        self.assertTrue(Row("x", -1.95, expected=-2, within=0.03).passed)

    def test_limits_are_judged_together(self):
        for measured, passed in ((0.97, False), (1, True), (1.04, False)):
            self.assertIs(Row("x", measured, above=0.98, below=1.03).passed, passed)

    def test_counts_must_be_met_exactly(self):
        self.assertTrue(Row("x", 5000, expected=5000, within=0.0).passed)
        self.assertFalse(Row("x", 4999, expected=5000, within=0.0).passed)

    def test_nothing_passes_that_is_no_number(self):
        self.assertFalse(Row("x", math.nan, expected=1, within=0.5).passed)
        self.assertFalse(Row("x", math.nan, below=1).passed)

    def test_without_a_demand_there_is_no_verdict(self):
        self.assertIsNone(Row("x", 3, expected=2).passed)
        self.assertEqual(report.verdict(Row("x", 3, expected=2)), "–")


class ClosedForms(unittest.TestCase):
    def test_volumes_of_cylinder_and_cone(self):
        turned = 1000 * math.sin(2 * math.pi / 1000) / 2  # of the unit circle's polygon
        cylinder = [[0, 0], [2, 0], [2, 3], [0, 3]]
        self.assertAlmostEqual(at_rest.volume_of_revolution(cylinder, 1000), turned * 12, places=9)
        self.assertAlmostEqual(at_rest.volume_of_revolution([[2, 0], [0, 3]], 1000), turned * 4, places=9)
        self.assertAlmostEqual(at_rest.volume_of_revolution([[1, 0], [1, 1]], 4), 2, places=9)  # a square's prism

    def test_kinetic_energy_is_that_seen_from_the_tank(self):
        # 2 kg at (1, 2, 0) and 1 kg at (1, -1, 3) m/s, seen from (1, 0, 0).
        report_ = {"fluid_volume": 0.003, "linear_momentum": [3, 3, 3], "kinetic_energy": 5 + 5.5}
        self.assertAlmostEqual(at_rest.relative_kinetic(report_, [1, 0, 0]), (2 * 4 + 1 * 10) / 2 / 3)

    def test_forces_are_means_after_a_time(self):
        series = [{"time": t, "nodes": {"wall": {"solids": [{"solid": "a", "force": [t, 2 * t, 0]}]}}}
                  for t in (0.1, 0.2, 0.3, 0.4)]
        force = mean_force(series, "wall", 0.2)["a"]
        self.assertAlmostEqual(force[0], 0.35)
        self.assertAlmostEqual(force[1], 0.7)

    @unittest.skipIf(numpy is None, "needs numpy")
    def test_the_surface_of_a_bowl_of_points_is_found(self):
        spacing, slope = 0.01, 3
        points = [[x * spacing, y * spacing, z * spacing] for x in range(-20, 21) for z in range(-20, 21)
                  for y in range(60) if y * spacing < 0.2 + slope * (x * x + z * z) * spacing ** 2]
        r, y = in_motion.surface(numpy.array(points), spacing, 0.2)
        found, level = in_motion.line(r * r, y)
        self.assertLess(r.max(), 0.2)
        self.assertAlmostEqual(found, slope, delta=0.05 * slope)
        self.assertAlmostEqual(level, 0.2, delta=spacing)


class Checks(unittest.TestCase):
    def test_every_check_says_what_it_compares_and_has_a_key_of_its_own(self):
        keys = [check.key for check in validate.CHECKS]
        self.assertEqual(len(set(keys)), len(keys))
        for check in validate.CHECKS:
            self.assertGreater(len(check.about), 40)

    def test_every_scene_can_be_read_and_has_gravity_as_the_closed_forms(self):
        found = sorted((SCENES / "validation").glob("*.json"))
        self.assertGreater(len(found), 8)
        for path in found:
            self.assertIn(scenes.read(path)["world"]["gravity"][1], (0, -9.8), path)

    def test_runs_that_tell_nothing_fail_their_check_only(self):
        def silent(lab):
            """Nothing comes of it."""
            return Outcome([Row("x", [][0])])
        outcome = validate.outcome_of(validate.Check("silent", "Silent", silent), None)
        self.assertIs(outcome.rows[0].passed, False)

    def test_unknown_checks_are_refused(self):
        with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()) as said:
            validate.arguments(["--weir", "w", "--only", "efflux,eflux"])
        self.assertIn("there is no check eflux; allowed: settled_volume", said.getvalue())

    def test_the_documents_need_all_checks(self):
        with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()) as said:
            validate.arguments(["--weir", "w", "--only", "efflux", "--docs"])
        self.assertIn("--only cannot be given", said.getvalue())
        self.assertIn(validate.MARKER, (ROOT / "docs" / "validation.md").read_text(encoding="utf-8"))

    def test_a_lab_asks_the_program_for_what_is_needed(self):
        with tempfile.TemporaryDirectory() as folder:
            stand_in = Path(folder) / "weir"
            stand_in.write_text(
                f"#!{sys.executable}\nimport json, sys\na = sys.argv\nopen(a[a.index('--stats') + 1], 'w').write("
                "json.dumps({'device': {'description': 'none'}, 'wall_seconds': 2, 'seen': a[1:]}))\n")
            stand_in.chmod(0o755)
            lab = Lab(stand_in, Path(folder) / "out", "cpu", 2, False, lambda text: None)
            result = lab.run("drop/1", "validation/drop", {"water.spacing": "0.02"}, export=True)
            seen = result.stats["seen"]
            self.assertIn("water.spacing=0.02", seen)
            self.assertEqual(seen[seen.index("--export") + 1], str(Path(folder) / "out" / "drop/1" / "particles.vtkhdf"))
            self.assertNotIn("--images", seen)
            left = Path(folder) / "out" / "drop/1" / "left"
            left.touch()
            lab.reuse = True
            self.assertTrue(lab.run("drop/1", "validation/drop", {"water.spacing": "0.02"}, export=True).stats)
            self.assertTrue(left.exists())
            self.assertEqual(lab.seconds, 4)  # found again, and counted
            lab.reuse = False
            self.assertTrue(lab.run("drop/1", "validation/drop", {"water.spacing": "0.02"}, export=True).stats)
            self.assertFalse(left.exists())
            self.assertEqual(lab.machine, "none")


    def test_runs_are_made_at_once_and_waited_for_where_they_are_looked_at(self):
        with tempfile.TemporaryDirectory() as folder:
            stand_in = Path(folder) / "weir"  # it ends once the others have begun, too
            stand_in.write_text(
                f"#!{sys.executable}\nimport json, os, sys, time\na = sys.argv\nstats = a[a.index('--stats') + 1]\n"
                f"open({folder!r} + '/' + str(os.getpid()) + '.begun', 'w')\n"
                f"until = time.monotonic() + 20\n"
                f"while sum(n.endswith('.begun') for n in os.listdir({folder!r})) < 3 and time.monotonic() < until:\n"
                "    time.sleep(0.01)\n"
                "open(stats, 'w').write(json.dumps({'device': {'description': 'none'}, 'wall_seconds': 2,\n"
                "                                   'late': time.monotonic() > until}))\n")
            stand_in.chmod(0o755)
            with Lab(stand_in, Path(folder) / "out", "cpu", 1, False, lambda text: None, jobs=3) as lab:
                results = [lab.run(f"drop/{k}", "validation/drop") for k in range(3)]
                self.assertEqual([result.stats["late"] for result in results], [False] * 3)
                self.assertEqual(lab.seconds, 6)

    def test_a_run_that_cannot_be_made_fails_where_it_is_looked_at(self):
        with tempfile.TemporaryDirectory() as folder, \
                Lab(Path("/bin/false"), folder, "cpu", 1, False, lambda text: None) as lab:
            result = lab.run("drop/1", "validation/drop")
            with self.assertRaises(program.RunFailed):
                result.series  # noqa: B018


class Reports(unittest.TestCase):
    DONE = [(validate.CHECKS[0], Outcome([Row("a", 1.0, "m", 1.1, 0.05), Row("b", 2.0)]), ["a.png"])]

    def test_the_page_counts_what_failed(self):
        page = report.markdown(self.DONE, "./dev validate", "a machine", 60)
        self.assertIn("0 demands met, 1 not", page)
        self.assertIn("| a | 1.1 | 1 | m | -9.09 % | within 5 % | **FAIL** |", page)

    def test_the_json_holds_the_same(self):
        check = json.loads(report.as_json(self.DONE, "c", "m"))["checks"][0]
        self.assertFalse(check["passed"])
        self.assertEqual([row["passed"] for row in check["rows"]], [False, None])


if __name__ == "__main__":
    unittest.main()
