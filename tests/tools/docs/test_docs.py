"""The checker of the documentation must find what is wrong, and say where. Argument: the folder of a build."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools" / "docs"))
import check  # noqa: E402
import commands  # noqa: E402
import documents  # noqa: E402
import measured  # noqa: E402
import prose  # noqa: E402

BUILD = Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else ROOT / "build" / "cpu"


class CheckedPage(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()

    def tearDown(self):
        self.folder.cleanup()

    def check(self, text):
        page = Path(self.folder.name) / "page.md"
        page.write_text(text)
        return check.PageCheck(page, "page.md", BUILD, Path(self.folder.name) / "work").run()

    def expect_mistake(self, text, line, *words):
        found = self.check(text).mistakes
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(f"page.md:{line}: "), found[0])
        for word in words:
            self.assertIn(word, found[0])

    def test_commands_are_run_in_a_folder_that_their_page_keeps(self):
        done = self.check("```sh\necho 3 >number.txt   # a comment\n```\n\n```sh\n[ $(cat number.txt) = 3 ]\nls resources dev\n```\n")
        self.assertEqual(done.mistakes, [])
        self.assertEqual(done.counts["run"], 3)

    def test_a_command_that_fails_is_a_mistake(self):
        self.expect_mistake("# a\n\n```sh\ntrue\nls no_such_file\n```\n", 3, "no_such_file")
        self.expect_mistake("<!-- check: with exit=3 -->\n```sh\ntrue\n```\n", 2, "not 3")
        self.assertEqual(self.check("<!-- check: with exit=3 -->\n```sh\nexit 3\n```\n").mistakes, [])

    def test_words_and_options_of_a_mark_come_into_the_commands(self):
        done = self.check("<!-- check: with SCENE=a.json frames=2 set=x.y=3 -->\n```sh\nprintf 'weir run SCENE' >b; grep -q 'run a.json$' b\n```\n")
        self.assertEqual(done.mistakes, [])
        self.assertEqual(check.with_options("weir run a.json --set b=1 \\\n  --quiet  # c\nls", "--frames 2"),
                         "weir run a.json --set b=1 \\\n  --quiet --frames 2  # c\nls")
        self.expect_mistake("<!-- check: with SCENE=a.json -->\n```sh\ntrue\n```\n", 2, "SCENE")

    def test_what_is_not_run_says_why_and_is_still_looked_up(self):
        done = self.check("<!-- check: skip, it takes long; an hour -->\n```sh\nweir run resources/scenes/dam_break.json --stats a.json\n```\n")
        self.assertEqual((done.mistakes, done.skipped), ([], [(2, "it takes long; an hour")]))
        skip = "<!-- check: skip, long -->\n```sh\n"
        self.expect_mistake(skip + "weir run resources/scenes/dam_break.json --stast a.json\n```\n", 2, "no option --stast")
        self.expect_mistake(skip + "weir run resources/scenes/dam_break.json --set water.spcing=1\n```\n", 2, "spcing")
        self.expect_mistake(skip + "weir run resources/scenes/none.json\n```\n", 2, "no scene")
        self.expect_mistake(skip + "./dev vlidate\n```\n", 2, "vlidate")
        self.expect_mistake(skip + "./dev validate --olny a\n```\n", 2, "--olny")
        self.expect_mistake(skip + "tests/benchmarks/none.sh\n```\n", 2, "none.sh")
        self.expect_mistake(skip + "cmake --preset cup\n```\n", 2, "cup")

    def test_scenes_are_validated(self):
        scene = '{ "weir": 1, "nodes": { "water": { "type": "ParticleFluid", "params": { "%s": 0.1 } } } }'
        self.assertEqual(self.check(f"```json\n{scene % 'spacing'}\n```\n").counts["scenes"], 1)
        self.assertEqual(self.check(f"```jsonc\n{scene % 'spacing'}\n```\n").mistakes, [])
        self.expect_mistake(f"```json\n{scene % 'spacing'}  // text\n```\n", 1, "no JSON")
        self.expect_mistake(f"```json\n{scene % 'spcing'}\n```\n", 1, "spcing")
        self.expect_mistake('```json\n{ "weir": 1, \n```\n', 1, "no JSON")
        self.expect_mistake('```json\n{ "modules": {} }\n```\n', 1, "a mark that says into which scene")
        mark = "<!-- check: into resources/scenes/dam_break.json at nodes.water -->\n"
        self.assertEqual(self.check(mark + '```json\n"params": { "spacing": 0.1 }\n```\n').mistakes, [])
        self.expect_mistake(mark + '```json\n"params": { "spcing": 0.1 }\n```\n', 2, "spcing")

    def test_comments_are_right_where_the_program_reads_them(self):
        scene = '{ "weir": 1, "nodes": { "water": { "type": "ParticleFluid" } } }  // text\n'
        file = Path(self.folder.name) / "scene.json"
        file.write_text(scene)
        refused = subprocess.run([BUILD / "bin" / "weir", "validate", file], capture_output=True, check=False).returncode != 0
        self.assertEqual(bool(self.check(f"```jsonc\n{scene}```\n").mistakes), refused)

    def test_pages_for_users_have_no_commit_hashes(self):
        self.expect_mistake("# a\n\nFaster since 9b5e73a.\n", 3, "commit hash")
        self.assertEqual(self.check("The defaced facade of 1234567 particles in 2026.\n").mistakes, [])

    def test_code_must_stand_in_its_file(self):
        mark = "<!-- check: from framework/graph/plugin_header.h -->\n"
        right = "```cpp\nstruct PluginHeader {\n  int interfaceVersion;\n  …\n  char doc[256];\n```\n"
        self.assertEqual(self.check(mark + right).counts["compared"], 1)
        self.expect_mistake(mark + right.replace("256", "255"), 2, "char doc[255];")
        self.expect_mistake(mark + "```cpp\n  char doc[256];\n  int interfaceVersion;\n```\n", 2, "interfaceVersion")
        self.expect_mistake("```cpp\nint a;\n```\n", 1, "a mark")

    def test_code_that_takes_the_place_of_other_code_does_so(self):
        made = "```sh\nprintf 'int a;\\nint b;\\n' >a.h\n```\n\n<!-- check: from a.h -->\n```cpp\nint b;\n```\n\n"
        edit = "<!-- check: edit a.h -->\n```cpp\nint c;\n```\n\n"
        self.assertEqual(self.check(made + edit + "```sh\ngrep -q 'int c' a.h\n! grep 'int b' a.h\n```\n").mistakes, [])
        self.expect_mistake(edit, 2, "no block before it")

    def test_pieces_of_a_scene_are_put_together(self):
        scene = '<!-- check: file a.json -->\n```json\n{ "weir": 1, "nodes": { "w": { "type": "ParticleFluid" } } }\n```\n\n'
        piece = '<!-- check: into a.json at nodes; file a.json -->\n```json\n"b": { "type": "BoxSampler" }\n```\n\n'
        links = '<!-- check: into a.json; file a.json -->\n```json\n"links": ["b.particles -> w.initial"]\n```\n\n'
        done = self.check(scene + piece + links + "```sh\nweir run a.json --frames 0 --set w.spacing=0.2 --set w.rest_steps=0\n```\n")
        self.assertEqual((done.mistakes, done.counts["scenes"]), ([], 3))
        self.expect_mistake(scene + links, 7, "'b'")

    def test_python_is_run_or_says_what_is_missing(self):
        self.assertEqual(self.check("```python\nimport json\nassert json.loads('1') == 1\n```\n").counts["run"], 1)
        self.expect_mistake("```python\nraise ValueError('odd')\n```\n", 1, "odd")
        self.expect_mistake("```python\nif\n```\n", 1, "no Python")
        self.assertIn("no_such_module", self.check("```python\nimport no_such_module\n```\n").skipped[0][1])

    def test_blocks_marks_paths_and_links_are_looked_at(self):
        self.expect_mistake("```\nls\n```\n", 1, "allowed are")
        self.assertIn("not understood", self.check("<!-- check: sometimes -->\n```sh\nls\n```\n").mistakes[0])
        self.assertIn("does not end", self.check("```sh\nls\n").mistakes[0])
        self.expect_mistake("See `framework/graph/none.h`.\n", 1, "none.h")
        self.expect_mistake("See `weir frob`, or not.\n", 1, "frob")
        self.expect_mistake("See [it](none.md).\n", 1, "none.md")
        self.expect_mistake("# Some `code` here\n\n[a](#some-code-here) [b](#some-code)\n", 3, "some-code ")

    def test_tests_that_pages_name_exist(self):
        if not (BUILD / "bin" / "weir_framework_tests").exists():
            self.skipTest("they are not built")
        self.assertEqual(self.check("`weir_framework_tests --gtest_filter='*Vec*'`\n").mistakes, [])
        self.expect_mistake("`weir_framework_tests --gtest_filter='*NoneIsSo*'`\n", 1, "NoneIsSo")


class Prose(unittest.TestCase):
    def test_words_sentences_and_terms_are_counted_without_code_and_tables(self):
        text = "# Title\n\nOne two. Three `a b c` four!\n\n```sh\nls -l\n```\n\n| a | b |\n|---|---|\n\n- item one\n- item two\n"
        self.assertEqual(prose.prose(text), ["One two. Three `a b c` four!", "- item one", "- item two"])
        self.assertEqual(len(list(prose.sentences(text))), 4)
        self.assertEqual(prose.words("a | b |\n|---|"), 2)
        self.assertEqual(len(prose.long_sentences(" ".join(["word"] * 31) + ". Short one.")), 1)
        self.assertEqual(prose.lacking_terms("A checkpoint of a plugin.", "| checkpoint | a file |"), ["plugin"])

    def test_the_pages_of_the_repository_keep_their_limits(self):
        self.assertEqual(list(check.mistakes_of_all()), [])


class Measured(unittest.TestCase):
    def test_blocks_of_numbers_are_written_between_their_marks(self):
        page = "before\n<!-- measured: validated -->\nold\n<!-- end of measured -->\nafter\n"
        new = measured.filled(page, measured.measured())
        self.assertTrue(new.startswith("before\n<!-- measured: validated -->\n\n| check |"))
        self.assertTrue(new.endswith("|\n\n<!-- end of measured -->\nafter\n"))
        self.assertEqual(measured.filled(new, measured.measured()), new)
        with self.assertRaises(SystemExit):
            measured.filled(page.replace("validated", "none"), [])

    def test_rows_that_are_no_water_say_so(self):
        rows = [{"case": "dam", "particles": "8", "late, batch (ms)": "1", "compression": c, "memory (B a particle)": "9"} for c in ("0.05", "0.24")]
        lines = measured.speed([measured.Device("CPU", "2026-01-01", rows, [])])
        self.assertEqual(["soft" in line for line in lines[2:4]], [False, True])
        self.assertIn("2026-01-01", lines[-1])

    def test_tables_are_read_with_their_headings(self):
        found = list(measured.tables("# A\n\n| a | b |\n|---|--:|\n| 1 | 2 |\n\n## B\n\n| c |\n|---|\n"))
        self.assertEqual(found, [("A", ["a", "b"], [["1", "2"]]), ("B", ["c"], [])])


class Splitting(unittest.TestCase):
    def test_lines_comments_and_continuations(self):
        text = "A=1 weir run 'a b' \\\n  --quiet >out 2>&1 # c\n./dev test && ls; cat b | wc\n"
        self.assertEqual(commands.split(text), [["weir", "run", "a b", "--quiet"], ["./dev", "test"], ["ls"], ["cat", "b"], ["wc"]])

    def test_headings_have_the_anchors_that_sites_give_them(self):
        self.assertEqual(documents.anchor("Steps by number, before `weir bench`"), "steps-by-number-before-weir-bench")


if __name__ == "__main__":
    unittest.main()
