"""Discs and polygons: how far a point is from one, and their outlines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
Corner: TypeAlias = tuple[float, float]  # [m]
PlaceTable: TypeAlias = Annotated[FloatArray, ("x", "y")]
"""Places (n, 2) [m], from a file whose columns have these names."""
EventTable: TypeAlias = Annotated[FloatArray, ("time", "x", "y", "service", "deadline")]
"""Events (n, 3 to 5) [s, m, m, s, s], the same; NaN: the file does not say."""

LinkTable: TypeAlias = Annotated[FloatArray, ("from", "to", "ratio", "time")]
"""Links (n, 3 or 4) [robot, robot, 1, s], the same: shares of frames that get through."""


class Shape(Protocol):
    """A closed region of the floor."""

    def distance(self, points: FloatArray) -> FloatArray:
        """How far outside the shape ``points`` (k, 2) [m] are (k,) [m]; 0 inside."""

    def outline(self) -> FloatArray:
        """The boundary as a polygon (c, 2) [m], counter-clockwise."""

    def bounds(self) -> tuple[Corner, Corner]:
        """The lower left and upper right corner of the bounding box [m]."""


@dataclass(frozen=True, slots=True)
class Disc:
    """A round region.

    Raises:
        ValueError: the radius is not positive.
    """

    x: float  # [m]
    y: float  # [m]
    radius: float  # [m]

    def __post_init__(self) -> None:
        if not 0.0 < self.radius < np.inf:
            raise ValueError(f"disc radius {self.radius} m; expected more than 0")

    def distance(self, points: FloatArray) -> FloatArray:
        """How far outside the disc ``points`` (k, 2) [m] are (k,) [m]; 0 inside."""
        away = np.hypot(points[:, 0] - self.x, points[:, 1] - self.y) - self.radius
        return np.asarray(np.maximum(away, 0.0))

    def outline(self) -> FloatArray:
        """A polygon of 64 corners (64, 2) [m], counter-clockwise."""
        turn = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
        return np.column_stack(
            [self.x + self.radius * np.cos(turn), self.y + self.radius * np.sin(turn)]
        )

    def bounds(self) -> tuple[Corner, Corner]:
        """The lower left and upper right corner of the bounding box [m]."""
        return (
            (self.x - self.radius, self.y - self.radius),
            (self.x + self.radius, self.y + self.radius),
        )


@dataclass(frozen=True, slots=True)
class Polygon:
    """A simple polygon, not necessarily convex; corners in either order.

    Raises:
        ValueError: it has fewer than three corners, or no area.
    """

    corners: tuple[Corner, ...]

    def __post_init__(self) -> None:
        if len(self.corners) < 3:
            raise ValueError(f"a polygon of {len(self.corners)} corners; expected 3 or more")
        if abs(self.signed_area()) < 1e-12:
            raise ValueError(f"the polygon {self.corners} has no area")

    def signed_area(self) -> float:
        """Its area [m²], negative if the corners run clockwise."""
        x, y = np.array(self.corners).T
        return float(0.5 * (x * np.roll(y, -1) - np.roll(x, -1) * y).sum())

    def distance(self, points: FloatArray) -> FloatArray:
        """How far outside the polygon ``points`` (k, 2) [m] are (k,) [m]; 0 inside."""
        a = np.array(self.corners)
        b = np.roll(a, -1, axis=0)
        side = b - a
        start = points[:, None, :] - a[None, :, :]
        share = np.clip((start * side).sum(axis=2) / (side * side).sum(axis=1), 0.0, 1.0)
        away = np.hypot(*(start - share[:, :, None] * side).transpose(2, 0, 1)).min(axis=1)
        return np.asarray(np.where(self.contains(points), 0.0, away))

    def contains(self, points: FloatArray) -> NDArray[np.bool_]:
        """Whether ``points`` (k, 2) [m] lie inside: an odd number of sides to their right."""
        a = np.array(self.corners)
        b = np.roll(a, -1, axis=0)
        y = points[:, 1, None]
        straddles = (a[:, 1] > y) != (b[:, 1] > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
        return np.asarray((straddles & (points[:, 0, None] < at)).sum(axis=1) % 2 == 1)

    def outline(self) -> FloatArray:
        """The corners (c, 2) [m], counter-clockwise."""
        points = np.array(self.corners)
        return points if self.signed_area() > 0.0 else points[::-1].copy()

    def bounds(self) -> tuple[Corner, Corner]:
        """The lower left and upper right corner of the bounding box [m]."""
        points = np.array(self.corners)
        low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        return (low[0], low[1]), (high[0], high[1])


def square(x: float, y: float, half: float) -> Polygon:
    """The upright square around (x, y) [m] with sides of twice ``half`` [m]."""
    return Polygon(
        ((x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half))
    )
