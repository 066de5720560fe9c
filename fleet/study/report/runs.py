"""The runs of a study as columns, and the axes along which they differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

Column = NDArray[Any]


@dataclass(frozen=True, slots=True)
class Runs:
    """Done runs: a value a run in each column (n,), and the names of the columns that vary."""

    columns: Mapping[str, Column]
    axes: tuple[str, ...]

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def __getitem__(self, name: str) -> Column:
        return self.columns[name]

    def take(self, chosen: NDArray[Any]) -> Runs:
        """The runs of these indices, or of this mask."""
        return Runs({name: column[chosen] for name, column in self.columns.items()}, self.axes)

    def values(self, name: str) -> list[Any]:
        """The different values of a column: numbers in order, others as they first come."""
        found = list(dict.fromkeys(self.columns[name].tolist()))
        return sorted(found) if is_numeric(self.columns[name]) else found

    def groups(self, names: Sequence[str]) -> Iterator[tuple[tuple[Any, ...], Runs]]:
        """The runs apart by their values in these columns, in the order of :meth:`values`."""
        if not names:
            yield (), self
            return
        for value in self.values(names[0]):
            chosen = self.take(np.flatnonzero(self.columns[names[0]] == value))
            for rest, runs in chosen.groups(names[1:]):
                yield (value, *rest), runs


def runs_of(table: pa.Table, labels: Sequence[str]) -> Runs:
    """The runs of a table; those of its ``labels`` columns that vary are its axes."""
    columns = {name: _column(table[name]) for name in table.column_names}
    for name in labels:
        if name in columns and table[name].null_count:  # a key that not every cell sets
            values = [_named(value) for value in table[name].to_pylist()]
            columns[name] = np.array(values, object)
    return Runs(columns, tuple(_axes(columns, labels)))


def ended(runs: Runs) -> NDArray[np.bool_]:
    """Whether each run came to the end of its network, rather than to a limit (n,)."""
    return np.array([not cut_off for cut_off in runs["censored"].tolist()], bool)


def is_numeric(column: Column) -> bool:
    """Whether a column holds numbers, rather than names."""
    return column.dtype.kind in "iuf"


def _axes(columns: Mapping[str, Column], labels: Sequence[str]) -> Iterator[str]:
    """Labels that vary by themselves: one that follows from an earlier one is left out."""
    found: list[str] = []
    for name in labels:
        if name == "seed" or name not in columns or _count(columns, [name]) < 2:
            continue
        if all(_count(columns, [other]) < _count(columns, [other, name]) for other in found):
            found.append(name)
            yield name


def _count(columns: Mapping[str, Column], names: Sequence[str]) -> int:
    return len(set(zip(*(columns[name].tolist() for name in names), strict=True)))


def _named(value: Any) -> str:
    return "–" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def _column(values: pa.ChunkedArray) -> Column:
    kind = values.type
    if pa.types.is_boolean(kind):
        return np.array(["yes" if v else "no" for v in values.to_pylist()], object)
    if pa.types.is_integer(kind) and not values.null_count:
        return np.array(values.to_numpy())
    if pa.types.is_integer(kind) or pa.types.is_floating(kind):
        return np.array([np.nan if v is None else v for v in values.to_pylist()], float)
    return np.array(["–" if v is None else v for v in values.to_pylist()], object)
