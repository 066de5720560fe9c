"""Which of the user's own files have been named to be run, so that a folder cannot name others.

A results folder is data, and may come from anybody. A run of it that runs Python files is run
again only if this user has swept with the same files at the same paths before, or says so.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

Code = tuple[Path, str]
"""A Python file and the sha256 of it."""


def remember(named: Iterable[Code]) -> None:
    """Note the files that the user has named; nothing, where the home folder takes no notes."""
    with suppress(OSError, RuntimeError):
        notes = _notes()
        notes.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        new = set(map(_line, named)) - set(_lines(notes))
        if new:
            descriptor = os.open(notes, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)
            with open(descriptor, "a", encoding="utf-8") as file:  # noqa: PTH123  # by its descriptor
                file.writelines(f"{line}\n" for line in sorted(new))


def unnamed(code: Iterable[Code]) -> list[Path]:
    """Those files that this user has not named, as they are, at these paths."""
    known: set[str] = set()
    with suppress(OSError, RuntimeError):
        known = set(_lines(_notes()))
    return [file for file, digest in code if _line((file, digest)) not in known]


def _notes() -> Path:
    """The file of notes, in the user's own folder for such things."""
    state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(state) / "talking-fleet" / "named-code"


def _lines(notes: Path) -> Iterator[str]:
    if notes.is_file() and (not hasattr(os, "getuid") or notes.stat().st_uid == os.getuid()):
        yield from notes.read_text("utf-8").splitlines()


def _line(code: Code) -> str:
    file, digest = code
    return f"{digest} {file.resolve()}"
