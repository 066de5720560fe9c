"""The worlds and event processes by name. One line here puts one into scenario files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from worlds import events
from worlds.arena import Arena, FloatArray, given, scatter
from worlds.events import Occurrence
from worlds.shapes import Corner, Disc, Polygon, square

PAPER = "Stanulovic et al., Sensors 21(18):6149, 2021, section 5"


@dataclass(frozen=True, slots=True)
class World:
    """A floor, and a way to start robots on it."""

    arena: Arena
    place: Callable[[Arena, int, float, np.random.Generator], FloatArray] = scatter
    robots: int = 100  # unless the scenario asks for another number
    fixed: bool = False  # whether the robots start in the same places every time


class Entry(NamedTuple):
    """A function that makes a world from its parameters, and where it comes from."""

    function: Callable[..., World]
    source: str


class EventsEntry(NamedTuple):
    """An event process, its parameters by keyword, and where it comes from."""

    function: Callable[..., Iterator[Occurrence]]  # arena, rate, generators of places and times
    source: str


def random(*, width: float = 10.0, height: float = 10.0) -> World:
    """Robots and events anywhere on an open floor: the paper's random topology."""
    return World(Arena(width, height))


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


def placed(*, positions: FloatArray, width: float = 10.0, height: float = 10.0) -> World:
    """Robots start where a CSV file (columns x, y in metres) puts them; events fall anywhere."""
    if positions.shape[1] != 2:
        raise ValueError(f"positions have {positions.shape[1]} columns; expected x and y")
    arena = Arena(width, height)
    inside = (positions >= 0.0) & (positions <= np.array([width, height]))
    if not inside.all():
        row = int(np.argmin(inside.all(axis=1)))
        x, y = positions[row].tolist()
        raise ValueError(
            f"robot {row} starts at ({x}, {y});"
            f" expected a place in the {width} m × {height} m arena"
        )
    return World(arena, partial(given, positions), robots=len(positions), fixed=True)


WORLDS: dict[str, Entry] = {
    "placed": Entry(placed, "a file of the user's"),
    "random": Entry(random, PAPER),
    "random-hole": Entry(random_hole, PAPER),
}

EVENTS: dict[str, EventsEntry] = {
    "bursts": EventsEntry(events.bursts, "Poisson cluster process"),
    "hot-spots": EventsEntry(events.hot_spots, "Poisson process in a mixture of places"),
    "trace": EventsEntry(events.trace, "a file of the user's"),
    "uniform": EventsEntry(events.uniform, f"{PAPER}; in a stream a Poisson process"),
}
