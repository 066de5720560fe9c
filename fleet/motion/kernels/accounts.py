"""What a step has cost the battery, and what for.

Work is force times the mean of the velocities before and after the step, which is exact: what the
motors do is what the body gains and what resistances, slip and contacts take. The battery gives a
motor's work divided by the efficiency, gets back the regenerated share of what brakes, and heats
the windings. Each account is kept by itself, from the forces and velocities that it is about, so
that they add up to what was drained only if nothing is forgotten.
"""

from __future__ import annotations

import math

from fleet.motion.kernels.records import EMPTY
from protocols.compiled import inlined, kernel

STILL = 1e-9  # [m/s] a change of velocity below this is no contact


@inlined
def drain(mover, energy):
    """Take ``energy`` [J] from the battery, if it holds as much; returns the share that it did.

    If it does not, it is empty now to the last bit, and the trip is over.
    """
    left = mover.held - mover.spent
    if energy > left:
        mover.spent, mover.phase = mover.held, EMPTY
        return left / energy
    mover.spent += energy
    return 1.0


@inlined
def _book(mover, params, step, driven, braked, heat, roll, viscous, scrub, slip, contact, kinetic):
    """Pay for a ``step`` [s] and keep what for: work [J] done by motors, ``driven`` and ``braked``
    (0 or more), and taken by all else.
    """
    cost, back = params.cost, params.back
    electronics = params.electronics * step
    share = drain(mover, electronics + heat + cost * driven - back * braked)
    mover.electronics += share * electronics
    mover.windings += share * heat
    mover.rolling += share * cost * roll
    mover.viscous += share * cost * viscous
    mover.scrub += share * cost * scrub
    mover.slip += share * cost * slip
    mover.contact += share * cost * contact
    mover.braking += share * (cost * kinetic + (cost - back) * braked)


@inlined
def settle_up(mover, effort, params, build, x, y, heading, vx, vy, spin, step):
    """See what became of a ``step`` [s]: the body's pose and velocity after it are given. Pays for
    it; returns whether something pushed the body.
    """
    cos, sin, h = effort.cos, effort.sin, params.half_track
    mx, my, mw = 0.5 * (mover.vx + vx), 0.5 * (mover.vy + vy), 0.5 * (mover.spin + spin)
    gx, gy, gw = vx - mover.vx, vy - mover.vy, spin - mover.spin
    jx, jy = build.mass * gx - effort.fx * step, build.mass * gy - effort.fy * step
    jw = build.inertia * gw - effort.torque * step
    kinetic = build.mass * (gx * mx + gy * my) + build.inertia * gw * mw
    contact = -(jx * mx + jy * my + jw * mw)
    square = effort.left * effort.left + effort.right * effort.right
    if params.holonomic:
        power = effort.left * (mx + effort.spin_left) + effort.right * (my + effort.spin_right)
        driven, braked = max(power, 0.0), max(-power, 0.0)
        heat = 0.5 * params.windings * square
        roll = effort.roll_left * mx + effort.roll_right * my
        viscous = effort.viscous_left * mx + effort.viscous_right * my
        scrub = 0.0
        slip = effort.left * effort.spin_left + effort.right * effort.spin_right
        rolled = math.sqrt(mx * mx + my * my)
    else:
        u, side = mx * cos + my * sin, my * cos - mx * sin
        left, right = u - h * mw, u + h * mw
        one = effort.left * (left + effort.spin_left)
        two = effort.right * (right + effort.spin_right)
        driven, braked = max(one, 0.0) + max(two, 0.0), max(-one, 0.0) + max(-two, 0.0)
        heat = params.windings * square + params.turning * abs(effort.turning)
        roll = effort.roll_left * left + effort.roll_right * right
        viscous = effort.viscous_left * left + effort.viscous_right * right
        scrub = effort.scrub * mw
        slip = effort.left * effort.spin_left + effort.right * effort.spin_right
        slip -= effort.side * side
        rolled = abs(u)
    _book(
        mover, params, step, driven * step, braked * step, heat * step, roll * step,
        viscous * step, scrub * step, slip * step, contact, kinetic,
    )  # fmt: skip
    mover.path += rolled * step
    mover.x, mover.y, mover.heading = x, y, heading
    mover.vx, mover.vy, mover.spin = vx, vy, spin
    least = STILL * build.mass
    return jx * jx + jy * jy > least * least


