"""The logic of tools/benchmarks and of the comparison with SPlisHSPlasH: rows, tables, fits, and what is refused. No simulation
is run. Called by ctest; needs nothing but Python, and draws where matplotlib is."""

import contextlib
import importlib.util
import io
import json
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools" / "benchmarks"))
sys.path.insert(0, str(ROOT / "tests" / "benchmarks"))

import benchmarks as runner  # noqa: E402  (it finds the others)
import compare_splishsplash as comparison  # noqa: E402
import converged_steps  # noqa: E402
import page  # noqa: E402
import results  # noqa: E402

HAS_NUMPY = importlib.util.find_spec("numpy") is not None
HAS_MATPLOTLIB = importlib.util.find_spec("matplotlib") is not None


def moment(name, particles, ms, **more):
    return {"moment": name, "particles": particles, "step_ms_median": ms, "batch_step_ms_mean": 0.9 * ms,
            "share_of_copy_bandwidth": 0.5, "neighbors_mean": 9.25, "compression_mean": 0.01,
            "modules_ms": {"water": ms, "water/solver": 0.7 * ms, "water/walls": 1e-4 * ms, "tank": 0.3 * ms}} | more


def entry(case, size, ms, **more):
    return {"case": case, "size": size, "memory": {"bytes_per_particle": 160.4},
            "moments": [moment("early", size, 0.5 * ms), moment("late", size, ms)]} | more


def written(entries, device="H100, 79 GiB", back_end="cuda", commit="abc1234"):
    machine = {"device": {"description": device, "back_end": back_end}, "cpu": "a CPU", "system": "Linux", "compiler": "GNU",
               "build_type": "Release", "cuda": "yes", "commit": commit, "date": "2026-01-02T03:04:05Z"}
    return {"weir_bench": 1, "command": "weir bench", "machine": machine, "copy_bytes_per_second": 3e12,
            "results": entries}


DAM = [entry("dam", size, ms) for size, ms in ((4096, 0.04), (135252, 0.1), (2000376, 1.0))]
SWEEPS = [entry("dam-3-sweeps", 135252, 0.2)]


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def file(self, name, content):
        path = self.folder / name
        path.write_text(json.dumps(content), encoding="utf-8")
        return path

    def read(self, content):
        return results.read(self.file("r.json", content))



class ConvergedSteps(Folder):
    def curves(self):
        stiff = written([entry("dam-default", size, ms) for size, ms in ((135_000, 1.0), (540_000, 4.0))])
        stiff["command"] += " --cases dam-default --set water.support_ratio=1.5 --set water.bulk_modulus=1e7"
        files = [self.file("stiff.json", stiff), self.file("defaults.json", written([entry("dam-default", 4096, 0.5)])),
                 self.file("three.json", written([entry("dam-packing", 4096, 0.1), entry("dam", 4096, 9)]))]
        return converged_steps.curves_of(files)

    def test_a_curve_for_each_solver_and_support(self):
        self.assertEqual(set(self.curves()), {("H100", "to 0.1 %", "1.5"), ("H100", "to 0.1 %", "2"),
                                              ("H100", "three iterations", "1.2")})

    def test_table_and_exponents_are_of_batches(self):
        self.assertIn("| H100 | to 0.1 % | 1.5 | 540,000 | 1.8 | 3.6 | 1 % |", converged_steps.table(self.curves()))
        self.assertEqual(list(converged_steps.exponents(self.curves(), "late")),
                         ["H100, to 0.1 %, 1.5 d, late: particles^1.00 from 135,000 on"])

    @unittest.skipUnless(HAS_MATPLOTLIB, "there is no matplotlib")
    def test_the_plot_is_drawn(self):
        converged_steps.draw(self.curves(), self.folder / "plot.png")
        self.assertGreater((self.folder / "plot.png").stat().st_size, 1000)


class Fits(unittest.TestCase):
    def test_the_exponent_of_a_power_law_is_found(self):
        for power in (0.9, 1.0, 1.1):
            series = [(n, 3e-4 * n ** power) for n in (2e5, 1e6, 5e6, 2.5e7)]
            self.assertAlmostEqual(results.exponent([(4096, 55.0), *series]), power)

    def test_one_size_has_no_exponent(self):
        self.assertIsNone(results.exponent([(4096, 1.0), (200_000, 2.0)]))


