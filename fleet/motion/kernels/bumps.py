"""Who is about to touch: with an engine, for finer steps; without, to stop in front of bodies."""

from __future__ import annotations

import math

from fleet.motion.kernels.grid import discs_near, edges_near
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
def near_something(mover, movers, active, floor, params):
    """Whether ``mover`` may touch a body or a wall in this step. Where others rest, or will."""
    x, y, radius = mover.x, mover.y, params.radius
    reach, grid = radius + 4.0 * params.cruise * params.dt, floor.grid[0]
    if min(x, y, grid.width - x, grid.height - y) < reach:
        return True
    for k in range(len(active)):
        other = movers[active[k]]
        if other.slot != mover.slot:
            dx, dy = other.x - x, other.y - y
            if dx * dx + dy * dy < (reach + radius) * (reach + radius):
                return True
    if discs_near(floor, mover.robot, x, y, x, y, reach + radius) > 0:
        return True
    return edges_near(floor, x, y, x, y, reach, 0) > 0


@kernel
def parts(movers, active, floor, params):
    """Into how many parts a step is divided where bodies may touch: one, unless somebody drives
    near something.
    """
    for k in range(len(active)):
        mover = movers[active[k]]
        if mover.awake and near_something(mover, movers, active, floor, params):
            return params.substeps
    return 1
