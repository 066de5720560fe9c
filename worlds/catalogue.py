"""The worlds and event processes by name. One line here puts one into scenario files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from worlds import events
from worlds.arena import Arena, FloatArray
from worlds.events import Occurrence
from worlds.obstacles import round_pit, scatter_through, shelves, walls
from worlds.occupancy import OccupancyGrid, obstacles
from worlds.scattering import given, scatter
from worlds.shapes import Corner, Disc, PlaceTable, Polygon, square

PAPER = "Stanulovic et al., Sensors 21(18):6149, 2021, section 5"


@dataclass(frozen=True, slots=True)
class World:
    """A floor, and a way to start robots on it."""

    arena: Arena
    place: Callable[[Arena, int, float, np.random.Generator], FloatArray] = scatter
    robots: int = 100  # unless the scenario asks for another number
    fixed: bool = False  # whether the robots start in the same places every time
    start: Corner | None = None  # a place in the area that robots start in [m]; None: the largest
    notices: tuple[str, ...] = ()  # what its author may want to know


class WorldEntry(NamedTuple):
    """A function that makes a world from its parameters, and where it comes from."""

    function: Callable[..., World]
    source: str


class EventsEntry(NamedTuple):
    """An event process, its parameters by keyword, and where it comes from."""

    function: Callable[..., Iterator[Occurrence]]  # ground, rate, generators of places and times
    source: str


def random(*, width: float = 10.0, height: float = 10.0, room: float = 0.0) -> World:
    """Robots and events anywhere on an open floor: the paper's random topology.

    Every robot starts with ``room`` [m] around its middle, or what its body takes if that is
    more: so points can be made to start where bodies of that radius would.

    Raises:
        ValueError: ``room`` is negative.
    """
    if not room >= 0.0:
        raise ValueError(f"room is {room} m; expected 0 or more")

    def place(arena: Arena, count: int, radius: float, rng: np.random.Generator) -> FloatArray:
        return scatter(arena, count, max(radius, room), rng)

    return World(Arena(width, height), place)


def random_hole(
    *,
    width: float = 10.0,
    height: float = 10.0,
    shape: Literal["disc", "square"] = "disc",
    radius: float = 2.5,
    corners: tuple[Corner, ...] = (),
) -> World:
    """As random, but no robot starts in a hole in the middle; events fall there too.

    ``radius`` [m] is that of the disc, or half a side of the square; ``corners`` [m] make a
    hole of any other shape and place.
    """
    x, y = 0.5 * width, 0.5 * height
    hole = Disc(x, y, radius) if shape == "disc" else square(x, y, radius)
    return World(Arena(width, height, hole=Polygon(corners) if corners else hole))


def pit(
    *,
    width: float = 10.0,
    height: float = 10.0,
    shape: Literal["disc", "square"] = "disc",
    radius: float = 2.5,
    sides: int = 32,
) -> World:
    """As random-hole, but robots must drive around the hole, and events fall beside it.

    ``radius`` [m] is that of the disc, or half a side of the square. The disc is a polygon of
    so many ``sides`` around it.
    """
    if not 0.0 < radius < 0.5 * min(width, height):
        raise ValueError(
            f"radius is {radius} m; expected more than 0, and less than half the"
            f" {width} m × {height} m floor"
        )
    if sides < 3:
        raise ValueError(f"sides is {sides}; expected 3 or more")
    x, y = 0.5 * width, 0.5 * height
    hole = round_pit(x, y, radius, sides) if shape == "disc" else square(x, y, radius)
    beside = partial(scatter_through, min(width, height) / 2 - radius, "the way past the pit")
    return World(Arena(width, height, obstacles=(hole,)), beside)


def rooms(
    *,
    width: float = 10.0,
    height: float = 10.0,
    columns: int = 3,
    rows: int = 3,
    wall: float = 0.15,
    door: float = 0.9,
) -> World:
    """Equal rooms; a door in the middle of every wall between two of them.

    ``wall`` is the thickness of walls, ``door`` the width of doors [m]. Radio passes walls.
    """
    if not wall > 0.0:
        raise ValueError(f"wall is {wall} m; expected more than 0")
    standing = walls(width, height, columns, rows, wall, door)
    return World(Arena(width, height, obstacles=standing), partial(scatter_through, door, "a door"))


def warehouse(
    *,
    columns: int = 3,
    rows: int = 5,
    length: float = 2.0,
    depth: float = 0.8,
    aisle: float = 1.0,
) -> World:
    """Rows of shelves with aisles between and around them.

    A shelf is ``length`` × ``depth``, an ``aisle`` so wide [m]; the floor is as large as that
    takes, 10 m × 10 m by default. Radio passes shelves.
    """
    width, height, found = shelves(columns, rows, length, depth, aisle)
    return World(Arena(width, height, obstacles=found), partial(scatter_through, aisle, "an aisle"))


def occupancy_map(
    *,
    file: OccupancyGrid,
    unknown: Literal["occupied", "free"] = "occupied",
    tolerance: float | None = None,
    start: Corner | None = None,
    positions: PlaceTable | None = None,
    cell: float | None = None,
) -> World:
    """The floor of an occupancy map: a YAML file and the image that it names, or a MovingAI file.

    ``file`` is as of ROS's map_server, or of the MovingAI benchmarks (``.map``), whose cells have
    sides of ``cell`` [m], 1 m if it is not given. ``unknown`` cells count as occupied, or as free.
    Occupied cells become polygons, which are larger by up to ``tolerance`` [m], one cell if it is
    not given: slanting walls have fewer corners then. No way through opens, but doors may be
    narrower by twice as much. Robots start in the largest area that they can drive in, or in the
    one around ``start``; or at ``positions``. All positions of the user's are in the frame of
    the map, as its origin says. Radio passes walls.
    """
    if cell is not None:
        if file.resolution != 1.0 or file.corner != (0.0, 0.0):
            raise ValueError(f"cell is {cell} m, but the file says how large its cells are")
        file = OccupancyGrid(file.cells, cell)
    left, low = file.corner
    if positions is not None:
        positions = positions * (cell or 1.0) - np.array(file.corner)
        _check_inside(positions, file.width, file.height, file.corner)
        start = start or (float(positions[0, 0]) + left, float(positions[0, 1]) + low)
    at = None if start is None else (start[0] - left, start[1] - low)
    standing = obstacles(file, unknown, tolerance, at)
    arena = Arena(file.width, file.height, obstacles=standing, corner=file.corner)
    if positions is None:
        return World(arena, partial(scatter, start=at), start=at, notices=file.notices)
    place = partial(given, positions, start=at)
    return World(arena, place, len(positions), True, at, file.notices)


def placed(*, positions: PlaceTable, width: float = 10.0, height: float = 10.0) -> World:
    """Robots start where a CSV file (columns x, y in metres) puts them; events fall anywhere."""
    _check_inside(positions, width, height)
    arena = Arena(width, height)
    return World(arena, partial(given, positions), robots=len(positions), fixed=True)


def _check_inside(
    positions: FloatArray, width: float, height: float, corner: Corner = (0.0, 0.0)
) -> None:
    """Refuse places (n, 2) [m] that are not on the floor, or that are no places."""
    if positions.ndim != 2 or positions.shape[1] != 2:
        raise ValueError(f"positions have {positions.shape[-1]} columns; expected x and y")
    inside = ((positions >= 0.0) & (positions <= np.array([width, height]))).all(axis=1)
    if not inside.all():
        robot = int(np.argmin(inside))
        x, y = (positions[robot] + np.array(corner)).tolist()
        raise ValueError(
            f"robot {robot} starts at ({x:g}, {y:g});"
            f" expected a place in the {width:g} m × {height:g} m arena"
        )


WORLDS: dict[str, WorldEntry] = {
    "map": WorldEntry(occupancy_map, "a file of the user's; wiki.ros.org/map_server"),
    "pit": WorldEntry(pit, f"{PAPER}; its hole as an obstacle"),
    "placed": WorldEntry(placed, "a file of the user's"),
    "random": WorldEntry(random, PAPER),
    "random-hole": WorldEntry(random_hole, PAPER),
    "rooms": WorldEntry(rooms, "an office floor"),
    "warehouse": WorldEntry(warehouse, "a storage floor"),
}

EVENTS: dict[str, EventsEntry] = {
    "bursts": EventsEntry(events.bursts, "Poisson cluster process"),
    "hot-spots": EventsEntry(events.hot_spots, "Poisson process in a mixture of places"),
    "trace": EventsEntry(events.trace, "a file of the user's"),
    "uniform": EventsEntry(events.uniform, f"{PAPER}; in a stream a Poisson process"),
}
