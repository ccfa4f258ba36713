"""The notebooks of examples/notebooks: their code cells run one after another in a Python of their own, as Jupyter runs them
from top to bottom. Jupyter itself is not needed; what only it can do, such as magics, is refused."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import weir

FOLDER = Path(__file__).parents[2] / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
LARGEST = 200_000  # bytes, pictures in texts among them


def read(path: Path) -> dict:
    return json.loads(path.read_text(encoding="utf-8"))


def code_of(notebook: dict) -> list[str]:
    return ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]


def script(cells: list[str]) -> str:
    """Each cell keeps its name in tracebacks; a figure that is shown is drawn, into nothing."""
    lines = ["import matplotlib", "matplotlib.use('Agg')", "import matplotlib.pyplot",
             "matplotlib.pyplot.show = lambda: (matplotlib.pyplot.gcf().canvas.draw(), matplotlib.pyplot.close('all'))"]
    lines += [f"exec(compile({cell!r}, 'cell {i}', 'exec'))" for i, cell in enumerate(cells, 1)]
    return "\n".join(lines)


def test_there_are_four():
    assert len(NOTEBOOKS) >= 4


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_is_committed_without_outputs(path):
    notebook = read(path)
    assert notebook["nbformat"] == 4 and path.stat().st_size < LARGEST
    for cell in notebook["cells"]:
        assert cell["cell_type"] in ("code", "markdown")
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None
    for cell in code_of(notebook):
        assert not any(line.lstrip().startswith(("%", "!")) for line in cell.splitlines()), "magics run in Jupyter alone"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_runs(path, tmp_path):
    pytest.importorskip("matplotlib")
    found = subprocess.run([sys.executable, "-B", "-c", script(code_of(read(path)))], cwd=tmp_path, capture_output=True,
                           text=True, timeout=600,
                           env=os.environ | {"PYTHONPATH": str(Path(weir.__file__).absolute().parents[1])})
    if found.returncode != 0 and "OpenGL" in found.stderr:
        pytest.skip("this machine cannot draw: " + found.stderr.splitlines()[-1])
    assert found.returncode == 0, found.stdout + found.stderr
