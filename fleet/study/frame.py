"""Rows of a table as columns, picked and grouped by what they have in common."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

if TYPE_CHECKING:
    from typing import Self

    import pyarrow as pa

Values = NDArray[Any]


@dataclass(frozen=True)
class Frame:
    """Columns (n,) of n rows, by name: numbers as NumPy has them, all else as objects."""

    columns: Mapping[str, Values]

    @classmethod
    def of(cls, table: pa.Table) -> Self:
        """From an Arrow table."""
        return cls({name: _column(table[name]) for name in table.column_names})

    @classmethod
    def of_rows(cls, rows: Iterable[Mapping[str, Any]]) -> Self:
        """From one mapping a row; all have the same keys."""
        listed = list(rows)
        names = list(listed[0]) if listed else []
        return cls({name: np.array([row[name] for row in listed]) for name in names})

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def __getitem__(self, name: str) -> Values:
        return self.columns[name]

    def numbers(self, name: str) -> NDArray[np.float64]:
        """A column as floats (n,); none of no rows, whatever the columns."""
        return np.asarray(self.columns[name], float) if len(self) else np.empty(0)

    def take(self, chosen: Values) -> Self:
        """The rows of these indices, or of this mask."""
        return replace(self, columns={name: c[chosen] for name, c in self.columns.items()})

    def where(self, **same: Any) -> Self:
        """The rows whose columns have these values; floats within 1e-9."""
        chosen = np.ones(len(self), bool)
        for name, value in same.items() if len(self) else ():
            column = self.columns[name]
            chosen &= (
                np.isclose(column, value, rtol=0.0, atol=1e-9)
                if isinstance(value, float)
                else column == value
            )
        return self.take(chosen)

    def ordered(self, name: str) -> Self:
        """The same rows, by one column: for pairing by seed."""
        return self.take(np.argsort(self.columns[name], kind="stable")) if len(self) else self

    def values(self, name: str) -> list[Any]:
        """The different values of a column: numbers in order, others as they first come."""
        if not len(self):
            return []
        found = list(dict.fromkeys(self.columns[name].tolist()))
        return sorted(found) if is_numeric(self.columns[name]) else found

    def groups(self, names: Sequence[str]) -> Iterator[tuple[tuple[Any, ...], Self]]:
        """The rows apart by their values in these columns, in the order of :meth:`values`."""
        if not names:
            yield (), self
            return
        for value in self.values(names[0]):
            chosen = self.take(np.flatnonzero(self.columns[names[0]] == value))
            for rest, rows in chosen.groups(names[1:]):
                yield (value, *rest), rows


def is_numeric(column: Values) -> bool:
    """Whether a column holds numbers, rather than names."""
    return column.dtype.kind in "iuf"


def _column(values: pa.ChunkedArray) -> Values:
    kind = values.type
    if pa.types.is_boolean(kind):
        return np.array(["yes" if v else "no" for v in values.to_pylist()], object)
    if pa.types.is_integer(kind) and not values.null_count:
        return np.array(values.to_numpy())
    if pa.types.is_integer(kind) or pa.types.is_floating(kind):
        return np.array([np.nan if v is None else v for v in values.to_pylist()], float)
    return np.array(["–" if v is None else v for v in values.to_pylist()], object)
