"""The arrays that the compiled topology works on, and the calls that keep them.

Importing this module loads numba.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from protocols.messages import Point, RobotId
from protocols.topology.cells import Cells
from protocols.topology.relinking import GABRIEL, RNG, UDG, relink, relink_all

GRAPHS = {"udg": UDG, "gabriel": GABRIEL, "rng": RNG}


class Neighbourhood:
    """Adjacency by robot, over a grid of cells; one moved robot is relinked locally."""

    def __init__(self, positions: Sequence[Point], radio_range: float, graph: str) -> None:
        self._graph = GRAPHS[graph]
        self._range = radio_range
        n = len(positions)
        self._cells = Cells(positions, 0.5 * radio_range)
        self._degree = np.zeros(n, np.int64)
        self._links = np.zeros((n, 16), np.int64)
        self._changed = np.zeros(n + 1, np.int64)
        self.move_all(range(n), positions)

    def of(self, robot: RobotId) -> list[RobotId]:
        """The robot's neighbours, ascending."""
        listed: list[RobotId] = self._links[robot, : self._degree[robot]].tolist()
        listed.sort()
        return listed

    def move(self, robot: RobotId, position: Point) -> list[RobotId]:
        """Relink; returns the moved robot, its neighbours, and all whose links differ now."""
        cells = self._cells
        while True:
            changes = relink(
                robot, position[0], position[1], self._graph, self._range,
                cells.x, cells.y, self._links, self._degree,
                cells.head, cells.after, cells.grid,
                cells.marked, cells.near, self._changed,
            )  # fmt: skip
            if changes >= 0:
                changed: list[RobotId] = self._changed[:changes].tolist()
                return changed
            self._widen()

    def move_all(self, robots: Sequence[RobotId], positions: Sequence[Point]) -> list[RobotId]:
        """Relink them all, one after another; returns as :meth:`move` does, each once."""
        cells = self._cells
        ids, places = np.array(robots, np.int64), np.array(positions, float).reshape(-1, 2)
        dirty = np.zeros(len(self._degree), np.bool_)
        done = 0
        while True:
            done = relink_all(
                done, ids, places, self._graph, self._range,
                cells.x, cells.y, self._links, self._degree,
                cells.head, cells.after, cells.grid,
                cells.marked, cells.near, self._changed, dirty,
            )  # fmt: skip
            if done == len(ids):
                touched: list[RobotId] = np.flatnonzero(dirty).tolist()
                return touched
            self._widen()

    def _widen(self) -> None:
        """Room for twice as many links a robot."""
        self._links = np.hstack([self._links, np.zeros_like(self._links)])
