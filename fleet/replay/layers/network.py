"""The links while robots drive, as those that stay and those that come and go.

Everybody but the movers is at rest, so of all links few change: those of the movers, and in
the Gabriel graph those whose disc a mover crosses. Only these are worked out for every
moment, and only these are written for every moment.

A link (u, v), u < v, of n robots is the number u·n + v.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from protocols.topology import GraphName, between, components, edges

FloatArray = NDArray[np.float64]
Codes = NDArray[np.intp]  # (m,) ascending


DOUBT = 1e-8  # share of a squared length that rounding cannot come to


class Spell(NamedTuple):
    """The links over some moments."""

    fixed: Codes  # among robots at rest, and there at every moment
    varying: list[Codes]  # the others of each moment


def whole(positions: FloatArray, radio_range: float, graph: GraphName) -> Codes:
    """All links over ``positions`` (n, 2) [m]; NaN for robots off the air."""
    return encode(edges(positions, radio_range, graph), len(positions))


def encode(pairs: NDArray[np.intp], n: int) -> Codes:
    """Links as numbers, ascending."""
    return np.asarray(np.sort(pairs[:, 0] * n + pairs[:, 1]))


def in_all(several: Sequence[Codes]) -> Codes:
    """The links that are in every one of some lists."""
    count = len(several)
    ordered = np.sort(np.concatenate(several))
    first, last = ordered[: max(len(ordered) - count + 1, 0)], ordered[count - 1 :]
    return np.asarray(first[first == last])


def without(codes: Codes, others: Codes) -> Codes:
    """The links that are not among others."""
    if not len(others):
        return codes
    place = np.minimum(np.searchsorted(others, codes), len(others) - 1)
    return np.asarray(codes[others[place] != codes])


def any_spell(
    positions: FloatArray, robots: Sequence[int], places: FloatArray, radio_range: float,
    graph: GraphName,
) -> Spell:  # fmt: skip
    """Links over the moments k at which ``robots`` (j,) are at ``places`` (k, j, 2) [m].

    Works for every graph and any number of movers, by computing every moment anew.
    """
    moments = []
    positions = positions.copy()
    for at in places:
        positions[list(robots)] = at
        moments.append(whole(positions, radio_range, graph))
    fixed = in_all(moments)
    for robot in robots:
        fixed = fixed[~touching(fixed, len(positions), robot)]
    return Spell(fixed, [without(codes, fixed) for codes in moments])


class MoverReach(NamedTuple):
    """Whom a mover reaches at each of k moments."""

    robot: int
    n: int
    places: FloatArray  # (k, 2) [m]
    squared: FloatArray  # (k, n) distances to everybody [m²]; NaN: off the air
    moment: NDArray[np.intp]  # (p,) ascending
    others: NDArray[np.intp]  # (p,) robots within range at that moment

    @classmethod
    def of(
        cls, positions: FloatArray, robot: int, places: FloatArray, radio_range: float
    ) -> MoverReach:
        """Robots whose position is NaN are out of everybody's reach."""
        squared = _squared(places, positions)
        squared[:, robot] = np.inf
        moment, others = np.nonzero(squared <= radio_range * radio_range)
        return cls(robot, len(positions), places, squared, moment, others)

    def rows(self, kept: NDArray[np.bool_]) -> list[Codes]:
        """The kept ones as links, moment by moment."""
        others = self.others[kept]
        codes = np.minimum(others, self.robot) * self.n + np.maximum(others, self.robot)
        cuts = np.searchsorted(self.moment[kept], np.arange(1, len(self.places)))
        return np.split(codes, cuts)


def disc_spell(before: Codes, robot: int, reach: MoverReach) -> Spell:
    """Links of the unit disc graph while one robot drives; ``before``: before it set off."""
    fixed = before[~touching(before, reach.n, robot)]
    return Spell(fixed, reach.rows(np.ones(len(reach.others), bool)))


def gabriel_spell(
    before: Codes, disc: Codes, positions: FloatArray, robot: int, reach: MoverReach
) -> Spell:
    """Links of the Gabriel graph while one robot drives.

    ``before`` are those before it set off, from ``positions`` (n, 2) [m]; ``disc`` are the
    links of the unit disc graph that stay.
    """
    n = len(positions)
    others = positions.copy()
    others[robot] = np.nan
    freed = without(disc, before)
    freed = freed[_covering(freed, positions, robot, positions[robot, None])[0]]
    stay = np.union1d(before[~touching(before, n, robot)], freed[~_blocked(freed, others)])

    rows = reach.rows(~_cut_off(positions, robot, reach))
    crossed = _covering(stay, positions, robot, reach.places)
    ever = crossed.any(axis=0)
    sometimes, shut = stay[ever], crossed[:, ever]
    moment, link = np.nonzero(~shut)
    cuts = np.searchsorted(moment, np.arange(1, len(shut)))
    open_ = np.split(sometimes[link], cuts)
    return Spell(
        stay[~ever],
        [np.sort(np.concatenate(both)) for both in zip(rows, open_, strict=True)],
    )


