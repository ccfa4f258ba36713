"""A release has one version everywhere, a dated changelog and a tag; or nothing is changed."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]
SCRIPT = SOURCE / "tools" / "packaging" / "make_release.py"
FILES = ["CHANGELOG.md", "CITATION.cff", "CMakeLists.txt", "tools/packaging/conda/recipe.yaml", "apps/studio/web/package.json",
         "apps/studio/web/package-lock.json"]
# Whoever runs the tests may have settings of git of their own.
ENVIRONMENT = dict(os.environ, GIT_CONFIG_GLOBAL=os.devnull, GIT_CONFIG_SYSTEM=os.devnull, GIT_AUTHOR_NAME="a", GIT_AUTHOR_EMAIL="a@b",
                   GIT_COMMITTER_NAME="a", GIT_COMMITTER_EMAIL="a@b")


class Release(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        for file in FILES:
            (self.folder / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(SOURCE / file, self.folder / file)
        changelog = self.folder / "CHANGELOG.md"
        changelog.write_text("# Changelog\n\n## [7.0.0] - unreleased\n\n- Water is wet.\n", encoding="utf-8")
        self.git("init", "--quiet")
        self.git("add", "--all")
        self.git("commit", "--quiet", "-m", "all")

    def git(self, *arguments):
        return subprocess.run(["git", *arguments], cwd=self.folder, env=ENVIRONMENT, check=True, capture_output=True, text=True).stdout

    def release(self, *arguments):
        return subprocess.run([sys.executable, "-B", SCRIPT, *arguments], cwd=self.folder, env=ENVIRONMENT, capture_output=True, text=True)

    def assert_refused(self, version, why):
        before = self.git("rev-parse", "HEAD"), self.git("status", "--porcelain"), self.git("tag")
        made = self.release(version)
        self.assertEqual(made.returncode, 1)
        self.assertIn(why, made.stderr)
        self.assertEqual(before, (self.git("rev-parse", "HEAD"), self.git("status", "--porcelain"), self.git("tag")))

    def test_one_version_stands_everywhere(self):
        made = self.release("7.0.0", "--date", "2031-02-03")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(self.git("status", "--porcelain"), "")
        for file in FILES:
            self.assertIn("7.0.0", (self.folder / file).read_text(encoding="utf-8"), file)
        lock = (self.folder / "apps/studio/web/package-lock.json").read_text(encoding="utf-8")
        self.assertEqual(len(re.findall(r'^ {2}(?: {4})?"version": "7.0.0"', lock, re.MULTILINE)), 2)
        self.assertIn("## [7.0.0] - 2031-02-03\n", (self.folder / "CHANGELOG.md").read_text(encoding="utf-8"))
        self.assertIn("date-released: 2031-02-03\n", (self.folder / "CITATION.cff").read_text(encoding="utf-8"))
        self.assertIn("- Water is wet.", self.git("tag", "--list", "--format=%(contents)", "v7.0.0"))
        self.assertEqual(self.git("rev-parse", "v7.0.0^{commit}"), self.git("rev-parse", "HEAD"))

    def test_what_is_in_the_way_is_told_and_nothing_changes(self):
        self.assert_refused("7.0", "three numbers")
        self.assert_refused("7.0.1", "does not begin with '## [7.0.1] - unreleased'")
        (self.folder / "CITATION.cff").write_text("", encoding="utf-8")
        self.assert_refused("7.0.0", "no part of a commit")
        self.git("checkout", "--quiet", ".")
        self.git("tag", "v7.0.0")
        self.assert_refused("7.0.0", "is not above 7.0.0")


if __name__ == "__main__":
    unittest.main()
