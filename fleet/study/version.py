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

IN_ROWS = ("fleet.study.play", "fleet.study.side_tables")
"""In ``fleet.study``: what has a say in what is in a row, or in the tables beside it."""

LIBRARIES = ("llvmlite", "numba", "numpy", "pillow", "pymunk", "scipy")
"""What decides the last bits of a run besides: another version of one is another row."""


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


def decides_nothing_more(module: str) -> bool:
    """Whether a module, by its dotted name, need not count beside the program's version.

    That covers it already, or it runs studies and has no say in what is in their rows.
    """
    parts = module.split(".")
    if parts[0] != "fleet" or len(parts) < 3:
        return parts[0] in {"fleet", "protocols", "worlds"}
    return parts[1] not in BESIDE or (parts[1] == "study" and module not in IN_ROWS)


@cache
def libraries() -> dict[str, str]:
    """The versions that decide the last bits of a run: Python's, and :data:`LIBRARIES`'."""
    return {"python": platform.python_version(), **{name: version(name) for name in LIBRARIES}}


def environment() -> dict[str, str]:
    """What a run's figures may depend on besides: versions, and the kind of machine."""
    return {
        "fleet": program_version(),
        **libraries(),
        "platform": f"{platform.system()} {platform.machine()}",
    }
