"""The user's tables of places and events: text files with a row a line, as spreadsheets, loggers
and robots write them.

Columns go by their names, wherever they stand, or by their order if there are none. What parts
cells (comma, semicolon, tab, bar or spaces), decimal commas, comments, byte-order marks and line
ends are found out. A value that is no number, and a place that is nowhere, is refused with its
line.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from datetime import datetime, time
from math import inf, isfinite, nan
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fleet.scenario.errors import bad, shown
from fleet.scenario.movingai import trips
from fleet.scenario.reading import read_text
from worlds.shapes import FloatArray

COMMENTS = ("#", "%", "//")
ALIASES = {
    "t": "time", "timestamp": "time", "stamp": "time", "secs": "time", "seconds": "time",
    "pos_x": "x", "position_x": "x", "position.x": "x", "pose.position.x": "x",
    "pos_y": "y", "position_y": "y", "position.y": "y", "pose.position.y": "y",
    "service_time": "service",
}  # fmt: skip
UNIT = re.compile(r"\s*[\[(].*?[\])]\s*$|_(m|s|sec)$")
NEEDED = ("x", "y", "from", "to", "ratio")  # where a table has such columns
EPOCH = 1e8  # [s] from which on times count from 1970: a run is never that long
TICKS = ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3), (EPOCH, 1.0))  # from where on, [s]
MOST = 1e12  # of any other number
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+([eE][-+]?\d+)?|[-+]?\d+")


class _Line(NamedTuple):
    number: int  # in the file, from 1
    text: str


def numbers(value: Any, columns: tuple[str, ...], key: str) -> FloatArray:
    """A table (n, columns) from the path of a file, or from a list of rows of numbers.

    NaN: the file does not say; x and y always are said. Times count from the first if they are
    dates, or seconds or ticks since 1970. Of a MovingAI scenario (``.scen``) places are where its
    trips start, and events where they lead to, in cells.

    Raises:
        BadInput: the file is not there, or something in it is not a number.
    """
    if isinstance(value, str):
        path = Path(value)
        if path.suffix.lower() == ".scen":
            return trips(path, columns, key)
        return _table(_lines(path, key), columns, path, key)
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        array = np.empty(0)
    least = 1 + max(map(columns.index, _needed(columns)))
    if array.ndim != 2 or not least <= array.shape[1] <= len(columns) or not array.size:
        array = np.full((1, 1), nan)
    if not (np.abs(array) <= MOST).all():
        raise bad(
            key, f"is {shown(value)}; expected the path of a table, or rows of {_listed(columns)}"
        )
    return array


def _needed(columns: Sequence[str]) -> set[str]:
    """Those that a table of these columns cannot do without."""
    return {name for name in columns if name in NEEDED}


def _lines(path: Path, key: str) -> list[_Line]:
    """What the file holds but for empty lines."""
    rows = read_text(path, key).split("\n")
    return [_Line(k, row) for k, row in enumerate(rows, 1) if row.strip(" \t,;|")]


def _table(lines: Sequence[_Line], columns: tuple[str, ...], path: Path, key: str) -> FloatArray:
    rows = [line for line in lines if not line.text.lstrip().startswith(COMMENTS)]
    if not rows:
        raise bad(key, f"{path}: holds no rows; expected {_listed(columns)}")
    mark = _mark([line.text for line in rows[:20]])
    head = _cells(rows[0], mark, path, key)
    places: dict[str, int]
    if not any(_is_value(cell, mark) for cell in head):
        places, rows = _by_name(head, columns, f"{path}:{rows[0].number}", key), rows[1:]
    elif (named := _commented_names(lines, rows[0], columns, mark, path, key)) is not None:
        places = named
    else:
        places = _by_order(len(head), columns, f"{path}:{rows[0].number}", key)
    if not rows:
        raise bad(key, f"{path}: holds no rows but the names of its columns")
    found = np.full((len(rows), len(columns)), nan)
    for k, line in enumerate(rows):
        cells = _cells(line, mark, path, key)
        for column, at in places.items():
            if column != "time":
                cell = cells[at] if at < len(cells) else ""
                said = f"{path}:{line.number}: {column} is {shown(cell)}"
                found[k, columns.index(column)] = _value(cell, column, mark, said, key)
    if "time" in places:
        cells = [_cell(line, places["time"], mark, path, key) for line in rows]
        found[:, columns.index("time")] = _times(cells, [r.number for r in rows], mark, path, key)
    return found


def _mark(rows: Sequence[str]) -> str:
    """What parts the cells of these rows; a space: any number of spaces."""
    for mark in ";\t|":
        if all(mark in row for row in rows):
            return mark
    parts = rows[-1].split()
    spaced = len(parts) > 1 and all(DECIMAL_COMMA.fullmatch(part) for part in parts)
    return "," if not spaced and all("," in row for row in rows) else " "


def _cells(line: _Line, mark: str, path: Path, key: str) -> list[str]:
    if mark == " ":
        return line.text.split()
    try:
        return [cell.strip() for cell in next(csv.reader([line.text], delimiter=mark))]
    except csv.Error as error:
        raise bad(key, f"{path}:{line.number}: cannot be read: {error}") from error


def _cell(line: _Line, at: int, mark: str, path: Path, key: str) -> str:
    cells = _cells(line, mark, path, key)
    return cells[at] if at < len(cells) else ""


def _plain(name: str) -> str:
    """A column's name without its unit, case, and comment mark."""
    name = UNIT.sub("", name.strip().strip("#%").strip().lower()).strip()
    return ALIASES.get(name, name)


