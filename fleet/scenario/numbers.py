"""Tables of numbers from the user's CSV files: places, and traces of events."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fleet.scenario.errors import bad, shortened, shown
from fleet.scenario.reading import read_text
from worlds.shapes import FloatArray

COLUMNS = (("x", "y"), ("time", "x", "y", "service", "deadline"))
"""What the columns of the user's tables may be called: places, and traces of events."""

MOST = 1e12  # of any number
MOST_CHARACTERS = 10_000  # of one line; a row of five numbers has a hundred


def numbers(value: Any, key: str) -> FloatArray:
    """A table (n, columns) from the path of a CSV file, or from a list of rows.

    Cells left empty, and rows that end early, are NaN from the fourth column on.

    Raises:
        BadInput: the file is not there, or something in it is not a number.
    """
    if isinstance(value, str):
        return read_numbers(Path(value), key)
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        array = np.empty(0)
    if array.ndim != 2 or array.shape[1] < 2 or not np.isfinite(array).all():
        raise bad(key, f"is {shown(value)}; expected a CSV file, or a list of rows of numbers")
    return array


def read_numbers(path: Path, key: str) -> FloatArray:
    """The numbers of a CSV file (n, columns); a first line may name the columns, in their order.

    Cells are parted by commas; or by semicolons or tabs, where decimal commas are read as well.
    Lines that are empty or begin with ``#`` are passed over.

    Raises:
        BadInput: the file is not there, or a line of it holds something else.
    """
    said = shortened(str(path), 100)
    found: list[list[float]] = []
    parting = ""
    for number, line in enumerate(read_text(path, key).split("\n"), 1):
        if not line.strip(" ,;\t") or line.startswith("#"):
            continue
        if len(line) > MOST_CHARACTERS:
            raise bad(key, f"{said}:{number}: is {len(line)} characters long; expected a row")
        if not parting:
            parting = next((mark for mark in ";\t" if mark in line), ",")
            cells = _cells(line, parting)
            if not any(cell and _number(cell) is not None for cell in cells):
                _check_names([cell.lower() for cell in cells], f"{said}:{number}", key)
                continue
        row = _row(_cells(line, parting))
        if (
            row is None
            or len(row) < min(3, len(found[0]) if found else 0)
            or not abs(np.nan_to_num(row)).max() <= 1e12
        ):
            raise bad(key, f"{said}:{number}: is {shown(line)}; expected numbers{_hint(line)}")
        found.append(row)
    if not found:
        raise bad(key, f"{said} holds no rows; expected lines of numbers")
    width = max(map(len, found))
    return np.array([row + [np.nan] * (width - len(row)) for row in found])


def _cells(line: str, parting: str) -> list[str]:
    cells = [cell.strip() for cell in next(csv.reader([line], delimiter=parting))]
    return cells if parting == "," else [cell.replace(",", ".") for cell in cells]


def _row(cells: Sequence[str]) -> list[float] | None:
    """The numbers of a row; None if one of them is none. Only the fourth on may be left empty."""
    found = [np.nan if k > 2 and not cell else _number(cell) for k, cell in enumerate(cells)]
    if len(found) < 2:
        return None
    kept = [number for number in found if number is not None]
    return kept if len(kept) == len(found) else None


def _hint(line: str) -> str:
    """What may have been meant by a row that holds no numbers."""
    return " with decimal points, or cells parted by semicolons" if line.count(",") > 2 else ""


def _check_names(names: list[str], place: str, key: str) -> None:
    for known in COLUMNS:
        if len(names) > 1 and names == list(known[: len(names)]):
            return
    said = shortened(",".join(names), 60)
    expected = " or ".join(",".join(known) for known in COLUMNS)
    raise bad(key, f"{place}: the columns are {said}; expected {expected}, or no names")


def _number(cell: str) -> float | None:
    try:
        number = float(cell)
    except ValueError:
        return None
    return number if np.isfinite(number) else None
