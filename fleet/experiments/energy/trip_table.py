"""Trips as columns: what Eq. (1) says of each, what it took, and what for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fleet.study.frame import Frame

FloatArray = NDArray[np.float64]

PARTS = ("detour", "launch", "scrub", "waiting", "contact")
"""What a trip takes beyond Eq. (1) on the straight line."""


@dataclass(frozen=True)
class TripTable(Frame):
    """Trips (n,): the table that the work functions fill, with the labels."""

    def arrived(self) -> TripTable:
        """Those that came to their site."""
        return self.where(outcome="arrived")

    def by_distance(self, edges: Sequence[float]) -> Iterator[tuple[float, float, TripTable]]:
        """Those from one edge [m] of straight distance to the next, with both edges."""
        for low, high in pairwise(edges):
            straight = self["straight"]
            yield low, high, self.take((straight >= low) & (straight < high))

    @property
    def eq1(self) -> FloatArray:
        """Eq. (1) on the straight line from start to site (n,) [J]."""
        return np.asarray(self["per_metre"] * self["straight"])

    def part(self, name: str) -> FloatArray:
        """What was drained for one of the :data:`PARTS` (n,) [J]."""
        if name == "detour":
            return np.asarray(self["energy_path"] - self.eq1)
        return np.asarray(self[f"energy_{name}"])

    @property
    def parts_sum(self) -> FloatArray:
        """Eq. (1) and all parts (n,) [J]: what a trip took, if the account is complete."""
        return np.asarray(self.eq1 + sum(self.part(name) for name in PARTS))


def closure(trips: TripTable) -> float:
    """The largest share of a trip's energy that its parts leave unexplained.

    The parts are the motion's account, the energy is what the battery lost.
    """
    if not len(trips):
        return 0.0
    gap = np.abs(trips.parts_sum - trips["drained"])
    return float((gap / np.maximum(trips["drained"], 1e-9)).max())
