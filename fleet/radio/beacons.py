"""Beacons over a radio that takes no turns: who sends one when, and who hears it.

Robots announce their positions as GPSR does (Karp and Kung, MobiCom 2000): every so often,
jittered. Where links are no disc, a beacon also lists whom its sender hears, so that both ends
of a link know which witnesses they share (mutual witness, Kim et al., NSDI 2005).

Importing this module loads numba.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.radio.propagation import PHASE, Air, arrives, chance, farthest, hears, reach
from fleet.radio.tables import Heard, note, tell
from protocols.compiled import kernel
from protocols.topology.cells import Cells, gather

NEAREST = 0.01  # robots are taken to be at least so far apart, as antennas are [m]


class Rota(NamedTuple):
    """When each of n robots beacons next: a binary heap, the soonest first, then the lowest id."""

    interval: float  # [s]
    jitter: float  # share of the interval over which beacons are spread
    due: NDArray[np.float64]  # (n,) [s]
    order: NDArray[np.int64]  # (n,) robots as a heap
    sent: NDArray[np.int64]  # (n,) how many each has sent


def rota(air: Air, robots: int, interval: float, jitter: float, rounds: int) -> Rota:
    """Everybody has beaconed ``rounds`` times before time 0."""
    phases = [chance(air.seed, PHASE, robot, 0, 0) for robot in range(robots)]
    due = interval * (np.array(phases, float) - rounds)
    order = np.lexsort((np.arange(robots), due)).astype(np.int64)  # sorted, so a heap
    return Rota(interval, jitter, due, order, np.zeros(robots, np.int64))


@kernel
def _sooner(rota, u, v):
    """Whether ``u`` beacons before ``v``."""
    return rota.due[u] < rota.due[v] or (rota.due[u] == rota.due[v] and u < v)


@kernel
def _postpone(rota, until):
    """The first of the heap beacons at ``until`` [s] next."""
    robot = rota.order[0]
    rota.due[robot] = until
    hole, n = 0, len(rota.order)
    while 2 * hole + 1 < n:
        child = 2 * hole + 1
        if child + 1 < n and _sooner(rota, rota.order[child + 1], rota.order[child]):
            child += 1
        if not _sooner(rota, rota.order[child], robot):
            break
        rota.order[hole] = rota.order[child]
        hole = child
    rota.order[hole] = robot


@kernel
def postponed(rota: Rota, seed: int) -> int:
    """Whose turn it is; that robot's next beacon is put down."""
    robot = int(rota.order[0])
    rota.sent[robot] += 1
    step = 1.0 + rota.jitter * (chance(seed, PHASE, robot, rota.sent[robot], 0) - 0.5)
    _postpone(rota, rota.due[robot] + rota.interval * step)
    return robot


@kernel
def _around(places, robot, distance):
    """Who is within a distance [m]: how many, and they are the first of ``near``."""
    count = gather(places, places.x[robot], places.y[robot], distance, robot, 0)
    for k in range(count):
        places.marked[places.near[k]] = False
    return count


@kernel
def hearers(air: Air, places: Cells, robot: int, on_air: NDArray[np.bool_]) -> int:
    """Who hears the robot where nothing is lost: how many, and they are first of ``near``."""
    p = places
    x, y = p.x[robot], p.y[robot]
    heard = 0
    for k in range(_around(places, robot, farthest(air))):
        w = p.near[k]
        if on_air[w] and hears(air, robot, w, x, y, p.x[w], p.y[w]):
            p.near[heard] = w
            heard += 1
    return heard


@kernel
def audible(
    air: Air,
    places: Cells,
    robot: int,
    on_air: NDArray[np.bool_],
    weakest: float,
    power: NDArray[np.float64],
) -> int:
    """Whom a frame of the robot's matters to, if only as noise: how many, first of ``near``.

    ``power``: how strong it is there, over the weakest that can be received.
    """
    p = places
    x, y = p.x[robot], p.y[robot]
    heard = 0
    for k in range(_around(places, robot, farthest(air) * weakest ** (-1.0 / air.path_loss))):
        w = p.near[k]
        away = max(math.hypot(p.x[w] - x, p.y[w] - y), NEAREST)
        here = (reach(air, x, y, p.x[w], p.y[w]) / away) ** air.path_loss
        if on_air[w] and here >= weakest:
            p.near[heard], power[heard] = w, here
            heard += 1
    return heard


@kernel
def broadcast(air: Air, places: Cells, frame: int, sender: int, on_air: NDArray[np.bool_]) -> int:
    """Who hears a frame from ``sender``: their number; they are the first of ``near``."""
    p = places
    x, y = p.x[sender], p.y[sender]
    heard = 0
    for k in range(_around(places, sender, farthest(air))):
        w = p.near[k]
        if on_air[w] and arrives(air, frame, sender, w, x, y, p.x[w], p.y[w]):
            p.near[heard] = w
            heard += 1
    return heard


@kernel
def beacons_until(
    time: float, air: Air, rota: Rota, places: Cells, heard: Heard, on_air: NDArray[np.bool_]
) -> int:
    """Send every beacon that is due up to ``time`` [s], in the order of time; how many.

    All are sent from where robots are now, so call it as often as that matters.
    """
    count = 0
    while len(rota.order) > 0 and rota.due[rota.order[0]] <= time:
        now = rota.due[rota.order[0]]
        robot = postponed(rota, air.seed)
        if not on_air[robot]:
            continue
        count += 1
        frame = -rota.sent[robot]  # beacons are numbered apart from messages
        hearers = broadcast(air, places, frame, robot, on_air)
        tell(heard, robot)
        for k in range(hearers):
            note(heard, places.near[k], robot, places.x[robot], places.y[robot], now)
    return count
