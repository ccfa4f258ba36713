"""The code blocks of docs/python.md, one after another, as a reader would run them."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import weir

PAGE = Path(__file__).parents[2] / "docs" / "python.md"
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)

# The blocks that need what a machine may lack say so in their first line.
NEEDS = """
import importlib.util, shutil, weir
def missing(what):
    if what == "CUDA":
        return not any(name.startswith("cuda") for name, _ in weir.devices())
    return importlib.util.find_spec(what) is None
"""


def script(folder: Path) -> str:
    lines = [NEEDS]
    for block in BLOCKS:
        first = block.splitlines()[0]
        needs = re.findall(r"\w+", first.removeprefix("# needs ").replace(" and ", " ")) if "# needs" in first else []
        lines.append(f"if not any(map(missing, {needs!r})):\n    exec({block!r})")
    return "\n".join(lines)


def test_every_block_runs(tmp_path):
    assert len(BLOCKS) >= 7
    found = subprocess.run([sys.executable, "-B", "-c", script(tmp_path)], cwd=tmp_path, capture_output=True, text=True,
                           timeout=600, env=os.environ | {"PYTHONPATH": str(Path(weir.__file__).absolute().parents[1])})
    if "ffmpeg" in found.stderr and "OpenGL" in found.stderr:
        pytest.skip("there is no ffmpeg or OpenGL: " + found.stderr.splitlines()[-1])
    assert found.returncode == 0, found.stderr
    assert (tmp_path / "dam.mp4").stat().st_size > 10_000
    assert (tmp_path / "dam.jsonl").stat().st_size > 1000
    assert "found -1 | a number above 0" in found.stdout
