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
from unittest import mock

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools" / "validation"))

import validate  # noqa: E402  (it finds all others)
import at_rest  # noqa: E402
import coiling  # noqa: E402
import confined  # noqa: E402
import defaults  # noqa: E402
import in_motion  # noqa: E402
import kept  # noqa: E402
import program  # noqa: E402
import report  # noqa: E402
import scene as scenes  # noqa: E402
import waves  # noqa: E402
from lab import SCENES, Chart, Lab, Outcome, Particles, Row, mean_force  # noqa: E402

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

    def test_of_nothing_expected_no_share_is_allowed(self):
        self.assertTrue(Row("x", 0.0, expected=0.0, within=0.05).passed)
        self.assertFalse(Row("x", 1e-3, expected=0.0, within=0.05).passed)
        self.assertFalse(Row("x", math.nan, expected=0.0, within=0.05).passed)

    def test_nothing_passes_that_is_no_number(self):
        self.assertFalse(Row("x", math.nan, expected=1, within=0.5).passed)
        self.assertFalse(Row("x", math.nan, below=1).passed)

    def test_without_a_demand_there_is_no_verdict(self):
        self.assertIsNone(Row("x", 3, expected=2).passed)
        self.assertEqual(report.verdict(Row("x", 3, expected=2).passed), "–")


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

    def test_the_period_of_a_wave_is_found_between_frames(self):
        times = [0.03 * k for k in range(100)]
        found = waves.period_of(times, [0.2 * math.exp(-t / 9) * math.cos(2 * math.pi * t / 1.23) for t in times])
        self.assertAlmostEqual(found, 1.23, delta=1e-3)


class Waves(unittest.TestCase):
    def test_zeros_are_found_between_frames(self):
        self.assertEqual(waves.zeros_of([0, 1, 2, 3], [-1, 1, 3, -1]), [0.5, 2.75])

    def test_periods_of_modes(self):
        # g·k·tanh(k·h) by hand, for k = π and 2π per m and h = 40 cm.
        self.assertAlmostEqual(waves.Wave(0.025).period, 2 * math.pi / math.sqrt(9.8 * 3.14159265 * 0.85013), places=4)
        self.assertAlmostEqual(waves.Wave(0.025, halves=2).period, 2 * math.pi / math.sqrt(9.8 * 6.2831853 * 0.98697), places=4)

    @unittest.skipIf(numpy is None, "needs numpy")
    def test_modes_keep_volume_and_pass_no_wall(self):
        step, where = 1e-4, numpy.random.default_rng(1).uniform((0, 0, 0), (1, 0.4, 0.1), (50, 3))
        for halves in (1, 2):
            mode = waves.Wave(0.025, halves).mode
            along, up = numpy.array([[step, 0, 0]]), numpy.array([[0, step, 0]])
            divergence = (mode(where + along) - mode(where - along))[:, 0] + (mode(where + up) - mode(where - up))[:, 1]
            self.assertLess(abs(divergence / (2 * step)).max(), 1e-5)
            ends, floor = numpy.array([[0, 0.2, 0], [1, 0.3, 0]]), numpy.array([[0.3, 0, 0]])
            self.assertLess(abs(mode(ends)[:, 0]).max(), 1e-12)
            self.assertLess(abs(mode(floor)[:, 1]).max(), 1e-12)

    def test_extremes_of_bessel_functions(self):
        # Abramowitz and Stegun, table 9.5.
        for order, expected in ((0, 3.8317059702), (1, 1.8411837813), (2, 3.0542369282)):
            self.assertAlmostEqual(waves.first_extreme(order), expected, places=8)

    @unittest.skipIf(numpy is None, "needs numpy")
    def test_modes_of_a_round_tank_keep_volume_and_pass_no_wall(self):
        random, step = numpy.random.default_rng(1), 1e-4
        where = random.uniform((-0.15, 0, -0.15), (0.15, 0.2, 0.15), (50, 3))
        angles = random.uniform(0, 6.28, 20)
        for turns in (0, 1):
            mode = waves.RoundWave(0.0125, turns).mode
            divergence = sum((mode(where + step * along) - mode(where - step * along)) @ along for along in numpy.eye(3))
            self.assertLess(abs(divergence / (2 * step)).max(), 1e-4)
            rim = numpy.stack([waves.RADIUS * numpy.cos(angles), 0 * angles + 0.1, waves.RADIUS * numpy.sin(angles)], axis=1)
            self.assertLess(abs((mode(rim) * rim)[:, [0, 2]].sum(axis=1)).max(), 1e-9)
            self.assertLess(abs(mode(where * [1, 0, 1])[:, 1]).max(), 1e-12)
            highest = mode(numpy.array([[waves.RADIUS if turns else 0, waves.ROUND_DEPTH, 0]]))
            self.assertAlmostEqual(highest[0, 1], 1, places=9)


