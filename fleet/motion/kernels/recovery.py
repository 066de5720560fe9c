"""Finding back to the path after a push.

A robot that has been pushed steers towards its path by feedback on its offset and heading. It
changes the velocity that the engine left it with by no more than its acceleration allows, and
never by more than a gentle one: commanding speed regardless would press bodies into each other.
"""

from __future__ import annotations

import math

from fleet.motion.kernels.drive import pay
from fleet.motion.kernels.geometry import wrapped
from fleet.motion.kernels.profile import heading_at
from fleet.motion.kernels.records import ARC, ARRIVED, EMPTY, LINE, LOST
from protocols.compiled import kernel

GENTLE = 5.0  # [m/s²] the most with which it speeds up and brakes, however strong it is
REACH = 0.2  # [m] on which offsets decay
LATERAL = 2.0  # [1/s] by which a holonomic robot reduces its offset
FACE = 1.2  # [rad] facing further away than this, it stops and turns
FACED = 0.05  # [rad] until it faces the path like this
ON_PATH = 1e-4  # [m] within this, and ten times as much in [rad], it is back
THERE = 1e-3  # [m] from the end of the path it stops
CLOSE = 0.01  # [m] from there it has arrived, otherwise it has missed it
PROGRESS = 0.005  # [m] that it must gain
PATIENCE = 1.0  # [s] in which it must
ASTRAY = 0.15  # [m] off the path it gives up


@kernel
def _project(segment, x, y):
    """Where on a segment of path (x, y) [m] is: (how far along, how far to the left) [m]."""
    if segment.kind == LINE:
        dx, dy = x - segment.x, y - segment.y
        return dx * segment.cos + dy * segment.sin, dy * segment.cos - dx * segment.sin
    dx, dy = x - segment.x, y - segment.y
    half = 0.5 * segment.length / segment.radius
    ahead = wrapped(segment.sense * (math.atan2(dy, dx) - segment.angle) - half) + half
    return segment.radius * ahead, segment.sense * (segment.radius - math.hypot(dx, dy))


@kernel
def _locate(mover, segments):
    """Find the segment that ``mover`` is on: (how far along, how far to the left, to go) [m]."""
    mover.segment = max(mover.segment, 1)
    along, left = _project(segments[mover.slot, mover.segment], mover.x, mover.y)
    while along >= segments[mover.slot, mover.segment].length and mover.segment + 1 < mover.count:
        mover.segment += 1
        along, left = _project(segments[mover.slot, mover.segment], mover.x, mover.y)
    to_go = segments[mover.slot, mover.segment].length - along
    for k in range(mover.segment + 1, mover.count):
        to_go += segments[mover.slot, k].length
    return along, left, to_go


@kernel
def _strength(params):
    """The acceleration [m/s²] of a robot that is off its path."""
    return min(params.acceleration, GENTLE)


@kernel
def _spin_towards(mover, error, params):
    """The turn rate [rad/s] that takes the heading error [rad] away, braking in time."""
    ease = params.turn_acceleration * params.dt
    if abs(error) <= ease * params.dt and abs(mover.spin) <= ease:
        return -error / params.dt
    fast = min(params.turn_rate, math.sqrt(2.0 * params.turn_acceleration * abs(error)))
    return min(max(-math.copysign(fast, error), mover.spin - ease), mover.spin + ease)


@kernel
def _steer(segment, left, error, speed, params):
    """The turn rate [rad/s] that follows the path at ``speed`` [m/s] and leads back to it."""
    bend = segment.sense / segment.radius if segment.kind == ARC else 0.0
    pull = 1.0 if abs(error) < 1e-6 else math.sin(error) / error
    spin = speed * (bend - pull * left / (REACH * REACH) - 2.0 * error / REACH)
    return min(max(spin, -params.turn_rate), params.turn_rate)


@kernel
def _wish(mover, segment, along, left, to_go, params):
    """The velocity [m/s] and turn rate [rad/s] that it would like: (vx, vy, spin)."""
    path = heading_at(segment, min(max(along, 0.0), segment.length))
    facing = path if params.holonomic else mover.heading + mover.astern
    speed = max(0.0, mover.ux * math.cos(facing) + mover.uy * math.sin(facing))
    speed = min(speed + _strength(params) * params.dt, segment.limit)
    speed = min(speed, math.sqrt(2.0 * _strength(params) * max(to_go, 0.0)))
    speed = min(speed, max(to_go, 0.0) / params.dt)
    if params.holonomic:
        side = -LATERAL * left
        return (
            speed * math.cos(path) - side * math.sin(path),
            speed * math.sin(path) + side * math.cos(path),
            0.0,
        )
    error = wrapped(facing - path)
    if abs(error) > FACE and to_go > THERE:
        mover.off_path = 2
    elif abs(error) < FACED:
        mover.off_path = 1
    if mover.off_path == 2:
        return 0.0, 0.0, _spin_towards(mover, error, params)
    spin = _steer(segment, left, error, speed, params)
    middle = facing + 0.5 * spin * params.dt
    return speed * math.cos(middle), speed * math.sin(middle), spin


@kernel
def _spend(mover, params):
    """Drain what a step at the commanded velocity takes."""
    square = mover.vx * mover.vx + mover.vy * mover.vy
    speed = math.sqrt(square)
    energy = (params.quadratic * square + params.linear * speed + params.constant) * params.dt
    if params.kinetic:
        gained = square - mover.ux * mover.ux - mover.uy * mover.uy
        energy += 0.5 * params.mass * max(0.0, gained)
    mover.spent_off_path += pay(mover, energy)
    mover.path += speed * params.dt
    mover.jostled += speed * params.dt


@kernel
def recover(mover, segments, params):
    """Command a step of a robot that is off its path; it may end the trip, or the drift."""
    along, left, to_go = _locate(mover, segments)
    segment = segments[mover.slot, mover.segment]
    if to_go < mover.best - PROGRESS or mover.off_path == 2:
        mover.best, mover.since = min(to_go, mover.best), 0
    mover.since += 1
    vx, vy, spin = _wish(mover, segment, along, left, to_go, params)
    dx, dy = vx - mover.ux, vy - mover.uy
    change = math.hypot(dx, dy)
    ease = min(1.0, _strength(params) * params.dt / change) if change > 0.0 else 1.0
    mover.vx, mover.vy, mover.spin = mover.ux + ease * dx, mover.uy + ease * dy, spin
    _spend(mover, params)
    speed = math.hypot(mover.vx, mover.vy)
    if mover.phase == EMPTY:
        return
    if to_go <= THERE and speed <= 2.0 * _strength(params) * params.dt:
        mover.phase = ARRIVED if max(abs(left), -to_go) <= CLOSE else LOST
    elif abs(left) > ASTRAY or mover.since * params.dt > PATIENCE:
        mover.phase = LOST
    elif abs(left) <= ON_PATH and ease == 1.0 and not mover.touching:
        path = heading_at(segment, min(max(along, 0.0), segment.length))
        error = 0.0 if params.holonomic else wrapped(mover.heading + mover.astern - path)
        if abs(error) <= 10.0 * ON_PATH and 0.0 <= along < segment.length:
            mover.off_path, mover.along, mover.speed = 0, along + speed * params.dt, speed
