"""The arrays that the compiled topology works on, and the calls that keep them.

Importing this module loads numba.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, sqrt

import numpy as np

from protocols.messages import Point, RobotId
from protocols.relink import GABRIEL, RNG, UDG, relink

GRAPHS = {"udg": UDG, "gabriel": GABRIEL, "rng": RNG}


class Neighbourhood:
    """Adjacency by robot, over a grid of cells; one moved robot is relinked locally."""

    def __init__(self, positions: Sequence[Point], radio_range: float, graph: str) -> None:
        self._graph = GRAPHS[graph]
        self._range = radio_range
        n = len(positions)
        self._x, self._y = np.full(n, np.nan), np.full(n, np.nan)
        self._degree = np.zeros(n, np.int64)
        self._links = np.zeros((n, 16), np.int64)
        self._lay_grid(np.array(positions, float).reshape(-1, 2))
        self._marked = np.zeros(n, np.bool_)
        self._near = np.zeros(n + 1, np.int64)
        self._changed = np.zeros(n + 1, np.int64)
        for robot, position in enumerate(positions):
            self.move(robot, position)

    def of(self, robot: RobotId) -> list[RobotId]:
        """The robot's neighbours, ascending."""
        listed: list[RobotId] = self._links[robot, : self._degree[robot]].tolist()
        listed.sort()
        return listed

    def move(self, robot: RobotId, position: Point) -> list[RobotId]:
        """Relink; returns the robots whose neighbours differ now, the moved one first."""
        while True:
            changes = relink(
                robot, position[0], position[1], self._graph, self._range,
                self._x, self._y, self._links, self._degree,
                self._head, self._after, self._grid,
                self._marked, self._near, self._changed,
            )  # fmt: skip
            if changes >= 0:
                changed: list[RobotId] = self._changed[:changes].tolist()
                return changed
            self._links = np.hstack([self._links, np.zeros_like(self._links)])

    def _lay_grid(self, positions: np.ndarray) -> None:
        """Cells of half a range, but no more than about one a robot."""
        known = positions[~np.isnan(positions).any(axis=1)]
        low = known.min(axis=0) if len(known) else np.zeros(2)
        span = np.maximum((known.max(axis=0) if len(known) else low) - low, 1e-9)
        size = max(0.5 * self._range, sqrt(span[0] * span[1] / max(len(positions), 1)))
        columns, rows = (max(1, ceil(side / size)) for side in span)
        self._grid = np.array([low[0], low[1], size, columns, rows], float)
        self._head = np.full(columns * rows, -1, np.int64)
        self._after = np.full(len(positions), -1, np.int64)
