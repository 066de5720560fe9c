"""The ground of a body: where a robot of some size can stand, and get to from the others.

Free floor is eroded by the robot's radius (Minkowski's difference, by GEOS). Of the areas that
are left the largest is taken, or the one around a given place: whoever starts there, and whatever
happens there, can be reached from everywhere else in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import cos, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from worlds.arena import Arena, FloatArray, ImpossibleWorld
from worlds.shapes import Corner

ROOM = 0.001  # [m] that a body needs on each side of a way through
JOIN = 16  # chords of a quarter circle around a corner, in the eroded floor
ROUND = 1.0 / cos(pi / (4 * JOIN))  # chords lie inside their circle: by so much more is eroded
MENDED = 2.0 * ROOM  # [m] by which the area is taken larger again, so that it touches what it may
geos = np.errstate(all="ignore")  # on some processors it leaves flags behind that mean nothing
WORTH_SAYING = 0.05  # share of the area taken from which on another one is mentioned


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """Where robots of ``radius`` [m] can be on the floor of ``arena``.

    Without obstacles it is all of the floor; bodies may then touch the walls around it.
    """

    arena: Arena
    radius: float
    area: float  # where centres may be [m²]
    covered: float  # and what bodies there can cover [m²]
    others: tuple[tuple[float, Corner], ...] = ()  # areas not taken, largest first [m²], a place
    _obstacles: Any = None  # prepared geometry
    _reach: Any = None  # where centres may be, prepared; None: anywhere

    @geos
    def holds(self, points: FloatArray) -> NDArray[np.bool_]:
        """Which of ``points`` (k, 2) [m] a robot can stand on, and get to (k,)."""
        if self._reach is None:
            return np.ones(len(points), bool)
        import shapely

        held = np.asarray(shapely.intersects_xy(self._reach, *points.T)) & self._inside(points)
        if self.radius == 0.0:
            return held & ~self.buried(points)
        held[held] = ~shapely.dwithin(self._obstacles, shapely.points(points[held]), self.radius)
        return held

    @geos
    def buried(self, points: FloatArray) -> NDArray[np.bool_]:
        """Which of ``points`` (k, 2) [m] lie in obstacles (k,)."""
        if self._obstacles is None:
            return np.zeros(len(points), bool)
        import shapely

        return np.asarray(shapely.intersects_xy(self._obstacles, *points.T))

    @geos
    def serves(self, points: FloatArray) -> NDArray[np.bool_]:
        """Which of ``points`` (k, 2) [m] a robot can stand on, or cover with its body (k,)."""
        if self._reach is None:
            return np.ones(len(points), bool)
        import shapely

        margin = self.radius + MENDED
        return np.asarray(shapely.dwithin(self._reach, shapely.points(points), margin))

    def notice(self) -> str | None:
        """What is to be said of areas that were not taken; None: nothing."""
        if not self.others or self.others[0][0] < WORTH_SAYING * self.area:
            return None
        area, (x, y) = self.others[0]
        left, low = self.arena.corner
        count = len(self.others) + 1
        return (
            f"the floor falls into {count} areas for robots of radius {self.radius:g} m;"
            f" the one taken has {self.area:.1f} m², another one {area:.1f} m²:"
            f" world.start = [{x + left:.2f}, {y + low:.2f}] picks that"
        )

    def _inside(self, points: FloatArray) -> NDArray[np.bool_]:
        low = self.radius
        high = np.array([self.arena.width, self.arena.height]) - low
        return np.asarray(((points >= low) & (points <= high)).all(axis=1))


@lru_cache(8)
@geos
def ground_of(arena: Arena, radius: float, start: Corner | None = None) -> Ground:
    """The ground of robots of ``radius`` [m]; ``start`` [m] picks the area.

    Raises:
        ImpossibleWorld: there is no room for such a robot, at ``start`` or at all.
    """
    if not arena.obstacles:
        return Ground(arena, radius, arena.width * arena.height, arena.width * arena.height)
    import shapely

    obstacles = shapely.union_all([shapely.polygons(p.corners) for p in arena.obstacles])
    shapely.prepare(obstacles)
    areas = _areas(arena, obstacles, radius + ROOM)
    taken = _taken(arena, areas, radius, start)
    others = tuple(
        (float(shapely.area(a)), _corner(shapely.point_on_surface(a)))
        for k, a in enumerate(areas)
        if k != taken
    )
    reach = shapely.buffer(areas[taken], MENDED)
    shapely.prepare(reach)
    covered = float(shapely.area(shapely.buffer(areas[taken], radius)))
    area = float(shapely.area(areas[taken]))
    return Ground(arena, radius, area, covered, others, obstacles, reach)


def _areas(arena: Arena, obstacles: Any, room: float) -> list[Any]:
    """The areas where the centre of a body with ``room`` [m] around it may be, largest first."""
    import shapely

    width, height = arena.width - room, arena.height - room
    if width <= room or height <= room:
        return []
    inside = shapely.box(room, room, width, height)
    grown = shapely.buffer(obstacles, room * ROUND, quad_segs=JOIN)
    parts = shapely.get_parts(shapely.difference(inside, grown))
    found = [part for part in parts if shapely.area(part) > 0.0]
    return sorted(found, key=lambda part: (-float(shapely.area(part)), shapely.bounds(part)[0]))


def _taken(arena: Arena, areas: list[Any], radius: float, start: Corner | None) -> int:
    """Which of the ``areas`` is taken: the first, or the one at ``start`` [m]."""
    import shapely

    if not areas:
        raise ImpossibleWorld(
            f"robot radius is {radius:g} m; such a body has no room anywhere on the"
            f" {arena.width:g} m × {arena.height:g} m floor; expected smaller robots"
        )
    if start is None:
        return 0
    away = np.array([shapely.distance(area, shapely.points(*start)) for area in areas])
    nearest = int(np.argmin(away))
    if away[nearest] > 2.0 * radius:
        line = shapely.shortest_line(areas[nearest], shapely.points(*start))
        x, y = _corner(shapely.get_point(line, 0))
        left, low = arena.corner
        raise ImpossibleWorld(
            f"world.start is [{start[0] + left:g}, {start[1] + low:g}]; a robot of radius"
            f" {radius:g} m has no room there; the nearest place is [{x + left:.2f}, {y + low:.2f}]"
        )
    return nearest


def _corner(point: Any) -> Corner:
    return float(point.x), float(point.y)
