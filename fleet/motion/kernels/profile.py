"""From a path to a speed profile: the turn that comes first, top speeds, and how they change."""

from __future__ import annotations

import math

from fleet.motion.kernels.geometry import wrapped
from fleet.motion.kernels.records import ARC, LINE, TURN, TURN_SHARE
from protocols.compiled import kernel

STRAIGHT = 1e-9  # [rad] no turn
NEAR = 1e-12  # [m], [rad], [s] that count as none
FORCE_SHARE = 0.8  # of the force of wheels that a plan may take; the rest is for finding back


@kernel
def heading_at(segment, along):
    """The direction [rad] of a segment of path, ``along`` [m or rad] from its start."""
    if segment.kind == LINE:
        return segment.angle
    if segment.kind == TURN:
        return segment.angle + segment.sense * along
    return segment.angle + segment.sense * (along / segment.radius + 0.5 * math.pi)


@kernel
def position_at(segment, along):
    """The point [m] of a segment of path that is ``along`` [m or rad] from its start."""
    if segment.kind == LINE:
        return segment.x + along * segment.cos, segment.y + along * segment.sin
    if segment.kind == ARC:
        angle = segment.angle + segment.sense * along / segment.radius
        return (
            segment.x + segment.radius * math.cos(angle),
            segment.y + segment.radius * math.sin(angle),
        )
    return segment.x, segment.y


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
def scrub_share(turn, speed, onset):
    """How much of the scrub a robot meets that turns at ``turn`` [rad/s] and rolls at ``speed``
    [m/s]: -1 to 1. Tyres that roll yield sideways before they slide.
    """
    most = onset * abs(speed) + 0.02
    return min(max(turn / most, -1.0), 1.0)


@kernel
def _limit(segment, params, build):
    """Set how fast a segment may be driven, and how fast that may change."""
    if segment.kind == TURN:
        segment.limit, segment.rate = params.turn_rate, params.turn_acceleration
        return
    segment.limit, segment.rate = params.cruise, params.acceleration
    if segment.kind == LINE:
        return
    segment.limit = min(segment.limit, math.sqrt(params.cornering * segment.radius))
    if params.holonomic:
        return
    segment.limit = min(segment.limit, TURN_SHARE * params.turn_rate * segment.radius)
    share = min(1.0, 1.0 / (segment.radius * params.onset))
    needed = share * build.scrub / params.half_track  # by both wheels [N]
    segment.rate = max(0.1 * segment.rate, segment.rate - FORCE_SHARE * needed / build.mass)


@kernel
def _brake_back(segments, first, end):
    """Set how fast each segment may end, so that what comes after can be kept, to a stop."""
    entry = 0.0
    for k in range(end - 1, first - 1, -1):
        segment = segments[k]
        segment.exit = min(entry, segment.limit)
        entry = math.sqrt(segment.exit * segment.exit + 2.0 * segment.rate * segment.length)
        entry = min(entry, segment.limit)
        if k > 0 and segments[k - 1].kind == TURN:
            entry = 0.0


@kernel
def profiled(segments, path, x, y, heading, params, build):
    """Copy ``path`` into ``segments`` from 1 on, and set its speeds for a drive from rest at
    (x, y) [m] and ``heading`` [rad].

    Returns (where it begins, 0 if there is something to turn first; whether it is driven
    backwards).
    """
    first, end, astern = 1, len(path) + 1, False
    for k in range(1, end):
        segments[k] = path[k - 1]
    if not params.holonomic:
        away = abs(wrapped(heading_at(segments[1], 0.0) - heading))
        astern = params.reverse != 0 and away > 0.5 * math.pi
        facing = heading + math.pi if astern else heading
        if _turn_first(segments[0], segments[1], x, y, facing):
            first = 0
    for k in range(first, end):
        _limit(segments[k], params, build)
    _brake_back(segments, first, end)
    return first, astern


@kernel
def stretch(segment, along, speed):
    """The next stretch on a segment: (final speed, duration [s], how far it leads [m or rad]).

    It is driven by speeding up, keeping speed or braking, whatever comes first; speed changes
    evenly in it. ``left`` is what there is to go on the segment. Speeding up all the way would
    end with the square of the speed ``most`` higher; if that is more than the exit speed allows,
    speeding up must end halfway between the squares of both.
    """
    left = segment.length - along
    to_exit = 0.5 * (speed * speed - segment.exit * segment.exit) / segment.rate
    if to_exit >= left - NEAR:
        last = segment.exit
        if to_exit > left + NEAR:  # it is too fast for what comes
            last = math.sqrt(max(0.0, speed * speed - 2.0 * segment.rate * left))
        return last, (speed - last) / segment.rate, left
    if speed > segment.limit:
        far = 0.5 * (speed * speed - segment.limit * segment.limit) / segment.rate
        return segment.limit, (speed - segment.limit) / segment.rate, min(far, left)
    if speed == segment.limit:
        return speed, (left - to_exit) / speed, left - to_exit
    most = speed * speed + 2.0 * segment.rate * left
    square = min(most, 0.5 * (most + segment.exit * segment.exit))
    if square > segment.limit * segment.limit:
        last = segment.limit
        far = 0.5 * (last * last - speed * speed) / segment.rate
    else:
        last = math.sqrt(square)
        far = left if square == most else 0.5 * (square - speed * speed) / segment.rate
    return last, (last - speed) / segment.rate, far
