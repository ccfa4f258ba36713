"""What pyproject.toml asks CMake for is there, and sources can use the headers that are compiled beforehand."""

import json
import platform
import shlex
import subprocess
import tempfile
import tomllib
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]


def defines():
    """The options of CMake; those that the environment may change by their defaults."""
    asked = tomllib.loads((SOURCE / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["scikit-build"]["cmake"]["define"]
    values = {name: value["default"] if isinstance(value, dict) else value for name, value in asked.items()}
    # The extension needs nanobind, which this Python may not have.
    return [f"-D{name}={value}" for name, value in (values | {"WEIR_PYTHON": "OFF"}).items()]


class PipBuild(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.build = Path(folder.name).resolve()
        command = ["cmake", "-S", SOURCE, "-B", cls.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DWEIR_CUDA=OFF", *defines()]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        cls.said = done.stderr
        cls.commands = {entry["file"]: entry["command"] for entry in json.loads((cls.build / "compile_commands.json").read_text())}

    def compile(self, file):
        command = [*shlex.split(self.commands[file]), "-Werror=invalid-pch"]
        Path(self.build, command[command.index("-o") + 1]).parent.mkdir(parents=True, exist_ok=True)
        done = subprocess.run(command, cwd=self.build, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_all_options_are_known(self):
        self.assertNotIn("not used by the project", self.said)

    def test_all_sources_of_libraries_read_headers_that_are_compiled_beforehand(self):
        without = [file for file, command in self.commands.items() if "/cmake_pch.hxx " not in command and "/apps/weir/" not in file]
        self.assertEqual(without, [])

    @unittest.skipUnless(platform.machine() == "x86_64", "other processors have kernels of one kind")
    def test_kernels_can_use_those_for_their_instruction_set(self):
        kernels = [file for file in self.commands if "/isa/" in file]
        if not kernels:
            self.skipTest("this processor has no AVX2, or the compiler keeps no kernels apart")
        headers = shlex.split(self.commands[kernels[0]])
        headers = headers[headers.index("-include") + 1]
        self.compile(f"{headers}.cxx")
        self.assertTrue(Path(f"{headers}.gch").is_file())
        self.compile(next(file for file in kernels if file.endswith("sphere_kernels.dual.cpp")))


if __name__ == "__main__":
    unittest.main()
