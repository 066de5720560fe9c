"""Driving one robot along its path.

In each step a robot goes through one or more stretches: speeding up, keeping its speed, braking.
A stretch ends when its speed, its way or the step does, whatever comes first; speed changes
linearly in it, and distance and energy are exact integrals over it. So where the robot is at the
end of a step and what it has drained do not depend on the steps.
"""

from __future__ import annotations

import math

from fleet.motion.kernels.geometry import wrapped
from fleet.motion.kernels.profile import heading_at
from fleet.motion.kernels.records import ARC, ARRIVED, EMPTY, LINE, TURN
from protocols.compiled import kernel

NEAR = 1e-12  # [m], [rad], [s] that count as none


@kernel
def _stretch(segment, along, speed):
    """The next stretch on a segment: (final speed, duration [s], how far it leads [m or rad]).

    ``left`` is what there is to go on the segment. Speeding up all the way would end with the
    square of the speed ``most`` higher; if that is more than the exit speed allows, speeding up
    must end halfway between the squares of both.
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


@kernel
def _throughout(segment, along, speed, time):
    """The final speed if one stretch lasts for ``time`` [s], which is so in most steps and found
    without dividing; negative if another begins before.
    """
    room, change = segment.rate * (segment.length - along), segment.rate * time
    spare = room - 0.5 * (speed * speed - segment.exit * segment.exit)
    if spare <= segment.rate * NEAR:
        return speed - change if speed - change >= segment.exit else -1.0
    if speed == segment.limit:
        return speed if change * speed < spare else -1.0
    last = speed + change
    spare = min(room, spare - 0.5 * (last * last - speed * speed))  # if it brakes from there
    return last if last <= segment.limit and 0.5 * change * (speed + last) <= spare else -1.0


@kernel
def _energy(segment, speed, last, time):
    """What a stretch of ``time`` [s] drains [J]: the integral of the power, and kinetic energy."""
    square = (speed * speed + speed * last + last * last) / 3.0
    power = segment.quadratic * square + segment.linear * 0.5 * (speed + last) + segment.constant
    return power * time + 0.5 * segment.inertia * max(0.0, last * last - speed * speed)


@kernel
def _lasting(segment, speed, last, time, charge):
    """After what share of a stretch the ``charge`` [J] is used up."""
    low, high = 0.0, 1.0
    for _ in range(60):
        share = 0.5 * (low + high)
        if _energy(segment, speed, speed + share * (last - speed), share * time) > charge:
            high = share
        else:
            low = share
    return low


@kernel
def pay(mover, energy):
    """Drain the battery by ``energy`` [J] if it holds as much; returns what was drained.

    If it does not, it is empty now to the last bit, and the trip is over.
    """
    if energy > mover.held - mover.spent:
        energy = mover.held - mover.spent
        mover.spent, mover.phase = mover.held, EMPTY
    else:
        mover.spent += energy
    return energy


@kernel
def go_on(mover, segments, time):
    """Move ``mover`` along its path for ``time`` [s], and drain it."""
    while time > NEAR:
        segment = segments[mover.slot, mover.segment]
        if segment.length - mover.along <= NEAR:
            if mover.segment + 1 == mover.count:
                mover.phase, mover.speed = ARRIVED, 0.0
                return
            mover.segment += 1
            mover.along = 0.0
            continue
        last, lasts = _throughout(segment, mover.along, mover.speed, time), time
        far = 0.5 * (mover.speed + last) * time
        if last < 0.0:
            last, lasts, far = _stretch(segment, mover.along, mover.speed)
            if lasts > time:
                last = mover.speed + time / lasts * (last - mover.speed)
                lasts, far = time, 0.5 * (mover.speed + last) * time
        energy = _energy(segment, mover.speed, last, lasts)
        charge = mover.held - mover.spent
        if energy > charge:
            share = _lasting(segment, mover.speed, last, lasts, charge)
            last = mover.speed + share * (last - mover.speed)
            far = 0.5 * (mover.speed + last) * share * lasts
        energy = pay(mover, energy)
        mover.along += far
        if segment.kind == TURN:
            mover.spent_turning += energy
        else:
            mover.spent_driving += energy
            mover.path += far
        if mover.phase == EMPTY:
            mover.speed = 0.0
            return
        mover.speed = last
        time -= lasts
    left = segments[mover.slot, mover.segment].length - mover.along
    if mover.segment + 1 == mover.count and left <= NEAR:
        mover.phase, mover.speed = ARRIVED, 0.0


@kernel
def position_at(segment, along):
    """The point [m] of a segment of path that is ``along`` [m or rad] from its start."""
    if segment.kind == LINE:
        return segment.x + along * segment.cos, segment.y + along * segment.sin
    if segment.kind == ARC:
        angle = segment.angle + segment.sense * along / segment.radius
        return segment.x + segment.radius * math.cos(angle), segment.y + segment.radius * math.sin(
            angle
        )
    return segment.x, segment.y


@kernel
def drive(mover, segments, params, dt):
    """Let ``mover`` go on for ``dt`` [s], and command the mean velocity that takes it there."""
    go_on(mover, segments, dt)
    segment = segments[mover.slot, mover.segment]
    x, y = position_at(segment, mover.along)
    pace = 1.0 / dt
    mover.vx, mover.vy, mover.spin = (x - mover.x) * pace, (y - mover.y) * pace, 0.0
    if not params.holonomic:
        facing = heading_at(segment, mover.along) - mover.astern
        mover.spin = wrapped(facing - mover.heading) * pace


@kernel
def swing(mover, dt, times):
    """Turn for ``dt`` [s], so many ``times``, as commanded; nothing can be in the way of that."""
    for _ in range(times):
        mover.heading += mover.spin * dt


@kernel
def coast(mover, dt, times):
    """Move for ``dt`` [s], so many ``times``, as commanded: what the engine does where nothing is
    in the way.
    """
    for _ in range(times):
        mover.x += mover.vx * dt
        mover.y += mover.vy * dt
    mover.ux, mover.uy = mover.vx, mover.vy
    swing(mover, dt, times)


@kernel
def wait(mover, params):
    """Let ``mover`` stand for a step; it may cost idle power."""
    mover.waited += 1
    mover.spent_waiting += pay(mover, params.idle * params.dt)
