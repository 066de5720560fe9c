"""The user's files as text. Whatever stands in the way is said in one sentence."""

from __future__ import annotations

import os
from difflib import get_close_matches
from pathlib import Path

from fleet.scenario.errors import bad, shortened, shown

MOST_BYTES = 64_000_000  # of one file; no table of places or events is longer


def read_text(path: Path, key: str, *, most: int = MOST_BYTES) -> str:
    """The text of a file in UTF-8, with or without a byte-order mark.

    Raises:
        BadInput: there is no such file, it is no text, or it holds more than ``most`` bytes.
    """
    try:
        with path.open("rb") as file:
            content = file.read(most + 1)
    except FileNotFoundError:
        raise bad(key, f"{shortened(str(path), 100)}: no such file{near_file(path)}") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in its name
        raise bad(key, f"{shown(str(path))} cannot be read: {reason(error)}") from error
    if len(content) > most:
        raise bad(
            key, f"{shown(str(path))} holds more than {most:,} bytes; expected a smaller file"
        )
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        marks = (b"\xff\xfe", b"\xfe\xff")
        what = "it is UTF-16" if content[:2] in marks else "it is not UTF-8 text"
        raise bad(key, f"{shown(str(path))} cannot be read: {what}; expected UTF-8") from error
    return text.replace("\r\n", "\n").replace("\r", "\n")


def is_file(path: Path) -> bool:
    """Whether there is such a file; a name that no file can have has none."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def near_file(path: Path) -> str:
    """A hint at the file beside ``path`` whose name is nearest to it, if there is one."""
    try:
        beside = [entry.name for entry in os.scandir(path.parent) if entry.name != path.name]
    except (OSError, ValueError):
        return ""
    alike = [name for name in beside if name.endswith(path.suffix)]
    near = get_close_matches(path.name, alike, 1, 0.6)
    return f"; did you mean {shown(str(path.parent / near[0]))}?" if near else ""


def reason(error: BaseException) -> str:
    """Why the system did not let us."""
    said = getattr(error, "strerror", None) or str(error)
    return shortened(said, 100) or type(error).__name__