@unittest.skipIf(numpy is None, "needs numpy")
class Confined(unittest.TestCase):
    @staticmethod
    def corner_of(cells):
        """What the square of an L of that many cells across counts for, in squares: its arms are three more long, with potentials
        1 and 0 at their ends."""
        inside = [(i, j) for i in range(4 * cells) for j in range(4 * cells) if i < cells or j < cells]
        number = {place: k for k, place in enumerate(inside)}
        matrix, right = numpy.zeros((len(inside), len(inside))), numpy.zeros(len(inside))
        for (i, j), k in number.items():
            for near in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
                if near in number:
                    matrix[k, k] += 1
                    matrix[k, number[near]] -= 1
            if i == 4 * cells - 1 or j == 4 * cells - 1:  # half a cell to the end
                matrix[k, k] += 2
                right[k] += 2 if i > j else 0
        potential = numpy.linalg.solve(matrix, right)
        flow = sum(2 * (1 - potential[number[4 * cells - 1, j]]) for j in range(cells))
        return 1 / flow - 6

    def test_a_square_corner_counts_as_the_closed_form_says(self):
        coarse, fine, order = self.corner_of(4), self.corner_of(8), 4 / 3  # of the error, at a corner of 270 degrees
        self.assertAlmostEqual((2 ** order * fine - coarse) / (2 ** order - 1), confined.CORNER, delta=0.002)

    def test_velocities_between_particles_are_found(self):
        places = numpy.random.default_rng(2).uniform((0, 0, 0), (0.1, 0.1, 0.02), (4000, 3))
        x, y = places[:, 0], places[:, 1]
        velocities = numpy.stack([1 + 3 * x - y + 20 * x * y, 2 * y - 40 * x ** 2, 0 * x], axis=1)
        found, = confined.velocities_at([Particles(places, velocities)], [(0.03, 0.06)], 0.005)
        self.assertAlmostEqual(found[0], 1 + 0.09 - 0.06 + 20 * 0.03 * 0.06)
        self.assertAlmostEqual(found[1], 0.12 - 40 * 0.03 ** 2)


class Defaults(unittest.TestCase):
    def test_steps_end_with_the_longest_that_is_not_warned_of(self):
        # A particle falls 20 mm in 63.9 ms.
        for found, expected in zip(defaults.steps_of(0.02), (0.001775, 0.005324, 0.015972)):
            self.assertAlmostEqual(found, expected, places=6)

    def test_frames_are_whole_numbers_of_steps_and_near_the_rate(self):
        for spacing, rate in ((0.02, 10), (0.00286, 200), (0.04, 50)):
            for dt in defaults.steps_of(spacing):
                settings = defaults.settings_of(spacing, dt, rate)
                steps = 1 / float(settings["world.frame_rate"]) / float(settings["world.dt"])
                self.assertAlmostEqual(steps, round(steps), places=9)
                self.assertGreater(steps, 0.9)
                self.assertLess(float(settings["world.frame_rate"]), 1.1 * rate)

    def test_of_several_steps_the_farthest_number_counts(self):
        def rows_of(measured, _, label):
            force, share = measured
            return [Row(f"force, {label}", force, "N", 10, 0.03), Row(f"told, {label}", 7),
                    Row(f"share, {label}", share, below=0.05)]

        def rows(*measured):
            return defaults.farthest((0.02, dict(zip((0.001, 0.003, 0.01), measured))), rows_of)[0]

        force, share = rows((10.1, 0.02), (9.5, 0.03), (10.4, 0.01))
        self.assertEqual((force.what, force.measured, force.passed), ("force, d = 20 mm, steps of 1, 3, 10 ms", 9.5, False))
        self.assertEqual((share.measured, share.passed), (0.03, True))
        for at in range(3):
            measured = [(10.0, 0.0)] * 3
            measured[at] = (math.nan, math.nan)
            self.assertEqual([row.passed for row in rows(*measured)], [False, False])

    def test_each_check_runs_three_steps_at_each_of_three_spacings_by_default(self):
        class Stub:
            scale = staticmethod(lambda quick, full: quick)

            def run(self, name, scene, settings, **options):
                asked.append((name, scene, settings["water.spacing"], settings["world.dt"], options["defaults"]))

        for check in (check for check in validate.CHECKS if check.key.startswith("default_")):
            asked = []
            with contextlib.suppress(AttributeError, ImportError):  # there are no results to judge, or no numpy to judge them
                check.run(Stub())
            self.assertEqual(len(set(asked)), len({name for name, *_ in asked}), check.key)
            self.assertEqual({by_default for *_, by_default in asked}, {True}, check.key)
            for scene in {scene for _, scene, *_ in asked}:
                self.assertEqual(len({(d, dt) for _, s, d, dt, _ in asked if s == scene}), 9, check.key)
                self.assertEqual(len({d for _, s, d, _, _ in asked if s == scene}), 3, check.key)


