"""TOML: its tables, and where each key of them stands."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fleet.scenario.errors import BadInput, bad, shortened, shown
from fleet.scenario.reading import read_text

DEEPEST = 12  # tables and lists within each other; no key of ours needs half of it
MOST_BYTES = 4_000_000  # of a scenario or study


@dataclass(frozen=True, slots=True)
class Document:
    """A TOML file that was read."""

    path: Path
    data: dict[str, Any]
    lines: Mapping[str, int]  # the line of each dotted key; the n-th table of a list: name[n]

    def place(self, key: str) -> str:
        """``file:line`` of the key, or of the nearest table around it."""
        within = key
        while within and within not in self.lines:
            unnumbered = re.sub(r"\[\d+\]$", "", within)
            within = unnumbered if unnumbered != within else within.rpartition(".")[0]
        if not within and key:  # a table that is set key by key, such as axes.range = [...]
            within = next((k for k in self.lines if k.startswith(f"{key}.")), "")
        path = shortened(str(self.path), 100)
        return f"{path}:{self.lines[within]}" if within else path

    def located(self, error: BadInput) -> BadInput:
        """The same problems, each with its place in the file."""
        return BadInput(
            (": ".join(filter(None, (self.place(key), key))), text) for key, text in error.problems
        )


def read_toml(path: Path) -> Document:
    """The tables of a TOML file, and the line that each dotted key stands in.

    Raises:
        BadInput: no such file, or not TOML.
    """
    text = read_text(path, "", most=MOST_BYTES)
    try:
        data = parse(text)
    except ValueError as error:
        raise bad("", _not_toml(path, text, str(error))) from error
    return Document(path, data, key_lines(text))


def parse(text: str) -> dict[str, Any]:
    """The tables of a TOML text.

    Raises:
        ValueError: it is no TOML, or holds what no key of ours can mean.
    """
    try:
        data = tomllib.loads(text)
    except RecursionError:
        raise ValueError(f"More than {DEEPEST} tables or lists within each other") from None
    except tomllib.TOMLDecodeError:
        raise
    except ValueError as error:  # Python's own, of a number
        what = "A whole number of too many digits" if "digits" in str(error) else str(error)
        raise ValueError(what) from error
    level: list[Any] = [data]
    for _ in range(DEEPEST):
        level = [
            inner
            for item in level
            for inner in (item.values() if isinstance(item, dict) else item)
            if isinstance(inner, dict | list)
        ]
    if level:
        raise ValueError(f"More than {DEEPEST} tables or lists within each other")
    return data


HEADER = re.compile(r"^\s*(\[\[?)\s*([^\]#]+?)\s*\]")
PART = r"(?:[\w-]+|\"[^\"]*\"|'[^']*')"
ENTRY = re.compile(rf"^\s*({PART}(?:\s*\.\s*{PART})*)\s*=")
TEXT = re.compile(r"\"\"\"|'''|\"(?:\\.|[^\"\\])*\"|'[^']*'|#.*|[\[\]{}]")


def key_lines(text: str) -> dict[str, int]:
    """The first line that each dotted key of a TOML text stands in; inline tables as one.

    The n-th table of a list is ``name[n]``. What stands within lists and texts of several
    lines is no key.
    """
    lines: dict[str, int] = {}
    counts: dict[str, int] = {}
    table, depth, quote = "", 0, ""
    for number, line in enumerate(text.split("\n"), 1):
        rest = line
        if not depth and not quote:
            if header := HEADER.match(line):
                table = _numbered(_bare(header[2]), header[1] == "[[", counts)
                lines.setdefault(table, number)
                continue
            if entry := ENTRY.match(line):
                key = _bare(entry[1])
                lines.setdefault(f"{table}.{key}" if table else key, number)
                rest = line[entry.end() :]
        depth, quote = _open(rest, depth, quote)
    return lines


def _bare(key: str) -> str:
    return re.sub(r"[\"'\s]", "", key)


def _numbered(table: str, listed: bool, counts: dict[str, int]) -> str:
    """The table's key, with the numbers of the lists that it stands in."""
    *outer, last = table.split(".")
    found = ""
    for part in outer:
        found = f"{found}.{part}" if found else part
        found = f"{found}[{counts[found]}]" if found in counts else found
    found = f"{found}.{last}" if found else last
    if listed:
        counts[found] = counts.get(found, -1) + 1
        return f"{found}[{counts[found]}]"
    return found


def _open(line: str, depth: int, quote: str) -> tuple[int, str]:
    """How many brackets, and which long quotation, are still open at the end of the line."""
    if quote:
        _, closed, line = line.partition(quote)
        if not closed:
            return depth, quote
    position = 0
    while found := TEXT.search(line, position):
        mark, position = found[0], found.end()
        if mark in ('"""', "'''"):
            end = line.find(mark, position)
            if end < 0:
                return depth, mark
            position = end + 3
        elif mark in "[{":
            depth += 1
        elif mark in "]}":
            depth = max(0, depth - 1)
    return depth, ""


def _not_toml(path: Path, text: str, message: str) -> str:
    where = re.search(r"\(at line (\d+), column (\d+)\)", message)
    what = shortened((message[: where.start()] if where else message).strip(), 120)
    place = shortened(str(path), 100)
    if where:
        place += f":{where[1]}:{where[2]}"
    elif long := re.search(r"\d{4000}", text):
        place += f":{text.count(chr(10), 0, long.start()) + 1}"
    return f"{place}: not TOML: {what[:1].lower()}{what[1:]}"


def parse_value(text: str) -> Any:
    """One value as in TOML, or, if it is none, as plain text on one line.

    Raises:
        ValueError: it holds a line break, or a number that is no number of ours.
    """
    text = text.strip()
    if "\n" in text or "\r" in text:
        raise ValueError("holds a line break; expected one value")
    try:
        return parse(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
    except ValueError as error:
        said = str(error)
        raise ValueError(f"is {shown(text)}; {said[:1].lower()}{said[1:]}") from error
