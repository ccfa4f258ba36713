"""What Clang warns of, and names that are not as CONTRIBUTING.md has them, must be found."""

import contextlib
import io
import json
import shutil
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools" / "style"))
import check_clang  # noqa: E402
import check_names  # noqa: E402

COMPILER = shutil.which("clang++-16") or "c++"
CLANG_TIDY = "clang-tidy-16"


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name).resolve()
        self.entries = []

    def add(self, name, text):
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        if name.endswith(".cpp"):
            command = f"c++ -std=c++20 -Wall -Wextra -include no_such_header.h -Winvalid-pch -o {name}.o -c {file}"
            self.entries.append({"directory": str(self.folder), "file": str(file), "command": command})
        (self.folder / "compile_commands.json").write_text(json.dumps(self.entries))

    def run_main(self, module, *arguments):
        printed = io.StringIO()
        with mock.patch.object(sys, "argv", ["check", str(self.folder), *arguments]), contextlib.redirect_stdout(printed):
            code = module.main()
        return code, printed.getvalue()


class ClangTest(Folder):
    def setUp(self):
        super().setUp()
        self.add("good.cpp", "int good() { return 1; }\n")

    def test_sources_without_warnings_pass(self):
        self.assertEqual(self.run_main(check_clang, COMPILER), (0, "1 sources read, 0 with warnings\n"))

    def test_a_warning_fails_and_is_told_with_its_file(self):
        self.add("bad.cpp", "int bad() { int never = 1; return 2; }\n")
        code, text = self.run_main(check_clang, COMPILER)
        self.assertEqual(code, 1)
        self.assertIn("bad.cpp", text)
        self.assertIn("never", text)
        self.assertIn("2 sources read, 1 with warnings", text)

    def test_what_other_targets_compile_is_left_out(self):
        self.add("bad.cpp", "int bad() { int never = 1; return 2; }\n")
        bad = self.folder / "bad.cpp"
        (self.folder / "build.ninja").write_text(f"rule cxx\n  command = false\nbuild bad.o: cxx {bad}\nbuild tests: phony bad.o\n")
        code, text = self.run_main(check_clang, COMPILER, "--compiled", str(self.folder), "tests")
        self.assertEqual((code, text), (0, "1 sources read, 0 with warnings\n"))

    def test_an_unknown_target_is_an_error(self):
        (self.folder / "build.ninja").write_text("build tests: phony\n")
        with self.assertRaisesRegex(SystemExit, "no_tests"):
            self.run_main(check_clang, COMPILER, "--compiled", str(self.folder), "no_tests")

    def test_so_are_parts_of_paths_that_are_named(self):
        self.add("tests/bad.cpp", "int bad() { int never = 1; return 2; }\n")
        self.assertEqual(self.run_main(check_clang, COMPILER, "--but", "/tests/"), (0, "1 sources read, 0 with warnings\n"))

    def test_nothing_to_read_is_a_failure(self):
        self.assertEqual(self.run_main(check_clang, COMPILER, "no_such_part")[0], 1)


@unittest.skipUnless(shutil.which(CLANG_TIDY), f"there is no {CLANG_TIDY}: ./dev setup-gate")
class NamesTest(Folder):
    def check(self, header):
        shutil.copy(ROOT / ".clang-tidy", self.folder)
        self.add("room/source.cpp", "")
        self.add("room/header.h", header)
        with mock.patch.object(check_names, "ROOT", self.folder), mock.patch.object(check_names, "ROOMS", ("room",)):
            return self.run_main(check_names, CLANG_TIDY)

    def test_names_by_the_rules_pass(self):
        text = "#pragma once\nclass GoodName {\n public:\n  int goodName() const { return member_; }\n\n private:\n  int member_ = 0;\n};\n"
        self.assertEqual(self.check(text), (0, "1 headers read, in 1 groups\n"))

    def test_protected_members_are_like_private_ones_or_plain(self):
        self.assertEqual(self.check("#pragma once\nclass A {\n protected:\n  int likePrivate_ = 0;\n  int plainOne = 0;\n};\n")[0], 0)
        self.assertEqual(self.check("#pragma once\nclass A {\n protected:\n  int not_so_ = 0;\n};\n")[0], 1)

    def test_a_name_against_the_rules_fails_and_is_told(self):
        code, text = self.check("#pragma once\nstruct bad_name {};\n")
        self.assertEqual(code, 1)
        self.assertIn("invalid case style for struct 'bad_name'", text)


if __name__ == "__main__":
    unittest.main()