@unittest.skipIf(numpy is None, "needs numpy")
class Coiling(unittest.TestCase):
    def test_the_frequency_of_a_whirl_is_that_of_its_ellipse(self):
        times = [0.28 + 0.0025 * k for k in range(89)]
        for sense in (1, -1):
            angles = sense * 80 * (numpy.array(times) + 1)
            for one, other, roundness in ((1, 0, 1), (1, 0.5, 0.6), (1, 1, 0)):
                path = one * numpy.exp(1j * angles) + other * numpy.exp(-1j * angles) + 0.3 + numpy.array(times)
                found, round_ = coiling.whirl(times, numpy.stack([path.real, path.imag], axis=1))
                self.assertAlmostEqual(found, 80, delta=0.2)
                self.assertAlmostEqual(round_, roundness, delta=0.01)

    def test_turns_are_counted_in_either_sense(self):
        for sense in (1, -1):
            angles = sense * 0.2 * numpy.arange(200) + 1
            middles = numpy.stack([numpy.cos(angles), numpy.sin(angles)], axis=1)
            self.assertAlmostEqual(coiling.turned(middles)[-1], 0.2 * 199)

    def test_the_pile_ends_where_the_rope_lies(self):
        # A disc of 6 mm height at rest, a coil on it that falls at half the speed, and a straight rope.
        disc = [(x, y, z, 0) for x in range(-20, 21) for y in range(24) for z in range(-20, 21)]
        rope = [(x, y, z, 0.1 if y < 26 else 0.25) for x in range(-4, 5) for y in range(24, 72) for z in range(-4, 5)]
        x, y, z, speed = numpy.array(disc + rope, dtype=float).T
        particles = Particles(0.00025 * numpy.stack([x, y + 0.5, z], axis=1), numpy.stack([0 * x, -speed, 0 * x], axis=1))
        self.assertAlmostEqual(coiling.top_of_pile(particles, 0.00025), 0.0065, places=9)


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
            gravity = scenes.read(path)["world"]["gravity"]
            values = [value for _, value in gravity["keyframes"]] if isinstance(gravity, dict) else [gravity]
            self.assertEqual(len({value[1] for value in values} - {0, -9.8}), 0, path)

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
        self.assertIn(validate.MARKER, (ROOT / "engineering" / "validation.md").read_text(encoding="utf-8"))

    def test_the_documents_are_of_the_solvers_of_the_scenes(self):
        with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()) as said:
            validate.arguments(["--weir", "w", "--solver", "Pbf", "--docs"])
        self.assertIn("--solver cannot be given", said.getvalue())

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
            self.assertIn("--images", lab.run("drop/1", "validation/drop", pictures=True).stats["seen"])
            changed = Lab(stand_in, Path(folder) / "out", "cpu", 2, False, lambda text: None, solver="TwoProjections")
            scene = scenes.read(changed.run("drop/2", "validation/efflux").stats["seen"][1])
            self.assertEqual(scene["nodes"]["water"]["modules"],
                             {"solver": {"type": "TwoProjections"}, "viscosity": {"enabled": False}})
            self.assertEqual(scene["nodes"]["vessel"], scenes.read(SCENES / "validation" / "efflux.json")["nodes"]["vessel"])
            plain = scenes.read(lab.run("drop/3", "validation/efflux", defaults=True).stats["seen"][1])["nodes"]
            self.assertEqual(plain["water"], {"type": "ParticleFluid", "params": {"spacing": 0.01},
                                              "modules": {"viscosity": {"params": {"rate": 0}}}})
            both = scenes.read(changed.run("drop/3", "validation/efflux", defaults=True).stats["seen"][1])["nodes"]
            self.assertEqual(both["water"]["modules"], scene["nodes"]["water"]["modules"])
            undrawn = Lab(stand_in, Path(folder) / "out", "cpu", 2, False, lambda text: None, pictures=False)
            self.assertNotIn("--images", undrawn.run("drop/1", "validation/drop", pictures=True).stats["seen"])

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


    def test_a_run_that_takes_too_long_fails_its_check_and_is_no_result(self):
        with tempfile.TemporaryDirectory() as folder:
            stand_in = Path(folder) / "weir"
            stand_in.write_text("#!/bin/sh\nexec sleep 60\n")
            stand_in.chmod(0o755)
            with Lab(stand_in, Path(folder) / "out", "cpu", 1, False, lambda text: None, limit=0.1) as lab:
                outcome = validate.outcome_of(validate.Check("x", "X", lambda lab: lab.run("drop/1", "validation/drop").series), lab)
            self.assertIs(outcome.rows[0].passed, False)
            self.assertIn("not done after 0.1 s", outcome.rows[0].what)
            self.assertFalse((Path(folder) / "out" / "drop/1" / "command.txt").exists())


