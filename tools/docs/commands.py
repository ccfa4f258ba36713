"""Says what is wrong with a command line without running it: a command, an option, a file or a test that does not exist."""

import re
import shlex
import subprocess
from functools import lru_cache
from pathlib import Path

from documents import Mistake

SCRIPTS_OF_DEV = {"validate": "tools/validation/validate.py", "paper": "tools/paper/paper.py",
                  "bench": "tools/benchmarks/benchmarks.py", "check-docs": "tools/docs/check.py"}
SHELL_MARKS = {"&&", "||", ";", "|", "&"}


def split(text):
    """The simple commands of a script, as lists of words; comments and continued lines are understood."""
    found = []
    for line in text.replace("\\\n", " ").split("\n"):
        lexer = shlex.shlex(re.sub(r"\d?>&\d", "", line), posix=True, punctuation_chars="&|;")
        lexer.whitespace_split = True
        try:
            tokens = list(lexer)
        except ValueError as error:
            raise Mistake(f"the command '{line.strip()}' is not understood: {error}") from None
        words = []
        for token in [*tokens, ";"]:
            if token not in SHELL_MARKS:
                words.append(token)
                continue
            if words := without_surroundings(words):
                found.append(words)
            words = []
    return found


def without_surroundings(words):
    """Without variables set before it and redirections behind it."""
    i = 0
    while i < len(words) and re.match(r"^[A-Z_]+=", words[i]):
        i += 1
    return [w for w in words[i:] if not re.match(r"^\d?[<>]", w)]


class Checker:
    """Knows the program, the tests and the scripts of one build."""

    def __init__(self, root, build):
        self.root, self.bin = Path(root), Path(build) / "bin"

    @lru_cache(maxsize=None)
    def output(self, *command, where=None):
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=where or self.root, timeout=120)
        return done.returncode, done.stdout + done.stderr

    def check(self, words, where):
        """Throws a Mistake. `where` is the folder that files are relative to."""
        name = words[0]
        plain = name.rsplit("/", 1)[-1]
        if plain == "weir":
            self.check_weir(words[1:], where)
        elif re.fullmatch(r"weir_\w+_tests", plain):
            self.check_tests(plain, words[1:])
        elif name == "./dev":
            self.check_dev(words[1:])
        elif name.startswith(("tests/", "tools/", "examples/")):
            self.check_script(name, words[1:])
        elif name == "cmake" and "--preset" in words:
            self.check_preset(words[words.index("--preset") + 1])

    def check_weir(self, words, where):
        if not words or words[0].startswith("-"):
            return
        code, text = self.output(str(self.bin / "weir"), words[0], "--help")
        if code != 0:
            raise Mistake(f"there is no command 'weir {words[0]}'")
        self.check_options(f"weir {words[0]}", words[1:], text)
        if words[0] == "run" and len(words) > 1:
            self.check_scene(words, where)

    def check_options(self, command, words, text):
        known = set(re.findall(r"--?[a-zA-Z][\w-]*", text)) | {"--help"}
        for word in words:
            option = word.split("=")[0]
            if re.match(r"^--?[a-zA-Z]", word) and option not in known:
                raise Mistake(f"'{command}' has no option {option}")

    def check_scene(self, words, where):
        """The scene and the parameters that are set, as `weir validate` sees them."""
        scene = next((w for w in words[1:] if w.endswith(".json")), None)
        if scene is None or not (Path(where) / scene).exists():
            if scene is not None and scene.startswith("resources/"):
                raise Mistake(f"there is no scene {scene}")
            return
        chosen = [str(self.bin / "weir"), "validate", str(Path(where) / scene)]
        for option, value in zip(words, words[1:]):
            if option in ("--set", "--plugin") and "…" not in value:
                chosen += [option, value]
        code, text = self.output(*chosen, where=where)
        if code != 0:
            raise Mistake(f"the scene does not fit: {text.strip()}")

    def check_tests(self, program, words):
        file = self.bin / program
        if not file.exists():
            raise Mistake(f"there is no {program} in {self.bin}: build it first")
        code, text = self.output(str(file), "--gtest_list_tests", *words)
        if code != 0 or not re.search(r"^  \S", text, re.MULTILINE):
            raise Mistake(f"{program} has no test for {' '.join(words)}")

    def check_dev(self, words):
        _, usage = self.output("./dev", "help")
        if words and not re.search(rf"^  {re.escape(words[0])}\b", usage, re.MULTILINE):
            raise Mistake(f"there is no command './dev {words[0]}'")
        if words and words[0] in SCRIPTS_OF_DEV:
            self.check_script(SCRIPTS_OF_DEV[words[0]], words[1:])

    def check_script(self, name, words):
        file = self.root / name
        if not file.exists():
            raise Mistake(f"there is no {name}")
        if file.suffix == ".py":
            code, text = self.output("/usr/bin/python3", "-B", str(file), "--help")
            if code != 0:
                raise Mistake(f"{name} --help ended with {code}: {text.strip()}")
            self.check_options(name, words, text)

    def check_preset(self, preset):
        code, text = self.output("cmake", "--list-presets=all")
        if code != 0 or f'"{preset}"' not in text:
            raise Mistake(f"there is no preset {preset}")
