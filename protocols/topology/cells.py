"""A grid of cells over the plane, so that who is near is found without asking everybody.

Importing this module loads numba.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, sqrt

import numpy as np

from protocols.messages import Point, RobotId
from protocols.topology.relinking import move_cell


class Cells:
    """Positions of a fleet as arrays, and the robots of each cell as linked lists.

    ``x``, ``y`` (n,) [m], NaN for who is nowhere; ``head`` (cells,), ``after`` (n,) and ``grid``
    [x0, y0, size, columns, rows] as kernels take them; ``marked`` (n,) and ``near`` (n + 1,)
    are their work space.
    """

    def __init__(self, positions: Sequence[Point], size: float) -> None:
        """Lay cells of ``size`` [m] over the positions, but no more than about one a robot."""
        n = len(positions)
        places = np.array(positions, float).reshape(-1, 2)
        known = places[~np.isnan(places).any(axis=1)]
        low = known.min(axis=0) if len(known) else np.zeros(2)
        span = np.maximum((known.max(axis=0) if len(known) else low) - low, 1e-9)
        side = max(size, sqrt(span[0] * span[1] / max(n, 1)))
        columns, rows = (max(1, ceil(length / side)) for length in span.tolist())
        self.grid = np.array([low[0], low[1], side, columns, rows], float)
        self.head = np.full(columns * rows, -1, np.int64)
        self.after = np.full(n, -1, np.int64)
        self.x, self.y = np.full(n, np.nan), np.full(n, np.nan)
        self.marked = np.zeros(n, np.bool_)
        self.near = np.zeros(n + 1, np.int64)

    def move(self, robot: RobotId, position: Point) -> None:
        """The robot is at ``position`` [m] now; NaN: nowhere."""
        x, y = position
        move_cell(robot, x, y, self.x, self.y, self.head, self.after, self.grid)