class Reports(unittest.TestCase):
    DONE = [(validate.CHECKS[0], Outcome([Row("a", 1.0, "m", 1.1, 0.05), Row("b", 2.0)]), ["a.png"])]

    def results(self, device, *rows):
        done = [(validate.CHECKS[0], Outcome(list(rows)), [])] if rows else self.DONE
        return json.loads(report.as_json(done, "./dev validate", device, 60))

    def test_the_page_counts_what_failed(self):
        page = report.markdown(self.DONE, [self.results("a machine")])
        self.assertIn("on a machine in 1.0 minutes of simulation: 0 demands met, 1 not", page)
        self.assertIn("| a | 1.1 | 1 | m | -9.09 % | within 5 % | **FAIL** |", page)

    def test_the_page_says_when_it_was_made(self):
        text = report.as_json(self.DONE, "./dev validate", "a machine", 60, "2001-02-03, abc")
        self.assertIn("on a machine (2001-02-03, abc) in 1.0 minutes", report.markdown(self.DONE, [json.loads(text)]))

    def test_the_json_holds_the_same(self):
        check = self.results("m")["checks"][0]
        self.assertFalse(check["passed"])
        self.assertEqual([row["passed"] for row in check["rows"]], [False, None])

    def test_devices_stand_side_by_side_by_what_was_measured(self):
        # The other device has its rows in another order, one of them alone, and expects something else.
        other = self.results("a card", Row("c", 5.0), Row("a", 1.21, "m", 1.2, 0.05))
        page = report.markdown(self.DONE, [self.results("a machine"), other])
        self.assertIn("2. Made by `./dev validate` on a card", page)
        self.assertIn("| a | m | within 5 % | 1.1 | 1 | -9.09 % | **FAIL** | 1.2 | 1.21 | +0.83 % | pass |", page)
        self.assertIn("| b |  | – | – | 2 | – | – | – | – | – | – |", page)
        widths = {line.count("|") for line in page.splitlines() if line.startswith("|")}
        self.assertEqual(widths, {12})


class CutOff(unittest.TestCase):
    """Of three stand-ins for checks the third is cut off, until `cut` is empty; `made` counts how often each was made."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder, self.made, self.cut = Path(folder.name), [], {"third"}
        stand_in = self.folder / "weir"
        stand_in.write_text("""#!/bin/sh
