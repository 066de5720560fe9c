"""Running into others without an engine: only after a breakdown, by those too near to brake."""

from __future__ import annotations

import math

from protocols.compiled import kernel


@kernel
def _enters(mover, x, y, dt, apart):
    """Whether ``mover``, as commanded for ``dt`` [s], comes nearer to (x, y) than ``apart`` [m]."""
    after = math.hypot(mover.x + mover.vx * dt - x, mover.y + mover.vy * dt - y)
    return after < apart and after < math.hypot(mover.x - x, mover.y - y)


@kernel
def bumps(mover, movers, active, floor, params):
    """Whether ``mover`` would drive into a body in this step: one under way, or a parked one."""
    apart = 2.0 * params.radius
    for k in range(len(active)):
        other = movers[active[k]]
        if other.slot != mover.slot and _enters(mover, other.x, other.y, params.dt, apart):
            return True
    robots = (len(floor.discs) - len(floor.edges)) // 2
    for robot in range(robots):
        disc = floor.discs[robot]
        if robot != mover.robot and _enters(mover, disc.x, disc.y, params.dt, apart):
            parked = True
            for k in range(len(active)):
                parked = parked and movers[active[k]].robot != robot
            if parked:
                return True
    return False


@kernel
def stay(mover):
    """Be stopped by what is in the way."""
    mover.ux = mover.uy = 0.0
