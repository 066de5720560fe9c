"""The runs of a study as columns, and the axes along which they differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from fleet.study.frame import Frame, Values


@dataclass(frozen=True)
class Runs(Frame):
    """Done runs: a value a run in each column (n,), and the names of the columns that vary."""

    axes: tuple[str, ...] = ()


def runs_of(table: pa.Table, labels: Sequence[str]) -> Runs:
    """The runs of a table; those of its ``labels`` columns that vary are its axes."""
    columns = dict(Frame.of(table).columns)
    for name in labels:
        if name in columns and table[name].null_count:  # a key that not every cell sets
            values = [_named(value) for value in table[name].to_pylist()]
            columns[name] = np.array(values, object)
    return Runs(columns, tuple(_axes(columns, labels)))


def runs_of_rows(rows: Sequence[Mapping[str, Any]]) -> Runs:
    """The runs of rows that are nothing but labels, as a study's cells."""
    table = pa.Table.from_pylist([dict(row) for row in rows])
    return runs_of(table, table.column_names)


def ended(runs: Runs) -> NDArray[np.bool_]:
    """Whether each run came to the end of its network, rather than to a limit (n,)."""
    ended: NDArray[np.bool_] = runs["censored"] == "no"  # see fleet.study.frame
    return ended


def _axes(columns: Mapping[str, Values], labels: Sequence[str]) -> Iterator[str]:
    """Labels that vary by themselves: one that follows from an earlier one is left out."""
    found: list[str] = []
    for name in labels:
        if name == "seed" or name not in columns or _count(columns, [name]) < 2:
            continue
        if all(_count(columns, [other]) < _count(columns, [other, name]) for other in found):
            found.append(name)
            yield name


def _count(columns: Mapping[str, Values], names: Sequence[str]) -> int:
    return len(set(zip(*(columns[name].tolist() for name in names), strict=True)))


def _named(value: Any) -> str:
    return "–" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
