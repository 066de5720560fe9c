"""From a path to a drive: the turn that comes first, top speeds, and what driving costs."""

from __future__ import annotations

import math

from fleet.motion.kernels.geometry import wrapped
from fleet.motion.kernels.records import GRIP, LINE, TURN
from protocols.compiled import kernel

STRAIGHT = 1e-9  # [rad] no turn


@kernel
def heading_at(piece, along):
    """The direction [rad] of a piece of path, ``along`` [m or rad] from its start."""
    if piece.kind == LINE:
        return piece.angle
    if piece.kind == TURN:
        return piece.angle + piece.sense * along
    return piece.angle + piece.sense * (along / piece.radius + 0.5 * math.pi)


@kernel
def _turn_first(piece, then, x, y, heading):
    """Make ``piece`` the turn on the spot at (x, y) [m] from ``heading`` [rad] to that of the
    piece ``then``; returns whether there is anything to turn.
    """
    angle = wrapped(heading_at(then, 0.0) - heading)
    piece.kind, piece.x, piece.y, piece.radius = TURN, x, y, 0.0
    piece.angle, piece.sense = heading, 1.0 if angle >= 0.0 else -1.0
    piece.length = abs(angle)
    return piece.length > STRAIGHT


@kernel
def _pay(piece, law, one, two, inertia):
    """Set the power of a piece whose two wheels turn ``one`` and ``two`` times as fast as it is
    driven: at the body's speed, or half for each wheel at its own.
    """
    piece.inertia = inertia if law.kinetic else 0.0
    piece.constant = law.constant
    if not law.per_wheel:
        one = two = 0.0 if piece.kind == TURN else 1.0
    piece.quadratic = 0.5 * law.quadratic * (one * one + two * two)
    piece.linear = 0.5 * law.linear * (abs(one) + abs(two))


@kernel
def _limit(piece, law):
    """Set how fast a piece may be driven, and what that costs."""
    moment = 0.5 * law.mass * law.radius * law.radius  # of a solid disc [kg m²]
    if piece.kind == TURN:
        piece.limit, piece.rate = law.turn_rate, law.turn_acceleration
        _pay(piece, law, law.half_track, law.half_track, moment)
        return
    piece.limit, piece.rate = law.cruise, law.acceleration
    if piece.kind == LINE or law.holonomic:
        _pay(piece, law, 1.0, 1.0, law.mass)
        return
    piece.limit = min(piece.limit, GRIP * law.turn_rate * piece.radius)
    lever = law.half_track / piece.radius
    inertia = law.mass + moment / (piece.radius * piece.radius)
    _pay(piece, law, 1.0 + lever, 1.0 - lever, inertia)


@kernel
def brake_back(mover, pieces):
    """Set how fast each piece may end, so that what comes after can be kept, to a stop."""
    entry = 0.0
    for k in range(mover.count - 1, mover.piece - 1, -1):
        piece = pieces[mover.slot, k]
        piece.exit = min(entry, piece.limit)
        entry = math.sqrt(piece.exit * piece.exit + 2.0 * piece.rate * piece.length)
        entry = min(entry, piece.limit)
        if k > 0 and pieces[mover.slot, k - 1].kind == TURN:
            entry = 0.0


@kernel
def set_off(mover, pieces, end, law):
    """Prepare ``mover`` and its path, pieces 1 to ``end``, for the drive from where it stands."""
    mover.count, mover.piece, mover.along, mover.speed, mover.astern = end, 1, 0.0, 0.0, 0.0
    mover.adrift, mover.best, mover.since = 0, math.inf, 0
    mover.vx = mover.vy = mover.spin = 0.0
    if end > 1 and not law.holonomic:
        turn, first = pieces[mover.slot, 0], pieces[mover.slot, 1]
        away = abs(wrapped(heading_at(first, 0.0) - mover.heading))
        if law.reverse and away > 0.5 * math.pi:
            mover.astern = math.pi
        if _turn_first(turn, first, mover.x, mover.y, mover.heading + mover.astern):
            mover.piece = 0
    for k in range(mover.piece, end):
        _limit(pieces[mover.slot, k], law)
    brake_back(mover, pieces)
