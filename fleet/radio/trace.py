"""Links from measurements: which share of frames gets from one robot to another, and from when.

What was not measured does not get through. Frames are repeated and neighbours heard of as over
the lossy radio; only chance is another.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fleet.agenda import Agenda
from fleet.radio.hearsay import Scattered
from fleet.radio.lossy import LossyRadio, Repetition
from worlds.shapes import FloatArray, LinkTable

if TYPE_CHECKING:
    from fleet.radio.propagation import Air

MOST_ROBOTS = 5000  # whose pairs fit into memory


@dataclass(frozen=True, kw_only=True)
class TraceSpec(Repetition):
    """The links, and how frames are repeated: see the base class, too.

    Raises:
        ValueError: a value is out of its range.
    """

    links: LinkTable  # from, to, ratio and time [s]; without a time: from the start

    def __post_init__(self) -> None:
        Repetition.__post_init__(self)
        links = self.links
        for row, (u, v, ratio) in enumerate(links[:, :3].tolist(), 1):
            ids = u == int(u) >= 0 and v == int(v) >= 0 and u != v
            if not ids or not 0.0 <= ratio <= 1.0:
                raise ValueError(
                    f"radio links: row {row} is from {u:g} to {v:g} with ratio {ratio:g};"
                    f" expected two robots, and 0 to 1"
                )

    def over(self, fleet: Scattered, seed: int, agenda: Agenda) -> TraceRadio:
        """The radio of this kind among these robots; see the base class."""
        return TraceRadio(self, fleet, seed, agenda)

    def air(self, fleet: Scattered, seed: int) -> Air:
        """Nothing gets through that is not in the table.

        Raises:
            ValueError: there are too many robots, or the table names others.
        """
        n = len(fleet.points)
        if n > MOST_ROBOTS:
            raise ValueError(f"links between {n} robots are too many; expected {MOST_ROBOTS}")
        most = int(self.links[:, :2].max())
        if most >= n:
            raise ValueError(f"links names robot {most}; expected 0 to {n - 1}")
        air = Repetition.air(self, fleet, seed)
        return air._replace(ratios=np.zeros((n, n), np.float32))


class TraceRadio(LossyRadio[TraceSpec]):
    """The air as it was measured."""

    def __init__(self, spec: TraceSpec, fleet: Scattered, seed: int, agenda: Agenda) -> None:
        links = spec.links
        time = links[:, 3] if links.shape[1] > 3 else np.zeros(len(links))
        time = np.nan_to_num(time)
        order = np.argsort(time, kind="stable")
        self._rows: FloatArray = links[order]
        self._times = time[order]
        self._passed = 0
        super().__init__(spec, fleet, seed, agenda)

    def _announce(self, time: float) -> None:
        """Links are as they were measured last; beacons are sent over them one by one."""
        while self._passed < len(self._times) and self._times[self._passed] <= time:
            if self._times[self._passed] > 0.0:  # before the start all is as it is then
                super()._announce(float(self._times[self._passed]))
            last = int(np.searchsorted(self._times, self._times[self._passed], "right"))
            u, v, ratio = self._rows[self._passed : last, :3].T
            self.air.ratios[u.astype(int), v.astype(int)] = ratio
            self._passed = last
        super()._announce(time)
