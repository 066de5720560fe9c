"""What the report shows: numbers, how they are drawn, and what is said of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from fleet.study.report.csv_files import write_csv
from fleet.study.statistics import Interval


@dataclass(frozen=True, slots=True)
class Column:
    """A column of an exhibit's table: its name with its unit, and how numbers are written."""

    name: str
    style: str = ""  # of format()


@dataclass(frozen=True, slots=True)
class Exhibit:
    """A figure, the numbers that it shows, and a caption."""

    name: str  # of its files
    caption: str
    columns: Sequence[Column]
    rows: Sequence[Sequence[Any]]
    figure: Figure | None = None

    def write_csv(self, folder: Path) -> None:
        """The numbers as they are; an interval takes three columns."""
        wide = [isinstance(value, Interval) for value in self.rows[0]] if self.rows else []
        head = [
            name
            for column, interval in zip(self.columns, wide, strict=True)
            for name in (
                [column.name, f"{column.name}, low", f"{column.name}, high"]
                if interval
                else [column.name]
            )
        ]
        lines = (
            [x for v in row for x in (v if isinstance(v, Interval) else [v])] for row in self.rows
        )
        write_csv(folder / f"{self.name}.csv", head, lines)

    def cells(self) -> list[list[str]]:
        """The rows as the page has them."""
        return [
            [written(value, column.style) for value, column in zip(row, self.columns, strict=True)]
            for row in self.rows
        ]


def written(value: Any, style: str) -> str:
    """A value for people: an interval as its estimate with its bounds."""
    if isinstance(value, Interval):
        if not isfinite(value.value):
            return "–"
        if not isfinite(value.low):
            return signed(value.value, style)
        return "{} [{}, {}]".format(*(signed(part, style) for part in value))
    if isinstance(value, float):
        return signed(value, style) if isfinite(value) else "–"
    return format(value, style if isinstance(value, int) else "")


def signed(value: float, style: str) -> str:
    """A number with a minus sign for a hyphen, and none before nothing."""
    text = format(value, style)
    nothing = not any(digit in text for digit in "123456789")
    return text.replace("-", "" if nothing else "−")
