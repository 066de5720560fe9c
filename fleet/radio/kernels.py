"""The compiled parts of radios under one name, so that they are loaded only where one is used."""

from __future__ import annotations

import numpy as np

from fleet.radio import beacons, propagation, tables
from fleet.radio.hearsay import AirSpec
from fleet.radio.shadowing import shadows
from fleet.radio.walls import walls
from worlds.arena import Arena

__all__ = ["air", "beacons", "propagation", "tables"]


def air(spec: AirSpec, radio_range: float, seed: int, arena: Arena) -> propagation.Air:
    """The physical layer over the arena's floor, for robots of ``radio_range`` [m]."""
    return propagation.Air(
        seed,
        radio_range,
        spec.loss,
        spec.loss_at_range,
        spec.falloff,
        spec.path_loss,
        shadows(spec.shadowing, spec.shadow_distance, np.random.default_rng(seed)),
        walls(arena, spec.wall_loss),
    )