class Reading(Folder):
    def test_rows_know_their_times(self):
        read = self.read(written(DAM))
        self.assertEqual(read.series("dam", "late"), [(4096, 0.04), (135252, 0.1), (2000376, 1.0)])
        self.assertEqual(read.rows[1].ms("early"), 0.05)
        self.assertEqual(read.key, "h100_79_gib")

    def test_what_diverged_has_no_time_in_any_table(self):
        bad = {"moment": "late", "particles": 4096, "diverged": "5 particles left the domain"}
        read = self.read(written([entry("dam", 4096, 9.0, moments=[moment("early", 4096, 7.5), bad])]))
        self.assertIsNone(read.rows[0].ms("late"))
        self.assertEqual(read.series("dam", "late"), [])
        line = page.case_table(read)[2]
        self.assertIn("7.50 | diverged (late): 5 particles left the domain", line)

    def test_what_was_skipped_says_why(self):
        read = self.read(written([{"case": "dam", "size": 99897344, "skipped": "it needs 33 GiB"}]))
        self.assertIn("| dam | 99,897,344 | it needs 33 GiB |", page.case_table(read)[2])

    def test_other_files_are_refused(self):
        for content in ({"weir": 1}, [], {"weir_bench": 2}):
            with self.assertRaisesRegex(results.Unusable, "not a file that weir bench"):
                self.read(content)
        with self.assertRaises(results.Unusable):
            results.read(self.folder / "missing.json")

    def test_files_of_one_device_are_put_together(self):
        first, second = self.read(written(DAM)), self.read(written(SWEEPS + [entry("dam", 4096, 0.03)]))
        merged, = results.merged([first, second])
        self.assertEqual(len(merged.rows), 4)
        self.assertEqual(merged.series("dam", "late")[0], (4096, 0.03))
        self.assertEqual(merged.command, "weir bench")
        other = self.read(written(DAM, device="CPU", back_end="cpu"))
        self.assertEqual(len(results.merged([first, other])), 2)

    def test_several_commits_are_not_mixed(self):
        with self.assertRaisesRegex(results.Unusable, "several commits, abc1234, def5678"):
            results.merged([self.read(written(DAM)), self.read(written(SWEEPS, commit="def5678"))])


class Pages(Folder):
    def test_the_tables_hold_the_numbers(self):
        text = page.markdown([self.read(written(DAM + SWEEPS))], runner.read_peers(), "steps.png")
        self.assertIn("| dam | 2,000,376 | 0.500 | 1.00 | 0.900 | 0.5 | 160 | 0.50 | 9.2 | 0.01 |", text)
        self.assertIn("commit abc1234, 2026-01-02. A copy reads and writes 3000 GB/s.", text)
        # ln(10)/ln(2000376/135252) = 0.855
        self.assertIn("From 135,252 to 2,000,376 particles, the time of `dam`, late, grows like the 0.855th power", text)
        self.assertIn("| particles | solver |\n", text)  # walls take too little
        # PeriDyNo's 1.42 ms over 0.2 ms.
        self.assertIn("| 135,252 | 0.100, 0.200 | 0.780, 1.42 | 0.083, 0.128 | – | – | 7.1 |", text)

    def test_batches_grow_with_a_power_of_their_own(self):
        rows = [entry("dam", size, 1.0) for size in (200_000, 2_000_000, 2_000_000_000)]
        for row, batch in zip(rows, (0.1, 1.0, 100.0)):
            row["moments"][1]["batch_step_ms_mean"] = batch
        text = page.markdown([self.read(written(rows))], runner.read_peers(), None)
        # In powers of ten: times 0, 1, 3 at sizes 0, 1, 4. The best line rises by 57/78, the one through the ends by 3/4.
        self.assertIn("0.000th power of their number; in batches like the 0.731th, and the 0.750th by the first and the last", text)

    def test_a_cpu_is_not_compared_with_a_gpu(self):
        text = page.markdown([self.read(written(SWEEPS, back_end="cpu"))], runner.read_peers(), None)
        self.assertNotIn("times faster", text)
        self.assertNotIn("![", text)

    def test_every_peer_says_where_its_times_are_from(self):
        for peer in runner.read_peers():
            self.assertGreater(len(peer["source"]), 40)
            self.assertEqual(len(peer["particles"]), len(peer["early_ms"]))
            self.assertEqual(len(peer["particles"]), len(peer["late_ms"]))


