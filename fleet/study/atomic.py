"""Files that appear whole, or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

DRAFT = ".draft"


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A draft beside ``path`` to write to; on the disk, it takes the place of ``path`` at the end.

    If what writes raises, what was at ``path`` stays, and the draft goes.
    """
    draft = path.with_name(f".{path.name}.{os.getpid()}{DRAFT}")
    try:
        yield draft
        with draft.open("rb") as file:
            os.fsync(file.fileno())
        draft.replace(path)
    finally:
        with suppress(OSError):
            draft.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file, all of it or nothing."""
    with replacing(path) as draft:
        draft.write_text(text, "utf-8")


def clear_drafts(folder: Path) -> None:
    """Remove what processes that were killed had begun to write into a folder."""
    for draft in folder.glob(f".*{DRAFT}"):
        process = draft.name.removesuffix(DRAFT).rpartition(".")[2]
        if process.isdecimal() and not _is_alive(int(process)):
            with suppress(OSError):
                draft.unlink(missing_ok=True)


def _is_alive(process: int) -> bool:
    if process == os.getpid():
        return False  # it has ended what it began, or has given up on it
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
