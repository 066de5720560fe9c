"""The compiled half of the lossy radio: who hears a frame, and what beacons leave behind.

Chance is a function of who, what and when, not of a sequence of draws: a frame's fate does not
depend on how many others were sent before it, so runs that differ in one thing stay comparable.

Importing this module loads numba.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from protocols.compiled import kernel
from protocols.topology.relinking import blocks, gather

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]

FRAME, SHADOW, PHASE = 1, 2, 3  # what chance is asked for


class Air(NamedTuple):
    """The physical layer's numbers."""

    seed: int
    radio_range: float  # r [m]
    loss: float  # probability that a frame is lost, wherever
    loss_at_range: float  # and that it is lost at the edge of the range
    falloff: float  # power of the distance with which that grows
    shadowing: float  # standard deviation [dB]
    path_loss: float  # exponent of the path loss, which turns decibels into range


@kernel
def _mixed(state):
    """One step of splitmix64 (Steele, Lea and Flood, OOPSLA 2014)."""
    z = state + np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@kernel
def chance(seed, purpose, a, b, c):
    """A number in [0, 1) that depends on all arguments, and on nothing else."""
    state = _mixed(np.uint64(seed) ^ _mixed(np.uint64(purpose)))
    state = _mixed(state ^ np.uint64(a))
    state = _mixed(state ^ np.uint64(b))
    state = _mixed(state ^ np.uint64(c))
    return np.float64(state >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@kernel
def reach(air, u, v):
    """How far ``u`` and ``v`` hear one another [m]: the range, shadowed log-normally.

    The same both ways and for the whole run. The shadowing is cut off at two deviations.
    """
    if air.shadowing <= 0.0:
        return air.radio_range
    low, high = min(u, v), max(u, v)
    a = chance(air.seed, SHADOW, low, high, 0)
    b = chance(air.seed, SHADOW, low, high, 1)
    normal = math.sqrt(-2.0 * math.log(1.0 - a)) * math.cos(2.0 * math.pi * b)
    normal = min(max(normal, -2.0), 2.0)
    return air.radio_range * 10.0 ** (air.shadowing * normal / (10.0 * air.path_loss))


@kernel
def all_reaches(air, n):
    """How far each two of n robots hear one another [m]: (n, n)."""
    found = np.zeros((n, n))
    for u in range(n):
        for v in range(u):
            found[u, v] = found[v, u] = reach(air, u, v)
    return found


@kernel
def farthest(air):
    """The longest that any link can be [m]."""
    return air.radio_range * 10.0 ** (2.0 * air.shadowing / (10.0 * air.path_loss))


@kernel
def arrives(air, frame, sender, receiver, distance):
    """Whether a frame reaches a receiver ``distance`` [m] away."""
    limit = reach(air, sender, receiver)
    if distance > limit:
        return False
    lost = air.loss_at_range * (distance / limit) ** air.falloff
    through = (1.0 - air.loss) * (1.0 - lost)
    return chance(air.seed, FRAME, frame, sender, receiver) < through


@kernel
def broadcast(
    air: Air,
    frame: int,
    sender: int,
    on_air: NDArray[np.bool_],
    px: FloatArray,
    py: FloatArray,
    head: IntArray,
    after: IntArray,
    grid: FloatArray,
    marked: NDArray[np.bool_],
    near: IntArray,
) -> int:
    """Who hears a frame from ``sender``: their number; they are the first of ``near``."""
    x, y = px[sender], py[sender]
    count = gather(x, y, farthest(air), sender, px, py, head, after, grid, marked, near, 0)
    heard = 0
    for k in range(count):
        w = near[k]
        marked[w] = False
        if on_air[w] and arrives(air, frame, sender, w, math.hypot(px[w] - x, py[w] - y)):
            near[heard] = w
            heard += 1
    return heard


@kernel
def unicast(
    air: Air, frame: int, attempts: int, sender: int, receiver: int, distance: float
) -> int:
    """Send a frame until it is acknowledged; how many times, negative if it never got through.

    The acknowledgement travels back over the same air. A receiver that heard one of several
    copies has heard it, though every acknowledgement be lost: its own next frame tells.
    """
    heard = False
    for attempt in range(attempts):
        copy = 64 * frame + 2 * attempt
        if arrives(air, copy, sender, receiver, distance):
            heard = True
            if arrives(air, copy + 1, receiver, sender, distance):
                return attempt + 1
    return attempts if heard else -attempts


@kernel
def note(
    u: int,
    v: int,
    x: float,
    y: float,
    time: float,
    known: IntArray,
    where_x: FloatArray,
    where_y: FloatArray,
    heard_at: FloatArray,
    size: IntArray,
    validity: float,
) -> None:
    """Robot ``u`` hears where ``v`` is. A full table drops what is oldest."""
    slot, oldest = -1, 0
    k = 0
    while k < size[u]:
        if known[u, k] == v:
            slot = k
            break
        if time - heard_at[u, k] > validity:  # forgotten: the last entry takes its place
            size[u] -= 1
            last = size[u]
            known[u, k], heard_at[u, k] = known[u, last], heard_at[u, last]
            where_x[u, k], where_y[u, k] = where_x[u, last], where_y[u, last]
            continue
        if heard_at[u, k] < heard_at[u, oldest]:
            oldest = k
        k += 1
    if slot < 0:
        if size[u] < known.shape[1]:
            slot = size[u]
            size[u] += 1
        else:
            slot = min(oldest, known.shape[1] - 1)
    known[u, slot] = v
    where_x[u, slot], where_y[u, slot], heard_at[u, slot] = x, y, time


@kernel
def forget(
    u: int,
    v: int,
    known: IntArray,
    where_x: FloatArray,
    where_y: FloatArray,
    heard_at: FloatArray,
    size: IntArray,
) -> None:
    """Robot ``u`` strikes ``v`` off its table."""
    for k in range(size[u]):
        if known[u, k] == v:
            size[u] -= 1
            last = size[u]
            known[u, k], heard_at[u, k] = known[u, last], heard_at[u, last]
            where_x[u, k], where_y[u, k] = where_x[u, last], where_y[u, last]
            return


@kernel
def beacons_until(
    time: float,
    air: Air,
    interval: float,
    jitter: float,
    validity: float,
    due: FloatArray,
    sent: IntArray,
    on_air: NDArray[np.bool_],
    px: FloatArray,
    py: FloatArray,
    head: IntArray,
    after: IntArray,
    grid: FloatArray,
    marked: NDArray[np.bool_],
    near: IntArray,
    known: IntArray,
    where_x: FloatArray,
    where_y: FloatArray,
    heard_at: FloatArray,
    size: IntArray,
) -> int:
    """Send every beacon that is due up to ``time`` [s], in the order of time; how many.

    ``due`` (n,): when each robot beacons next [s]; ``sent`` (n,): how many it has sent. All
    are sent from where robots are now, so call it as often as that matters. The tables are
    ``known``, ``where_x``, ``where_y``, ``heard_at`` (n, capacity) and ``size`` (n,).
    """
    count = 0
    while True:
        robot = int(np.argmin(due))
        now = due[robot]
        if now > time:
            return count
        sent[robot] += 1
        step = 1.0 + jitter * (chance(air.seed, PHASE, robot, sent[robot], 0) - 0.5)
        due[robot] = now + interval * step
        if not on_air[robot]:
            continue
        count += 1
        frame = -sent[robot]  # beacons are numbered apart from messages
        heard = broadcast(air, frame, robot, on_air, px, py, head, after, grid, marked, near)
        for k in range(heard):
            note(
                near[k], robot, px[robot], py[robot], now,
                known, where_x, where_y, heard_at, size, validity,
            )  # fmt: skip


@kernel
def local_links(
    u: int,
    x: float,
    y: float,
    time: float,
    validity: float,
    graph: int,
    known: IntArray,
    where_x: FloatArray,
    where_y: FloatArray,
    heard_at: FloatArray,
    size: IntArray,
    chosen: IntArray,
) -> int:
    """The slots of the neighbours that ``u`` at (x, y) [m] keeps in its routing graph.

    Each robot reduces its own table, by the rule of the whole graph; where tables differ, so
    do the ends of a link. Returns their number; they are the first of ``chosen``.
    """
    count = 0
    for k in range(size[u]):
        if time - heard_at[u, k] > validity:
            continue
        free = True
        for j in range(size[u]):
            if j == k or time - heard_at[u, j] > validity:
                continue
            if blocks(
                graph, known[u, j], u, known[u, k],
                where_x[u, j], where_y[u, j], x, y, where_x[u, k], where_y[u, k],
            ):  # fmt: skip
                free = False
                break
        if free:
            chosen[count] = k
            count += 1
    return count