while [ "$1" != --stats ]; do shift; done
echo '{"device": {"description": "a machine"}, "wall_seconds": 0.1}' >"$2"
""")
        stand_in.chmod(0o755)

        def check_of(name, value):
            def run(lab):
                """Nothing is compared."""
                self.made.append(name)
                lab.run(name, "validation/drop").stats  # noqa: B018
                if name in self.cut:
                    raise KeyboardInterrupt
                return Outcome([Row("a", value, "m", 1.1, 0.05), Row("b", 1 / 3, below=1)])
            return validate.Check(name, name.capitalize(), run)
        checks = [check_of("first", 1.07), check_of("second", 2.0), check_of("third", 1.1)]
        patch = mock.patch.object(validate, "CHECKS", checks)
        patch.start()
        self.addCleanup(patch.stop)

    def call(self, *more, out="out", commit="c"):
        self.made.clear()
        with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
            return validate.main(["--weir", str(self.folder / "weir"), "--device", "cpu", "--no-plots", "--commit", commit,
                                  "--out", str(self.folder / out), *more])

    def cut_off(self, *more, **options):
        with self.assertRaises(KeyboardInterrupt):
            self.call(*more, **options)

    def texts(self, out):
        """Both files, without the name of the folder."""
        return [(self.folder / out / "quick" / name).read_text(encoding="utf-8").replace(str(self.folder / out), "DIR")
                for name in ("README.md", "results.json")]

    def test_a_call_that_was_cut_off_goes_on_and_writes_what_one_call_does(self):
        self.cut_off()
        self.cut.clear()
        self.assertEqual(self.call("--resume"), 1)
        self.assertEqual(self.made, ["third"])
        self.assertEqual(self.call(out="at_once"), 1)
        self.assertEqual(self.made, ["first", "second", "third"])
        self.assertEqual(self.texts("out"), self.texts("at_once"))

    def test_several_at_a_time_are_kept_as_each_ends(self):
        self.cut_off("--jobs", "3")
        self.cut.clear()
        self.call("--jobs", "3", "--resume")
        self.assertEqual(self.made, ["third"])

    def test_without_being_asked_all_is_made_again(self):
        self.cut_off()
        self.cut.clear()
        self.call()
        self.assertEqual(len(self.made), 3)

    def test_what_another_solver_made_is_made_again(self):
        self.cut_off()
        self.cut.clear()
        self.call("--resume", "--solver", "Pbf")
        self.assertEqual(self.made, ["first", "second", "third"])
        self.call("--resume")
        self.assertEqual(self.made, ["third"])

    def test_what_another_commit_device_or_scale_made_is_made_again(self):
        for more, commit in (((), "d"), (("--device", "cuda"), "c"), (("--scale", "full"), "c")):
            self.cut.add("third")
            self.cut_off()
            self.cut.clear()
            self.call("--resume", *more, commit=commit)
            self.assertEqual(len(self.made), 3, more)

    def test_what_cannot_be_judged_or_may_be_of_another_build_is_not_kept(self):
        self.cut.clear()
        self.call("--limit", "1e-9")  # no run ends
        self.call("--resume")
        self.assertEqual(len(self.made), 3)
        self.call("--reuse", out="reused")
        self.call("--resume", out="reused")
        self.assertEqual(len(self.made), 3)

    def test_files_that_cannot_be_read_do_not_count(self):
        self.cut.clear()
        self.call()
        (self.folder / "out" / "quick" / "checks" / "second.json").write_text('{"key": "second"', encoding="utf-8")
        self.call("--resume")
        self.assertEqual(self.made, ["second"])

    def test_it_is_refused_where_commits_cannot_be_told_apart(self):
        for commit, said_of_it in (("", "not known"), ("abc-changed", "abc-changed")):
            with mock.patch.object(kept, "commit_of", lambda folder, commit=commit: commit), \
                    self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()) as said:
                validate.arguments(["--weir", "w", "--resume"])
            self.assertIn(f"the commit is {said_of_it}", said.getvalue())
        with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()):
            validate.arguments(["--weir", "w", "--commit", "c", "--resume", "--reuse"])

    def test_pictures_and_curves_are_kept(self):
        picture = self.folder / "run" / "frame.png"
        picture.parent.mkdir()
        picture.touch()
        curves = (("closed form", [0.0, 1.0], [math.nan, 1 / 3], "k-"),)
        if numpy:
            curves += (("found", numpy.array([1, 2], dtype=numpy.float32), [numpy.float64(0.1)], "o"),)
        outcome = Outcome([Row("a", math.nan, below=1, note="n")], (Chart("t", "x", "y", curves),), picture)
        kept.Kept(self.folder, "c", "cpu", "quick", drawn=True).write("drop", kept.Result(outcome, 2.5, "m", "2001-02-03"))
        found = kept.Kept(self.folder, "c", "cpu", "quick", drawn=True).read("drop")
        self.assertEqual((found.seconds, found.machine, found.day), (2.5, "m", "2001-02-03"))
        self.assertEqual(found.outcome.picture, picture)
        self.assertTrue(math.isnan(found.outcome.rows[0].measured))
        self.assertEqual(found.outcome.rows[0].note, "n")
        for (label, xs, ys, style), now in zip(curves, found.outcome.charts[0].curves, strict=True):
            self.assertEqual((label, [*map(str, map(float, xs))], [*map(str, map(float, ys))], style),
                             (now[0], [*map(str, now[1])], [*map(str, now[2])], now[3]))
        picture.unlink()
        self.assertIsNone(kept.Kept(self.folder, "c", "cpu", "quick", drawn=True).read("drop"))

    def test_numbers_alone_do_not_do_where_pictures_are_wanted(self):
        result = kept.Result(Outcome([Row("a", 1.0)]), 2.5, "m", "2001-02-03")
        kept.Kept(self.folder, "c", "cpu", "quick", drawn=False).write("drop", result)
        self.assertIsNone(kept.Kept(self.folder, "c", "cpu", "quick", drawn=True).read("drop"))
        self.assertIsNotNone(kept.Kept(self.folder, "c", "cpu", "quick", drawn=False).read("drop"))

    def test_a_commit_is_that_of_the_folder_itself(self):
        self.assertEqual(kept.commit_of(self.folder), "")


class SeveralDevices(unittest.TestCase):
    def test_devices_are_each_named_once(self):
        self.assertEqual(validate.arguments(["--weir", "w", "--device", "cpu, cuda"]).devices, ["cpu", "cuda"])
        for wrong in ("cpu,cpu", "cpu,", ""):
            with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()) as said:
                validate.arguments(["--weir", "w", "--device", wrong])
            self.assertIn(f"--device: {wrong!r} is not allowed", said.getvalue())

    def test_a_page_of_which_nothing_is_drawn_keeps_its_pictures(self):
        with tempfile.TemporaryDirectory() as folder:
            page, images = Path(folder) / "page.md", Path(folder) / "images"
            page.write_text(f"By hand.\n{validate.MARKER}\nold", encoding="utf-8")
            images.mkdir()
            (images / "drop_plot.png").write_bytes(b"as it was")
            check = next(check for check in validate.CHECKS if check.key == "drop")
            with mock.patch.multiple(validate, PAGE=page, IMAGES=images):
                names = validate.pictures_of_page(check)
                results = report.markdown([(check, Outcome([Row("a", 1.0)]), names)],
                                          [json.loads(report.as_json([(check, Outcome([Row("a", 1.0)]), names)], "c", "m", 6))])
                validate.write_docs(results, [(check, None, names)], Path(folder), drawn=False)
            self.assertIn("](images/validation/drop_plot.png)", page.read_text(encoding="utf-8"))
            self.assertNotIn("old", page.read_text(encoding="utf-8"))
            self.assertEqual((images / "drop_plot.png").read_bytes(), b"as it was")

    def test_what_stands_beside_must_be_results(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "results.json"
            for text in ("", "[]", '{"checks": []}'):
                path.write_text(text)
                with self.assertRaises(program.RunFailed) as said:
                    validate.results_of(path)
                self.assertIn("these are not results of ./dev validate", str(said.exception))
            with self.assertRaises(program.RunFailed):
                validate.results_of(Path(folder) / "none.json")

    def test_each_device_is_run_and_a_failure_on_any_is_told(self):
        with tempfile.TemporaryDirectory() as folder:
            stand_in = Path(folder) / "weir"  # the force on the wall is right on one device alone
            stand_in.write_text(
                f"#!{sys.executable}\nimport json, sys\na = sys.argv\ndevice = a[a.index('--device') + 1]\n"
                "json.dump({'device': {'description': 'a ' + device}, 'wall_seconds': 2}, open(a[a.index('--stats') + 1], 'w'))\n"
                "x = 0.0 if device == 'cuda' else 0.01\n"
                "frame = {'time': 1.0, 'nodes': {'water': {'fluid_volume': 1e-3, 'kinetic_energy': x,"
                " 'linear_momentum': [0, 0, 0]}}}\n"
                "open(a[a.index('--series') + 1], 'w').write((json.dumps(frame) + '\\n') * 2)\n")
            stand_in.chmod(0o755)

            def call(*devices):
                with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
                    return validate.main(["--weir", str(stand_in), "--out", folder, "--only", "block_at_rest", "--no-plots",
                                          *devices])

            self.assertEqual(call("--device", "cuda"), 0)
            self.assertEqual(call("--device", "cuda,cpu"), 1)
            page = (Path(folder) / "quick" / "README.md").read_text(encoding="utf-8")
            self.assertIn("2. Made by", page)
            self.assertIn("| below 0.001 | – | 0 | – | pass | – | 0.01 | – | **FAIL** |", page)
            theirs = Path(folder) / "quick" / "cpu" / "results.json"
            self.assertTrue(theirs.exists())
            self.assertEqual(call("--device", "cuda", "--beside", str(theirs)), 0)
            self.assertIn("on a cpu (", (Path(folder) / "quick" / "README.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    unittest.main()
