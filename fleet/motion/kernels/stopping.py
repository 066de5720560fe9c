"""Stopping on the way, and whose ways it blocks: what reserved traffic does after a breakdown."""

from __future__ import annotations

from fleet.motion.kernels.grid import put
from fleet.motion.kernels.profile import brake_back
from fleet.motion.kernels.records import DRIVING, Floor, IntArray, Traffic
from fleet.motion.kernels.reservations import bound, conflict, foresee, neighbours
from protocols.compiled import kernel


@kernel
def _cut(mover, segments):
    """Shorten the path to what the mover needs to brake to a stop."""
    square = mover.speed * mover.speed
    k, along = mover.segment, mover.along
    while True:
        segment = segments[mover.slot, k]
        needs = 0.5 * square / segment.rate
        if needs <= segment.length - along or k + 1 == mover.count:
            segment.length = min(segment.length, along + needs)
            mover.count = k + 1
            break
        square -= 2.0 * segment.rate * (segment.length - along)
        k, along = k + 1, 0.0
    brake_back(mover, segments)


@kernel
def stop_short(floor: Floor, traffic: Traffic, slot: int, step: int) -> int:
    """Make the mover in ``slot`` brake on its path from ``step`` on, and reserve where it stops.

    Returns how many knots its track has; if that is more than there is room for, it must be
    stopped again with more.
    """
    mover, params = traffic.movers[slot], traffic.params[0]
    _cut(mover, traffic.segments)
    mover.phase = DRIVING
    traffic.ghost[0] = mover
    ghost = traffic.ghost[0]
    foresee(mover, ghost, traffic.segments, traffic.reservations, traffic.boxes, params, step)
    put(floor, mover.robot, ghost.x, ghost.y)
    return int(mover.knots)


@kernel
def stand(floor: Floor, traffic: Traffic, slot: int, step: int) -> None:
    """The mover in ``slot`` stands where it is from ``step`` on, and rests there; its body must be
    parked.
    """
    mover = traffic.movers[slot]
    mover.speed, mover.awake = 0.0, 0
    mover.vx = mover.vy = mover.spin = mover.ux = mover.uy = 0.0
    mover.first, mover.knots = step // traffic.params[0].stride, 1
    traffic.reservations[slot, 0, 0], traffic.reservations[slot, 0, 1] = mover.x, mover.y
    bound(mover, traffic.boxes)
    put(floor, mover.robot, mover.x, mover.y)


@kernel
def blocked(traffic: Traffic, active: IntArray, slot: int, step: int, found: IntArray) -> int:
    """List in ``found`` who will come too near to the mover in ``slot``; returns how many."""
    mover, params = traffic.movers[slot], traffic.params[0]
    now = step // params.stride
    count = 0
    for k in range(neighbours(mover, traffic.boxes, active, params.gap, traffic.near)):
        other = traffic.movers[traffic.near[k]]
        last = max(mover.first + mover.knots, other.first + other.knots) - 1
        if conflict(mover, other, traffic.reservations, params, now, last):
            found[count] = other.slot
            count += 1
    return count
