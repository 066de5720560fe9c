"""Walls that weaken what is sent through them.

Importing this module loads numba.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from protocols.compiled import kernel
from worlds.arena import Arena

FINEST = 0.05  # side of a cell [m], if the floor has no more of them than:
MOST_CELLS = 4_000_000


class Walls(NamedTuple):
    """What stands on the floor, as the cells that it covers."""

    loss: float  # for each that a link passes through [dB]
    size: float  # of a cell [m]
    covered: NDArray[np.bool_]  # (rows, columns)


def walls(arena: Arena, loss: float) -> Walls:
    """The arena's obstacles, each of which takes ``loss`` [dB] off a link through it."""
    from PIL import Image, ImageDraw

    if loss <= 0.0 or not arena.obstacles:
        return Walls(0.0, 1.0, np.zeros((0, 0), np.bool_))
    size = max(FINEST, math.sqrt(arena.width * arena.height / MOST_CELLS))
    rows, columns = math.ceil(arena.height / size), math.ceil(arena.width / size)
    covered = Image.new("1", (columns, rows))
    pen = ImageDraw.Draw(covered)
    for obstacle in arena.obstacles:
        corners = np.array(obstacle.corners) / size - 0.5  # a pixel's middle is at whole numbers
        pen.polygon([(x, y) for x, y in corners.tolist()], fill=1, outline=1)
    return Walls(loss, size, np.array(covered, np.bool_))


@kernel
def crossings(walls: Walls, ax: float, ay: float, bx: float, by: float) -> int:
    """How many obstacles the line from a to b [m] passes through, looked at every half cell."""
    if walls.loss <= 0.0:
        return 0
    rows, columns = walls.covered.shape
    steps = int(math.hypot(bx - ax, by - ay) / (0.5 * walls.size)) + 1
    count, inside = 0, False
    for k in range(steps + 1):
        share = k / steps
        column = int((ax + share * (bx - ax)) / walls.size)
        row = int((ay + share * (by - ay)) / walls.size)
        here = False
        if 0 <= row < rows and 0 <= column < columns:
            here = walls.covered[row, column]
        if here and not inside:
            count += 1
        inside = here
    return count
