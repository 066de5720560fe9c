"""References: where a robot should be, step by step, from departure to rest.

A reference is (count, 4): x, y [m], heading [rad, not wrapped] and the way driven up to there [m],
negative where it is driven backwards, one sample each step. Positions follow the path and its speed
profile exactly. Headings are averaged over a window of time: a change of curvature, for which
wheels would need infinite torque, becomes a ramp. Sampling by itself spreads it over a step, which
the window makes allowance for.
"""

from __future__ import annotations

import math

import numpy as np

from fleet.motion.kernels.geometry import wrapped
from fleet.motion.kernels.profile import NEAR, heading_at, position_at, profiled, stretch
from fleet.motion.kernels.records import ARC, LINE, TURN
from protocols.compiled import inlined, kernel

ROUNDING = 1e-9  # share of a step
SPARE = 4  # samples for which there is room behind a reference


@inlined
def at(references, slot, count, due):
    """The sample ``due`` of a reference, which may lie between two: (x, y, heading, way).

    Between samples speeds change evenly: a cubic through the four samples around.
    """
    i = min(int(due), count - 1)
    f = due - i
    if f == 0.0 or i == count - 1:
        return (
            references[slot, i, 0],
            references[slot, i, 1],
            references[slot, i, 2],
            references[slot, i, 3],
        )
    before, after = max(i - 1, 0), min(i + 2, count - 1)
    p = 0.5 * f * ((2.0 - f) * f - 1.0)
    q = 0.5 * ((3.0 * f - 5.0) * f * f + 2.0)
    r = 0.5 * f * ((4.0 - 3.0 * f) * f + 1.0)
    s = 0.5 * (f - 1.0) * f * f
    one, two, three, four = (
        references[slot, before], references[slot, i], references[slot, i + 1],
        references[slot, after],
    )  # fmt: skip
    return (
        p * one[0] + q * two[0] + r * three[0] + s * four[0],
        p * one[1] + q * two[1] + r * three[1] + s * four[1],
        p * one[2] + q * two[2] + r * three[2] + s * four[2],
        p * one[3] + q * two[3] + r * three[3] + s * four[3],
    )


@kernel
def _note(reference, count, x, y, heading, way):
    """Add a sample, if there is room; returns how many there are now."""
    if count < len(reference):
        reference[count, 0], reference[count, 1] = x, y
        reference[count, 2], reference[count, 3] = heading, way
    return count + 1


@kernel
def _sampled(reference, segments, first, end, x, y, heading, astern, dt):
    """Sample the profile of segments[first:end] every ``dt`` [s]; returns how many samples."""
    count = _note(reference, 0, x, y, heading, 0.0)
    way, wait, forwards = 0.0, dt, -1.0 if astern else 1.0
    behind, speed = math.pi if astern else 0.0, 0.0
    for k in range(first, end):
        segment = segments[k]
        heading += wrapped(heading_at(segment, 0.0) - behind - heading)
        bend = segment.sense if segment.kind == TURN else 0.0
        if segment.kind == ARC:
            bend = segment.sense / segment.radius
        gain = 0.0 if segment.kind == TURN else forwards
        along = 0.0
        while segment.length - along > NEAR:
            last, lasts, far = stretch(segment, along, speed)
            change = (last - speed) / lasts if lasts > 0.0 else 0.0
            more = math.ceil((lasts - wait) / dt - ROUNDING)
            for n in range(more):
                time = wait + n * dt
                here = along + (speed + 0.5 * change * time) * time
                if count >= len(reference):
                    count += more - n
                    break
                if segment.kind == LINE:
                    x, y = segment.x + here * segment.cos, segment.y + here * segment.sin
                else:
                    x, y = position_at(segment, here)
                reference[count, 0], reference[count, 1] = x, y
                reference[count, 2], reference[count, 3] = heading + bend * here, way + gain * here
                count += 1
            if more > 0:
                wait += more * dt
            wait -= lasts
            along += far
            speed = last
        heading += bend * segment.length
        way += gain * segment.length
    if wait < (1.0 - ROUNDING) * dt or count == 1:
        x, y = position_at(segments[end - 1], segments[end - 1].length)
        count = _note(reference, count, x, y, heading, way)
    return count


