"""The compiled parts of radios under one name, so that they are loaded only where one is used."""

from __future__ import annotations

import numpy as np

from fleet.radio import beacons, propagation, tables
from fleet.radio.hearsay import AirSpec, Scattered
from fleet.radio.shadowing import shadows
from fleet.radio.walls import walls

__all__ = ["air", "beacons", "propagation", "tables"]


def air(spec: AirSpec, fleet: Scattered, seed: int) -> propagation.Air:
    """The physical layer over the fleet's floor, at its range."""
    return propagation.Air(
        seed,
        fleet.radio_range,
        spec.loss,
        spec.loss_at_range,
        spec.falloff,
        spec.path_loss,
        shadows(spec.shadowing, spec.shadow_distance, np.random.default_rng(seed)),
        walls(fleet.arena, spec.wall_loss),
        np.zeros((0, 0), np.float32),
    )