def _cut_off(positions: FloatArray, robot: int, reach: MoverReach) -> NDArray[np.bool_]:
    """Which of those within reach (p,) somebody keeps from the mover."""
    w = np.unique(reach.others)  # whoever comes between is within reach as well
    apart = _squared(positions[w], positions[w])
    np.fill_diagonal(apart, np.inf)
    near, row = reach.squared[:, w], np.searchsorted(w, reach.others)

    def exactly(pair: NDArray[np.intp], third: NDArray[np.intp]) -> NDArray[np.bool_]:
        other, here = reach.others[pair], reach.places[reach.moment[pair]]
        return _between(robot, other, w[third], here, positions[other], positions[w[third]])

    cut_off = np.zeros(len(row), bool)
    for start in range(0, len(row), 512):
        part = slice(start, start + 512)
        moment = reach.moment[part]
        cut_off[part] = _in_disc(
            near[moment], apart[row[part]], near[moment, row[part]][:, None],
            lambda pair, third, start=start: exactly(start + pair, third),
        ).any(axis=1)  # fmt: skip
    return cut_off


def _covering(
    codes: Codes, positions: FloatArray, robot: int, places: FloatArray
) -> NDArray[np.bool_]:
    """Over which links' discs (k, m) the mover is at each of its ``places`` (k, 2) [m]."""
    u, v = np.divmod(codes, len(positions))
    uv = ((positions[u] - positions[v]) ** 2).sum(axis=1)
    away = _squared(places, positions)

    def exactly(moment: NDArray[np.intp], link: NDArray[np.intp]) -> NDArray[np.bool_]:
        a, b = u[link], v[link]
        return _between(a, b, robot, positions[a], positions[b], places[moment])

    return _in_disc(away[:, u], away[:, v], uv, exactly)


def _in_disc(
    uw: FloatArray, vw: FloatArray, uv: FloatArray,
    exactly: Callable[..., NDArray[np.bool_]],
) -> NDArray[np.bool_]:  # fmt: skip
    """Whether w lies in the closed disc over uv, by squared distances [m²]; where rounding leaves
    that in doubt, ``exactly`` is asked, by indices.
    """
    excess = uw + vw - uv
    doubtful = np.abs(excess) <= DOUBT * uv
    inside = excess <= 0.0
    if doubtful.any():
        where = np.nonzero(doubtful)
        inside[where] = exactly(*where)
    return np.asarray(inside)


def _squared(one: FloatArray, other: FloatArray) -> FloatArray:
    """Squared distances (k, m) [m²] from each of (k, 2) to each of (m, 2) [m]."""
    dx = one[:, 0, None] - other[:, 0]
    dy = one[:, 1, None] - other[:, 1]
    return np.asarray(dx * dx + dy * dy)


def touching(codes: Codes, n: int, robot: int) -> NDArray[np.bool_]:
    """Which links are the robot's."""
    u, v = np.divmod(codes, n)
    return np.asarray((u == robot) | (v == robot))


def component_counts(
    links: Sequence[Codes], on_air: Sequence[NDArray[np.bool_]], n: int
) -> NDArray[np.intp]:
    """How many connected components the robots ``on_air`` (n,) form, for each list of links."""
    shift = np.repeat(n * np.arange(len(links)), [len(codes) for codes in links])
    ends = np.divmod(np.concatenate([np.empty(0, np.intp), *links]), n)
    lowest = components(n * len(links), np.stack(ends, axis=1) + shift[:, None])
    roots = (lowest == np.arange(len(lowest))).reshape(-1, n) & np.array(on_air).reshape(-1, n)
    return np.asarray(roots.sum(axis=1))


def _blocked(codes: Codes, positions: FloatArray) -> NDArray[np.bool_]:
    """Which links have any robot in their disc."""
    u, v = np.divmod(codes, len(positions))
    from_u, from_v = _squared(positions[u], positions), _squared(positions[v], positions)
    link = np.arange(len(codes))
    uv = from_u[link, v][:, None]
    from_u[link, u] = from_v[link, v] = np.inf  # nobody is in its own way

    def exactly(link: NDArray[np.intp], w: NDArray[np.intp]) -> NDArray[np.bool_]:
        a, b = u[link], v[link]
        return _between(a, b, w, positions[a], positions[b], positions[w])

    return np.asarray(_in_disc(from_u, from_v, uv, exactly).any(axis=1))


def _between(
    u: NDArray[np.intp] | int, v: NDArray[np.intp], w: NDArray[np.intp] | int,
    at_u: FloatArray, at_v: FloatArray, at_w: FloatArray,
) -> NDArray[np.bool_]:  # fmt: skip
    """Whether w, at ``at_w`` (..., 2) [m], keeps u and v apart."""
    to_u, to_v = at_u - at_w, at_v - at_w
    return np.asarray(between(u, v, w, (to_u[..., 0], to_u[..., 1]), (to_v[..., 0], to_v[..., 1])))
