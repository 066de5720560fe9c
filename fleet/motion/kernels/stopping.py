"""Stopping on the way, and whose ways it blocks: what reserved traffic does after a breakdown."""

from __future__ import annotations

from fleet.motion.kernels.grid import put
from fleet.motion.kernels.profile import brake_back
from fleet.motion.kernels.records import DRIVING, Floor, IntArray, Traffic
from fleet.motion.kernels.tracks import bound, conflict, foresee, neighbours
from protocols.compiled import kernel


@kernel
def _cut(mover, pieces):
    """Shorten the path to what the mover needs to brake to a stop."""
    square = mover.speed * mover.speed
    k, along = mover.piece, mover.along
    while True:
        piece = pieces[mover.slot, k]
        needs = 0.5 * square / piece.rate
        if needs <= piece.length - along or k + 1 == mover.count:
            piece.length = min(piece.length, along + needs)
            mover.count = k + 1
            break
        square -= 2.0 * piece.rate * (piece.length - along)
        k, along = k + 1, 0.0
    brake_back(mover, pieces)


@kernel
def stop_short(floor: Floor, traffic: Traffic, slot: int, step: int) -> int:
    """Make the mover in ``slot`` brake on its path from ``step`` on, and reserve where it stops.

    Returns how many knots its track has; if that is more than there is room for, it must be
    stopped again with more.
    """
    mover, law = traffic.movers[slot], traffic.law[0]
    _cut(mover, traffic.pieces)
    mover.phase = DRIVING
    traffic.ghost[0] = mover
    ghost = traffic.ghost[0]
    foresee(mover, ghost, traffic.pieces, traffic.tracks, traffic.boxes, law, step)
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
    mover.first, mover.knots = step // traffic.law[0].stride, 1
    traffic.tracks[slot, 0, 0], traffic.tracks[slot, 0, 1] = mover.x, mover.y
    bound(mover, traffic.boxes)
    put(floor, mover.robot, mover.x, mover.y)


@kernel
def blocked(traffic: Traffic, active: IntArray, slot: int, step: int, found: IntArray) -> int:
    """List in ``found`` who will come too near to the mover in ``slot``; returns how many."""
    mover, law = traffic.movers[slot], traffic.law[0]
    now = step // law.stride
    count = 0
    for k in range(neighbours(mover, traffic.boxes, active, law.gap, traffic.near)):
        other = traffic.movers[traffic.near[k]]
        last = max(mover.first + mover.knots, other.first + other.knots) - 1
        if conflict(mover, other, traffic.tracks, law, now, last):
            found[count] = other.slot
            count += 1
    return count