@kernel
def wait(mover, params):
    """Let ``mover`` stand for a step; it may cost idle power."""
    mover.waited += 1
    energy = params.idle * params.dt
    mover.waiting += energy * drain(mover, energy)


@kernel
def follow(mover, reference, params, build):
    """Let ``mover`` make the next step of its reference exactly, as the robot would that ``build``
    describes: no engine, the forces that it takes are worked out backwards from the motion.
    """
    step = params.dt
    pace, h = 1.0 / step, params.half_track
    i, last = int(mover.due), mover.count - 1
    j = min(i + 1, last)
    x, y, heading = reference[j, 0], reference[j, 1], reference[j, 2]
    if params.holonomic:
        vx, vy = (x - reference[i, 0]) * pace, (y - reference[i, 1]) * pace
        mx, my = 0.5 * (mover.vx + vx), 0.5 * (mover.vy + vy)
        gx, gy = vx - mover.vx, vy - mover.vy
        mean = math.sqrt(mx * mx + my * my)
        resist = build.viscous + (build.rolling / mean if mean > 0.0 else 0.0)
        fx, fy = build.mass * gx * pace + resist * mx, build.mass * gy * pace + resist * my
        power = fx * mx + fy * my
        driven, braked = max(power, 0.0), max(-power, 0.0)
        heat = 0.5 * params.windings * (fx * fx + fy * fy)
        roll, viscous, scrub = build.rolling * mean, build.viscous * mean * mean, 0.0
        kinetic, rolled = build.mass * (gx * mx + gy * my), mean
        mover.vx, mover.vy = vx, vy
    else:
        ahead = (reference[j, 3] - reference[i, 3]) * pace
        aside = (heading - reference[i, 2]) * pace
        u, w = 0.5 * (mover.ahead + ahead), 0.5 * (mover.aside + aside)
        gain, gain_turn = ahead - mover.ahead, aside - mover.aside
        most = params.onset * abs(u)
        share = min(abs(w) / most, 1.0) if most > 0.0 else (1.0 if w != 0.0 else 0.0)
        torque = math.copysign(share * build.scrub, w)
        push = 0.5 * build.mass * gain * pace
        twist = 0.5 * (build.inertia * gain_turn * pace + torque) / h
        left, right = u - h * w, u + h * w
        roll_left = math.copysign(0.5 * build.rolling, left) if left != 0.0 else 0.0
        roll_right = math.copysign(0.5 * build.rolling, right) if right != 0.0 else 0.0
        thick = 0.5 * build.viscous
        force_left = push - twist + roll_left + thick * left
        force_right = push + twist + roll_right + thick * right
        one, two = force_left * left, force_right * right
        driven, braked = max(one, 0.0) + max(two, 0.0), max(-one, 0.0) + max(-two, 0.0)
        heat = params.windings * (force_left * force_left + force_right * force_right)
        heat += params.turning * share
        roll = roll_left * left + roll_right * right
        viscous, scrub = thick * (left * left + right * right), torque * w
        kinetic = build.mass * gain * u + build.inertia * gain_turn * w
        rolled = abs(u)
        mover.ahead, mover.aside, mover.spin = ahead, aside, aside
        mover.vx, mover.vy = (x - reference[i, 0]) * pace, (y - reference[i, 1]) * pace
    _book(
        mover, params, step, driven * step, braked * step, heat * step, roll * step,
        viscous * step, scrub * step, 0.0, 0.0, kinetic,
    )  # fmt: skip
    mover.path += rolled * step
    mover.x, mover.y, mover.heading = reference[i, 0], reference[i, 1], reference[i, 2]
    mover.due = i + 1.0
