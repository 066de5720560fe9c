"""Tables of numbers as robots leave them: any separator, several header lines, decimal commas."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fleet.scenario.errors import bad, or_list

SEPARATORS = (",", ";", "\t", "|", " ")
_LOOKED_AT = 60  # lines, to tell the form of a file
_PLAIN = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")
_COMMA = re.compile(r"[-+]?\d*,\d+([eE][-+]?\d+)?$")
_MISSING = {"", "nan", "na", "n/a", "none", "null", "-", "inf", "-inf", "+inf", "true", "false"}
_CLOCK = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}(?:[.,]\d+)?)$")
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}")


@dataclass(frozen=True, slots=True)
class Sheet:
    """The numbers of one file, column by column; what was no number is NaN."""

    source: str  # the file's name, for messages
    columns: dict[str, NDArray[np.float64]]  # by the name in the header; all of one length
    units: dict[str, str]  # as a line of the header gives them
    notes: tuple[str, ...]  # what had to be understood, in sentences


def read_sheet(path: Path) -> Sheet:
    """The table of a text file.

    Separators are sniffed, as are lines before the header, further header lines (one of units is
    understood), a byte-order mark, decimal commas, separators at the ends of lines, ISO dates.

    Raises:
        BadInput: the file cannot be read, is no table, or has no header line.
    """
    text, notes = _text_of(path)
    lines = [line for line in text.splitlines() if line.strip()]
    separator = _separator(lines[:_LOOKED_AT])
    if separator is None:
        raise bad("--log", f"{path}: holds no lines of numbers; expected a table, a row a sample")
    head, first = _header(lines, separator)
    if first == 0:
        raise bad(
            "--log", f"{path}: has no header line; expected one that names the columns, such as"
            " 'time,v,omega,power'",
        )  # fmt: skip
    cells = _cells(lines[first:], separator)
    names, units = _names(head, len(cells), path)
    if first > 1:
        notes.append(f"{first} lines before the first row; names from {names[:3]!r} on")
    columns = {name: _numbers(column) for name, column in zip(names, cells, strict=False)}
    if any(len(c) and _COMMA.match(c[0].as_py().strip()) for c in cells):
        notes.append("decimal commas")
    expected = len(lines) - first
    if cells and len(cells[0]) < expected:
        notes.append(f"{expected - len(cells[0])} lines that are cut off left out")
    if separator != ",":
        notes.append(f"columns separated by {_SPOKEN.get(separator, separator)}")
    return Sheet(path.name, columns, units, tuple(notes))


_SPOKEN = {"\t": "tabs", " ": "blanks", ";": "semicolons", "|": "bars"}


def _text_of(path: Path) -> tuple[str, list[str]]:
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise bad("--log", f"{str(path)!r} cannot be read: {error.strerror}") from error
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return raw.decode("utf-16", "replace"), ["written in UTF-16"]
    if b"\0" in raw[:4096]:
        raise bad("--log", f"{path}: is not text; expected a table (CSV) or a ROS bag")
    try:
        return raw.decode("utf-8-sig"), []
    except UnicodeDecodeError:
        return raw.decode("latin-1"), ["not UTF-8; read as Latin-1"]


def _split(line: str, separator: str) -> list[str]:
    """The cells of one line; a separator at the end begins no cell."""
    if separator == " ":
        return line.split()
    line = line.strip("\r\n " if separator == "\t" else "\r\n \t")
    found = next(csv.reader([line], delimiter=separator))
    cells = [cell.strip() for cell in found]
    return cells[:-1] if len(cells) > 1 and not cells[-1] else cells


def _is_number(cell: str) -> bool:
    return bool(_PLAIN.match(cell) or _COMMA.match(cell) or _DATE.match(cell) or _CLOCK.match(cell))


def _is_row(cells: Sequence[str]) -> bool:
    """Whether most cells of a line are numbers, or are left empty."""
    filled = [c for c in cells if c.lower() not in _MISSING]
    numeric = sum(map(_is_number, filled))
    return numeric >= 1 and len(cells) >= 2 and numeric >= 0.5 * len(filled)


def _separator(lines: Sequence[str]) -> str | None:
    """The separator that makes most cells numbers, in rows of one length."""
    best, chosen = 0.0, None
    for separator in SEPARATORS:
        rows = [cells for cells in (_split(line, separator) for line in lines) if _is_row(cells)]
        if not rows:
            continue
        lengths = [len(cells) for cells in rows]
        common = max(set(lengths), key=lengths.count)
        cells = [c for row in rows for c in row if c]
        numeric = sum(map(_is_number, cells)) / max(1, len(cells))
        score = numeric * lengths.count(common) / len(lines) * (1.0 + 0.01 * min(common, 20))
        if score > best:
            best, chosen = score, separator
    return chosen


def _header(lines: Sequence[str], separator: str) -> tuple[list[list[str]], int]:
    """The lines before the first row of numbers, split, and how many they are."""
    head: list[list[str]] = []
    for number, line in enumerate(lines):
        cells = _split(line, separator)
        if _is_row(cells) and not line.lstrip().startswith("#"):
            return head, number
        head.append(_split(line.lstrip().lstrip("#%").strip(), separator))
    return head, len(lines)


def _names(head: list[list[str]], width: int, path: Path) -> tuple[list[str], dict[str, str]]:
    """The names of the columns and, if a line below gives them, their units."""
    whole = [cells for cells in head if len(cells) >= max(2, min(width, width - 1))]
    if not whole:
        raise bad(
            "--log", f"{path}: no line before the numbers names their {width} columns; expected"
            " such as 'time,v,omega,power'",
        )  # fmt: skip
    names = whole[0]
    twice = sorted({name for name in names if name and names.count(name) > 1})
    if twice:
        raise bad("--log", f"{path}: two columns are called {or_list(twice)}; expected each once")
    names = [name or f"column {k + 1}" for k, name in enumerate(names)]
    units: dict[str, str] = {}
    for cells in whole[1:]:
        for name, cell in zip(names, cells, strict=False):
            units.setdefault(name, cell.strip("[]() "))
    return names[:width], units


def _cells(lines: Sequence[str], separator: str) -> list[Any]:
    """The cells of the rows, column by column; lines that end early are left out."""
    import pyarrow as pa
    from pyarrow import csv as arrow

    lengths = [len(_split(line, separator)) for line in lines[:_LOOKED_AT]]
    width = max(set(lengths), key=lengths.count)
    if separator == " ":
        body = "\n".join(" ".join(line.split()) for line in lines)
    else:
        body = "\n".join(line.rstrip("\r") for line in lines)
    names = [str(k) for k in range(width)]
    trailing = lines[0].rstrip().endswith(separator) and separator not in " \t"
    if trailing or (separator == "\t" and lines[0].endswith("\t")):
        names.append("end")
    table = arrow.read_csv(
        io.BytesIO(body.encode()),
        read_options=arrow.ReadOptions(column_names=names),
        parse_options=arrow.ParseOptions(
            delimiter=separator, invalid_row_handler=lambda _: "skip", ignore_empty_lines=True
        ),
        convert_options=arrow.ConvertOptions(
            column_types={name: pa.string() for name in names}, strings_can_be_null=False
        ),
    )
    return [table.column(str(k)).combine_chunks() for k in range(width)]


def _numbers(column: Any) -> NDArray[np.float64]:
    """A column of text as numbers; ISO dates and times of day as seconds; NaN for the rest."""
    import pyarrow as pa
    import pyarrow.compute as pc

    text = pc.utf8_trim_whitespace(column)
    try:
        return _as_float(pc.cast(text, pa.float64()))
    except pa.ArrowInvalid:
        pass
    sample = next((c.as_py() for c in text if c.as_py().lower() not in _MISSING), "")
    if _DATE.match(sample) or _CLOCK.match(sample):
        return np.array([_seconds(c.as_py()) for c in text])
    if _COMMA.match(sample) or (_PLAIN.match(sample) and "," in "".join(text[:200].to_pylist())):
        text = pc.replace_substring(text, ",", ".")
    numeric = pc.match_substring_regex(text, "^" + _PLAIN.pattern)
    return _as_float(pc.cast(pc.if_else(numeric, text, None), pa.float64()))


def _as_float(values: Any) -> NDArray[np.float64]:
    numbers: NDArray[np.float64] = np.array(values.to_numpy(zero_copy_only=False), float)
    numbers[~np.isfinite(numbers)] = np.nan
    return numbers


def _seconds(cell: str) -> float:
    """An ISO date and time as seconds since 1970, a time of day as seconds since midnight."""
    clock = _CLOCK.match(cell)
    if clock:
        return 3600.0 * int(clock[1]) + 60.0 * int(clock[2]) + float(clock[3].replace(",", "."))
    try:
        moment = datetime.fromisoformat(cell.replace(",", "."))
    except ValueError:
        return float("nan")
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
