"""The worlds by name. One line here puts a world into scenario files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from worlds.arena import Arena, FloatArray, scatter
from worlds.events import uniform_sites
from worlds.shapes import Corner, Disc

PAPER = "Stanulovic et al., Sensors 21(18):6149, 2021, section 5"


@dataclass(frozen=True, slots=True)
class World:
    """A floor, a way to start robots on it, and the sites where events happen."""

    arena: Arena
    place: Callable[[Arena, int, float, np.random.Generator], FloatArray] = scatter
    sites: Callable[[Arena, np.random.Generator], Iterator[Corner]] = uniform_sites


class Entry(NamedTuple):
    """A function that makes a world from its parameters, and where it comes from."""

    function: Callable[..., World]
    source: str


def random(*, width: float = 10.0, height: float = 10.0) -> World:
    """Robots and events anywhere on an open floor: the paper's random topology."""
    return World(Arena(width, height))


def random_hole(*, width: float = 10.0, height: float = 10.0, radius: float = 2.5) -> World:
    """As random, but no robot starts in a round hole in the middle; events fall there too."""
    return World(Arena(width, height, hole=Disc(0.5 * width, 0.5 * height, radius)))


WORLDS: dict[str, Entry] = {
    "random": Entry(random, PAPER),
    "random-hole": Entry(random_hole, PAPER),
}
