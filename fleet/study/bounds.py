"""How long all joules of a fleet could last: a yardstick, and a bound that nobody exceeds.

For the paper's motion, in which a trip costs Eq. (1) on the straight line.
"""

from __future__ import annotations

from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.assembly import make_schedule, streams
from fleet.placement import start
from fleet.scenario.choices import make_world
from fleet.scenario.model import Scenario
from fleet.schedule import Schedule
from worlds.ground import ground_of

SITES = 2000  # events looked at to tell how far the nearest robot is, and more if they last


class Bounds(NamedTuple):
    """Rounds that all joules of a fleet would last for.

    ``nearest`` is a yardstick: what sending the nearest robot comes to, if robots stayed as
    evenly spread as they start. ``foresight`` is a bound: no allocation whatever outlives it.
    """

    nearest: float  # if each event cost a trip from the nearest place that a robot starts at
    foresight: float  # if trips were the shortest that serve all events, known in advance


def bounds(scenario: Scenario) -> Bounds:
    """The bounds of the fleet and the events of ``scenario``, in rounds and ``straight`` motion.

    Batteries count as one: that a robot runs empty while others hold plenty shortens neither.
    The effort grows with the cube of the bound: seconds for one of 2000 rounds.

    Raises:
        BadInput: something in the scenario does not exist, or does not fit.
        ImpossibleWorld: no connected network of these robots was found in this world.
    """
    random = streams(scenario.seed)
    world = make_world(scenario.world)
    ground = ground_of(world.arena, 0.0, world.start)
    starts = np.array(start(world, ground, scenario, random["placement"]))
    schedule = make_schedule(scenario, ground, len(starts), random)
    sites = _next_sites(schedule, SITES)
    spec = scenario.robot
    reach = spec.capacity * len(starts) / spec.power.per_metre(spec.cruise)  # [m], of them all
    nearest = float(_distances(sites, starts).min(axis=1).mean())  # [m]
    while (most := _most(starts, sites, reach)) == len(sites):
        more = _next_sites(schedule, len(sites))
        if not len(more):
            break  # there are no more events
        sites = np.vstack([sites, more])
    return Bounds(reach / nearest, most)


def _next_sites(schedule: Schedule, count: int) -> NDArray[np.float64]:
    """Where the next events happen (at most count, 2) [m]."""
    places = [occurrence.position for occurrence in islice(schedule.occurrences, count)]
    return np.array(places, float).reshape(-1, 2)


def shortest_service(starts: NDArray[np.float64], sites: NDArray[np.float64]) -> float:
    """The least distance [m] in which robots at ``starts`` (n, 2) serve ``sites`` (m, 2) in order.

    The offline k-server problem. Whoever serves a site comes from where it served one before, or
    from its start, and every such place is left once: an assignment of places to later sites
    (Chrobak, Karloff, Payne and Vishwanathan, SIAM J. Discrete Math. 4(2):172, 1991).
    """
    from scipy.optimize import linear_sum_assignment

    if not len(sites):
        return 0.0
    lengths = _distances(sites, np.vstack([starts, sites[:-1]]))
    order = np.arange(len(sites))
    lengths[:, len(starts) :][order[:-1] >= order[:, None]] = np.inf  # not served yet
    rows, places = linear_sum_assignment(lengths)
    return float(lengths[rows, places].sum())


def _most(starts: NDArray[np.float64], sites: NDArray[np.float64], reach: float) -> int:
    """How many of ``sites``, from the first, can be served within ``reach`` [m]."""
    low, high = 0, len(sites)
    while low < high:
        middle = (low + high + 1) // 2
        if shortest_service(starts, sites[:middle]) <= reach:
            low = middle
        else:
            high = middle - 1
    return low


def _distances(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """From each of ``a`` (m, 2) to each of ``b`` (n, 2): (m, n) [m]."""
    return np.asarray(np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1)))
