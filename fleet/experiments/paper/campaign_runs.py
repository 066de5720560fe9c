"""The campaign's rows, picked by what they have in common."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Results:
    """Runs as columns: a label of what was run, and the figures of its summary."""

    def __init__(self, columns: Mapping[str, NDArray[Any]]) -> None:
        self._columns = dict(columns)

    @classmethod
    def of(cls, rows: Iterable[Mapping[str, Any]]) -> Results:
        """From one mapping a run; all have the same keys."""
        listed = list(rows)
        names = list(listed[0]) if listed else []
        return cls({name: np.array([row[name] for row in listed]) for name in names})

    def __len__(self) -> int:
        return len(next(iter(self._columns.values()), ()))

    def where(self, **same: Any) -> Results:
        """Those runs whose columns have these values; floats within 1e-9."""
        chosen = np.ones(len(self), bool)
        for name, value in same.items():
            column = self._columns[name] if len(self) else np.empty(0)
            chosen &= np.isclose(column, value) if isinstance(value, float) else column == value
        return self.chosen(chosen)

    def chosen(self, which: NDArray[np.bool_]) -> Results:
        """Those runs that ``which`` is true of (runs,)."""
        return Results({name: column[which] for name, column in self._columns.items()})

    def values(self, name: str) -> NDArray[np.float64]:
        """One column (runs,)."""
        if not len(self):
            return np.empty(0)
        return np.asarray(self._columns[name], dtype=float)

    def distinct(self, name: str) -> list[Any]:
        """The values that a column takes, ascending."""
        found: list[Any] = np.unique(self._columns[name]).tolist() if len(self) else []
        return found

    def per_event(self) -> NDArray[np.float64]:
        """Messages a round of each run (runs,)."""
        return self.values("messages") / np.maximum(self.values("events"), 1)

    def ordered(self, name: str) -> Results:
        """The same runs, by one column: for pairing by seed."""
        order = np.argsort(self._columns[name], kind="stable") if len(self) else np.empty(0, int)
        return Results({key: column[order] for key, column in self._columns.items()})
