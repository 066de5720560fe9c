"""Stopping on the way, and whose ways it blocks: what reserved traffic does after a breakdown."""

from __future__ import annotations

from fleet.motion.kernels.grid import put
from fleet.motion.kernels.records import DRIVING, Floor, IntArray, Traffic
from fleet.motion.kernels.reference import cut_short
from fleet.motion.kernels.reservations import bound, conflict, foresee, neighbours
from protocols.compiled import kernel


@kernel
def stop_short(floor: Floor, traffic: Traffic, slot: int, step: int) -> int:
    """Make the mover in ``slot`` brake on its path from ``step`` on, and reserve where it stops.

    Returns how many knots its track has.
    """
    mover, params = traffic.movers[slot], traffic.params[0]
    reference = traffic.references[slot]
    count = cut_short(traffic.references, slot, traffic.draft, mover.count, mover.due, params)
    for k in range(count):
        for column in range(4):
            reference[k, column] = traffic.draft[k, column]
    mover.phase, mover.stopping, mover.count, mover.due = DRIVING, 1, count, 0.0
    mover.best, mover.since, mover.late = 0.0, 0.0, 0.0
    knots = foresee(mover, reference, traffic.reservations, traffic.boxes, params, step)
    put(floor, mover.robot, reference[count - 1, 0], reference[count - 1, 1])
    return int(knots)


@kernel
def stand(floor: Floor, traffic: Traffic, slot: int, step: int) -> None:
    """The mover in ``slot`` stands where it is from ``step`` on, and rests there; its body must be
    parked.
    """
    mover = traffic.movers[slot]
    mover.awake = 0
    mover.vx = mover.vy = mover.spin = mover.ahead = mover.aside = 0.0
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
