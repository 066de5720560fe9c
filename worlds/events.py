"""When and where something happens that a robot should go to.

An event process yields occurrences without end, in the order of time. Where time goes in
rounds only the places matter, and they are the same as in a stream.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from math import inf
from typing import NamedTuple, TypeAlias

import numpy as np

from worlds.arena import Arena, FloatArray, ImpossibleWorld
from worlds.shapes import Corner

BLOCK = 256  # places and gaps drawn at a time


class Occurrence(NamedTuple):
    """Something happens."""

    time: float  # [s] from the start of the run
    position: Corner  # [m]
    service: float | None = None  # how long it keeps a robot [s]; None: as all others
    deadline: float | None = None  # how long it may wait for one [s]; None: as all others


Events: TypeAlias = Callable[
    [Arena, float, np.random.Generator, np.random.Generator], Iterator[Occurrence]
]
"""Arena, mean rate [1/s], generator of places, generator of times."""


def uniform(
    arena: Arena, rate: float, places: np.random.Generator, times: np.random.Generator
) -> Iterator[Occurrence]:
    """Anywhere on the floor, hole included; in a stream as a Poisson process."""
    for time, site in zip(poisson_times(rate, times), uniform_sites(arena, places), strict=False):
        yield Occurrence(time, site)


def hot_spots(
    arena: Arena,
    rate: float,
    places: np.random.Generator,
    times: np.random.Generator,
    *,
    spots: int = 3,
    spread: float = 1.0,
    share: float = 0.8,
) -> Iterator[Occurrence]:
    """A share of the events around a few places, normally spread [m]; the rest anywhere."""
    if not (spots >= 1 and spread > 0.0 and 0.0 <= share <= 1.0):
        raise ValueError(
            f"hot spots: spots {spots}, spread {spread} m, share {share};"
            f" expected at least 1, more than 0, and 0 to 1"
        )
    background = uniform_sites(arena, places)
    centres = [next(background) for _ in range(spots)]
    for time in poisson_times(rate, times):
        if times.random() < share:
            centre = centres[int(times.integers(spots))]
            yield Occurrence(time, _near(arena, centre, spread, background, places))
        else:
            yield Occurrence(time, next(background))


def bursts(
    arena: Arena,
    rate: float,
    places: np.random.Generator,
    times: np.random.Generator,
    *,
    size: float = 5.0,
    spacing: float = 1.0,
    spread: float = 1.0,
) -> Iterator[Occurrence]:
    """Groups of events, geometric in number, close in time [s] and place [m]."""
    if not (size >= 1.0 and spacing >= 0.0 and spread > 0.0):
        raise ValueError(
            f"bursts: size {size}, spacing {spacing} s, spread {spread} m;"
            f" expected at least 1, at least 0, and more than 0"
        )
    background = uniform_sites(arena, places)
    last = 0.0
    for start in poisson_times(rate / size, times):
        time, centre = max(start, last), next(background)
        for _ in range(int(times.geometric(1.0 / size))):
            yield Occurrence(time, _near(arena, centre, spread, background, places))
            last = time
            time += float(times.exponential(spacing)) if spacing else 0.0


def trace(
    arena: Arena,
    _rate: float,
    _places: np.random.Generator,
    _times: np.random.Generator,
    *,
    occurrences: FloatArray,
) -> Iterator[Occurrence]:
    """The events of a CSV file: columns time [s], x, y [m], and, if wanted, service, deadline."""
    if not 3 <= occurrences.shape[1] <= 5:
        raise ValueError(
            f"a trace of {occurrences.shape[1]} columns; expected time, x, y, service, deadline"
        )
    past = np.flatnonzero(occurrences[:, 0] < 0.0)
    if len(past):
        raise ValueError(f"an event happens at {occurrences[past[0], 0]} s; expected 0 or more")
    size = np.array([arena.width, arena.height])
    outside = ((occurrences[:, 1:3] < 0.0) | (occurrences[:, 1:3] > size)).any(axis=1)
    if outside.any():
        row = occurrences[int(np.argmax(outside))].tolist()
        raise ValueError(f"the event at ({row[1]}, {row[2]}) lies outside the arena")
    for row in occurrences[np.argsort(occurrences[:, 0], kind="stable")].tolist():
        extra = [None if value != value else value for value in row[3:5]]  # noqa: PLR0124  # NaN
        yield Occurrence(row[0], (row[1], row[2]), *extra)


def poisson_times(rate: float, rng: np.random.Generator) -> Iterator[float]:
    """Times [s] of a Poisson process; for a rate of 0 or inf all at 0."""
    if not 0.0 < rate < inf:
        yield from (0.0 for _ in count())
    time = 0.0
    while True:
        for gap in rng.exponential(1.0 / rate, BLOCK).tolist():
            time += gap
            yield time


def uniform_sites(arena: Arena, rng: np.random.Generator) -> Iterator[Corner]:
    """Sites [m] without end, uniform over the floor, the hole included, obstacles not."""
    barren = 0
    while True:
        drawn = arena.random_points(BLOCK, 0.0, rng)
        free = arena.is_free(drawn)
        barren = 0 if free.any() else barren + 1
        if barren > 100:
            raise ImpossibleWorld("the obstacles cover the whole arena; expected some free floor")
        yield from map(tuple, drawn[free].tolist())


def _near(
    arena: Arena,
    centre: Corner,
    spread: float,
    background: Iterator[Corner],
    rng: np.random.Generator,
) -> Corner:
    """A free place on the floor around a centre; anywhere, should there be none."""
    drawn = np.array(centre) + rng.normal(0.0, spread, (32, 2))
    inside = ((drawn >= 0.0) & (drawn <= [arena.width, arena.height])).all(axis=1)
    free = drawn[inside & arena.is_free(drawn)]
    if not len(free):
        return next(background)
    x, y = free[0].tolist()
    return (x, y)
