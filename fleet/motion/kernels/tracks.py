"""Reservations: where a robot will be, and how long it must wait for others to pass.

A track is a list of knots: where the robot will be at the ticks of one clock for all, one tick
every ``law.stride`` steps. Between two knots it is taken to move evenly; the gap that robots
keep has room for the difference. Two tracks are in conflict if the robots come nearer to each
other than the gap while one of them drives. Nobody's path leads through where others rest or
will rest, so a robot that waits is safe from everybody, and its track is free at the latest when
all others have arrived: nobody waits forever.
"""

from __future__ import annotations

import math

from fleet.motion.kernels.drive import coast, drive
from fleet.motion.kernels.records import DRIVING
from protocols.compiled import kernel


@kernel
def _note(mover, tracks, x, y):
    """Add (x, y) [m] to the track, if there is room."""
    if mover.knots < tracks.shape[1]:
        tracks[mover.slot, mover.knots, 0], tracks[mover.slot, mover.knots, 1] = x, y
    mover.knots += 1
    mover.x0, mover.x1 = min(mover.x0, x), max(mover.x1, x)
    mover.y0, mover.y1 = min(mover.y0, y), max(mover.y1, y)


@kernel
def foresee(mover, ghost, pieces, tracks, law, step):
    """Drive a ghost of ``mover`` to its end from ``step`` on, and keep its track.

    The mover gets the track's clock, length and bounds; ``ghost``, a record, ends as it will.
    If there are more knots than a track has room for, the rest is not kept.
    """
    mover.first, mover.knots = step // law.stride, 0
    tick = law.stride * law.dt
    gone = (step - mover.first * law.stride) * law.dt
    mover.x0 = mover.x1 = mover.x
    mover.y0 = mover.y1 = mover.y
    ghost.phase = DRIVING
    drive(ghost, pieces, law, tick - gone)
    coast(ghost, tick - gone)
    back = gone / (tick - gone)  # the first knot lies in the past
    x, y = mover.x - back * (ghost.x - mover.x), mover.y - back * (ghost.y - mover.y)
    _note(mover, tracks, x, y)
    _note(mover, tracks, ghost.x, ghost.y)
    while ghost.phase == DRIVING:
        drive(ghost, pieces, law, tick)
        coast(ghost, tick)
        _note(mover, tracks, ghost.x, ghost.y)


@kernel
def _knot(mover, tick):
    """The knot that holds at ``tick``: before its track a robot is at its start, then its end."""
    return min(max(tick - mover.first, 0), mover.knots - 1)


@kernel
def _apart(one, other, tracks, tick):
    """From the other to the one at ``tick`` [m]."""
    i, j = _knot(one, tick), _knot(other, tick)
    return (
        tracks[one.slot, i, 0] - tracks[other.slot, j, 0],
        tracks[one.slot, i, 1] - tracks[other.slot, j, 1],
    )


@kernel
def _meet(dx, dy, ex, ey, gap):
    """Whether a point that moves evenly from d to e [m] comes within ``gap`` [m] of 0."""
    vx, vy = ex - dx, ey - dy
    square = vx * vx + vy * vy
    share = 0.0
    if square > 0.0:
        share = min(max(-(dx * vx + dy * vy) / square, 0.0), 1.0)
    x, y = dx + share * vx, dy + share * vy
    return x * x + y * y < gap * gap


@kernel
def conflict(one, other, tracks, law, first, last):
    """Whether two movers come nearer than the gap between the ticks ``first`` and ``last``.

    As neither drives faster than cruise speed, ticks are passed over for which they are too far
    apart.
    """
    if one.x0 - law.gap > other.x1 or other.x0 - law.gap > one.x1:
        return False
    if one.y0 - law.gap > other.y1 or other.y0 - law.gap > one.y1:
        return False
    closing = 2.0 * law.cruise * law.stride * law.dt  # [m] in a tick, at most
    tick = first
    while tick < last:
        dx, dy = _apart(one, other, tracks, tick)
        skip = int((math.hypot(dx, dy) - law.gap) / closing)
        if skip < 1:
            ex, ey = _apart(one, other, tracks, tick + 1)
            if _meet(dx, dy, ex, ey, law.gap):
                return True
            skip = 1
        tick += skip
    return False


@kernel
def reserve(mover, movers, tracks, active, law):
    """Put off the track of ``mover`` until it conflicts with no other: by how many ticks.

    Ticks count from when it drives until the other has arrived.
    """
    asked = mover.first
    k, passed = 0, 0
    while passed < len(active):
        other = movers[active[k]]
        if other.slot != mover.slot:
            last = other.first + other.knots - 1
            while conflict(mover, other, tracks, law, mover.first, last):
                mover.first += 1
                passed = 0
        passed += 1
        k = (k + 1) % len(active)
    return mover.first - asked
