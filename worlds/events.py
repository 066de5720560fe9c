"""When and where something happens that a robot should go to."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from worlds.arena import Arena, ImpossibleWorld
from worlds.shapes import Corner

BLOCK = 256  # sites drawn at a time


def uniform_sites(arena: Arena, rng: np.random.Generator) -> Iterator[Corner]:
    """Sites [m] without end, uniform over the floor, the hole included, obstacles not."""
    barren = 0
    while True:
        drawn = arena.random_points(BLOCK, 0.0, rng)
        free = np.ones(BLOCK, bool)
        for obstacle in arena.obstacles:
            free &= obstacle.distance(drawn) > 0.0
        barren = 0 if free.any() else barren + 1
        if barren > 100:
            raise ImpossibleWorld("the obstacles cover the whole arena; expected some free floor")
        yield from map(tuple, drawn[free].tolist())
