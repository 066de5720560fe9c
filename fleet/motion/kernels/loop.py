"""Everybody's drive: setting off, and the loop over the steps."""

from __future__ import annotations

import numpy as np

from fleet.motion.chipmunk import park_body, read_body, step_space, wake_body, write_body
from fleet.motion.kernels.bumps import bumps, stay
from fleet.motion.kernels.drive import coast, drive, position_at, swing, wait
from fleet.motion.kernels.geometry import wrapped
from fleet.motion.kernels.grid import put
from fleet.motion.kernels.profile import set_off
from fleet.motion.kernels.records import (
    ARRIVED,
    DRIVING,
    EMPTY,
    MOVER,
    TOUCHED,
    WAITING,
    FloatArray,
    Floor,
    IntArray,
    Record,
    Records,
    Traffic,
    Wires,
)
from fleet.motion.kernels.recovery import recover
from fleet.motion.kernels.reservations import foresee, reserve
from protocols.compiled import kernel

STILL = 1e-9  # [m/s] a smaller difference to the command is no contact


@kernel
def launch(
    floor: Floor, traffic: Traffic, active: IntArray, slot: int, path: Records, step: int
) -> int:
    """Send the mover in ``slot`` along ``path``, (k,) SEGMENT, at ``step`` or as soon as its way is
    free, and reserve the place where it will rest.

    Returns how many knots its track has; if that is more than there is room for, it must be
    launched again with more.
    """
    movers, segments, params = traffic.movers, traffic.segments, traffic.params[0]
    reservations, boxes = traffic.reservations, traffic.boxes
    mover, end = movers[slot], len(path) + 1
    for k in range(1, end):
        segments[slot, k] = path[k - 1]
    set_off(mover, segments, end, params)
    mover.phase, mover.start, mover.knots = WAITING, step, 0
    if end == 1:
        mover.phase = ARRIVED
        return 0
    if mover.ux != 0.0 or mover.uy != 0.0:
        mover.off_path = 1
    x, y = position_at(segments[slot, end - 1], segments[slot, end - 1].length)
    if params.reserved:
        traffic.ghost[0] = mover
        ghost = traffic.ghost[0]
        foresee(mover, ghost, segments, reservations, boxes, params, step)
        if mover.knots > reservations.shape[1]:
            return int(mover.knots)
        put_off = reserve(mover, movers, reservations, boxes, active, traffic.near, params)
        mover.start += params.stride * put_off
        x, y = ghost.x, ghost.y
    put(floor, mover.robot, x, y)
    return int(mover.knots)


@kernel
def embark(
    floor: Floor,
    traffic: Traffic,
    active: IntArray,
    slot: int,
    robot: int,
    x: float,
    y: float,
    heading: float,
    charge: float,
    path: Records,
    step: int,
) -> int:
    """Give ``robot`` the mover in ``slot`` and send it along ``path``; see launch."""
    traffic.movers[slot] = np.zeros(1, MOVER)[0]
    mover = traffic.movers[slot]
    mover.robot, mover.slot, mover.departed = robot, slot, step
    mover.x, mover.y, mover.heading, mover.held = x, y, heading, charge
    return launch(floor, traffic, active, slot, path, step)


@kernel
def _decide(mover, segments, params, step):
    """Command what a mover does in ``step``; returns whether it does anything.

    Its body is woken when it leaves its place: where robots are kept apart, one that turns on
    the spot needs no engine.
    """
    if mover.phase == WAITING:
        if step < mover.start:
            wait(mover, params)
            return False
        mover.phase = DRIVING
    mover.steps += 1
    if mover.off_path:
        recover(mover, segments, params)
    else:
        drive(mover, segments, params, params.dt)
    if not mover.awake and (mover.vx != 0.0 or mover.vy != 0.0 or not params.reserved):
        mover.awake = 2
    return True


@kernel
def _see(mover, params):
    """See what became of the command; returns whether the trip needs looking after."""
    if mover.awake:
        mover.awake = 1
        dx, dy = mover.ux - mover.vx, mover.uy - mover.vy
        touching = dx * dx + dy * dy > STILL * STILL
        if touching and not mover.touching:
            mover.contacts += 1
        mover.touching = 1 if touching else 0
        if touching and mover.phase == DRIVING and not mover.off_path:
            mover.off_path = 1
            if params.reserved:
                mover.phase = TOUCHED
    return mover.phase >= ARRIVED


