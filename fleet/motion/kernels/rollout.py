"""What a drive will cost, told before it begins."""

from __future__ import annotations

from fleet.motion.kernels.accounts import follow
from fleet.motion.kernels.records import DRIVING, Records, Traffic
from fleet.motion.kernels.reference import SPARE, lay
from protocols.compiled import kernel

PLENTY = 1e300  # [J]


@kernel
def rest_at(mover, x, y, heading):
    """Make ``mover`` one that rests at (x, y) [m] and ``heading`` [rad], with nothing spent."""
    mover.x, mover.y, mover.heading = x, y, heading
    mover.vx = mover.vy = mover.spin = mover.ahead = mover.aside = 0.0
    mover.due, mover.spent, mover.path = 0.0, 0.0, 0.0


@kernel
def rollout(
    traffic: Traffic, segments: Records, path: Records, x: float, y: float, heading: float
) -> tuple[float, int]:
    """The energy [J] of driving along ``path``, (k,) SEGMENT, from rest at (x, y) [m] and
    ``heading`` [rad], as controllers believe: the turn on the spot and all ramps included, but
    nothing for others on the way. Where there is no path to drive it is nothing.

    Returns besides how much room the reference takes; if that is more than ``traffic.draft`` has,
    there must be more. ``segments``, (more than k,) SEGMENT, are work space.
    """
    if len(path) == 0:
        return 0.0, 0
    ghost, params = traffic.ghost[0], traffic.params[0]
    build = traffic.builds[len(traffic.builds) - 1]
    count = lay(traffic.draft, segments, path, x, y, heading, params, build)
    if count + SPARE > len(traffic.draft):
        return 0.0, count + SPARE
    rest_at(ghost, x, y, heading)
    ghost.phase, ghost.count, ghost.held = DRIVING, count, PLENTY
    for _ in range(count):
        follow(ghost, traffic.draft, params, build)
    return float(ghost.spent), count + SPARE
