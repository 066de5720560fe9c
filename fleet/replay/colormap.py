"""Energy as colour: viridis, from empty to full."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Every 16th colour of viridis (matplotlib, CC0), between which 256 are interpolated.
_VIRIDIS = (
    0x440154, 0x481A6C, 0x472F7D, 0x414487, 0x39568C, 0x31688E, 0x2A788E, 0x23888E,
    0x1F988B, 0x22A884, 0x35B779, 0x54C568, 0x7AD151, 0xA5DB36, 0xD2E21B, 0xFDE725,
)  # fmt: skip


def _table() -> NDArray[np.uint8]:
    stops = np.array([list(stop.to_bytes(3)) for stop in _VIRIDIS], float)
    at = np.linspace(0.0, len(stops) - 1.0, 256)
    mixed = [np.interp(at, np.arange(len(stops)), stops[:, channel]) for channel in range(3)]
    return np.asarray(np.rint(np.column_stack(mixed)), np.uint8)


TABLE = _table()  # (256, 3)
PACKED = (
    (TABLE[:, 0].astype(np.uint32) << 24)
    | (TABLE[:, 1].astype(np.uint32) << 16)
    | (TABLE[:, 2].astype(np.uint32) << 8)
    | np.uint32(255)
)  # (256,) 0xRRGGBBAA


def levels(energy: ArrayLike, capacity: float) -> NDArray[np.uint8]:
    """Energies [J] as steps of 0 to 255."""
    share = np.clip(np.asarray(energy, float) / capacity, 0.0, 1.0)
    return np.asarray(np.rint(255.0 * share), np.uint8)


def energy_colours(energy: ArrayLike, capacity: float) -> NDArray[np.uint32]:
    """Energies [J] as colours 0xRRGGBBAA."""
    return np.asarray(PACKED[levels(energy, capacity)])
