"""When and where something happens that a robot should go to.

An event process yields occurrences without end, in the order of time. Where time goes in
rounds only the places matter, and they are the same as in a stream.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from math import inf
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from worlds.arena import FloatArray, ImpossibleWorld
from worlds.ground import Ground
from worlds.shapes import Corner, EventTable

BLOCK = 256  # places and gaps drawn at a time
MOST = 10_000  # hot spots of a run, or events of a burst
BARREN = 1000  # so many blocks without a place: there is none


class Occurrence(NamedTuple):
    """Something happens."""

    time: float  # [s] from the start of the run
    position: Corner  # [m]
    service: float | None = None  # how long it keeps a robot [s]; None: as all others
    deadline: float | None = None  # how long it may wait for one [s]; None: as all others


Events: TypeAlias = Callable[
    [Ground, float, np.random.Generator, np.random.Generator], Iterator[Occurrence]
]
"""The robots' ground, mean rate [1/s], generator of places, generator of times."""


def uniform(
    ground: Ground, rate: float, places: np.random.Generator, times: np.random.Generator
) -> Iterator[Occurrence]:
    """Anywhere on the floor, hole included; in a stream as a Poisson process."""
    for time, site in zip(poisson_times(rate, times), uniform_sites(ground, places), strict=False):
        yield Occurrence(time, site)


def hot_spots(
    ground: Ground,
    rate: float,
    places: np.random.Generator,
    times: np.random.Generator,
    *,
    spots: int = 3,
    spread: float = 1.0,
    share: float = 0.8,
) -> Iterator[Occurrence]:
    """A share of the events around a few places, normally spread [m]; the rest anywhere."""
    if not (1 <= spots <= MOST and spread > 0.0 and 0.0 <= share <= 1.0):
        raise ValueError(
            f"hot spots: spots {spots}, spread {spread} m, share {share};"
            f" expected 1 to {MOST}, more than 0, and 0 to 1"
        )
    background = uniform_sites(ground, places)
    centres = [next(background) for _ in range(spots)]
    for time in poisson_times(rate, times):
        if times.random() < share:
            centre = centres[int(times.integers(spots))]
            yield Occurrence(time, _near(ground, centre, spread, background, places))
        else:
            yield Occurrence(time, next(background))


def bursts(
    ground: Ground,
    rate: float,
    places: np.random.Generator,
    times: np.random.Generator,
    *,
    size: float = 5.0,
    spacing: float = 1.0,
    spread: float = 1.0,
) -> Iterator[Occurrence]:
    """Groups of events, geometric in number, close in time [s] and place [m]."""
    if not (1.0 <= size <= MOST and spacing >= 0.0 and spread > 0.0):
        raise ValueError(
            f"bursts: size {size}, spacing {spacing} s, spread {spread} m;"
            f" expected 1 to {MOST}, at least 0, and more than 0"
        )
    background = uniform_sites(ground, places)
    last = 0.0
    for start in poisson_times(rate / size, times):
        time, centre = max(start, last), next(background)
        for _ in range(int(times.geometric(1.0 / size))):
            yield Occurrence(time, _near(ground, centre, spread, background, places))
            last = time
            time += float(times.exponential(spacing)) if spacing else 0.0


def trace(
    ground: Ground,
    rate: float,
    _places: np.random.Generator,
    _times: np.random.Generator,
    *,
    occurrences: EventTable,
    scale: float = 1.0,
) -> Iterator[Occurrence]:
    """The events of a file: time [s], x, y [m], service and deadline [s], all but x, y if wanted.

    Without times they come evenly, at the mean rate. ``scale``: x and y are in units of so many
    metres.
    """
    if not 3 <= occurrences.shape[1] <= 5:
        raise ValueError(
            f"a trace of {occurrences.shape[1]} columns; expected time, x, y, service, deadline"
        )
    if not 0.0 < scale < inf:
        raise ValueError(f"scale is {scale}; expected more than 0")
    times, positions = occurrences[:, 0], scale * occurrences[:, 1:3] - ground.arena.corner
    if np.isnan(times).all():
        times = np.arange(len(times)) / rate if 0.0 < rate < inf else np.zeros(len(times))
    _refuse(~np.isfinite(times), occurrences, "has no time; expected one in all rows, or in none")
    _refuse(times < 0.0, occurrences, "happens at {time:g} s; expected 0 or more")
    _refuse(~np.isfinite(positions).all(axis=1), occurrences, "is nowhere; expected x and y")
    size = np.array([ground.arena.width, ground.arena.height])
    outside = ((positions < 0.0) | (positions > size)).any(axis=1)
    _refuse(outside, occurrences, "lies outside the arena")
    _refuse(ground.buried(positions), occurrences, "lies in a wall or another obstacle")
    lost = f"is where no robot of radius {ground.radius:g} m gets to from the others"
    _refuse(~ground.serves(positions), occurrences, lost)
    for row in np.argsort(times, kind="stable").tolist():
        x, y = positions[row].tolist()
        extra = [None if np.isnan(value) else float(value) for value in occurrences[row, 3:5]]
        yield Occurrence(float(times[row]), (x, y), *extra)


def _refuse(which: Any, table: FloatArray, why: str) -> None:
    """Raise a ValueError about the first of the rows of a trace that are meant."""
    if which.any():
        row = int(np.argmax(which))
        time, x, y = table[row, :3].tolist()
        said = why.format(time=time)
        raise ValueError(f"row {row + 1}: the event at ({x:g}, {y:g}) {said}")


def poisson_times(rate: float, rng: np.random.Generator) -> Iterator[float]:
    """Times [s] of a Poisson process; for a rate of 0 or inf all at 0."""
    if not 0.0 < rate < inf:
        yield from (0.0 for _ in count())
    time = 0.0
    while True:
        for gap in rng.exponential(1.0 / rate, BLOCK).tolist():
            time += gap
            yield time


def uniform_sites(ground: Ground, rng: np.random.Generator) -> Iterator[Corner]:
    """Sites [m] without end, uniform over the ground: the hole included, obstacles not."""
    barren = 0
    while True:
        drawn = ground.arena.random_points(BLOCK, 0.0, rng)
        free = ground.holds(drawn)
        barren = 0 if free.any() else barren + 1
        if barren > BARREN:
            raise ImpossibleWorld(
                f"robots of radius {ground.radius:g} m get to too small a part of the floor:"
                f" {ground.area:.3g} m²; expected room for events"
            )
        yield from map(tuple, drawn[free].tolist())


def _near(
    ground: Ground,
    centre: Corner,
    spread: float,
    background: Iterator[Corner],
    rng: np.random.Generator,
) -> Corner:
    """A free place on the floor around a centre; anywhere, should there be none."""
    drawn = np.array(centre) + rng.normal(0.0, spread, (32, 2))
    inside = ((drawn >= 0.0) & (drawn <= [ground.arena.width, ground.arena.height])).all(axis=1)
    free = drawn[inside & ground.holds(drawn)]
    if not len(free):
        return next(background)
    x, y = free[0].tolist()
    return (x, y)
