"""How far bodies are from each other and from what stands around, seen without any kernel."""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from worlds.arena import Arena


def least_gap(places: NDArray[np.float64], radius: float, arena: Arena) -> float:
    """The least gap [m] around discs of ``radius`` at ``places`` (n, 2) [m]; negative: overlap.

    A disc that is looked at often enough cannot get into an obstacle without crossing a side.
    """
    away = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    np.fill_diagonal(away, inf)
    border = np.minimum(places, np.array([arena.width, arena.height]) - places).min()
    gap = min(away.min() - 2.0 * radius, border - radius)
    if arena.obstacles:
        loops = [np.array(polygon.corners) for polygon in arena.obstacles]
        start = np.vstack(loops)
        along = np.vstack([np.roll(loop, -1, axis=0) for loop in loops]) - start
        off = places[:, None] - start
        share = np.clip((off * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
        beside = np.hypot(*(off - share[..., None] * along).transpose(2, 0, 1)).min()
        gap = min(gap, beside - radius)
    return float(gap)
