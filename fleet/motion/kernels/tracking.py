"""The controller: what forces make a body follow its reference.

Feed-forward of what the believed robot needs, and feedback on where the body will be: its place
after the step that is about to be made, as the engine moves first and then applies forces. The
errors are those of Kanayama et al. (ICRA 1990, doi 10.1109/ROBOT.1990.126006), the gain across the
path goes with the speed as in Canudas de Wit et al. (1993).
"""

from __future__ import annotations

import math

from fleet.motion.kernels.profile import scrub_share
from fleet.motion.kernels.wheels import clipped
from protocols.compiled import inlined, kernel

PATIENT = 0.05  # [m] of error from which on the reference waits; at twice as much it stands
LEVER = 0.15  # [m] that weighs errors of heading against those of place
CORRECTION = 0.3  # [m/s] of speed that feedback adds at most
CORRECTION_TURN = 2.0  # [rad/s]
ROLLS = 1e-3  # [m/s] from which on a wheel is taken to need its full rolling resistance
CREEPING = 0.1  # [m/s] a robot may come to its end with


@inlined
def _face(effort, heading):
    """Set the cosine and sine of ``heading`` [rad], by the theorems of addition from one near by
    and series that are exact to the last bit but one.
    """
    turn = heading - effort.faced
    if abs(turn) > 0.1 or effort.faced_cos == effort.faced_sin:
        effort.faced, turn = heading, 0.0
        effort.faced_cos, effort.faced_sin = math.cos(heading), math.sin(heading)
    t = turn * turn
    cos = 1.0 - 0.5 * t * (1.0 - t / 12.0 * (1.0 - t / 30.0 * (1.0 - t / 56.0)))
    sin = turn * (1.0 - t / 6.0 * (1.0 - t / 20.0 * (1.0 - t / 42.0 * (1.0 - t / 72.0))))
    effort.cos = effort.faced_cos * cos - effort.faced_sin * sin
    effort.sin = effort.faced_sin * cos + effort.faced_cos * sin


@inlined
def compare(mover, effort, params, x, y, heading, step, share):
    """Set how far the body will be from the pose of its reference, (x, y) [m] and ``heading``
    [rad], after the coming ``step`` [s], and move on along the reference by ``share`` of a sample,
    or less if the body is far behind or ahead of it. Sets ``effort.stop`` if it should stop now:
    the reference has ended, and it is there, or half a second has passed.
    """
    dx, dy = x - mover.x - mover.vx * step, y - mover.y - mover.vy * step
    mover.error = math.sqrt(dx * dx + dy * dy)
    effort.along, effort.across, effort.turn = dx, dy, 0.0
    far = mover.error
    if not params.holonomic:
        facing = mover.heading + mover.spin * step
        _face(effort, facing)
        cos, sin = effort.cos, effort.sin
        effort.along, effort.across = dx * cos + dy * sin, dy * cos - dx * sin
        effort.turn = heading - facing
        far = max(abs(effort.along), LEVER * abs(effort.turn))
    effort.stop = 0
    if mover.due >= mover.count - 1.0:
        mover.late += step
        speed = math.sqrt(mover.vx * mover.vx + mover.vy * mover.vy)
        near = mover.error < params.margin and speed < CREEPING
        effort.stop = 1 if near or mover.late > 0.5 else 0
    pace = 1.0 if far < PATIENT else max(0.0, 2.0 - far / PATIENT)
    mover.lags = 0 if pace == 1.0 else 1
    mover.due = min(mover.due + pace * share, mover.count - 1.0)


@kernel
def stop(mover, effort, params, build, pace):
    """Set the forces of wheels that bring the body to rest within a step. ``pace``: 1/step."""
    mover.ahead = mover.aside = effort.turning = 0.0
    speed = mover.vx * effort.cos + mover.vy * effort.sin
    push = -0.5 * build.mass * speed * pace
    twist = -0.5 * build.inertia * mover.spin * pace / params.half_track
    effort.left = clipped(push - twist, params.motor)
    effort.right = clipped(push + twist, params.motor)


@inlined
def track(mover, effort, params, build, ahead, aside, pace):
    """Set the forces of wheels for the coming step, at whose end the reference goes ``ahead``
    [m/s] and turns ``aside`` [rad/s]. ``pace``: 1/step.
    """
    speed, turn = mover.vx * effort.cos + mover.vy * effort.sin, effort.turn
    before, before_turn = mover.ahead, mover.aside
    mover.ahead, mover.aside = ahead, aside
    square = turn * turn
    if square < 2.5e-3:
        pull, facing = 1.0 - square / 6.0, 1.0 - 0.5 * square
    else:
        pull, facing = math.sin(turn) / turn, math.cos(turn)
    more = params.across_gain * ahead * pull * effort.across + params.heading_gain * turn
    wish = ahead * facing + clipped(params.along_gain * effort.along, CORRECTION)
    wish_turn = aside + clipped(more, CORRECTION_TURN)
    gain = (ahead - before) * pace + (before + wish - ahead - speed) * params.servo
    gain_turn = (aside - before_turn) * pace
    gain_turn += (before_turn + wish_turn - aside - mover.spin) * params.servo
    effort.turning = scrub_share(wish_turn, wish, params.onset)
    push = 0.5 * build.mass * gain
    twist = 0.5 * (build.inertia * gain_turn + build.scrub * effort.turning) / params.half_track
    left, right = wish - params.half_track * wish_turn, wish + params.half_track * wish_turn
    most, thick = 0.5 * build.rolling, 0.5 * build.viscous
    one = push - twist + clipped(most / ROLLS * left, most) + thick * left
    two = push + twist + clipped(most / ROLLS * right, most) + thick * right
    effort.left, effort.right = clipped(one, params.motor), clipped(two, params.motor)


@kernel
def track_freely(mover, effort, params, build, ux, uy, pace):
    """The same for a holonomic robot, whose motors push in any direction: ``left`` and ``right``
    are the forces in x and y, (ux, uy) [m/s] the velocity of the reference; or it stops.
    """
    effort.turning = 0.0
    if effort.stop:
        mover.ahead = mover.aside = 0.0
        fx, fy = -build.mass * mover.vx * pace, -build.mass * mover.vy * pace
    else:
        dx, dy, bx, by = effort.along, effort.across, mover.ahead, mover.aside
        mover.ahead, mover.aside = ux, uy
        gain = min(params.along_gain, CORRECTION / max(mover.error, 1e-9))
        servo = params.servo
        wx, wy = ux + gain * dx, uy + gain * dy
        resist = build.viscous + build.rolling / max(math.sqrt(wx * wx + wy * wy), ROLLS)
        fx = build.mass * ((ux - bx) * pace + (bx + gain * dx - mover.vx) * servo) + resist * wx
        fy = build.mass * ((uy - by) * pace + (by + gain * dy - mover.vy) * servo) + resist * wy
    force, most = math.sqrt(fx * fx + fy * fy), 2.0 * params.motor
    cut = most / force if force > most else 1.0
    effort.left, effort.right = cut * fx, cut * fy
