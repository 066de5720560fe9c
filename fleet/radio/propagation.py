"""The compiled physical layer: how far robots hear one another, and which frames survive.

Chance is a function of who, what and when, not of a sequence of draws: a frame's fate does not
depend on how many others were sent before it, so runs that differ in one thing stay comparable.

Importing this module loads numba.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.radio.shadowing import CUT, Shadows, shadow
from fleet.radio.walls import Walls, crossings
from protocols.compiled import kernel

FRAME, PHASE, BACKOFF = 1, 3, 4  # what chance is asked for
EVERYWHERE = 1e9  # [m]


class Air(NamedTuple):
    """The physical layer's numbers."""

    seed: int
    radio_range: float  # r [m]
    loss: float  # probability that a frame is lost, wherever
    loss_at_range: float  # and that it is lost at the edge of the range
    falloff: float  # power of the distance with which that grows
    path_loss: float  # exponent η of the path loss, which turns decibels into range
    shadows: Shadows
    walls: Walls
    ratios: NDArray[np.float32]  # (n, n) of frames delivered, from and to; or (0, 0): by distance


@kernel
def _mixed(state):
    """One step of splitmix64 (Steele, Lea and Flood, OOPSLA 2014)."""
    z = state + np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@kernel
def chance(seed, purpose, a, b, c):
    """A number in [0, 1) that depends on all arguments, and on nothing else."""
    state = _mixed(np.uint64(seed) ^ _mixed(np.uint64(purpose)))
    state = _mixed(state ^ np.uint64(a))
    state = _mixed(state ^ np.uint64(b))
    state = _mixed(state ^ np.uint64(c))
    return np.float64(state >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@kernel
def reach(air, ax, ay, bx, by):
    """How far robots at a and b [m] hear one another [m]: the range, shadowed, less the walls.

    The same both ways, and for the whole run.
    """
    if air.shadows.deviation <= 0.0 and air.walls.loss <= 0.0:
        return air.radio_range
    better = shadow(air.shadows, ax, ay, bx, by)
    better -= air.walls.loss * crossings(air.walls, ax, ay, bx, by)
    return air.radio_range * 10.0 ** (better / (10.0 * air.path_loss))


@kernel
def hears(air, sender, receiver, ax, ay, bx, by):
    """Whether a robot at b hears the sender at a [m], if nothing is lost by chance."""
    if len(air.ratios) > 0:
        return air.ratios[sender, receiver] > 0.0
    return math.hypot(bx - ax, by - ay) <= reach(air, ax, ay, bx, by)


@kernel
def farthest(air):
    """The longest that any link can be [m]."""
    if len(air.ratios) > 0:
        return EVERYWHERE
    return air.radio_range * 10.0 ** (CUT * air.shadows.deviation / (10.0 * air.path_loss))


@kernel
def arrives(air, frame, sender, receiver, ax, ay, bx, by):
    """Whether a frame from a sender at a gets to a receiver at b [m]."""
    if len(air.ratios) > 0:
        return chance(air.seed, FRAME, frame, sender, receiver) < air.ratios[sender, receiver]
    limit, distance = reach(air, ax, ay, bx, by), math.hypot(bx - ax, by - ay)
    if distance > limit:
        return False
    return survives(air, frame, sender, receiver, distance / limit)


@kernel
def survives(air, frame, sender, receiver, share):
    """Whether a frame over a ``share`` of how far the two hear one another is lost by chance."""
    lost = air.loss_at_range * share**air.falloff
    through = (1.0 - air.loss) * (1.0 - lost)
    return chance(air.seed, FRAME, frame, sender, receiver) < through


@kernel
def unicast(
    air: Air,
    frame: int,
    attempts: int,
    sender: int,
    receiver: int,
    ax: float,
    ay: float,
    bx: float,
    by: float,
) -> int:
    """Send a frame until it is acknowledged; how many times, negative if it never got through.

    The acknowledgement travels back over the same air. A receiver that heard one of several
    copies has heard it, though every acknowledgement be lost: its own next frame tells.
    """
    heard = False
    for attempt in range(attempts):
        copy = 64 * frame + 2 * attempt
        if arrives(air, copy, sender, receiver, ax, ay, bx, by):
            heard = True
            if arrives(air, copy + 1, receiver, sender, ax, ay, bx, by):
                return attempt + 1
    return attempts if heard else -attempts
