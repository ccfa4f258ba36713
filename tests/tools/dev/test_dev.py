"""What ./dev says without doing anything. Nothing is installed or built: what would do so stands in PATH as a program that
leaves a file behind. Called by ctest."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
DOES_SOMETHING = ("apt-get", "apt-cache", "dpkg-query", "sudo", "cmake", "ctest", "pip", "doxygen", "clang-format-14", "rm", "mkdir")


class Dev(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.called = Path(folder.name) / "called"
        for name in DOES_SOMETHING:
            stand_in = Path(folder.name) / name
            stand_in.write_text(f"#!/bin/sh\necho {name} >>'{self.called}'\nexit 1\n")
            stand_in.chmod(0o755)
        self.environment = {**os.environ, "PATH": f"{folder.name}:{os.environ['PATH']}"}

    def dev(self, *words):
        done = subprocess.run([str(ROOT / "dev"), *words], capture_output=True, text=True, check=False, env=self.environment)
        self.assertFalse(self.called.exists(), f"{words} does something: {done.stderr}")
        return done

    def commands(self):
        return re.findall(r"^  ([a-z][a-z-]*)", self.dev("help").stdout, re.MULTILINE)

    def test_help_of_each_command_comes_before_anything_is_done(self):
        commands = self.commands()
        self.assertIn("validate", commands)
        self.assertIn("clean", commands)
        for command in commands:
            for words in ((command, "--help"), (command, "cpu", "-h"), ("help", command)):
                done = self.dev(*words)
                self.assertEqual(done.returncode, 0, (words, done.stderr))
                self.assertIn(command, done.stdout)
                self.assertNotIn("this text" if command != "help" else "demo", done.stdout)  # of this command alone

    def test_options_of_scripts_are_told(self):
        for command, option in (("validate", "--resume"), ("bench", "--docs"), ("paper", "--no-plots"), ("check-docs", "--only"),
                                ("release", "--date")):
            self.assertIn(option, self.dev(command, "--help").stdout)

    def test_words_that_would_be_ignored_are_refused(self):
        for words in (("demo", "cuda"), ("build", "cpu", "cuda"), ("clean", "build"), ("check-format", "--fix")):
            done = self.dev(*words)
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"'{words[0]}' takes at most", done.stderr)

    def test_unknown_commands_are_refused(self):
        for words in (("biuld",), ("biuld", "--help"), ("biuld", "cpu"), ("help", "biuld")):
            done = self.dev(*words)
            self.assertEqual(done.returncode, 1)
            self.assertIn("there is no command 'biuld'", done.stderr)


if __name__ == "__main__":
    unittest.main()
