"""Places from the user's files: CSV with columns x and y, in metres."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

from fleet.scenario.errors import bad
from worlds.shapes import FloatArray


def places(value: Any, key: str) -> FloatArray:
    """Positions (n, 2) [m] from the path of a CSV file, or from a list of pairs.

    Raises:
        BadInput: the file is not there, or something in it is not a place.
    """
    if isinstance(value, str):
        return read_places(Path(value), key)
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 2 or array.shape[1] != 2 or not np.isfinite(array).all():
        raise bad(key, f"is {value!r}; expected a CSV file, or a list of [x, y] pairs in metres")
    return array


def read_places(path: Path, key: str) -> FloatArray:
    """Positions (n, 2) [m] from a CSV file; a first line of names is skipped.

    Raises:
        BadInput: the file is not there, or a line of it is not a place.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file) if row]
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not text"
        raise bad(key, f"{str(path)!r} cannot be read: {reason}") from error
    found = []
    for number, row in enumerate(rows, 1):
        try:
            x, y = (float(cell) for cell in row[:2])
        except ValueError:
            if number == 1 and any(cell.strip().lower() == "x" for cell in row):
                continue
            raise bad(key, f"{path}:{number}: {','.join(row)!r}; expected x,y in metres") from None
        if not np.isfinite([x, y]).all():
            raise bad(key, f"{path}:{number}: {','.join(row)!r}; expected finite x,y in metres")
        found.append((x, y))
    if not found:
        raise bad(key, f"{path} holds no places; expected lines of x,y in metres")
    return np.array(found)
