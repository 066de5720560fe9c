"""Where it happens: the floor, what stands on it, and where robots start."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from worlds.shapes import Disc, Polygon, Shape

FloatArray: TypeAlias = NDArray[np.float64]


class ImpossibleWorld(ValueError):
    """The world that was asked for cannot be made; the message says what stands in the way."""


@dataclass(frozen=True, slots=True)
class Arena:
    """A walled rectangular floor with its lower left corner at (0, 0).

    ``hole`` is empty of robots at the start, but may be driven through, as in the paper;
    ``obstacles`` stop robots.

    Raises:
        ValueError: a side is not positive, or a shape lies outside the floor.
    """

    width: float = 10.0  # [m]
    height: float = 10.0  # [m]
    hole: Disc | Polygon | None = None
    obstacles: tuple[Polygon, ...] = ()

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


def scatter(
    arena: Arena, count: int, radius: float, rng: np.random.Generator, *, crowded: int = 200
) -> FloatArray:
    """Start ``count`` robots of ``radius`` [m] at random, off walls, hole and each other.

    Returns positions (count, 2) [m]. Points are drawn uniformly and kept if they are free,
    so with radius 0 and no shapes the result is the paper's uniform placement.

    Raises:
        ImpossibleWorld: ``crowded`` draws a robot did not find everybody a place.
    """
    placed = np.empty((0, 2))
    for _ in range(crowded):
        drawn = arena.random_points(count, radius, rng)
        free = np.ones(count, bool)
        for shape in arena.shapes:
            clearance = 0.0 if shape is arena.hole else radius
            free &= shape.distance(drawn) > clearance
        drawn = drawn[free]
        placed = (
            _spaced(placed, drawn, count, 2.0 * radius)
            if radius
            else np.vstack([placed, drawn])[:count]
        )
        if len(placed) == count:
            return placed
    raise ImpossibleWorld(
        f"{count} robots of radius {radius} m do not fit into the free part of the"
        f" {arena.width} m × {arena.height} m arena; expected fewer or smaller robots"
    )


def given(
    positions: FloatArray, arena: Arena, count: int, radius: float, _rng: np.random.Generator
) -> FloatArray:
    """The first ``count`` of these ``positions`` (n, 2) [m], as they are.

    Raises:
        ImpossibleWorld: there are fewer, or bodies of that radius would not have room there.
    """
    if count > len(positions):
        raise ImpossibleWorld(f"robots is {count}; expected {len(positions)} or fewer, as placed")
    chosen = positions[:count]
    size = np.array([arena.width, arena.height])
    stuck = np.array(((chosen < radius) | (chosen > size - radius)).any(axis=1))
    for obstacle in arena.obstacles:
        stuck |= obstacle.distance(chosen) < radius
    for robot in range(count):
        gaps = np.hypot(*(chosen[:robot] - chosen[robot]).T)
        stuck[robot] |= bool((gaps < 2.0 * radius).any())
    if radius > 0.0 and stuck.any():
        robot = int(np.argmax(stuck))
        x, y = chosen[robot].tolist()
        raise ImpossibleWorld(
            f"robot {robot} of radius {radius} m has no room at ({x}, {y});"
            f" expected free places, or motion straight, in which robots are points"
        )
    return chosen


def _spaced(placed: FloatArray, drawn: FloatArray, count: int, gap: float) -> FloatArray:
    """Add those drawn points that keep ``gap`` [m] from all others, up to ``count``."""
    kept = list(placed)
    for point in drawn:
        if len(kept) == count:
            break
        others = np.array(kept).reshape(-1, 2)
        if (((others - point) ** 2).sum(axis=1) > gap * gap).all():
            kept.append(point)
    return np.array(kept).reshape(-1, 2)
