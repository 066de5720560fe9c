"""Occupancy maps: floors as robots that map them write them down, cell by cell."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from worlds.arena import ImpossibleWorld
from worlds.outlines import polygons
from worlds.shapes import Corner, Polygon

OCCUPIED, FREE, UNKNOWN = 100, 0, -1  # as in nav_msgs/OccupancyGrid
SMALL = 0.05  # share of the largest free area below which another one is filled


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyGrid:
    """What is known of each cell of a rectangular floor.

    Raises:
        ValueError: there are no cells, or the resolution is not positive.
    """

    cells: NDArray[np.int8]  # (rows, columns), of the three above; the first row is the lowest
    resolution: float  # side of a cell [m]
    corner: Corner = (0.0, 0.0)  # where the lower left corner lies in the frame of the map [m]
    notices: tuple[str, ...] = ()  # what its author may want to know

    def __post_init__(self) -> None:
        if self.cells.ndim != 2 or self.cells.size == 0:
            raise ValueError(f"a map of shape {self.cells.shape}; expected rows and columns")
        if not 0.0 < self.resolution < np.inf:
            raise ValueError(f"resolution is {self.resolution} m; expected more than 0")
        self.cells.flags.writeable = False

    @property
    def width(self) -> float:
        """From the left to the right side [m]."""
        return float(self.cells.shape[1] * self.resolution)

    @property
    def height(self) -> float:
        """From the lower to the upper side [m]."""
        return float(self.cells.shape[0] * self.resolution)


@lru_cache(8)
def obstacles(
    grid: OccupancyGrid,
    unknown: Literal["occupied", "free"],
    tolerance: float | None,
    start: Corner | None = None,
) -> tuple[Polygon, ...]:
    """What stands on the floor, as polygons; ``tolerance`` [m], of a cell if None.

    Free areas much smaller than the largest count as occupied, but for the one at ``start`` [m].

    Raises:
        ImpossibleWorld: no cell is free.
        ValueError: the tolerance is negative.
    """
    cells = 1.0 if tolerance is None else tolerance / grid.resolution
    if not 0.0 <= cells < np.inf:
        raise ValueError(f"tolerance is {tolerance} m; expected 0 or more")
    free = grid.cells == FREE if unknown == "occupied" else grid.cells != OCCUPIED
    if not free.any():
        raise ImpossibleWorld(
            f"no cell of the map is free, unknown cells counting as {unknown};"
            f" expected some free floor"
        )
    at = None
    if start is not None:
        at = int(start[1] // grid.resolution), int(start[0] // grid.resolution)
    rows, columns = free.shape
    x, y = np.arange(columns + 1) * grid.resolution, np.arange(rows + 1) * grid.resolution
    return polygons(~large_areas(free, at), x, y, cells)


def large_areas(free: NDArray[np.bool_], start: tuple[int, int] | None = None) -> NDArray[np.bool_]:
    """The cells of areas that hang together by sides, without the small ones.

    ``start`` is the row and column of a cell whose area is kept in any case; the same shape as
    ``free``.
    """
    from scipy.ndimage import label

    areas, count = label(free)
    if count < 2:
        return free
    sizes = np.bincount(areas.ravel())
    sizes[0] = 0
    kept = sizes >= SMALL * sizes.max()
    if start is not None and all(0 <= k < n for k, n in zip(start, free.shape, strict=True)):
        kept[areas[start]] = True
    kept[0] = False
    return np.asarray(kept[areas])