class Runner(Folder):
    def options(self, *more):
        return ["--weir", str(self.folder / "weir"), "--out", str(self.folder / "out"), *map(str, more)]

    def stand_in(self, code=0):
        content = json.dumps(written(DAM))
        (self.folder / "weir").write_text(
            f"#!{sys.executable}\nimport sys\na = sys.argv\nopen(a[a.index('--json') + 1], 'w').write({content!r})\n"
            f"open({str(self.folder / 'seen')!r}, 'w').write(' '.join(a[1:]))\nsys.exit({code})\n", encoding="utf-8")
        (self.folder / "weir").chmod(0o755)

    def docs(self):
        docs = self.folder / "docs"
        docs.mkdir()
        (docs / "benchmarks.md").write_text("# Before\n\n" + runner.MARKER + "\n\nold\n", encoding="utf-8")
        return docs

    def call(self, *more, docs=None):
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            return runner.main(self.options(*more), docs or self.folder)

    def test_it_runs_the_program_and_writes_a_page(self):
        self.stand_in()
        self.assertEqual(self.call("--no-plots", "--device", "cpu", "--quick"), 0)
        self.assertIn("bench --device cpu --quick --json", (self.folder / "seen").read_text())
        self.assertIn("| dam | 4,096 |", (self.folder / "out" / "README.md").read_text())

    def test_a_program_that_writes_nothing_ends_it(self):
        (self.folder / "weir").write_text("#!/bin/sh\nexit 2\n", encoding="utf-8")
        (self.folder / "weir").chmod(0o755)
        with self.assertRaises(SystemExit) as end:
            self.call("--no-plots")
        self.assertEqual(end.exception.code, 2)

    @unittest.skipUnless(HAS_MATPLOTLIB, "needs matplotlib")
    def test_the_documents_keep_results_of_all_devices(self):
        docs = self.docs()
        gpu = self.file("gpu.json", written(DAM))
        cpu = self.file("cpu.json", written(DAM, device="CPU, 4 threads", back_end="cpu"))
        self.call("--from", cpu, "--docs", docs=docs)
        self.call("--from", gpu, "--docs", docs=docs)
        text = (docs / "benchmarks.md").read_text(encoding="utf-8")
        self.assertTrue(text.startswith("# Before\n\n" + runner.MARKER))
        self.assertNotIn("old", text)
        self.assertLess(text.index("### H100"), text.index("### CPU"))  # GPUs first
        self.assertIn("](images/benchmarks/steps.png)", text)
        self.assertGreater((docs / "images" / "benchmarks" / "steps.png").stat().st_size, 5000)
        # A new run of one device takes the place of that device's results alone.
        self.call("--from", self.file("gpu.json", written(SWEEPS, commit="def5678")), "--docs", docs=docs)
        text = (docs / "benchmarks.md").read_text(encoding="utf-8")
        self.assertIn("commit def5678", text)
        self.assertIn("### CPU", text)
        self.assertEqual(text.count("### H100"), 1)

    def test_rows_that_are_no_water_are_named(self):
        deep = entry("dam", 22986960, 8.0)
        deep["moments"][1]["compression_mean"] = 0.24
        text = page.markdown([results.read(self.file("deep.json", written([*DAM, deep])))], [], None)
        self.assertIn("capacity and not water: 22,986,960 (dam).", text)
        self.assertNotIn("capacity", page.markdown([results.read(self.file("dam.json", written(DAM)))], [], None))

    @unittest.skipUnless(HAS_MATPLOTLIB, "needs matplotlib")
    def test_a_run_that_broke_off_leaves_the_documents(self):
        docs = self.docs()
        self.stand_in(code=130)
        self.assertEqual(self.call("--docs", docs=docs), 130)
        self.assertIn("old", (docs / "benchmarks.md").read_text(encoding="utf-8"))

    def test_what_cannot_be_together_is_refused(self):
        for more, part in ((("--from", "a.json", "--quick"), "nothing is run"), (("--docs", "--quick"), "--quick"),
                           (("--json", "x.json"), "results.json"), (("--docs", "--no-plots"), "has a plot")):
            with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()) as said:
                runner.arguments(self.options(*more))
            self.assertIn(part, said.getvalue())

    def test_the_page_of_this_project_has_the_marker(self):
        self.assertIn(runner.MARKER, (ROOT / "engineering" / "benchmarks.md").read_text(encoding="utf-8"))


