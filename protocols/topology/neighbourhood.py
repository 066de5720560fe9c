"""The arrays that the compiled topology works on, and the calls that keep them.

Importing this module loads numba.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from protocols.compiled import direct
from protocols.messages import Point, RobotId
from protocols.topology.cells import cells_over
from protocols.topology.relinking import GABRIEL, RNG, UDG, Adjacency, relink, relink_all

GRAPHS = {"udg": UDG, "gabriel": GABRIEL, "rng": RNG}


class Neighbourhood:
    """Adjacency by robot, over a grid of cells; one moved robot is relinked locally."""

    def __init__(self, positions: Sequence[Point], radio_range: float, graph: str) -> None:
        n = len(positions)
        self._relink = relink
        self._cells = cells_over(positions, 0.5 * radio_range)
        self._links = Adjacency(
            GRAPHS[graph],
            float(radio_range),
            np.zeros((n, 16), np.int64),
            np.zeros(n, np.int64),
            np.zeros(n + 1, np.int64),
        )
        self.move_all(range(n), positions)
        if n:
            self.move(0, positions[0])
        self._relink = direct(relink)

    def of(self, robot: RobotId) -> list[RobotId]:
        """The robot's neighbours, ascending."""
        listed: list[RobotId] = self._links.table[robot, : self._links.degree[robot]].tolist()
        listed.sort()
        return listed

    def move(self, robot: RobotId, position: Point) -> list[RobotId]:
        """Relink; returns the moved robot, its neighbours, and all whose links differ now."""
        while True:
            changes = self._relink(self._links, self._cells, robot, position[0], position[1])
            if changes >= 0:
                changed: list[RobotId] = self._links.changed[:changes].tolist()
                return changed
            self._widen()

    def move_all(self, robots: Sequence[RobotId], positions: Sequence[Point]) -> list[RobotId]:
        """Relink them all, one after another; returns as :meth:`move` does, each once."""
        ids, places = np.array(robots, np.int64), np.array(positions, float).reshape(-1, 2)
        dirty = np.zeros(len(self._links.degree), np.bool_)
        done = 0
        while True:
            done = relink_all(self._links, self._cells, done, ids, places, dirty)
            if done == len(ids):
                touched: list[RobotId] = np.flatnonzero(dirty).tolist()
                return touched
            self._widen()

    def _widen(self) -> None:
        """Room for twice as many links a robot."""
        table = self._links.table
        self._links = self._links._replace(table=np.hstack([table, np.zeros_like(table)]))
