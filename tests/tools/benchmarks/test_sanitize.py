"""What sanitize.py says of programs that stand for the tests and for compute-sanitizer."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks/sanitize.py"

# Tests as GoogleTest prints them. The sanitizer's name for itself is in the environment of what it runs.
TESTS = r'''#!/usr/bin/env python3
import os, sys, time
under = "SANITIZER" in os.environ
chosen = next((a.split("=", 1)[1].split(":") for a in sys.argv if a.startswith("--gtest_filter=")), None)
for name in ["A.Good", "A.Skipped", "A.Reads", "A.Fails/0", "A.Hangs", "A.Crashes", "B.AfterTheCrash"]:
    if chosen and name not in chosen:
        continue
    print(f"[ RUN      ] {name}", flush=True)
    result, more = "      OK", ""
    if name == "A.Skipped":
        result = " SKIPPED"
    if under and name == "A.Reads":
        print("========= Invalid __global__ read of size 4 bytes\n=========     at kernel", flush=True)
    if under and name == "A.Fails/0":
        result, more = " FAILED ", ", where GetParam() = 1"
    if under and name == "A.Hangs":
        time.sleep(600)
    if under and name == "A.Crashes":
        os.abort()
    print(f"[ {result} ] {name}{more} (1 ms)", flush=True)
'''
WITHOUT_WAIT = TESTS.replace('"A.Hangs", ', "")
SANITIZER = r'''#!/usr/bin/env python3
import os, subprocess, sys
print("========= COMPUTE-SANITIZER", flush=True)
command = sys.argv[1:]
while command[0].startswith("--"):
    command = command[2:]
subprocess.run(command, env=dict(os.environ, SANITIZER="1"))
print(f"========= ERROR SUMMARY: {int('A.Reads' in command[-1])} errors")
'''


class Sanitize(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for name, text in [("bin/weir_nodes_tests", TESTS), ("sanitizer", SANITIZER)]:
            file = self.folder / name
            file.parent.mkdir(exist_ok=True)
            file.write_text(text)
            file.chmod(0o755)

    def run_script(self, *options):
        return subprocess.run([sys.executable, SCRIPT, self.folder / "bin", self.folder / "results.json", "--tools", "memcheck", "--limit", "5",
                               "--jobs", "2", "--sanitizer", self.folder / "sanitizer", *options], capture_output=True, text=True)

    def verdicts(self):
        tests = json.loads((self.folder / "results.json").read_text())["tests"]["memcheck"]["weir_nodes_tests"]
        return {name: entry["verdict"] for name, entry in tests.items()}

    def test_every_test_gets_its_own_verdict(self):
        run = self.run_script()
        self.assertEqual(run.returncode, 1, run.stderr)
        self.assertEqual(self.verdicts(), {"A.Good": "clean", "A.Skipped": "skipped", "A.Reads": "reported", "A.Fails/0": "failed",
                                           "A.Hangs": "cut off", "A.Crashes": "failed", "B.AfterTheCrash": "clean"})
        self.assertIn("Invalid __global__ read", run.stdout)
        self.assertIn("| memcheck, `weir_nodes_tests` | 2 | 1 | 1 | 2 | 1 | 0 |", run.stdout)

    def test_goes_on_where_it_was_and_not_with_another_build(self):
        (self.folder / "bin/weir_nodes_tests").write_text(WITHOUT_WAIT)
        self.assertEqual(self.run_script("--seconds", "0").returncode, 0)
        self.assertEqual(set(self.verdicts().values()), {"not reached"})
        self.run_script()
        self.assertEqual(self.verdicts()["A.Good"], "clean")
        (self.folder / "bin/weir_nodes_tests").write_text(WITHOUT_WAIT + "\n")
        run = self.run_script()
        self.assertEqual(run.returncode, 1)
        self.assertIn("results of another build", run.stderr)


if __name__ == "__main__":
    unittest.main()
