"""The cache of machine code: what makes it stale, whose it is, and what happens to files."""

from __future__ import annotations

import os
import re
import stat
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from protocols import compiled

ROOT = Path(compiled.__file__).parents[1]
KERNEL = "from protocols.compiled import kernel\n\n@kernel\n"
SOURCES = {
    "__init__": "",
    "inner": KERNEL + "def twice(x):\n    return 2.0 * x\n",
    "limits": "MOST = 10.0\n",
    "outer": "from mine.inner import twice\nfrom mine.limits import (\n    MOST,\n)\n"
    + KERNEL
    + "def capped(x):\n    return min(twice(x), MOST)\n",
    "notes": "from mine.outer import capped\n",
}
PROBE = """
from mine.notes import capped
print(capped(3.0), sum(capped.stats.cache_misses.values()))
"""


def run(cache, script, path):
    return subprocess.run(
        [sys.executable, "-c", script],
        env={
            **os.environ,
            "NUMBA_CACHE_DIR": str(cache),
            "PYTHONPATH": os.pathsep.join([str(path), str(ROOT)]),
        },
        capture_output=True,
        text=True,
        check=True,
    ).stdout


@pytest.fixture
def package(tmp_path):
    folder = tmp_path / "mine"
    folder.mkdir()
    for name, text in SOURCES.items():
        (folder / f"{name}.py").write_text(text)
    return folder


@pytest.fixture
def imported(package, monkeypatch):
    monkeypatch.syspath_prepend(str(package.parent))
    for name in ("inner", "limits", "outer", "notes"):
        import_module(f"mine.{name}")
    yield package
    for name in [name for name in sys.modules if name.partition(".")[0] == "mine"]:
        del sys.modules[name]


@pytest.mark.parametrize(
    ("edited", "stale"), [("notes", False), ("outer", True), ("inner", True), ("limits", True)]
)
def test_code_hangs_on_the_file_and_on_those_it_takes_something_from(imported, edited, stale):
    compiled.digest.cache_clear()
    before = compiled.digest("mine.outer")
    file = imported / f"{edited}.py"
    file.write_text(file.read_text() + "# a comment\n")
    compiled.digest.cache_clear()
    assert (compiled.digest("mine.outer") != before) == stale


@pytest.mark.slow
def test_what_is_stale_is_compiled_anew_and_removed(package):
    cache = package.parent / "cache"

    def probe():
        value, misses = run(cache, PROBE, package.parent).split()
        return float(value), int(misses)

    def edit(name, old, new):
        file = package / f"{name}.py"
        file.write_text(file.read_text().replace(old, new))

    assert probe() == (6.0, 1)
    edit("notes", "from", "# a comment\nfrom")
    assert probe() == (6.0, 0)
    edit("inner", "2.0", "3.0")
    assert probe() == (9.0, 1)
    edit("limits", "10.0", "5.0")
    assert probe() == (5.0, 1)
    folders = [folder.name.partition("-")[0] for folder in (cache / "fleet-kernels").iterdir()]
    assert sorted(folders) == ["inner", "outer"]


def test_code_that_nobody_has_used_for_long_is_removed(tmp_path, monkeypatch):
    left, used = (tmp_path / f"gone-{name}" for name in ("left", "used"))
    for folder in (left, used):
        folder.mkdir()
    os.utime(left, (0.0, 0.0))
    monkeypatch.setattr(compiled, "code_root", lambda: tmp_path)
    assert compiled.code_folder(Path("file.py"), "stamp").exists()
    assert used.exists()
    assert not left.exists()


def kernel_modules():
    for file in sorted([*ROOT.glob("fleet/**/*.py"), *ROOT.glob("protocols/**/*.py")]):
        if re.search(r"^@kernel$", file.read_text(encoding="utf-8"), re.MULTILINE):
            yield ".".join(file.relative_to(ROOT).with_suffix("").parts)


def test_our_kernels_hang_on_kernels_and_on_few_files_besides():
    modules = set(kernel_modules())
    assert "protocols.topology.relinking" in modules
    for module in modules:
        import_module(module)
    besides = {name: compiled.sources(name) - modules for name in modules}
    protocols = {f"protocols.{name}" for name in ("auctions", "routing", "rfta3", "rules")}
    assert not protocols & set.union(*besides.values()), "an edited protocol recompiles nothing"
    assert set.union(*(besides[name] for name in modules if "radio" not in name)) == {
        "protocols.compiled",
        "protocols.topology.witness",
        "fleet.motion.kernels.records",
    }


@pytest.mark.parametrize("fault", ["a link", "open to others", "somebody else's", "a file"])
def test_a_folder_that_others_can_write_to_is_not_used(fault, tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(compiled.tempfile, "tempdir", str(tmp_path))
    planted = tmp_path / "cache" / "fleet-kernels"
    planted.parent.mkdir()
    if fault == "a link":
        (tmp_path / "elsewhere").mkdir(mode=0o700)
        planted.symlink_to(tmp_path / "elsewhere")
    elif fault == "a file":
        planted.write_text("")
    else:
        planted.mkdir(mode=0o700)
    if fault == "open to others":
        planted.chmod(0o770)
    if fault == "somebody else's":
        owner = planted.stat().st_uid
        monkeypatch.setattr(compiled.os, "geteuid", lambda: owner + 1)
    root = compiled.code_root.__wrapped__()
    assert root.parent == tmp_path
    assert root != planted
    assert stat.S_IMODE(root.stat().st_mode) == 0o700


def test_the_folder_is_made_for_its_user_alone(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    root = compiled.code_root.__wrapped__()
    assert root == tmp_path / "fleet-kernels"
    assert stat.S_IMODE(root.stat().st_mode) == 0o700


@pytest.mark.slow
def test_a_truncated_cache_is_compiled_anew(package):
    cache = package.parent / "cache"
    assert run(cache, PROBE, package.parent) == "6.0 1\n"
    files = [f for f in cache.rglob("*") if f.suffix in (".nbi", ".nbc")]
    assert files
    for file in files:
        file.write_bytes(file.read_bytes()[:10])
    assert run(cache, PROBE, package.parent) == "6.0 1\n"
    assert run(cache, PROBE, package.parent) == "6.0 0\n"


def test_a_cache_that_cannot_be_written_does_not_matter(package):
    blocked = package.parent / "file"
    blocked.write_text("not a folder")
    assert run(blocked / "cache", PROBE, package.parent) == "6.0 1\n"
