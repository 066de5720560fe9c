"""Things on the floor that robots must drive around: pits, walls with doors, shelves.

They stop robots, not radio: a link is as good through a wall as in the open.
"""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from worlds.arena import Arena, FloatArray, ImpossibleWorld
from worlds.outlines import polygons
from worlds.scattering import scatter
from worlds.shapes import Polygon

ROOM = 0.01  # [m] that a robot needs beside its own width


def round_pit(x: float, y: float, radius: float, sides: int) -> Polygon:
    """The regular polygon around a disc at (x, y) of that radius [m]."""
    out = radius / cos(pi / sides)
    turns = [2.0 * pi * (k + 0.5) / sides for k in range(sides)]
    return Polygon(tuple((x + out * cos(turn), y + out * sin(turn)) for turn in turns))


def walls(
    width: float, height: float, columns: int, rows: int, thickness: float, door: float
) -> tuple[Polygon, ...]:
    """Walls between equal rooms, with a door in the middle of each that two rooms share [m].

    Raises:
        ValueError: doors are wider than rooms, or there is no room at all.
    """
    across = _room_lines("columns", width, columns, thickness, door)
    up = _room_lines("rows", height, rows, thickness, door)
    is_wall_across, is_door_across = _wall_and_door(columns)
    is_wall_up, is_door_up = _wall_and_door(rows)
    standing = is_wall_across & ~is_door_up[:, None]
    lying = is_wall_up[:, None] & ~is_door_across
    return polygons(standing | lying, across, up)


def shelves(
    columns: int, rows: int, length: float, depth: float, aisle: float
) -> tuple[float, float, tuple[Polygon, ...]]:
    """Rows of shelves with aisles on all sides: width and height of the floor, shelves [m].

    Raises:
        ValueError: something is not positive.
    """
    for name, count in (("columns", columns), ("rows", rows)):
        if count < 1:
            raise ValueError(f"{name} is {count}; expected 1 or more")
    for name, size in (("length", length), ("depth", depth), ("aisle", aisle)):
        if not 0.0 < size < np.inf:
            raise ValueError(f"{name} is {size} m; expected more than 0")
    across = np.cumsum([0.0] + columns * [aisle, length] + [aisle])
    up = np.cumsum([0.0] + rows * [aisle, depth] + [aisle])
    odd = np.arange(2 * columns + 1) % 2 == 1
    found = polygons(odd & (np.arange(2 * rows + 1) % 2 == 1)[:, None], across, up)
    return float(across[-1]), float(up[-1]), found


def scatter_through(
    passage: float,
    called: str,
    arena: Arena,
    count: int,
    radius: float,
    rng: np.random.Generator,
) -> FloatArray:
    """As :func:`worlds.scattering.scatter`, if robots of ``radius`` [m] fit through every passage.

    Raises:
        ImpossibleWorld: they do not, or they do not all find a place.
    """
    if radius > 0.0 and passage < 2.0 * radius + ROOM:
        raise ImpossibleWorld(
            f"{called} is {passage:g} m, too narrow for robots of radius {radius:g} m;"
            f" expected {2.0 * radius + ROOM:g} m or more, or smaller robots"
        )
    return scatter(arena, count, radius, rng)


def _room_lines(called: str, size: float, rooms: int, thickness: float, door: float) -> FloatArray:
    """Where rooms begin, their doors begin and end, and rooms end [m]."""
    side = {"columns": "width", "rows": "height"}[called]
    if rooms < 1:
        raise ValueError(f"{called} is {rooms}; expected 1 or more")
    room = (size - (rooms - 1) * thickness) / rooms
    if not 0.0 < door < room:
        raise ValueError(
            f"door is {door} m in rooms of {room:.3g} m, {called} = {rooms} over a {side} of"
            f" {size:g} m; expected more than 0, and less than a room"
        )
    begin = np.arange(rooms)[:, None] * (room + thickness)
    beside = 0.5 * (room - door)
    return np.asarray((begin + np.array([0.0, beside, beside + door, room])).ravel())


def _wall_and_door(rooms: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which of the spans between these lines are walls, and which lie in line with doors."""
    span = np.arange(4 * rooms - 1) % 4
    return span == 3, span == 1
