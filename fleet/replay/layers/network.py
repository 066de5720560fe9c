"""Links as sorted numbers: a link (u, v), u < v, of n robots is u·n + v."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from protocols.topology import components

FloatArray = NDArray[np.float64]
Codes = NDArray[np.intp]  # (m,) ascending


def in_reach(places: FloatArray, reach: float) -> Codes:
    """Pairs within ``reach`` [m] of each other, at ``places`` (n, 2) [m]; NaN: off the air."""
    n = len(places)
    found = squared(places, places) <= reach * reach
    return np.asarray(np.flatnonzero(np.triu(found, 1).reshape(n * n)))


def of_movers(
    base: FloatArray, movers: Sequence[int], places: FloatArray, reach: float
) -> list[Codes]:
    """The links of ``movers`` (j,) at ``places`` (k, j, 2) [m], moment by moment.

    The others are at ``base`` (n, 2) [m], as for :func:`in_reach`.
    """
    n, k = len(base), len(places)
    if not len(movers):
        return [np.empty(0, np.intp)] * k
    keys = []
    for j, mover in enumerate(movers):
        x, y = places[:, j, 0, None], places[:, j, 1, None]
        near = (base[:, 0] - x) ** 2 + (base[:, 1] - y) ** 2 <= reach * reach
        near[:, movers] = (places[..., 0] - x) ** 2 + (places[..., 1] - y) ** 2 <= reach * reach
        near[:, mover] = False
        moment, other = np.nonzero(near)
        code = np.minimum(other, mover) * n + np.maximum(other, mover)
        keys.append(moment * (n * n) + code)
    found = np.sort(keys[0]) if len(keys) == 1 else np.unique(np.concatenate(keys))
    moment, code = np.divmod(found, n * n)
    bounds = np.searchsorted(moment, np.arange(k + 1)).tolist()
    return [code[a:b] for a, b in pairwise(bounds)]


def squared(one: FloatArray, other: FloatArray) -> FloatArray:
    """Squared distances (k, m) [m²] from each of (k, 2) to each of (m, 2) [m]."""
    dx = one[:, 0, None] - other[:, 0]
    dy = one[:, 1, None] - other[:, 1]
    return np.asarray(dx * dx + dy * dy)


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


def touching(codes: Codes, n: int, robots: Sequence[int]) -> NDArray[np.bool_]:
    """Which links are those robots'."""
    chosen = np.zeros(n, bool)
    chosen[list(robots)] = True
    u, v = np.divmod(codes, n)
    return np.asarray(chosen[u] | chosen[v])


def component_counts(
    links: Sequence[Codes], on_air: Sequence[NDArray[np.bool_]], n: int
) -> NDArray[np.intp]:
    """How many connected components the robots ``on_air`` (n,) form, for each list of links."""
    shift = np.repeat(n * np.arange(len(links)), [len(codes) for codes in links])
    ends = np.divmod(np.concatenate([np.empty(0, np.intp), *links]), n)
    lowest = components(n * len(links), np.stack(ends, axis=1) + shift[:, None])
    roots = (lowest == np.arange(len(lowest))).reshape(-1, n) & np.array(on_air).reshape(-1, n)
    return np.asarray(roots.sum(axis=1))
