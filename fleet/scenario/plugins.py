"""The user's own protocols and metrics: ``file.py:name``."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import module_from_spec, spec_from_file_location
from inspect import signature
from pathlib import Path
from types import ModuleType
from typing import Any
from zlib import crc32

from fleet.scenario import watchdog
from fleet.scenario.errors import BadInput, bad, shown, unknown
from fleet.scenario.reading import is_file, near_file, reason
from fleet.scenario.watchdog import Stuck, Watch


def looks_like_file(name: str) -> bool:
    """Whether a name means an object in a file of the user's."""
    return ".py:" in name or name.endswith(".py")


def load_object(reference: str, key: str) -> Any:
    """The object that ``path/to/file.py:name`` means.

    Modules beside the file can be imported in it by their names.

    Raises:
        BadInput: the file, or the object in it, is not there, or the file does not import, or
            names types that are nowhere; the sentence says which and why.
    """
    path, name = _split(reference, key)
    module = _imported(path, key).module
    if not hasattr(module, name):
        names = [n for n, v in vars(module).items() if callable(v) and not n.startswith("_")]
        if not names:
            raise bad(key, f"{shown(str(path))} has no {shown(name)}, and no function at all")
        raise bad(key, f"{shown(str(path))}: {unknown('name', name, names)}")
    found = getattr(module, name)
    if not callable(found):
        raise bad(key, f"{shown(reference)} is of type {type(found).__name__}; expected a function")
    try:
        signature(found, eval_str=True)  # annotations may be any code
    except Exception as error:
        said = f"the parameters of {shown(reference)} cannot be read: {what(error)}"
        raise bad(key, said) from error
    return found


def home_of(reference: str) -> Path | None:
    """The folder of the user's file that a name means an object of; None: it means none."""
    return (
        Path(reference.rpartition(":")[0]).resolve().parent if looks_like_file(reference) else None
    )


@contextmanager
def held(called: str, folder: Path, key: str) -> Iterator[None]:
    """Code of the user's in ``folder``: whatever it raises, and that it never ends, is bad input.

    Raises:
        BadInput: one sentence, with the line. A ValueError says what it says, and no more.
    """
    try:
        with Watch(folder):
            yield
    except BadInput:
        raise
    except ValueError as error:
        raise bad(key, reason(error)) from error
    except (Exception, SystemExit, Stuck) as error:
        raise bad(key, f"{shown(called)} fails{where_in(error, folder)}: {what(error)}") from error


def files_of(reference: str, key: str) -> tuple[Path, ...]:
    """The file of ``path/to/file.py:name``, and those beside and below it that it imports.

    What a run did depends on all of them.

    Raises:
        BadInput: as from :func:`load_object`.
    """
    return tuple(sorted(_imported(_split(reference, key)[0], key).files))


@dataclass(frozen=True, slots=True)
class _Loaded:
    """A file of the user's as it was when it was imported."""

    module: ModuleType
    files: Mapping[Path, int]  # it, and the modules of the user's that it imports: written when

    @property
    def current(self) -> bool:
        """Whether nobody has edited any of it since."""
        return all(is_file(path) and _written(path) == when for path, when in self.files.items())


_LOADED: dict[Path, _Loaded] = {}


def _split(reference: str, key: str) -> tuple[Path, str]:
    path_text, _, name = reference.rpartition(":")
    if not path_text or "/" in name:
        raise bad(key, f"{shown(reference)} names no object; expected file.py:name")
    path = Path(path_text)
    if not is_file(path):
        raise bad(key, f"{shown(path_text)} is not a file{near_file(path)}")
    return path, name


def _imported(path: Path, key: str) -> _Loaded:
    home = path.resolve()
    loaded = _LOADED.get(home)
    if loaded is None or not loaded.current:
        try:
            with Watch(home.parent):
                loaded = _LOADED[home] = _load(home)
        except (Exception, SystemExit, Stuck) as error:  # whatever it raises is the user's to read
            where = where_in(error, home.parent)
            raise bad(key, f"{shown(str(path))} does not import{where}: {what(error)}") from error
    return loaded


def what(error: BaseException) -> str:
    """The error of the user's code in a few words."""
    if isinstance(error, Stuck):
        return f"it does not come to an end within {watchdog.PATIENCE:g} s"
    said, name = reason(error), type(error).__name__
    return name if said == name else f"{name}: {said}"


def where_in(error: BaseException, folder: Path) -> str:
    """The last line within ``folder`` that the error came through, as `` in line 7 of x.py``."""
    if isinstance(error, SyntaxError) and error.filename:
        file, line = Path(error.filename), error.lineno
        return f" in line {line} of {file.name}" if file.is_relative_to(folder) else ""
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        if Path(frame.filename).is_relative_to(folder):
            return f" in line {frame.lineno} of {Path(frame.filename).name}"
    return where_in(error.__cause__, folder) if error.__cause__ else ""


def _load(path: Path) -> _Loaded:
    """Import the file anew, and with it the modules beside it."""
    name = f"_user_{path.stem}_{crc32(str(path).encode()):08x}"
    spec = spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path} is not a Python file")
    module = module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up
    with _siblings(path.parent) as files:
        spec.loader.exec_module(module)
    return _Loaded(module, {file: _written(file) for file in {path, *files}})


@contextmanager
def _siblings(folder: Path) -> Iterator[set[Path]]:
    """Let modules in ``folder`` be imported; yields those that were, once it is left.

    They are taken out of ``sys.modules`` again: another folder may hold others of their names.
    """
    before = set(sys.modules)
    found: set[Path] = set()
    sys.path.insert(0, str(folder))
    try:
        yield found
    finally:
        sys.path.remove(str(folder))
        for name in set(sys.modules) - before:
            file = getattr(sys.modules[name], "__file__", None)
            if file and Path(file).is_relative_to(folder) and not _installed(name, file):
                found.add(Path(file))
                del sys.modules[name]
        if str(folder) not in sys.path:  # for what is imported only within a function
            sys.path.append(str(folder))


def _installed(name: str, file: str) -> bool:
    """Whether a module is no file of the user's: a library's, ours, or one that was asked for."""
    ours = name.partition(".")[0] in ("fleet", "protocols", "worlds")
    return ours or name.startswith("_user_") or "site-packages" in file


def _written(path: Path) -> int:
    return path.stat().st_mtime_ns
