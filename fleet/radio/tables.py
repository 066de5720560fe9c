"""What robots know of their neighbours: where each was last heard, for as long as that is valid.

Importing this module loads numba.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from protocols.compiled import kernel
from protocols.messages import Point, RobotId
from protocols.topology.relinking import blocks

Where = Callable[[RobotId], tuple[float, float, float]]
"""Where a robot itself is now [m], [m], and what time it is [s]."""


class Heard(NamedTuple):
    """What n robots have heard, at most ``capacity`` each; the first ``size`` of a row count."""

    known: NDArray[np.int64]  # (n, capacity): whom
    x: NDArray[np.float64]  # (n, capacity): where they were [m]
    y: NDArray[np.float64]
    time: NDArray[np.float64]  # (n, capacity): when that was [s]
    size: NDArray[np.int64]  # (n,)
    validity: float  # [s]
    told: NDArray[np.int64]  # (n, capacity): whom each listed in its last beacon; or (n, 0)
    told_size: NDArray[np.int64]  # (n,)


def nothing_heard(robots: int, capacity: int, validity: float, *, mutual: bool) -> Heard:
    """Empty tables. With ``mutual`` a link is cut only by witnesses that both its ends hear."""
    shape = (robots, max(capacity, 1))
    return Heard(
        np.zeros(shape, np.int64),
        np.zeros(shape),
        np.zeros(shape),
        np.zeros(shape),
        np.zeros(robots, np.int64),
        validity,
        np.zeros(shape if mutual else (robots, 0), np.int64),
        np.zeros(robots, np.int64),
    )


@kernel
def _drop(heard, u, slot):
    """Forget an entry: the last takes its place."""
    heard.size[u] -= 1
    last = heard.size[u]
    heard.known[u, slot], heard.time[u, slot] = heard.known[u, last], heard.time[u, last]
    heard.x[u, slot], heard.y[u, slot] = heard.x[u, last], heard.y[u, last]


@kernel
def note(heard: Heard, u: int, v: int, x: float, y: float, time: float) -> None:
    """Robot ``u`` hears that ``v`` is at (x, y) [m]. A full table drops what is oldest."""
    slot, oldest, k = -1, 0, 0
    while k < heard.size[u]:
        if heard.known[u, k] == v:
            slot = k
            break
        if time - heard.time[u, k] > heard.validity:
            _drop(heard, u, k)
            continue
        if heard.time[u, k] < heard.time[u, oldest]:
            oldest = k
        k += 1
    if slot < 0:
        if heard.size[u] < heard.known.shape[1]:
            slot = heard.size[u]
            heard.size[u] += 1
        else:
            slot = min(oldest, heard.known.shape[1] - 1)
    heard.known[u, slot] = v
    heard.x[u, slot], heard.y[u, slot], heard.time[u, slot] = x, y, time


@kernel
def tell(heard: Heard, u: int) -> None:
    """Robot ``u`` beacons: it lists whom it hears, where that is asked for."""
    if heard.told.shape[1] > 0:
        heard.told_size[u] = heard.size[u]
        for k in range(heard.size[u]):
            heard.told[u, k] = heard.known[u, k]


@kernel
def _shared(heard, v, w):
    """Whether ``v`` has said that it hears ``w``; without lists everybody near is heard by all."""
    if heard.told.shape[1] == 0:
        return True
    k, listed = 0, heard.told_size[v]
    while k < listed and heard.told[v, k] != w:
        k += 1
    return k < listed


@kernel
def forget(heard: Heard, u: int, v: int) -> None:
    """Robot ``u`` strikes ``v`` off its table."""
    for k in range(heard.size[u]):
        if heard.known[u, k] == v:
            _drop(heard, u, k)
            return


@kernel
def local_links(
    heard: Heard, graph: int, u: int, x: float, y: float, time: float, chosen: NDArray[np.int64]
) -> int:
    """The slots of the neighbours that ``u`` at (x, y) [m] keeps in its routing graph.

    Each robot reduces its own table, by the rule of the whole graph; where tables differ, so
    do the ends of a link. Returns their number; they are the first of ``chosen``.
    """
    count = 0
    for k in range(heard.size[u]):
        if time - heard.time[u, k] > heard.validity:
            continue
        free = True
        for j in range(heard.size[u]):
            if j == k or time - heard.time[u, j] > heard.validity:
                continue
            w, v = heard.known[u, j], heard.known[u, k]
            at_w, at_v = (heard.x[u, j], heard.y[u, j]), (heard.x[u, k], heard.y[u, k])
            if blocks(graph, w, u, v, at_w, (x, y), at_v) and _shared(heard, v, w):
                free = False
                break
        if free:
            chosen[count] = k
            count += 1
    return count


class HearsayTables(Sequence[Mapping[RobotId, Point]]):
    """The robots' routing tables, worked out when they are looked at."""

    def __init__(self, heard: Heard, graph: int, where: Where) -> None:
        self.heard = heard
        self._graph = graph
        self._where = where
        self._chosen = np.zeros(heard.known.shape[1], np.int64)

    @overload
    def __getitem__(self, robot: int) -> Mapping[RobotId, Point]: ...
    @overload
    def __getitem__(self, robot: slice) -> Sequence[Mapping[RobotId, Point]]: ...
    def __getitem__(
        self, robot: int | slice
    ) -> Mapping[RobotId, Point] | Sequence[Mapping[RobotId, Point]]:
        if isinstance(robot, slice):
            return [self[k] for k in range(len(self))[robot]]
        heard = self.heard
        count = local_links(heard, self._graph, robot, *self._where(robot), self._chosen)
        slots = self._chosen[:count]
        ids = heard.known[robot, slots].tolist()
        x, y = heard.x[robot, slots].tolist(), heard.y[robot, slots].tolist()
        return dict(sorted(zip(ids, zip(x, y, strict=True), strict=True)))

    def __len__(self) -> int:
        return len(self.heard.size)

    def __iter__(self) -> Iterator[Mapping[RobotId, Point]]:
        return (self[robot] for robot in range(len(self)))
