"""Reservations: where a robot will be, and how long it must wait for others to pass.

A track is a list of knots: where the robot will be at the ticks of one clock for all, one tick
every ``params.stride`` steps. Between two knots it is taken to move evenly; the gap that robots
keep has room for the difference, and for how far a robot may be from its reference. Two tracks are
in conflict if the robots come nearer to each other than the gap while one of them drives. Nobody's
path leads through where others rest or will rest, so a robot that waits is safe from everybody, and
its track is free at the latest when all others have arrived: nobody waits forever.
"""

from __future__ import annotations

import math

from protocols.compiled import kernel


@kernel
def bound(mover, boxes):
    """Start the bounds of the track anew, where the mover is."""
    boxes[mover.slot, 0] = boxes[mover.slot, 2] = mover.x
    boxes[mover.slot, 1] = boxes[mover.slot, 3] = mover.y


@kernel
def _note(mover, reservations, boxes, x, y):
    """Add (x, y) [m] to the track, and to its bounds."""
    reservations[mover.slot, mover.knots, 0], reservations[mover.slot, mover.knots, 1] = x, y
    mover.knots += 1
    box = boxes[mover.slot]
    box[0], box[1] = min(box[0], x), min(box[1], y)
    box[2], box[3] = max(box[2], x), max(box[3], y)


@kernel
def foresee(mover, reference, reservations, boxes, params, step):
    """Keep the track of ``mover`` along its ``reference`` from ``step`` on.

    Its body is at the first sample after that step. Returns how many knots the track has; if there
    is no room for so many, none are kept.
    """
    stride = params.stride
    mover.first, mover.knots = (step + 1) // stride, 0
    gone = step + 1 - mover.first * stride
    last = mover.count - 1
    needed = (last + gone + stride - 1) // stride + 1
    if needed > reservations.shape[1]:
        return needed
    bound(mover, boxes)
    x, y = reference[0, 0], reference[0, 1]
    after = min(1, last)
    # the first knot lies in the past
    _note(
        mover, reservations, boxes,
        x - gone * (reference[after, 0] - x), y - gone * (reference[after, 1] - y),
    )  # fmt: skip
    for knot in range(1, needed):
        k = min(knot * stride - gone, last)
        _note(mover, reservations, boxes, reference[k, 0], reference[k, 1])
    return needed


@kernel
def _knot(mover, tick):
    """The knot that holds at ``tick``: before its track a robot is at its start, then its end."""
    return min(max(tick - mover.first, 0), mover.knots - 1)


@kernel
def _apart(one, other, reservations, tick):
    """From the other to the one at ``tick`` [m]."""
    i, j = _knot(one, tick), _knot(other, tick)
    return (
        reservations[one.slot, i, 0] - reservations[other.slot, j, 0],
        reservations[one.slot, i, 1] - reservations[other.slot, j, 1],
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
def conflict(one, other, reservations, params, first, last):
    """Whether two movers come nearer than the gap between the ticks ``first`` and ``last``.

    As neither drives faster than cruise speed, ticks are passed over for which they are too far
    apart.
    """
    closing = 2.0 * params.cruise * params.stride * params.dt  # [m] in a tick, at most
    tick = first
    while tick < last:
        dx, dy = _apart(one, other, reservations, tick)
        skip = int((math.sqrt(dx * dx + dy * dy) - params.gap) / closing)
        if skip < 1:
            ex, ey = _apart(one, other, reservations, tick + 1)
            if _meet(dx, dy, ex, ey, params.gap):
                return True
            skip = 1
        tick += skip
    return False


@kernel
def neighbours(mover, boxes, active, gap, near):
    """List in ``near`` the other slots whose reservations come near that of ``mover``; how many."""
    count = 0
    x0, y0 = boxes[mover.slot, 0] - gap, boxes[mover.slot, 1] - gap
    x1, y1 = boxes[mover.slot, 2] + gap, boxes[mover.slot, 3] + gap
    for k in range(len(active)):
        slot = active[k]
        beside = boxes[slot, 0] > x1 or boxes[slot, 2] < x0
        beyond = boxes[slot, 1] > y1 or boxes[slot, 3] < y0
        if not beside and not beyond and slot != mover.slot:
            near[count] = slot
            count += 1
    return count


@kernel
def reserve(mover, movers, reservations, boxes, active, near, params):
    """Put off the track of ``mover`` until it conflicts with no other: by how many ticks.

    Ticks count from when it drives until the other has arrived.
    """
    asked = mover.first
    count = neighbours(mover, boxes, active, params.gap, near)
    k, passed = 0, 0
    while passed < count:
        other = movers[near[k]]
        last = other.first + other.knots - 1
        while conflict(mover, other, reservations, params, mover.first, last):
            mover.first += 1
            passed = 0
        passed += 1
        k = (k + 1) % count
    return mover.first - asked
