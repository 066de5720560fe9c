"""Shadowing by place: what stands between two places weakens all that is sent between them.

Gudmundson (Electronics Letters 27(23), 1991): in decibels shadowing is normal, and its
correlation falls off exponentially with how far an end of the link is moved. Here it is a sum
of plane waves over both ends of a link (Patel, Stüber and Pratt, IEEE Trans. Veh. Technol.
54(5), 2005, for the method), made symmetric in the ends: a function of the two places and the
seed alone, so that a robot that comes back finds what it left.

Importing this module loads numba.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from protocols.compiled import kernel

WAVES = 32
CUT = 2.0  # standard deviations at which shadowing is cut off: no link is without bound


class Shadows(NamedTuple):
    """A field of shadowing over all links."""

    deviation: float  # standard deviation [dB]
    distance: float  # over which correlation falls to 1/e [m]
    waves: NDArray[np.float64]  # (k, 5): wave numbers at the two ends [rad/m], phase


def shadows(deviation: float, distance: float, rng: np.random.Generator) -> Shadows:
    """A field of ``deviation`` [dB] whose correlation falls to 1/e within ``distance`` [m].

    The wave numbers follow the spectrum of exp(-x/distance) in the plane, (1 + k²d²)^(-3/2).
    """
    waves = np.empty((WAVES if deviation > 0.0 else 0, 5))
    for end in (0, 2):
        share = rng.random(len(waves))
        number = np.sqrt((1.0 - share) ** -2.0 - 1.0) / distance
        angle = 2.0 * np.pi * rng.random(len(waves))
        waves[:, end] = number * np.cos(angle)
        waves[:, end + 1] = number * np.sin(angle)
    waves[:, 4] = 2.0 * np.pi * rng.random(len(waves))
    return Shadows(deviation, distance, waves)


@kernel
def shadow(field: Shadows, ax: float, ay: float, bx: float, by: float) -> float:
    """How much better than on average a and b [m] hear one another [dB]; the same both ways.

    Both directions of each wave are added. Their correlation is that of moving both ends by the
    length of the link, which the last factor makes up for.
    """
    if field.deviation <= 0.0:
        return 0.0
    total = 0.0
    for k in range(len(field.waves)):
        px, py, qx, qy, phase = field.waves[k]
        total += math.cos(px * ax + py * ay + qx * bx + qy * by + phase)
        total += math.cos(px * bx + py * by + qx * ax + qy * ay + phase)
    apart = math.hypot(ax - bx, ay - by) / field.distance
    scale = math.sqrt(1.0 / (len(field.waves) * (1.0 + math.exp(-2.0 * apart))))
    normal = min(max(total * scale, -CUT), CUT)
    return field.deviation * normal
