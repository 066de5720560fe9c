"""Everybody's drive: setting off, and the loop over the steps."""

from __future__ import annotations

import numpy as np

from fleet.motion.chipmunk import park_body, read_body, step_space, wake_body, write_body
from fleet.motion.kernels.accounts import follow, settle_up, wait
from fleet.motion.kernels.bumps import bumps, parts
from fleet.motion.kernels.geometry import wrapped
from fleet.motion.kernels.grid import put
from fleet.motion.kernels.records import (
    ARRIVED,
    DRIVING,
    LOST,
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
from fleet.motion.kernels.reference import SPARE, at, lay
from fleet.motion.kernels.reservations import foresee, reserve
from fleet.motion.kernels.tracking import compare, stop, track, track_freely
from fleet.motion.kernels.wheels import push, push_freely
from protocols.compiled import inlined, kernel

RESTS = 1e-3  # [m/s] below which a robot at the end of its way is parked
RESTS_TURNING = 1e-2  # [rad/s]
FIGHTS = 2.5  # [s] that it may take to come to rest at the end of its way
CLOSE = 0.02  # [m] from there it has arrived, otherwise it has missed it
PROGRESS = 3.0  # samples that it must get on
PATIENCE = 1.0  # [s] in which it must
ASTRAY = 0.15  # [m] off the path it gives up


@kernel
def launch(
    floor: Floor,
    traffic: Traffic,
    active: IntArray,
    segments: Records,
    slot: int,
    path: Records,
    step: int,
) -> tuple[int, int]:
    """Send the mover in ``slot`` along ``path``, (k,) SEGMENT, at ``step`` or as soon as its way is
    free, and reserve the place where it will rest.

    ``segments``, (more than k,) SEGMENT, are work space. Returns how much room its reference and
    how many knots its track take; if there is less of one, it must be launched again with more.
    """
    movers, params = traffic.movers, traffic.params[0]
    believed = traffic.builds[len(traffic.builds) - 1]
    reservations, boxes, reference = traffic.reservations, traffic.boxes, traffic.references[slot]
    mover = movers[slot]
    mover.phase, mover.start, mover.knots, mover.stopping = WAITING, step, 0, 0
    mover.due, mover.best, mover.since, mover.late = 0.0, 0.0, 0.0, 0.0
    mover.ahead = mover.aside = 0.0
    if len(path) == 0:
        mover.phase = ARRIVED
        return 0, 0
    count = lay(reference, segments, path, mover.x, mover.y, mover.heading, params, believed)
    if count + SPARE > len(reference):
        return count + SPARE, 0
    mover.count = count
    if params.reserved:
        knots = foresee(mover, reference, reservations, boxes, params, step)
        if knots > reservations.shape[1]:
            return count + SPARE, knots
        put_off = reserve(mover, movers, reservations, boxes, active, traffic.near, params)
        mover.start += params.stride * put_off
    put(floor, mover.robot, reference[count - 1, 0], reference[count - 1, 1])
    return count + SPARE, int(mover.knots)


@kernel
def embark(
    floor: Floor,
    traffic: Traffic,
    active: IntArray,
    segments: Records,
    slot: int,
    robot: int,
    x: float,
    y: float,
    heading: float,
    charge: float,
    path: Records,
    step: int,
) -> tuple[int, int]:
    """Give ``robot`` the mover in ``slot`` and send it along ``path``; see launch."""
    traffic.movers[slot] = np.zeros(1, MOVER)[0]
    mover = traffic.movers[slot]
    mover.robot, mover.slot, mover.departed = robot, slot, step
    mover.x, mover.y, mover.heading, mover.held = x, y, heading, charge
    return launch(floor, traffic, active, segments, slot, path, step)


@inlined
def sets_off(mover, params, step):
    """Whether a mover drives in ``step``; if not it waits."""
    if mover.phase == WAITING:
        if step < mover.start:
            wait(mover, params)
            return False
        mover.phase = DRIVING
    if mover.phase != DRIVING:
        return False
    mover.steps += 1
    if not mover.awake:
        mover.awake = 2
    return True


@inlined
def press(mover, effort, references, params, build, believed, divided):
    """Decide how hard a mover pushes for the next part of a step that is ``divided`` into so many
    parts.
    """
    step, share = params.dt / divided, 1.0 / divided
    pace = 1.0 / step
    x, y, heading, way = at(references, mover.slot, mover.count, mover.due)
    compare(mover, effort, params, x, y, heading, step, share)
    x_next, y_next, heading_next, way_next = at(references, mover.slot, mover.count, mover.due)
    if params.holonomic:
        track_freely(
            mover, effort, params, believed, (x_next - x) * pace, (y_next - y) * pace, pace
        )
        push_freely(mover, effort, params, build, believed, step, pace)
    else:
        if effort.stop:
            stop(mover, effort, params, believed, pace)
        else:
            ahead, aside = (way_next - way) * pace, (heading_next - heading) * pace
            track(mover, effort, params, believed, ahead, aside, pace)
        push(mover, effort, params, build, believed, step, pace)


@inlined
def _see(mover, params, pushed, step):
    """See what became of a mover's ``step`` [s]: whether it was pushed, and what of its trip."""
    if pushed and not mover.touching:
        mover.contacts += 1
    mover.touching = 1 if pushed else 0
    if mover.phase != DRIVING:
        return
    out = pushed or mover.lags or mover.error > params.margin
    if out and params.reserved and not mover.stopping:
        mover.phase = TOUCHED
        return
    if mover.late > 0.0:
        speed = abs(mover.vx) + abs(mover.vy)
        if (speed < RESTS and abs(mover.spin) < RESTS_TURNING) or mover.late > FIGHTS:
            mover.phase = ARRIVED if mover.error < CLOSE else LOST
        return
    if mover.due >= mover.best + PROGRESS:
        mover.best, mover.since = mover.due, 0.0
    mover.since += step
    if mover.since > PATIENCE or mover.error > ASTRAY:
        mover.phase = LOST


@inlined
def drives(mover, params, step, first):
    """Whether a mover's body is up to the engine in the next part of ``step``, the ``first`` of it
    or not.
    """
    if first and not sets_off(mover, params, step):
        return False
    return mover.awake != 0 and mover.phase == DRIVING


@inlined
def witness(mover, effort, params, build, x, y, heading, vx, vy, spin, divided):
    """Let a mover know its body's pose and velocity after a part of a step."""
    part = params.dt / divided
    pushed = settle_up(mover, effort, params, build, x, y, heading, vx, vy, spin, part)
    _see(mover, params, pushed, part)


@kernel
def sample(movers, references, params, active, samples, count, step):
    """Keep the poses at ``step`` of those whose turn it is, and where they should be; returns how
    many are kept now.
    """
    for k in range(len(active)):
        mover = movers[active[k]]
        turn = mover.phase == DRIVING and (step - mover.departed) % params.sample == 0
        if turn or mover.phase >= ARRIVED:
            due = mover.due if mover.late > 0.0 else max(mover.due - 1.0, 0.0)
            place = int(due)
            samples[count, 0], samples[count, 1] = mover.robot, step * params.dt
            samples[count, 2], samples[count, 3] = mover.x, mover.y
            samples[count, 4] = wrapped(mover.heading)
            samples[count, 5] = mover.held - mover.spent
            samples[count, 6] = references[mover.slot, place, 0]
            samples[count, 7] = references[mover.slot, place, 1]
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
def _go_by_plan(mover, reference, params, believed, blocked):
    """A step of one robot without an engine: exactly as planned, but that it stays where it is if
    a body has ``blocked`` its way.
    """
    if blocked:
        mover.contacts += 1
        mover.phase = LOST
        return
    last = mover.due >= mover.count - 1.0
    follow(mover, reference, params, believed)
    if last and mover.phase == DRIVING:
        mover.phase = ARRIVED


@kernel
def parks(mover: Record) -> bool:
    """Whether the body of ``mover`` is to be parked at once: its trip has ended by itself, or it
    does not know how to go on.
    """
    if mover.awake and ARRIVED <= mover.phase <= LOST:
        mover.awake = 0
        mover.vx = mover.vy = mover.spin = 0.0
        return True
    return False


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

    ``wires``: the engine; with none, all go exactly as planned, but that nobody drives into a body
    where somebody had to stop against its reservation. Returns (steps made, samples kept, trips
    that need looking after); it stops early if ``samples`` gets full.
    """
    movers, efforts, references, builds, params = (
        traffic.movers, traffic.efforts, traffic.references, traffic.builds, traffic.params[0]
    )  # fmt: skip
    calls, bodies, numbers, counts = wires.calls, wires.bodies, wires.numbers, wires.counts
    engine, believed = calls[0] != 0, builds[len(builds) - 1]
    made, kept, over = 0, 0, 0
    while made < steps and over == 0:
        if params.sample > 0 and kept + len(active) > len(samples):
            break
        divided = 1 if engine else 0
        if engine and params.substeps > 1:
            divided = parts(movers, active, floor, params)
        for n in range(divided):
            moving = 0
            for k in range(len(active)):
                slot = active[k]
                mover = movers[slot]
                if drives(mover, params, step + made, n == 0):
                    moving += 1
                    body, effort = bodies[mover.robot], efforts[slot]
                    press(
                        mover, effort, references, params, builds[mover.robot], believed, divided
                    )  # fmt: skip
                    if mover.awake == 2:
                        wake_body(calls, body, builds[mover.robot].inertia)
                        mover.awake = 1
                    write_body(calls, body, numbers, counts, effort.fx, effort.fy, effort.torque)
            if moving == 0:
                continue
            step_space(calls, params.dt / divided)
            for k in range(len(active)):
                slot = active[k]
                mover = movers[slot]
                if drives(mover, params, step + made, False):
                    read_body(calls, bodies[mover.robot], counts)
                    witness(
                        mover, efforts[slot], params, builds[mover.robot], numbers[0], numbers[1],
                        numbers[2], numbers[3], numbers[4], numbers[5], divided,
                    )  # fmt: skip
                    if parks(mover):
                        park_body(calls, bodies[mover.robot])
        for k in range(len(active)):
            mover = movers[active[k]]
            if not engine and sets_off(mover, params, step + made):
                careful = params.substeps > 1
                blocked = careful and bumps(mover, movers, active, floor, params)
                _go_by_plan(mover, references[active[k]], params, believed, blocked)
            if mover.phase >= ARRIVED:
                over += 1
        made += 1
        if params.sample > 0:
            kept = sample(movers, references, params, active, samples, kept, step + made)
    report(movers, active, traffic.poses, traffic.over)
    return made, kept, over
