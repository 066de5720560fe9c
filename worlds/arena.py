"""Where it happens: the floor, and what stands on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from worlds.shapes import Corner, Disc, Polygon, Shape

FloatArray: TypeAlias = NDArray[np.float64]


class ImpossibleWorld(ValueError):
    """The world that was asked for cannot be made; the message says what stands in the way."""


@dataclass(frozen=True, slots=True)
class Arena:
    """A walled rectangular floor with its lower left corner at (0, 0).

    ``hole`` is empty of robots at the start, but may be driven through, as in the paper;
    ``obstacles`` stop robots. ``corner`` is where that corner lies in the frame of the map that
    the floor comes from, if it comes from one: places of the user's are given in that frame.

    Raises:
        ValueError: a side is not positive, or a shape lies outside the floor.
    """

    width: float = 10.0  # [m]
    height: float = 10.0  # [m]
    hole: Disc | Polygon | None = None
    obstacles: tuple[Polygon, ...] = ()
    corner: Corner = (0.0, 0.0)  # [m]

    def __post_init__(self) -> None:
        for name, side in (("width", self.width), ("height", self.height)):
            if not 0.0 < side < np.inf:
                raise ValueError(f"arena {name} {side} m; expected more than 0")
        for shape in self.shapes:
            low, high = shape.bounds()
            if low[0] >= self.width or low[1] >= self.height or high[0] <= 0 or high[1] <= 0:
                raise ValueError(f"{shape} lies outside the {self.width} m × {self.height} m arena")

    @property
    def shapes(self) -> tuple[Shape, ...]:
        """Everything drawn on the floor."""
        return self.obstacles if self.hole is None else (self.hole, *self.obstacles)

    def is_free(self, points: FloatArray) -> NDArray[np.bool_]:
        """Which of ``points`` (k, 2) [m] no obstacle covers (k,)."""
        free = np.ones(len(points), bool)
        for obstacle in self.obstacles:
            free &= obstacle.distance(points) > 0.0
        return free

    def random_points(self, count: int, margin: float, rng: np.random.Generator) -> FloatArray:
        """``count`` points (count, 2) [m], uniform over the rectangle ``margin`` off the walls."""
        low = np.array([margin, margin])
        high = np.array([self.width - margin, self.height - margin])
        if (low > high).any():
            raise ImpossibleWorld(
                f"an arena of {self.width} m × {self.height} m has no room {margin} m off its walls"
            )
        return np.asarray(low + rng.random((count, 2)) * (high - low))
