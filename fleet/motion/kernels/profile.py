"""From a path to a drive: the turn that comes first, top speeds, and what driving costs."""

from __future__ import annotations

import math

from fleet.motion.kernels.geometry import wrapped
from fleet.motion.kernels.records import GRIP, LINE, TURN
from protocols.compiled import kernel

STRAIGHT = 1e-9  # [rad] no turn


@kernel
def heading_at(segment, along):
    """The direction [rad] of a segment of path, ``along`` [m or rad] from its start."""
    if segment.kind == LINE:
        return segment.angle
    if segment.kind == TURN:
        return segment.angle + segment.sense * along
    return segment.angle + segment.sense * (along / segment.radius + 0.5 * math.pi)


@kernel
def _turn_first(segment, then, x, y, heading):
    """Make ``segment`` the turn on the spot at (x, y) [m] from ``heading`` [rad] to that of the
    segment ``then``; returns whether there is anything to turn.
    """
    angle = wrapped(heading_at(then, 0.0) - heading)
    segment.kind, segment.x, segment.y, segment.radius = TURN, x, y, 0.0
    segment.angle, segment.sense = heading, 1.0 if angle >= 0.0 else -1.0
    segment.length = abs(angle)
    return segment.length > STRAIGHT


@kernel
def _pay(segment, params, one, two, inertia):
    """Set the power of a segment whose two wheels turn ``one`` and ``two`` times as fast as it is
    driven: at the body's speed, or half for each wheel at its own.
    """
    segment.inertia = inertia if params.kinetic else 0.0
    segment.constant = params.constant
    if not params.per_wheel:
        one = two = 0.0 if segment.kind == TURN else 1.0
    segment.quadratic = 0.5 * params.quadratic * (one * one + two * two)
    segment.linear = 0.5 * params.linear * (abs(one) + abs(two))


@kernel
def _limit(segment, params):
    """Set how fast a segment may be driven, and what that costs."""
    moment = 0.5 * params.mass * params.radius * params.radius  # of a solid disc [kg m²]
    if segment.kind == TURN:
        segment.limit, segment.rate = params.turn_rate, params.turn_acceleration
        _pay(segment, params, params.half_track, params.half_track, moment)
        return
    segment.limit, segment.rate = params.cruise, params.acceleration
    if segment.kind == LINE or params.holonomic:
        _pay(segment, params, 1.0, 1.0, params.mass)
        return
    segment.limit = min(segment.limit, GRIP * params.turn_rate * segment.radius)
    lever = params.half_track / segment.radius
    inertia = params.mass + moment / (segment.radius * segment.radius)
    _pay(segment, params, 1.0 + lever, 1.0 - lever, inertia)


@kernel
def brake_back(mover, segments):
    """Set how fast each segment may end, so that what comes after can be kept, to a stop."""
    entry = 0.0
    for k in range(mover.count - 1, mover.segment - 1, -1):
        segment = segments[mover.slot, k]
        segment.exit = min(entry, segment.limit)
        entry = math.sqrt(segment.exit * segment.exit + 2.0 * segment.rate * segment.length)
        entry = min(entry, segment.limit)
        if k > 0 and segments[mover.slot, k - 1].kind == TURN:
            entry = 0.0


@kernel
def set_off(mover, segments, end, params):
    """Prepare ``mover`` and its path, segments 1 to ``end``, for the drive from where it stands."""
    mover.count, mover.segment, mover.along, mover.speed, mover.astern = end, 1, 0.0, 0.0, 0.0
    mover.off_path, mover.best, mover.since = 0, math.inf, 0
    mover.vx = mover.vy = mover.spin = 0.0
    if end > 1 and not params.holonomic:
        turn, first = segments[mover.slot, 0], segments[mover.slot, 1]
        away = abs(wrapped(heading_at(first, 0.0) - mover.heading))
        if params.reverse and away > 0.5 * math.pi:
            mover.astern = math.pi
        if _turn_first(turn, first, mover.x, mover.y, mover.heading + mover.astern):
            mover.segment = 0
    for k in range(mover.segment, end):
        _limit(segments[mover.slot, k], params)
    brake_back(mover, segments)
