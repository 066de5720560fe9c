"""What a drive will cost, told before it begins."""

from __future__ import annotations

from fleet.motion.kernels.drive import go_on
from fleet.motion.kernels.profile import set_off
from fleet.motion.kernels.records import DRIVING, Records
from protocols.compiled import kernel

FOR_EVER = 1e9  # [s]
PLENTY = 1e300  # [J]


@kernel
def rollout(
    ghosts: Records,
    segments: Records,
    params: Records,
    path: Records,
    x: float,
    y: float,
    heading: float,
) -> float:
    """The energy [J] of driving along ``path``, (k,) SEGMENT, from (x, y) [m] and ``heading``
    [rad]: the turn on the spot and all ramps included, but nothing for others on the way. Where
    there is no path to drive it is nothing.

    ``ghosts``, (1,) MOVER, and ``segments``, (1, more than k) SEGMENT, are work space.
    """
    if len(path) == 0:
        return 0.0
    ghost, end = ghosts[0], len(path) + 1
    for k in range(1, end):
        segments[0, k] = path[k - 1]
    ghost.slot, ghost.phase = 0, DRIVING
    ghost.x, ghost.y, ghost.heading = x, y, heading
    ghost.held, ghost.spent = PLENTY, 0.0
    set_off(ghost, segments, end, params[0])
    go_on(ghost, segments, FOR_EVER)
    return float(ghost.spent)
