"""Where robots start: drawn at random, or as given, with room for everybody's body."""

from __future__ import annotations

from math import floor, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from worlds.arena import Arena, FloatArray, ImpossibleWorld
from worlds.ground import ground_of
from worlds.shapes import Corner

DENSEST = 0.65
"""Share of the floor that bodies dropped at random can cover, and some more: in a plane no more fit
at 0.547, in a corridor one body wide at 0.587 (Rényi's parking constant by π/4). Torquato and
Stillinger, Rev. Mod. Phys. 82:2633, 2010, doi:10.1103/RevModPhys.82.2633."""


def scatter(
    arena: Arena,
    count: int,
    radius: float,
    rng: np.random.Generator,
    *,
    start: Corner | None = None,
    crowded: int = 200,
) -> FloatArray:
    """Start ``count`` robots of ``radius`` [m] at random, off walls, hole and each other.

    Returns positions (count, 2) [m], all in one area of the floor: see :mod:`worlds.ground`;
    ``start`` [m] picks it. Points are drawn uniformly and kept if they are free, so with radius 0
    and no shapes the result is the paper's uniform placement.

    Raises:
        ImpossibleWorld: ``crowded`` draws a robot did not find everybody a place, or so many
            would not find one in any number of draws.
    """
    ground = ground_of(arena, radius, start)
    few = 4.0 / sqrt(count) if count else 0.0  # these fill their corners better
    if count * pi * radius**2 > DENSEST * (1.0 + few) * ground.covered:
        raise _too_many(arena, count, radius)
    placed = _Spaced(2.0 * radius)
    for _ in range(crowded):
        drawn = arena.random_points(count, radius, rng)
        free = ground.holds(drawn)
        if arena.hole is not None:
            free &= arena.hole.distance(drawn) > 0.0
        placed.add(drawn[free], count)
        if len(placed.points) == count:
            return np.array(placed.points).reshape(-1, 2)
    raise _too_many(arena, count, radius)


def given(
    positions: FloatArray,
    arena: Arena,
    count: int,
    radius: float,
    _rng: np.random.Generator,
    *,
    start: Corner | None = None,
) -> FloatArray:
    """The first ``count`` of these ``positions`` (n, 2) [m], as they are.

    Raises:
        ImpossibleWorld: there are fewer, bodies of that radius would not have room there, or
            could not get to where the others start.
    """
    if count > len(positions):
        raise ImpossibleWorld(f"robots is {count}; expected {len(positions)} or fewer, as placed")
    chosen = positions[:count]
    if radius == 0.0:
        return chosen
    if start is None and arena.obstacles and count:
        x, y = chosen[0].tolist()
        start = (x, y)
    fits = _fits(arena, chosen, radius)
    if fits.all() and arena.obstacles:
        apart = ~ground_of(arena, radius, start).holds(chosen)
        if apart.any():
            robot, (x, y) = _first(apart, chosen, arena)
            raise ImpossibleWorld(
                f"robot {robot} of radius {radius} m at ({x}, {y}) cannot get to where robot 0"
                f" starts; expected places that a body can drive between"
            )
    if not fits.all():
        robot, (x, y) = _first(~fits, chosen, arena)
        raise ImpossibleWorld(
            f"robot {robot} of radius {radius} m has no room at ({x}, {y});"
            f" expected free places, or motion straight, in which robots are points"
        )
    return chosen


def _first(which: NDArray[np.bool_], points: FloatArray, arena: Arena) -> tuple[int, Corner]:
    """The first of the points, and where it is in the user's frame [m]."""
    robot = int(np.argmax(which))
    x, y = (points[robot] + arena.corner).tolist()
    return robot, (round(x, 6), round(y, 6))


def _fits(arena: Arena, points: FloatArray, radius: float) -> NDArray[np.bool_]:
    """Which bodies have room beside walls, obstacles and the bodies before them."""
    size = np.array([arena.width, arena.height])
    fits = np.array(((points >= radius) & (points <= size - radius)).all(axis=1))
    for obstacle in arena.obstacles:
        fits &= obstacle.distance(points) >= radius
    placed = _Spaced(2.0 * radius, touching=True)
    for robot, point in enumerate(points.tolist()):
        fits[robot] &= placed.is_clear(*point)
        placed.keep(*point)
    return fits


def _too_many(arena: Arena, count: int, radius: float) -> ImpossibleWorld:
    return ImpossibleWorld(
        f"{count} robots of radius {radius} m do not fit into the free part of the"
        f" {arena.width:g} m × {arena.height:g} m arena; expected fewer or smaller robots"
    )


class _Spaced:
    """Points that keep a ``gap`` [m] from each other, in cells as wide as the gap."""

    def __init__(self, gap: float, *, touching: bool = False) -> None:
        self.points: list[tuple[float, float]] = []
        self._gap = gap
        self._square = gap * gap
        self._touching = touching  # whether just the gap is enough
        self._cells: dict[tuple[int, int], list[tuple[float, float]]] = {}

    def add(self, drawn: FloatArray, count: int) -> None:
        """Keep those drawn points that are clear of all others, until there are ``count``."""
        for x, y in drawn.tolist():
            if len(self.points) == count:
                return
            if self.is_clear(x, y):
                self.keep(x, y)

    def is_clear(self, x: float, y: float) -> bool:
        """Whether a point keeps the gap from all that are there [m]."""
        if self._gap == 0.0:
            return True
        column, row = floor(x / self._gap), floor(y / self._gap)
        for across in (column - 1, column, column + 1):
            for up in (row - 1, row, row + 1):
                for ox, oy in self._cells.get((across, up), ()):
                    square = (ox - x) * (ox - x) + (oy - y) * (oy - y)
                    if square < self._square or (square == self._square and not self._touching):
                        return False
        return True

    def keep(self, x: float, y: float) -> None:
        """Add a point [m]."""
        self.points.append((x, y))
        if self._gap > 0.0:
            cell = floor(x / self._gap), floor(y / self._gap)
            self._cells.setdefault(cell, []).append((x, y))
