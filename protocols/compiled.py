"""Compiling the measured hot loops.

A kernel is an ordinary function over arrays and floats. Modules that hold kernels load numba,
which costs seconds: import them only where a run needs them. Compiled code is cached on disk, in
a folder named after a hash of every module that holds kernels: numba by itself would go on
using the old machine code of a kernel after another that it calls has been edited.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])

KERNEL_PACKAGES = ("protocols", "fleet.motion")


def kernel(function: F) -> F:
    """``function`` compiled by numba, without fast-math: bit for bit what Python computes."""
    import numba

    numba.config.CACHE_DIR = str(_cache_folder(numba.__version__))
    compiled = numba.njit(function, error_model="numpy")
    compiled._cache = _forgiving_cache(function)
    result: F = compiled
    return result


def _forgiving_cache(function: Callable[..., Any]) -> Any:
    """A cache on disk that recompiles what it cannot read, where numba's own would raise."""
    from numba.core.caching import FunctionCache

    class ForgivingCache(FunctionCache):  # type: ignore[misc]  # numba is not typed
        def load_overload(self, sig: Any, target_context: Any) -> Any:
            try:
                return super().load_overload(sig, target_context)
            except Exception:  # noqa: BLE001  # a file cut short may raise anything
                self.flush()
                return None

    return ForgivingCache(function)


@cache
def _cache_folder(numba_version: str) -> Path:
    digest = hashlib.sha256(numba_version.encode())
    for package in KERNEL_PACKAGES:
        spec = find_spec(package)
        for folder in (spec.submodule_search_locations or ()) if spec else ():
            for source in sorted(Path(folder).rglob("*.py")):
                digest.update(source.read_bytes())
    given = os.environ.get("NUMBA_CACHE_DIR")
    for root in (Path(given) if given else _home_cache(), Path(tempfile.gettempdir())):
        folder_path = root / f"fleet-kernels-{digest.hexdigest()[:16]}"
        try:
            folder_path.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder_path, os.W_OK):
            return folder_path
    return Path(tempfile.mkdtemp(prefix="fleet-kernels-"))


def _home_cache() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser())
