"""Compiling the measured hot loops.

A kernel is an ordinary function over arrays and floats. This module loads numba, which costs
a part of a second: import it, and modules that hold kernels, only where a run needs them.

Machine code is kept on disk, for each file by a digest of that file and of all that it imports
of its own package and of this one: numba by itself would go on using the old machine code of a
kernel after another that it calls, in another file, has been edited. As machine code that
anybody could have put there is not to be run, the folder belongs to the user alone.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import re
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numba
import numpy as np
from numba.core.caching import CompileResultCacheImpl, FunctionCache

F = TypeVar("F", bound=Callable[..., Any])

OURS = frozenset({"protocols", "fleet", "worlds"})  # packages whose imports are followed
IMPORTS = re.compile(r"^from +([\w.]+) +import +(\([^)]*\)|.*)|^import +(.*)", re.MULTILINE)
UNUSED = 30.0 * 24 * 3600  # after which the code of a file that may be gone is removed [s]


def kernel(function: F) -> F:
    """``function`` compiled by numba, without fast-math: bit for bit what Python computes.

    With ``NUMBA_DISABLE_JIT`` set it is the function itself, whose integers wrap as compiled.
    """
    return _compiled(function)


def inlined(function: F) -> F:
    """The same for what a hot loop does in every round: its machine code is put where it is called,
    so that no arguments are passed, and arrays among them not counted.
    """
    return _compiled(function, forceinline=True)


def _compiled(function: F, **options: Any) -> F:
    if numba.config.DISABLE_JIT:
        return np.errstate(over="ignore")(function)
    compiled = numba.njit(function, error_model="numpy", **options)
    with suppress(OSError):  # no file to go by, as at a prompt: compiled for this process
        compiled._cache = _KernelCache(function)
    result: F = compiled
    return result


def direct(kernel: F) -> F:
    """The machine code of ``kernel``, which is called without asking again what types its
    arguments have: for tuples of arrays that takes longer than the shorter kernels do.

    Only if it has been called in this process, and always with arguments of the same types;
    otherwise, and if nothing is compiled, ``kernel`` itself. Numbers are converted; arrays must
    be what they were, contiguous ones too.
    """
    overloads = getattr(kernel, "overloads", {})
    if len(overloads) != 1:
        return kernel
    (only,) = overloads.values()
    entry_point: F = only.entry_point
    return entry_point


class _Locator:
    """Where numba keeps the code of a function, and what makes it stale."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self._line = function.__code__.co_firstlineno
        self._digest = digest(function.__module__)
        self._folder = code_folder(Path(file), self._digest)

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> _Locator:
        """As numba makes one."""
        return cls(function, file)

    def ensure_cache_path(self) -> None:
        """Called before code is saved."""
        self._folder.mkdir(exist_ok=True)

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Code saved under another is stale."""
        return self._digest

    def get_disambiguator(self) -> str:
        """What tells functions of one name apart."""
        return str(self._line)


class _KernelCacheImpl(CompileResultCacheImpl):  # type: ignore[misc]  # numba is not typed
    _locator_classes = (_Locator,)


class _KernelCache(FunctionCache):  # type: ignore[misc]
    """Compiles what it cannot read, and keeps going where it cannot write."""

    _impl_class = _KernelCacheImpl

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # noqa: BLE001  # a file cut short may raise anything
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)
        except OSError:  # the disk is full, or somebody has removed the folder
            return


@cache
def digest(module: str) -> str:
    """A hash of all sources that the kernels of ``module`` are made of."""
    whole = hashlib.sha256()
    for name in sorted(sources(module)):
        whole.update(_file_of(name).read_bytes())
    return whole.hexdigest()[:16]


def sources(module: str) -> set[str]:
    """``module``, which is being imported, and those that it imports at its top, or that these
    import, as far as they belong to its own package or to one of ours.
    """
    followed = OURS | {module.partition(".")[0]}
    found: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += [other for other in _imported(name) if other.partition(".")[0] in followed]
    return found


@cache
def _imported(module: str) -> list[str]:
    """The modules that ``module`` imports, and has imported, at its top."""
    names: list[str] = []
    for package, inside, plain in IMPORTS.findall(_file_of(module).read_text(encoding="utf-8")):
        names += re.findall(r"[\w.]+", plain)
        submodules = [f"{package}.{name}" for name in re.findall(r"\w+", inside)]
        names += [name for name in submodules if name in sys.modules] or [package]
    return [name for name in names if name in sys.modules]


def _file_of(module: str) -> Path:
    return Path(getattr(sys.modules.get(module), "__file__", None) or os.devnull)


def code_folder(file: Path, stamp: str) -> Path:
    """The folder for the code of ``file`` under this digest; that under others is removed."""
    root = code_root()
    place = f"{file} {sys.implementation.cache_tag} {numba.__version__}"
    name = f"{file.stem}-{hashlib.sha256(place.encode()).hexdigest()[:8]}"
    folder = root / f"{name}-{stamp}"
    if not folder.exists():
        stale = [*root.glob(f"{name}-*"), *_unused(root), *_unused(root.parent, "fleet-kernels-*")]
        for old in stale:
            shutil.rmtree(old, ignore_errors=True)
        folder.mkdir(exist_ok=True)
    os.utime(folder)
    return folder


def _unused(root: Path, pattern: str = "*") -> list[Path]:
    """Folders of code that nobody has used for long, such as of a version that is gone."""
    return [path for path in root.glob(pattern) if time.time() - path.lstat().st_mtime > UNUSED]


@cache
def code_root() -> Path:
    """The folder that machine code is kept in: the user's own, or one made for this process."""
    given = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME")
    root = Path(given or Path("~/.cache").expanduser()) / "fleet-kernels"
    if _private(root):
        return root
    fresh = Path(tempfile.mkdtemp(prefix="fleet-kernels-"))
    atexit.register(_remove, fresh, os.getpid())
    return fresh


def _remove(folder: Path, owner: int) -> None:
    if os.getpid() == owner:  # not a child that was forked off
        shutil.rmtree(folder, ignore_errors=True)


def _private(folder: Path) -> bool:
    """Whether the folder, made if need be, is one that nobody else can write to."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = folder.lstat()
    except (OSError, RuntimeError):
        return False
    if not stat.S_ISDIR(found.st_mode) or not os.access(folder, os.W_OK):
        return False
    if not hasattr(os, "geteuid"):  # Windows: what is in a user's folder is the user's
        return True
    return found.st_uid == os.geteuid() and stat.S_IMODE(found.st_mode) & 0o077 == 0
