"""What decides a row besides its scenario: files that are read, code that is run, libraries."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from functools import cache, lru_cache
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from fleet.scenario.errors import BadInput
from fleet.scenario.local_code import code_of
from fleet.scenario.maps import image_of
from fleet.study.version import decides_nothing_more, libraries, program_version

DATA = frozenset({".csv", ".json", ".npy", ".py", ".toml", ".txt", ".yaml", ".yml"})
"""What a work function of the user's own is taken to read, of the files that its jobs name."""

CODE = ".py"


def made_by(
    scenario: Mapping[str, Any], tables: Sequence[str], function: str, *, ours: bool
) -> dict[str, Any]:
    """Everything that a job's row depends on, its scenario aside; of plain values.

    ``files`` has a sha256 for each file that the scenario names, whatever its suffix, for the
    image of a map, and for each local module that named Python code imports. ``packages`` are
    installed ones that such code imports, with their versions. A work function that is not
    ``ours`` may name files that it writes: of its files only those count whose suffix is in
    :data:`DATA`.

    Raises:
        ModuleNotFoundError: the work function's module is not there.
    """
    named = [p for p in _named_files(scenario) if ours or p.suffix in DATA]
    codes = [code_of(path) for path in named if path.suffix == CODE]
    source, installed = _work(function)
    files = {str(path): digest(path) for path in named}
    for code, path in zip(codes, (p for p in named if p.suffix == CODE), strict=True):
        files |= {_beside(file, path): digest(file) for file in code.files[1:]}
    described: dict[str, Any] = {
        "version": program_version(),
        "libraries": libraries(),
        "function": [function, source],
    }
    packages = {*installed, *(name for code in codes for name in code.packages)}
    if files:
        described["files"] = files
    if packages:
        described["packages"] = {name: _version(name) for name in sorted(packages)}
    if tables:
        described["tables"] = sorted(tables)
    return described


def changed(described: Mapping[str, Any]) -> Iterator[str]:
    """The files, of those that a row depends on, whose content is another one now.

    One that is not there is not named: who needs it says so.
    """
    for name, before in described.get("files", {}).items():
        path = Path(name)
        if path.is_file() and digest(path) != before:
            yield name


def code_named(described: Mapping[str, Any]) -> dict[str, str]:
    """The user's Python files that a job runs, with the sha256 of each."""
    return {n: d for n, d in described.get("files", {}).items() if Path(n).suffix == CODE}


def digest(path: Path) -> str:
    """The sha256 of a file's bytes."""
    stat = path.stat()
    return _digest(path.resolve(), stat.st_mtime_ns, stat.st_size, stat.st_ino)


@lru_cache(256)
def _digest(path: Path, _modified: int, _size: int, _inode: int) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _named_files(value: Any) -> Iterator[Path]:
    """The files that a scenario names, as it names them; a map is two files."""
    if isinstance(value, Mapping):
        for item in value.values():
            yield from _named_files(item)
    elif isinstance(value, list | tuple):
        for item in value:
            yield from _named_files(item)
    elif isinstance(value, str):
        path = _file(value) or _file(value.rpartition(":")[0])
        if path is None:
            return
        yield path
        if path.suffix in {".yaml", ".yml"}:
            try:
                image = image_of(path, "world.file")
            except BadInput:  # it is no map, or a bad one, which its reader says
                return
            if image.is_file():
                yield image


def _file(name: str) -> Path | None:
    try:
        return Path(name) if name and Path(name).is_file() else None
    except (OSError, ValueError):  # too long for a name, or with a zero in it
        return None


def _beside(file: Path, named: Path) -> str:
    """A module's path as the scenario would name it: from where the file is that imports it."""
    folder = named.resolve().parent
    inside = file.is_relative_to(folder)
    return str(named.parent / file.relative_to(folder)) if inside else str(file)


@cache
def _work(function: str) -> tuple[str, tuple[str, ...]]:
    """A hash of a work function's module and of what it imports besides the library; packages."""
    module = function.partition(":")[0]
    spec = find_spec(module)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(f"no module named {module!r}")
    code = code_of(Path(spec.origin), module.rpartition(".")[0], decides_nothing_more)
    whole = hashlib.sha256()
    for text in sorted(digest(file) for file in code.files):
        whole.update(text.encode())
    return whole.hexdigest()[:16], code.packages


@cache
def _version(package: str) -> str:
    """The version of the distribution that a top-level package comes from."""
    for distribution in packages_distributions().get(package, [package]):
        try:
            return version(distribution)
        except PackageNotFoundError:
            continue
    return "unknown"
