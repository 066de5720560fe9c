"""Rows of a recording as Arrow columns, built from NumPy arrays without walking them in Python.

A row belongs to one moment and holds any number of instances of each component: the columns
here are the instances of all rows, one after another, and how many belong to each row.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import rerun as rr
from numpy.typing import ArrayLike, NDArray

from fleet.replay.scheme import MSG, ROUND, SIM_TIME, STORY


class Moment(NamedTuple):
    """When a row is true, on all timelines."""

    time: float  # simulated [s]
    round: int
    msg: int
    story: float  # [s]

    def later(self, time: float) -> Moment:
        """At another simulated ``time`` [s], while nobody talks."""
        return self._replace(time=time, story=self.story + time - self.time)


class Index(NamedTuple):
    """The moments of many rows, each (k,)."""

    times: NDArray[np.float64]  # [s]
    rounds: NDArray[np.int64]
    msgs: NDArray[np.int64]
    stories: NDArray[np.float64]  # [s]

    @classmethod
    def of(cls, moments: Sequence[Moment]) -> Index:
        """The moments of rows that were kept one by one."""
        times, rounds, msgs, stories = zip(*moments, strict=True) if moments else ((), (), (), ())
        return cls(
            np.array(times, float),
            np.array(rounds, np.int64),
            np.array(msgs, np.int64),
            np.array(stories, float),
        )

    @classmethod
    def drive(cls, times: NDArray[np.float64], at: Moment) -> Index:
        """Simulated ``times`` (k,) [s] up to ``at``, while nobody talks."""
        k = len(times)
        whole = np.full(k, at.round, np.int64), np.full(k, at.msg, np.int64)
        return cls(times, *whole, times + (at.story - at.time))

    @classmethod
    def joined(cls, parts: Sequence[Index]) -> Index:
        """The moments of several, one after another."""
        return cls(
            np.concatenate([part.times for part in parts]),
            np.concatenate([part.rounds for part in parts]),
            np.concatenate([part.msgs for part in parts]),
            np.concatenate([part.stories for part in parts]),
        )

    def take(self, rows: NDArray[np.intp]) -> Index:
        """Some of them."""
        return Index(self.times[rows], self.rounds[rows], self.msgs[rows], self.stories[rows])

    def columns(self) -> list[rr.TimeColumn]:
        """As Rerun has them; times as whole nanoseconds, for fractions would be cut off."""
        times, stories = (
            np.rint(1e9 * seconds).astype("timedelta64[ns]")
            for seconds in (self.times, self.stories)
        )
        return [
            rr.TimeColumn(STORY, duration=stories),
            rr.TimeColumn(SIM_TIME, duration=times),
            rr.TimeColumn(ROUND, sequence=self.rounds),
            rr.TimeColumn(MSG, sequence=self.msgs),
        ]


class _Values(rr.ComponentBatchMixin):
    """Instances of a component, as they are."""

    def __init__(self, values: pa.Array) -> None:
        self.values = values

    def as_arrow_array(self) -> pa.Array:
        return self.values


def column(
    descriptor: rr.ComponentDescriptor, values: pa.Array, lengths: ArrayLike | None = None
) -> rr.ComponentColumn:
    """One component of many rows: all its instances, and how many a row has; None: one each."""
    return rr.ComponentColumn(descriptor, _Values(values), lengths=lengths)


def single(name: str, value: bool | int | float | str) -> rr.DescribedComponentBatch:
    """A plain value as a component of its own."""
    return rr.DescribedComponentBatch(_Values(pa.array([value])), rr.ComponentDescriptor(name))


_PAIR = pa.list_(pa.field("item", pa.float32(), nullable=False), 2)
_STRIP = pa.list_(pa.field("item", _PAIR, nullable=False))


def pairs(xy: ArrayLike) -> pa.Array:
    """Points or vectors (k, 2)."""
    flat = np.ascontiguousarray(xy, np.float32).reshape(-1)
    return pa.FixedSizeListArray.from_arrays(pa.array(flat), type=_PAIR)


def strips(xy: ArrayLike, points: ArrayLike) -> pa.Array:
    """Polylines: all their points (k, 2), and how many each has."""
    offsets = np.concatenate([[0], np.cumsum(np.asarray(points, np.int64))]).astype(np.int32)
    return pa.ListArray.from_arrays(pa.array(offsets), pairs(xy), type=_STRIP)


def segments(xy: ArrayLike) -> pa.Array:
    """Polylines of two points each: (k, 2, 2)."""
    ends = np.asarray(xy, np.float32).reshape(-1, 2, 2)
    return strips(ends, np.full(len(ends), 2))


def colours(rgba: ArrayLike) -> pa.Array:
    """Colours 0xRRGGBBAA (k,)."""
    return pa.array(np.asarray(rgba, np.uint32))


def reals(values: ArrayLike) -> pa.Array:
    """Numbers (k,) in single precision."""
    return pa.array(np.asarray(values, np.float32))


def doubles(values: ArrayLike) -> pa.Array:
    """Numbers (k,) in double precision."""
    return pa.array(np.asarray(values, np.float64))


def whole(values: ArrayLike) -> pa.Array:
    """Numbers (k,), none of them more than two thousand million."""
    return pa.array(np.asarray(values, np.int32))


def texts(values: Sequence[str | None]) -> pa.Array:
    """Texts (k,); None: nothing."""
    return pa.array(values, pa.string())


def own(archetype: str, name: str) -> rr.ComponentDescriptor:
    """The descriptor of a component that Rerun does not know."""
    return rr.ComponentDescriptor(f"{archetype}:{name}", archetype=archetype)
