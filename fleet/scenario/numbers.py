"""Tables of numbers from the user's CSV files: places, and traces of events."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

from fleet.scenario.errors import bad
from worlds.shapes import FloatArray

COLUMNS = (("x", "y"), ("time", "x", "y", "service", "deadline"))
"""What the columns of the user's tables may be called: places, and traces of events."""


def numbers(value: Any, key: str) -> FloatArray:
    """A table (n, columns) from the path of a CSV file, or from a list of rows.

    Cells left empty, and rows that end early, are NaN from the third column on.

    Raises:
        BadInput: the file is not there, or something in it is not a number.
    """
    if isinstance(value, str):
        return read_numbers(Path(value), key)
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 2 or array.shape[1] < 2 or not np.isfinite(array).all():
        raise bad(key, f"is {value!r}; expected a CSV file, or a list of rows of numbers")
    return array


def read_numbers(path: Path, key: str) -> FloatArray:
    """The numbers of a CSV file (n, columns); a first line may name the columns, in their order.

    Raises:
        BadInput: the file is not there, or a line of it holds something else.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file) if row]
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not text"
        raise bad(key, f"{str(path)!r} cannot be read: {reason}") from error
    if rows and not any(map(_is_number, rows[0])):
        _check_names([name.strip().lower() for name in rows.pop(0)], path, key)
    found = []
    for number, row in enumerate(rows, 1):
        cells = [cell.strip() for cell in row]
        if len(cells) < 2 or not all(
            _is_number(c) or (k > 1 and not c) for k, c in enumerate(cells)
        ):
            raise bad(key, f"{path}: row {number} is {','.join(row)!r}; expected numbers")
        found.append([float(cell) if cell else np.nan for cell in cells])
    if not found:
        raise bad(key, f"{path} holds no rows; expected lines of numbers")
    width = max(map(len, found))
    return np.array([row + [np.nan] * (width - len(row)) for row in found])


def _check_names(names: list[str], path: Path, key: str) -> None:
    for known in COLUMNS:
        if names == list(known[: len(names)]):
            return
    expected = " or ".join(",".join(known) for known in COLUMNS)
    raise bad(key, f"{path}: the columns are {','.join(names)}; expected {expected}, or no names")


def _is_number(cell: str) -> bool:
    try:
        return bool(np.isfinite(float(cell)))
    except ValueError:
        return False