def compared(name, ms, compression):
    return {"program": "p", "method": name, "moments": {"late": {"step_ms_median": ms, "compression_mean": compression}}}


class Comparison(Folder):
    def test_verdicts_are_ratios_of_late_steps(self):
        rows = comparison.verdicts([("PBF", compared("3 iterations", 10.0, 0.01), compared("PBF", 99.0, 0.02)),
                                    ("DFSPH", compared("3 iterations", 10.0, 0.01), compared("DFSPH", 51.0, 0.001))])
        self.assertEqual([row["met"] for row in rows], [False, True])
        self.assertAlmostEqual(rows[0]["times_faster"], 9.9)
        table = "\n".join(comparison.verdict_table(rows))
        self.assertIn("| PBF | 3 iterations | 10.000 | 99.000 | 0.01 | 0.02 | 9.9 | 10 | **not met** |", table)

    def test_weir_is_made_stiff_enough_for_the_others_compression(self):
        settings = dict(text.split("=") for text in comparison.as_incompressible_as(1e-4))
        # The pressure below a column of 0.81 m compresses it by that.
        self.assertAlmostEqual(1000 * 9.8 * 0.81 / float(settings["water.bulk_modulus"]), 1e-4, delta=1e-6)
        self.assertEqual(float(settings["water.solver.tolerance"]), 1e-4)
        softest = dict(text.split("=") for text in comparison.as_incompressible_as(0.5))
        self.assertEqual(float(softest["water.bulk_modulus"]), 1e6)

    def test_without_the_package_it_says_how_to_install_it(self):
        bare = self.folder / "python"
        bare.write_text("#!/bin/sh\necho \"ModuleNotFoundError: No module named 'pysplishsplash'\" >&2\nexit 1\n",
                        encoding="utf-8")
        bare.chmod(0o755)
        with self.assertRaisesRegex(comparison.Failed, "No module named 'pysplishsplash'.*\n.*pip install pysplishsplash=="):
            comparison.environment_for(str(bare))
        with self.assertRaisesRegex(comparison.Failed, "cannot be run"):
            comparison.environment_for(str(self.folder / "missing"))

    def test_where_opengl_libraries_meet_the_systems_is_loaded_first(self):
        picky = self.folder / "python"
        picky.write_text("#!/bin/sh\n[ \"$LD_PRELOAD\" = libGLX.so.0 ] || kill -SEGV $$\n", encoding="utf-8")
        picky.chmod(0o755)
        with contextlib.redirect_stderr(io.StringIO()):
            self.assertEqual(comparison.environment_for(str(picky)), {"LD_PRELOAD": "libGLX.so.0"})


@unittest.skipUnless(HAS_NUMPY, "the model is fitted by numpy")
class RanksModel(unittest.TestCase):
    def setUp(self):
        import ranks_model
        self.model = ranks_model

    def test_halos_have_a_layer_of_each_neighbour(self):
        self.assertEqual(self.model.halo_of_slabs(1e6, 1), 0)
        self.assertAlmostEqual(self.model.halo_of_slabs(1e6, 2), 12e3)
        self.assertAlmostEqual(self.model.halo_of_slabs(1e6, 8), 24e3)
        self.assertAlmostEqual(self.model.halo_of_blocks(8e6, 8), 72e3)

    def test_the_fit_finds_the_numbers_that_made_the_times(self):
        made = [0.2, 0.3, 2.5, 0.4]
        points = [(particles, ranks, float(self.model.terms(particles, ranks) @ made))
                  for particles in (10**5, 10**6, 10**7) for ranks in (1, 2, 3, 4)]
        for found, meant in zip(self.model.fitted(points), made):
            self.assertAlmostEqual(found, meant, places=6)

    def test_it_is_within_three_per_cent_of_what_was_measured(self):
        points = self.model.read(self.model.DATA)
        model = self.model.fitted(points)
        for particles, ranks, ms in points:
            self.assertLess(abs(self.model.terms(particles, ranks) @ model / ms - 1), 0.03)


if __name__ == "__main__":
    unittest.main()
