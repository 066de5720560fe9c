"""The links while robots drive, as those that stay and those that come and go.

Everybody but the movers is at rest, so of all links few change: those of the movers, and in
the Gabriel graph those whose disc a mover crosses. Only these are worked out for every
moment, and only these are written for every moment.

A link (u, v), u < v, of n robots is the number u·n + v.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from protocols.links import between, components
from protocols.topology import GraphName, edges

FloatArray = NDArray[np.float64]
Codes = NDArray[np.intp]  # (m,) ascending


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


class Reach(NamedTuple):
    """Whom a mover reaches at each of k moments."""

    robot: int
    n: int
    places: FloatArray  # (k, 2) [m]
    moment: NDArray[np.intp]  # (p,) ascending
    others: NDArray[np.intp]  # (p,) robots within range at that moment

    @classmethod
    def of(cls, positions: FloatArray, robot: int, places: FloatArray, radio_range: float) -> Reach:
        """Robots whose position is NaN are out of everybody's reach."""
        away = positions[None, :, :] - places[:, None, :]
        near = (away * away).sum(axis=2) <= radio_range * radio_range
        near[:, robot] = False
        moment, others = np.nonzero(near)
        return cls(robot, len(positions), places, moment, others)

    def rows(self, kept: NDArray[np.bool_]) -> list[Codes]:
        """The kept ones as links, moment by moment."""
        others = self.others[kept]
        codes = np.minimum(others, self.robot) * self.n + np.maximum(others, self.robot)
        cuts = np.searchsorted(self.moment[kept], np.arange(1, len(self.places)))
        return np.split(codes, cuts)


def disc_spell(before: Codes, robot: int, reach: Reach) -> Spell:
    """Links of the unit disc graph while one robot drives; ``before``: before it set off."""
    fixed = before[~touching(before, reach.n, robot)]
    return Spell(fixed, reach.rows(np.ones(len(reach.others), bool)))


def gabriel_spell(
    before: Codes, disc: Codes, positions: FloatArray, robot: int, reach: Reach
) -> Spell:
    """Links of the Gabriel graph while one robot drives.

    ``before`` are those before it set off, from ``positions`` (n, 2) [m]; ``disc`` are the
    links of the unit disc graph that stay.
    """
    n = len(positions)
    others = positions.copy()
    others[robot] = np.nan
    freed = without(disc, before)
    u, v = np.divmod(freed, n)
    freed = freed[_between(u, v, robot, positions[u], positions[v], positions[robot])]
    stay = np.union1d(before[~touching(before, n, robot)], freed[~_blocked(freed, others)])

    kept = np.ones(len(reach.others), bool)
    w = np.unique(reach.others)  # whoever comes between is within reach as well
    for start in range(0, len(kept), 512):
        part = slice(start, start + 512)
        other = reach.others[part, None]
        here = reach.places[reach.moment[part], None]
        kept[part] = ~_between(robot, other, w, here, positions[other], others[w]).any(axis=1)
    rows = reach.rows(kept)

    u, v = np.divmod(stay, n)
    crossed = _between(u, v, robot, positions[u], positions[v], reach.places[:, None])  # (k, m)
    ever = crossed.any(axis=0)
    open_ = [stay[ever][~shut] for shut in crossed[:, ever]]
    return Spell(
        stay[~ever],
        [np.sort(np.concatenate(both)) for both in zip(rows, open_, strict=True)],
    )


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
    n = len(positions)
    u, v = (end[:, None] for end in np.divmod(codes, n))
    return np.asarray(
        _between(u, v, np.arange(n), positions[u], positions[v], positions).any(axis=1)
    )


def _between(
    u: NDArray[np.intp] | int, v: NDArray[np.intp], w: NDArray[np.intp] | int,
    at_u: FloatArray, at_v: FloatArray, at_w: FloatArray,
) -> NDArray[np.bool_]:  # fmt: skip
    """Whether w, at ``at_w`` (..., 2) [m], keeps u and v apart."""
    to_u, to_v = at_u - at_w, at_v - at_w
    return between(u, v, w, (to_u[..., 0], to_u[..., 1]), (to_v[..., 0], to_v[..., 1]))