def _by_name(head: Sequence[str], columns: tuple[str, ...], place: str, key: str) -> dict[str, int]:
    """Where each of the ``columns`` stands that are there; others are passed over."""
    names = [_plain(name) for name in head]
    said = f"{place}: the columns are {shown(','.join(head))}"
    if missing := sorted(_needed(columns) - set(names)):
        raise bad(key, f"{said}; expected {_listed(columns)}: {missing[0]} is missing")
    for name in columns:
        if names.count(name) > 1:
            raise bad(key, f"{said}; expected {name} once")
    return {name: names.index(name) for name in columns if name in names}


def _commented_names(
    lines: Sequence[_Line], first: _Line, columns: tuple[str, ...], mark: str, path: Path, key: str
) -> dict[str, int] | None:
    """The columns by the last comment before the rows, if that names them."""
    before = [line for line in lines if line.number < first.number]
    if not before:
        return None
    text = before[-1].text.lstrip().lstrip("#%/ ")
    head = _cells(_Line(before[-1].number, text), mark, path, key)
    if not _needed(columns) <= {_plain(name) for name in head}:
        return None
    return _by_name(head, columns, f"{path}:{before[-1].number}", key)


def _by_order(count: int, columns: tuple[str, ...], place: str, key: str) -> dict[str, int]:
    least = 1 + max(map(columns.index, _needed(columns)))
    if not least <= count <= len(columns):
        raise bad(
            key,
            f"{place}: has {count} cells, and there is no line that names them;"
            f" expected {_listed(columns)}",
        )
    return {name: at for at, name in enumerate(columns[:count])}


def _listed(columns: tuple[str, ...]) -> str:
    """The columns, as a sentence names them."""
    last = columns.index("y") + 1
    rest = columns[last:]
    return ",".join(columns[:last]) + (f", and if wanted {' and '.join(rest)}" if rest else "")


def _number(cell: str, mark: str) -> float:
    """NaN: it is none."""
    if mark != "," and DECIMAL_COMMA.fullmatch(cell):
        cell = cell.replace(",", ".")
    try:
        return float(cell) if "_" not in cell else nan
    except ValueError:
        return nan


def _is_value(cell: str, mark: str) -> bool:
    """Whether a cell belongs to a row, not to a line of names."""
    return isfinite(_number(cell, mark)) or _moment(cell) is not None or cell.lower() == "nan"


def _value(cell: str, column: str, mark: str, said: str, key: str) -> float:
    """The number in a cell; NaN if it is empty and may be."""
    if column not in NEEDED and cell.lower() in {"", "nan"}:
        return nan
    value = _number(cell, mark)
    if column == "deadline" and value == inf:
        return inf
    if not abs(value) <= MOST:
        raise bad(key, f"{said}; expected a number")
    if column == "service" and value < 0.0:
        raise bad(key, f"{said}; expected 0 s or more")
    if column == "deadline" and value <= 0.0:
        raise bad(key, f"{said}; expected more than 0 s")
    return value


def _times(
    cells: Sequence[str], rows: Sequence[int], mark: str, path: Path, key: str
) -> FloatArray:
    """Times [s]: as they are, or from the first if they are dates or count from 1970."""
    if not any(cells):
        return np.full(len(cells), nan)
    times = np.array([_number(cell, mark) for cell in cells])
    dates = [_moment(cell) for cell in cells] if np.isnan(times).any() else []
    zoned = {date.tzinfo is None for date in dates if date is not None}
    for k, (cell, row) in enumerate(zip(cells, rows, strict=True)):
        known = dates[k] is not None if dates and _moment(cells[0]) else isfinite(times[k])
        if not known or len(zoned) > 1:
            alike = " in all rows, with or without a time zone" if len(zoned) > 1 else ""
            raise bad(
                key,
                f"{path}:{row}: time is {shown(cell)}; expected seconds, or a date and time as"
                f" 2021-09-13T12:00:00{alike}",
            )
    known_dates = [date for date in dates if date is not None]
    if known_dates:
        first = min(known_dates)
        return np.array([(date - first).total_seconds() for date in known_dates])
    for least, tick in TICKS:
        if times.min() >= least:
            return np.asarray((times - times.min()) * tick)
    return times


def _moment(cell: str) -> datetime | None:
    """A date and time as of ISO 8601, or a time of the day; None: it is neither."""
    try:
        return datetime.fromisoformat(cell)  # zones are compared by the caller
    except ValueError:
        pass
    try:
        if ":" not in cell:
            return None
        return datetime.combine(datetime(2000, 1, 1), time.fromisoformat(cell))  # noqa: DTZ001
    except ValueError:
        return None
