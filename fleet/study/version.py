"""Which program made a result: its version, and a hash of the sources that decide a run."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib.metadata import version
from pathlib import Path

import fleet

BESIDE = ("cli", "experiments", "logs", "replay", "study")
"""In ``fleet``: what watches runs, and decides nothing in them."""


@cache
def program_version() -> str:
    """The release and the first digits of a hash of its sources: ``0.1.0+5c1f09ab``.

    The hash covers ``protocols``, ``worlds`` and what ``fleet`` holds besides the command line,
    the replay, the studies and the experiments. An edit of a protocol is another version of the
    program.
    """
    root = Path(fleet.__file__).resolve().parent
    digest = hashlib.sha256()
    for folder in (root, root.parent / "protocols", root.parent / "worlds"):
        for path in sorted(folder.rglob("*.py")):
            inner = path.relative_to(folder)
            if folder == root and inner.parts[0] in BESIDE:
                continue
            digest.update(f"{folder.name}/{inner.as_posix()}\0".encode())
            digest.update(path.read_bytes())
    return f"{fleet.__version__}+{digest.hexdigest()[:8]}"


def environment() -> dict[str, str]:
    """What a run's figures may depend on besides: versions, and the kind of machine."""
    versions = {name: version(name) for name in ("numpy", "scipy", "numba", "pymunk")}
    return {
        "fleet": program_version(),
        "python": platform.python_version(),
        **versions,
        "platform": f"{platform.system()} {platform.machine()}",
    }


@cache
def source_digest(module: str) -> str:
    """A hash of one module's source: a work function is a part of what its rows depend on."""
    from importlib.util import find_spec

    spec = find_spec(module)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(f"no module named {module!r}")
    return hashlib.sha256(Path(spec.origin).read_bytes()).hexdigest()[:16]