@kernel
def _area(areas, headings, count, where):
    """The integral of the headings from the first sample to ``where``, which may lie outside."""
    if where <= 0.0:
        return where * headings[0]
    if where >= count - 1.0:
        return areas[count - 1] + (where - (count - 1.0)) * headings[count - 1]
    i = int(where)
    f = where - i
    return areas[i] + f * (headings[i] + 0.5 * f * (headings[i + 1] - headings[i]))


@kernel
def _smoothed(reference, count, half):
    """Average the headings over ``half`` steps to both sides."""
    if half <= 0.0:
        return
    headings, areas = np.empty(count), np.empty(count)
    headings[0] = reference[0, 2]
    areas[0] = 0.0
    for i in range(1, count):
        headings[i] = reference[i, 2]
        areas[i] = areas[i - 1] + 0.5 * (headings[i - 1] + headings[i])
    share = 0.5 / half
    for i in range(1, count - 1):
        after = _area(areas, headings, count, i + half)
        reference[i, 2] = share * (after - _area(areas, headings, count, i - half))


@kernel
def lay(reference, segments, path, x, y, heading, params, build):
    """Write the reference of a drive along ``path`` from rest at (x, y) [m] and ``heading`` [rad];
    returns how many samples it has. If there is not room for :data:`SPARE` more, it is not whole.
    """
    first, astern = profiled(segments, path, x, y, heading, params, build)
    end = len(path) + 1
    count = _sampled(reference, segments, first, end, x, y, heading, astern, params.dt)
    if count + SPARE > len(reference):
        return count
    if params.holonomic:
        for k in range(count):
            reference[k, 2] = heading
    else:
        _smoothed(reference, count, 0.5 * (params.window - params.dt) / params.dt)
    return count


@kernel
def cut_short(references, slot, draft, count, due, params):
    """Write into ``draft`` how to brake from the sample ``due`` on, on the reference in ``slot``;
    returns how many samples that takes: at most :data:`SPARE` more than the reference has left.

    The way is driven with even braking, a turn on the spot is slowed down evenly.
    """
    left = count - due
    x, y, heading, way = at(references, slot, count, due)
    draft[0, 0], draft[0, 1], draft[0, 2], draft[0, 3] = x, y, heading, way
    _, _, heading_before, way_before = at(references, slot, count, max(due - 1.0, 0.0))
    speed = abs(way - way_before) / params.dt
    turn = abs(heading - heading_before) / params.dt
    if speed * params.dt < 1e-6:
        steps = turn / params.turn_acceleration / params.dt
    else:
        steps = speed / params.acceleration / params.dt
    made, place = 1, due
    most = min(math.ceil(steps), int(left) + SPARE - 2)
    for k in range(1, most + 1):
        pace = max(0.0, 1.0 - (k - 0.5) / steps)  # of the speed at the beginning
        if speed * params.dt < 1e-6:
            place = min(place + pace, count - 1.0)
        else:
            way_to_go = pace * speed * params.dt
            place = _further(references[slot], count, place, way_to_go)
        x, y, heading, way = at(references, slot, count, place)
        draft[k, 0], draft[k, 1], draft[k, 2], draft[k, 3] = x, y, heading, way
        made = k + 1
    return made


@kernel
def _further(reference, count, place, far):
    """The place on the reference that is ``far`` [m] further on."""
    while far > 0.0 and place < count - 1.0:
        i = int(place)
        step = abs(reference[i + 1, 3] - reference[i, 3])
        there = (i + 1 - place) * step
        if there >= far:
            return place + far / step
        far -= there
        place = i + 1.0
    return place
