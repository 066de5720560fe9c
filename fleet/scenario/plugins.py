"""The user's own protocols and metrics: ``file.py:name``."""

from __future__ import annotations

import sys
import traceback
from difflib import get_close_matches
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

from fleet.scenario.errors import bad, unknown


def looks_like_file(name: str) -> bool:
    """Whether a name means an object in a file of the user's."""
    return ".py:" in name or name.endswith(".py")


def load_object(reference: str, key: str) -> Any:
    """The object that ``path/to/file.py:name`` means.

    Raises:
        BadInput: the file, or the object in it, is not there, or the file does not import;
            the sentence says which and why.
    """
    path_text, _, name = reference.rpartition(":")
    if not path_text:
        raise bad(key, f"{reference!r} names no object; expected file.py:name")
    path = Path(path_text)
    if not path.is_file():
        near = get_close_matches(path.name, [p.name for p in path.parent.glob("*.py")], 1, 0.6)
        hint = f"; did you mean {str(path.parent / near[0])!r}?" if near else ""
        raise bad(key, f"{path_text!r} is not a file{hint}")
    try:
        module = _load(path.resolve(), path.stat().st_mtime_ns)
    except Exception as error:  # whatever the user's file raises is the user's to read
        line = next(
            (f.lineno for f in reversed(traceback.extract_tb(error.__traceback__))
             if f.filename == str(path.resolve())), getattr(error, "lineno", None),
        )  # fmt: skip
        where = f" in line {line}" if line else ""
        raise bad(
            key, f"{path_text!r} does not import{where}: {type(error).__name__}: {error}"
        ) from error
    if not hasattr(module, name):
        names = [n for n, v in vars(module).items() if callable(v) and not n.startswith("_")]
        raise bad(key, unknown(f"name in {path_text!r}", name, names))
    found = getattr(module, name)
    if not callable(found):
        raise bad(key, f"{reference!r} is a {type(found).__name__}; expected a function")
    return found


@cache
def _load(path: Path, _modified: int) -> ModuleType:
    spec = spec_from_file_location(f"_user_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path} is not a Python file")
    module = module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module