@kernel
def command(movers: Records, segments: Records, params: Record, active: IntArray, step: int) -> int:
    """Decide what everybody does in ``step``; returns for how many that is up to the engine."""
    moving, part = 0, params.dt / params.substeps
    for k in range(len(active)):
        mover = movers[active[k]]
        if _decide(mover, segments, params, step):
            if mover.awake:
                swing(mover, part, params.substeps)
                moving += 1
            else:
                coast(mover, part, params.substeps)
    return moving


@kernel
def settle(movers: Records, params: Record, active: IntArray) -> int:
    """See what became of the commands; returns how many trips need looking after."""
    over = 0
    for k in range(len(active)):
        if _see(movers[active[k]], params):
            over += 1
    return over


@kernel
def _tell(mover, calls, bodies, numbers, counts):
    """Give the velocity that a mover is to have to its body."""
    body = bodies[mover.robot]
    if mover.awake == 2:
        wake_body(calls, body)
    write_body(calls, body, numbers, counts, mover.vx, mover.vy)


@kernel
def _hear(mover, calls, bodies, numbers, counts):
    """Learn from a mover's body where it is now, and how fast."""
    read_body(calls, bodies[mover.robot], counts)
    mover.x, mover.y = numbers[0], numbers[1]
    mover.ux, mover.uy = numbers[2], numbers[3]


@kernel
def sample(
    movers: Records, params: Record, active: IntArray, samples: FloatArray, count: int, step: int
) -> int:
    """Keep the poses at ``step`` of those whose turn it is; returns how many are kept now."""
    for k in range(len(active)):
        mover = movers[active[k]]
        turn = mover.phase == DRIVING and (step - mover.departed) % params.sample == 0
        if turn or mover.phase >= ARRIVED:
            samples[count, 0], samples[count, 1] = mover.robot, step * params.dt
            samples[count, 2], samples[count, 3] = mover.x, mover.y
            samples[count, 4] = wrapped(mover.heading)
            samples[count, 5] = mover.held - mover.spent
            count += 1
    return count


@kernel
def report(movers: Records, active: IntArray, poses: FloatArray, over: IntArray) -> int:
    """Write down how everybody is now, and who needs looking after: their places in ``active``,
    and their phases. Returns how many these are.
    """
    count = 0
    for k in range(len(active)):
        mover = movers[active[k]]
        poses[k, 0], poses[k, 1] = mover.x, mover.y
        poses[k, 2], poses[k, 3] = wrapped(mover.heading), mover.held - mover.spent
        if mover.phase >= ARRIVED:
            over[count, 0], over[count, 1] = k, mover.phase
            count += 1
    return count


@kernel
def run(
    floor: Floor,
    traffic: Traffic,
    wires: Wires,
    active: IntArray,
    step: int,
    steps: int,
    samples: FloatArray,
) -> tuple[int, int, int]:
    """Drive on from ``step`` until trips need looking after, ``steps`` at most.

    ``wires``: the engine; with none, all that drive coast, and stop at what they would run into
    where bodies may touch at all: in steps of several parts. Returns (steps made, samples kept,
    trips that need looking after); it stops early if ``samples`` gets full.
    """
    movers, segments, params = traffic.movers, traffic.segments, traffic.params[0]
    calls, bodies, numbers, counts = wires.calls, wires.bodies, wires.numbers, wires.counts
    engine, substeps, part = calls[0] != 0, params.substeps, params.dt / params.substeps
    made, kept, over = 0, 0, 0
    while made < steps and over == 0:
        if params.sample > 0 and kept + len(active) > len(samples):
            break
        moving = 0
        for k in range(len(active)):
            mover = movers[active[k]]
            if _decide(mover, segments, params, step + made):
                if engine and mover.awake:
                    _tell(mover, calls, bodies, numbers, counts)
                    swing(mover, part, substeps)
                    moving += 1
                elif substeps > 1 and bumps(mover, movers, active, floor, params):
                    stay(mover)
                else:
                    coast(mover, part, substeps)
        if moving > 0:
            for _ in range(substeps):
                step_space(calls, part)
        for k in range(len(active)):
            mover = movers[active[k]]
            if engine and mover.awake:
                _hear(mover, calls, bodies, numbers, counts)
            if _see(mover, params):
                over += 1
                if mover.awake and mover.phase <= EMPTY:
                    mover.awake = 0
                    if engine:
                        park_body(calls, bodies[mover.robot])
        made += 1
        if params.sample > 0:
            kept = sample(movers, params, active, samples, kept, step + made)
    report(movers, active, traffic.poses, traffic.over)
    return made, kept, over
