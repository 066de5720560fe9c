"""The notebooks run from top to bottom, and show what they promise: tables, pictures, a verdict."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat")
NotebookClient = pytest.importorskip("nbclient").NotebookClient
pytest.importorskip("ipykernel")

EXAMPLES = Path(__file__).parents[1] / "examples"
NOTEBOOKS = {  # the mime types of what each shows, and words that stand in it
    "one_run": ({"text/html", "image/png"}, "rfta2 on random-hole"),
    "one_study": ({"text/html", "image/png"}, "40 of 40 runs done"),
    "one_log": ({"image/png"}, "Energy linear in distance"),
}


def test_each_notebook_is_run():
    assert {path.stem for path in EXAMPLES.glob("*.ipynb")} == set(NOTEBOOKS)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_it_is_kept_without_what_came_of_it(name):
    notebook = nbformat.read(EXAMPLES / f"{name}.ipynb", as_version=4)
    nbformat.validate(notebook)
    assert not any(cell.get("outputs") for cell in notebook.cells)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")  # of the notebook's machinery; the kernel is not under test
@pytest.mark.parametrize("name", NOTEBOOKS)
def test_it_runs_and_shows(name, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    notebook = nbformat.read(EXAMPLES / f"{name}.ipynb", as_version=4)
    NotebookClient(
        notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    ).execute()
    shown = [out for cell in notebook.cells for out in cell.get("outputs", [])]
    kinds = {kind for out in shown for kind in out.get("data", {})}
    wanted, words = NOTEBOOKS[name]
    assert wanted <= kinds
    assert words in str(shown)
