"""The campaign's runs as columns."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fleet.study.frame import Frame


@dataclass(frozen=True)
class Results(Frame):
    """Runs (n,): a label of what was run, and the figures of its summary."""

    def per_event(self) -> NDArray[np.float64]:
        """Messages an event of each run (n,)."""
        return self.numbers("messages") / np.maximum(self.numbers("events"), 1)

    def hops(self) -> NDArray[np.float64]:
        """Routing steps an event of each run (n,)."""
        steps = self.numbers("hops_greedy") + self.numbers("hops_face")
        return np.asarray(steps / np.maximum(self.numbers("events"), 1))

    def with_rows_of(self, other: Results) -> Results:
        """These runs, and then the others."""
        if not len(self) or not len(other):
            return self if len(self) else other
        both = {name: np.concatenate([c, other[name]]) for name, c in self.columns.items()}
        return replace(self, columns=both)
