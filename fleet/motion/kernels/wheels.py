"""What the floor does to wheels that push: resistance, traction, side grip.

Resistances are impulses that may stop a motion and never reverse it. While both wheels roll on the
way they roll they are known at once; otherwise they are found together, for both wheels and for
turning, by projected Gauss-Seidel iteration, as contact solvers do.
"""

from __future__ import annotations

import math

from protocols.compiled import inlined, kernel

TURNS = 8  # of the iteration, at most
SETTLED = 1e-13  # [N·s] a change below this ends it
NOTHING = 1e-15  # [N·m·s] of scrub below this is none


@inlined
def clipped(value, most):
    """``value`` brought into [-most, most]."""
    return min(max(value, -most), most)


@inlined
def _resist(mover, effort, build, params, speed, step, pace):
    """Fill in the resistances for a ``step`` [s] from ``speed`` [m/s]; returns the speed and the
    turn rate [rad/s] after it, were there grip without end.
    """
    h, spin = params.half_track, mover.spin
    lighter, inert = build.per_mass, build.per_inertia
    nimbler, thick = h * inert, 0.5 * build.viscous
    left, right = speed - h * spin, speed + h * spin
    most, most_scrub = 0.5 * build.rolling * step, build.scrub * step
    roll_left = math.copysign(most, left if left != 0.0 else effort.left)
    roll_right = math.copysign(most, right if right != 0.0 else effort.right)
    push_left = (effort.left - thick * left) * step - roll_left
    push_right = (effort.right - thick * right) * step - roll_right
    u = speed + (push_left + push_right) * lighter
    w = spin + (push_right - push_left) * nimbler
    soft = scrub = 0.0
    if most_scrub > NOTHING:
        soft = params.onset * abs(speed) / most_scrub
        scrub = clipped(w / (inert + soft), most_scrub)
        w -= scrub * inert
    # viscous at the mean of the speeds before and after
    more_left, more_right = 0.5 * thick * (u - h * w - left), 0.5 * thick * (u + h * w - right)
    u -= (more_left + more_right) * step * lighter
    w -= (more_right - more_left) * step * nimbler
    if (u - h * w) * roll_left < 0.0 or (u + h * w) * roll_right < 0.0:
        stiff = 1.0 / (lighter + h * nimbler)  # the mass that a wheel feels
        for _ in range(TURNS):
            new = clipped(roll_left + (u - h * w) * stiff, most)
            one = new - roll_left
            u, w, roll_left = u - one * lighter, w + one * nimbler, new
            new = clipped(roll_right + (u + h * w) * stiff, most)
            two = new - roll_right
            u, w, roll_right = u - two * lighter, w - two * nimbler, new
            new = clipped(scrub + (w - soft * scrub) / (inert + soft), most_scrub)
            three = new - scrub
            w, scrub = w - three * inert, new
            if abs(one) + abs(two) + abs(three) <= SETTLED:
                break
    effort.roll_left, effort.roll_right = roll_left * pace, roll_right * pace
    effort.viscous_left = thick * left + more_left
    effort.viscous_right = thick * right + more_right
    effort.scrub = scrub * pace
    return u, w


@kernel
def _spun(net, grip, stiffness):
    """How much faster than the floor a wheel turns [m/s] on which the net force [N] is more than
    the floor holds: its motor's servo gives it that much of what is too much.
    """
    return math.copysign(max(abs(net) - grip, 0.0), net) / stiffness


@inlined
def push(mover, effort, params, build, believed, step, pace):
    """From the forces of the wheels to force and torque on the body, for a ``step`` [s]."""
    h = params.half_track
    cos, sin = effort.cos, effort.sin
    speed, aside = mover.vx * cos + mover.vy * sin, mover.vy * cos - mover.vx * sin
    u, w = _resist(mover, effort, build, params, speed, step, pace)
    net_left = effort.left - effort.viscous_left - effort.roll_left
    net_right = effort.right - effort.viscous_right - effort.roll_right
    effort.spin_left = effort.spin_right = 0.0
    if abs(net_left) > build.grip or abs(net_right) > build.grip:
        stiffness = 0.5 * believed.mass * params.servo
        effort.spin_left = _spun(net_left, build.grip, stiffness)
        effort.spin_right = _spun(net_right, build.grip, stiffness)
        held_left, held_right = clipped(net_left, build.grip), clipped(net_right, build.grip)
        effort.left -= net_left - held_left
        effort.right -= net_right - held_right
        net_left, net_right = held_left, held_right
        u = speed + (net_left + net_right) * step / build.mass
        w = mover.spin + h * (net_right - net_left) * step / build.inertia
        most = build.scrub * step
        soft = params.onset * abs(speed) / max(most, NOTHING)
        scrub = clipped(w / (build.per_inertia + soft), most)
        w -= scrub * build.per_inertia
        effort.scrub = scrub * pace
    ahead = net_left + net_right
    effort.torque = h * (net_right - net_left) - effort.scrub
    half = 0.5 * w * step
    bend = half + half * half * half / 3.0 if abs(half) < 0.05 else math.tan(min(half, 1.5))
    side = build.mass * pace * (u * bend - aside)  # that leaves no slip halfway through
    left = max(0.0, 4.0 * build.grip * build.grip - ahead * ahead)  # of the grip, squared
    effort.side = side if side * side < 0.5 * left else clipped(side, math.sqrt(left))
    effort.fx = ahead * cos - effort.side * sin
    effort.fy = ahead * sin + effort.side * cos


@kernel
def push_freely(mover, effort, params, build, believed, step, pace):
    """The same for a holonomic robot: its motors push in x and y, and all resists its velocity."""
    mass, most, thick = build.mass, build.rolling * step, build.viscous
    vx = mover.vx + (effort.left - thick * mover.vx) * step / mass
    vy = mover.vy + (effort.right - thick * mover.vy) * step / mass
    # rolling resistance against the mean velocity, or as much as stops it
    mx, my = mover.vx + vx, mover.vy + vy
    mean = math.sqrt(mx * mx + my * my)
    rx, ry = mass * vx, mass * vy
    if mean > 0.0 and rx * rx + ry * ry > most * most:
        sx, sy = most * mx / mean, most * my / mean
        if (rx - sx) * rx + (ry - sy) * ry > 0.0:
            rx, ry = sx, sy
    effort.roll_left, effort.roll_right = rx * pace, ry * pace
    # viscous at the mean of the velocities before and after
    effort.viscous_left = thick * 0.5 * (mover.vx + vx - rx / mass)
    effort.viscous_right = thick * 0.5 * (mover.vy + vy - ry / mass)
    effort.spin_left = effort.spin_right = effort.scrub = effort.side = effort.torque = 0.0
    nx = effort.left - effort.viscous_left - effort.roll_left
    ny = effort.right - effort.viscous_right - effort.roll_right
    net, grip = math.sqrt(nx * nx + ny * ny), 2.0 * build.grip
    if net > grip:
        stiffness = believed.mass * params.servo
        over = (net - grip) / net
        effort.spin_left, effort.spin_right = over * nx / stiffness, over * ny / stiffness
        effort.left -= over * nx
        effort.right -= over * ny
        nx, ny = nx * grip / net, ny * grip / net
    effort.fx, effort.fy = nx, ny
