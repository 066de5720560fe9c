"""What is shipped, and what may import what."""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dist")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", folder],
        cwd=ROOT, check=True, capture_output=True,
    )  # fmt: skip
    (path,) = folder.glob("*.whl")
    return path


def test_the_wheel_has_three_packages_and_nothing_else(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in names}
    assert {top for top in tops if not top.endswith(".dist-info")} == {
        "fleet", "protocols", "worlds"
    }  # fmt: skip
    for package in ("fleet", "protocols", "worlds"):
        assert f"{package}/py.typed" in names
    shipped = {name for name in names if name.endswith((".j2", ".typed", ".css"))}
    there = {
        str(path.relative_to(ROOT))
        for package in ("fleet", "protocols", "worlds")
        for path in (ROOT / package).rglob("*")
        if path.suffix in {".j2", ".typed", ".css"}
    }
    assert shipped == there


def test_a_run_from_the_wheel_alone(wheel, tmp_path):
    """As a user has it: not from the source tree."""
    script = (
        "import fleet, sys; assert '.whl' in fleet.__file__;"
        "from fleet.cli import main;"
        "main(['run', '--motion', 'straight', '--rounds', '3', '--json'])"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(wheel)!r}); {script}"],
        cwd=tmp_path, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert '"served": 3' in done.stdout


def test_imports_run_one_way():
    done = subprocess.run(
        [Path(sys.executable).parent / "lint-imports", "--no-cache"],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert re.search(r"[1-9]\d* kept, 0 broken", done.stdout)
