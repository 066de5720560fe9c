"""The campaign's runs as columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fleet.study.frame import Frame


@dataclass(frozen=True)
class Results(Frame):
    """Runs (n,): a label of what was run, and the figures of its summary."""

    def per_event(self) -> NDArray[np.float64]:
        """Messages an event of each run (n,)."""
        return self.numbers("messages") / np.maximum(self.numbers("events"), 1)
