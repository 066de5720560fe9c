"""Where the robots of a run start: drawn until they make one network, or refused at once."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from math import ceil, exp, floor, log, log10, pi, sqrt

import numpy as np

from fleet.scenario.model import Scenario
from protocols.messages import Point
from protocols.topology import connected, unit_disc
from worlds.arena import FloatArray, ImpossibleWorld
from worlds.catalogue import World
from worlds.ground import Ground

ATTEMPTS = 2000  # placements drawn in search of a connected network
LOOKED_AT = 8  # of them before it is judged whether to go on
FORLORN = 1e-3  # connected placements that are to be expected of all, below which it is not
MOST_LINKS = 20_000_000  # twice the unit disc links that fit into memory and patience
EULER = 0.5772156649  # the mean of a standard Gumbel distribution
ROOMY = 0.55  # share of the floor that bodies easily cover, and a quarter more
MOST_TRIED = 5000  # robots, in search of a number that would do: more take long
DENSE = 200  # robots up to which all distances at once give the spanning tree

Progress = Callable[[int, int], object]
"""Called with how many placements were drawn, and of how many at most."""


def start(
    world: World,
    ground: Ground,
    scenario: Scenario,
    rng: np.random.Generator,
    progress: Progress = lambda _tried, _most: None,
) -> list[Point]:
    """Places [m] on the ``ground`` for the scenario's robots that make one network.

    Before much is tried, it is judged from the first placements whether one of the rest may be
    connected at all; see :func:`_expected`.

    Raises:
        ImpossibleWorld: the robots do not fit, or none of :data:`ATTEMPTS` placements was, or
            would be, connected, where it must be. The sentence says what would do; that has been
            tried.
    """
    count, reach = scenario.robots or world.robots, scenario.range
    _check_links(count, reach, ground.area)
    fresh = deepcopy(rng)
    seen: list[FloatArray] = []  # the first placements
    most = 1 if world.fixed else ATTEMPTS
    for tried in range(1, most + 1):
        try:
            positions = world.place(ground.arena, count, ground.radius, rng)
        except ImpossibleWorld as error:
            raise _with_hint(error, _fewer(world, ground, scenario, count, fresh)) from None
        if not scenario.connected or connected(count, unit_disc(positions, reach)):
            return [(x, y) for x, y in positions.tolist()]
        progress(tried, most)
        if tried <= LOOKED_AT:
            seen.append(positions)
        if tried == LOOKED_AT and most * _expected(seen, reach, ground) < FORLORN:
            break
    needed = _rounded_up(min(map(critical_range, seen)))
    robots = None if world.fixed else _more(world, ground, scenario, seen, fresh)
    raise ImpossibleWorld(_refusal(world, scenario, count, tried, needed, robots))


def critical_range(positions: FloatArray) -> float:
    """The least radio range [m] that makes one network of robots at ``positions`` (n, 2) [m].

    It is the longest edge of their minimum spanning tree, which is part of their Delaunay
    triangulation (Penrose, Ann. Appl. Probab. 7:340, 1997, doi:10.1214/aoap/1034625335).
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import minimum_spanning_tree
    from scipy.spatial import Delaunay

    count = len(positions)
    if count < 2:
        return 0.0
    if count <= DENSE:
        pairs = np.argwhere(np.triu(np.ones((count, count), bool), 1))
    else:
        corners = Delaunay(positions, qhull_options="QJ").simplices
        pairs = np.sort(np.vstack([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]))
        pairs = np.unique(pairs, axis=0)
    length = np.hypot(*(positions[pairs[:, 0]] - positions[pairs[:, 1]]).T)
    length = np.maximum(length, 1e-12)  # nothing is no edge
    links = coo_array((length, (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return float(minimum_spanning_tree(links.tocsr()).data.max())


def _expected(seen: list[FloatArray], reach: float, ground: Ground) -> float:
    """The probability that a placement is connected within ``reach`` [m], from some placements.

    n·π·r²/A of the least range is Gumbel distributed, with the scale 1 on an open floor (Penrose);
    on others, and for few robots, it spreads more.
    """
    needed = _degrees(seen, ground)
    scale = max(1.0, float(needed.std(ddof=1)) * sqrt(6.0) / pi)
    degree = len(seen[0]) * pi * reach**2 / ground.area
    lag = (degree - float(needed.mean())) / scale + EULER
    return exp(-exp(min(-lag, 700.0)))


def _degrees(seen: list[FloatArray], ground: Ground) -> FloatArray:
    """The mean number of neighbours within the critical range of each placement."""
    per_square = len(seen[0]) * pi / ground.area
    return np.array([per_square * critical_range(positions) ** 2 for positions in seen])


def _check_links(count: int, reach: float, area: float) -> None:
    degree = min(count * pi * reach**2 / area, count)
    if count * degree > MOST_LINKS:
        raise ImpossibleWorld(
            f"robots is {count}; {degree:.0f} of them within range of each"
            f" are too many links to keep; expected fewer robots or a shorter range"
        )


def _does(
    world: World, ground: Ground, scenario: Scenario, count: int, fresh: np.random.Generator
) -> bool:
    """Whether so many robots find places among the first few that are drawn for them."""
    rng = deepcopy(fresh)
    try:
        _check_links(count, scenario.range, ground.area)
        for _ in range(LOOKED_AT // 2):
            positions = world.place(ground.arena, count, ground.radius, rng)
            if not scenario.connected or connected(count, unit_disc(positions, scenario.range)):
                return True
    except ImpossibleWorld:
        pass
    return False


def _fewer(
    world: World, ground: Ground, scenario: Scenario, count: int, fresh: np.random.Generator
) -> int | None:
    """A smaller number of robots that would do, if one is found; tried by the same seed."""
    if ground.radius > 0.0:
        count = min(count, ceil(ROOMY * ground.covered / (pi * ground.radius**2)))
    while not world.fixed and count > 1:
        count = floor(0.8 * count)
        if _does(world, ground, scenario, count, fresh):
            return count
    return None


def _more(
    world: World,
    ground: Ground,
    scenario: Scenario,
    seen: list[FloatArray],
    fresh: np.random.Generator,
) -> int | None:
    """A larger number of robots that would do, if one is found; tried by the same seed.

    The degree that is needed grows with the logarithm of their number.
    """
    offset = float(_degrees(seen, ground).mean()) - log(len(seen[0]))
    estimate = float(len(seen[0]))
    for _ in range(20):
        estimate = ground.area / (pi * scenario.range**2) * max(1.0, log(estimate) + offset)
    for more in (1.0, 1.15, 1.3, 1.6, 2.0):
        count = ceil(more * estimate)
        if len(seen[0]) < count <= MOST_TRIED and _does(world, ground, scenario, count, fresh):
            return count
    return None


def _rounded_up(reach: float) -> float:
    """To two digits, never less [m]."""
    unit = 10.0 ** (floor(log10(reach)) - 1)
    return float(f"{ceil(reach / unit - 1e-9) * unit:.12g}")


def _with_hint(error: ImpossibleWorld, robots: int | None) -> ImpossibleWorld:
    return error if robots is None else ImpossibleWorld(f"{error}; robots = {robots} would do")


def _refusal(
    world: World, scenario: Scenario, count: int, tried: int, needed: float, robots: int | None
) -> str:
    which = "the placement" if world.fixed else f"none of {tried} placements"
    verb = "is not" if world.fixed else "made"
    more = "" if robots is None else f" or robots = {robots}"
    return (
        f"range is {scenario.range:g} m; {which} of {count} robots {verb} a connected network;"
        f" range = {needed:g}{more} would do, or connected = false"
    )
