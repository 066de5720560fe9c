"""Redriven on recorded commands: they cost what the law says, and what was measured."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from driven_logs import exported

from fleet.logs.judging import judge
from fleet.logs.redriving import redrive, redriven_sentence, robot_of
from fleet.motion.builds import resistance_of
from fleet.motion.commanded import drive_commanded
from fleet.motion.options import DriveOptions
from fleet.robot import PRESETS

SMALL = PRESETS["small"]


def steady(seconds=4.0, speed=0.5):
    """Up to a speed, on at it, and down again, in steps of 1/60 s."""
    ramp = np.arange(0.0, speed, SMALL.acceleration / 60.0)
    return np.r_[ramp, np.full(round(60 * seconds), speed), ramp[::-1]]


def test_a_steady_drive_costs_what_power_and_inertia_say():
    v = steady()
    body = drive_commanded(SMALL, v, 0.0 * v)
    assert body.arrived
    assert body.path == pytest.approx(v.sum() / 60.0, rel=0.005)
    longer = steady(seconds=6.0)
    more = drive_commanded(SMALL, longer, 0.0 * longer).energy - body.energy
    assert more == pytest.approx(2.0 * SMALL.power.power(0.5), rel=1e-3)


def test_the_compiled_loop_and_the_public_interface_agree():
    v = steady(seconds=0.5)
    omega = np.where(v > 0.4, 0.8, 0.0)
    free = DriveOptions(traffic="free")
    assert drive_commanded(SMALL, v, omega, free) == pytest.approx(
        drive_commanded(SMALL, v, omega, replace(free, bridge=False))
    )


def test_turning_costs_scrub_and_a_body_that_is_too_weak_does_not_arrive():
    turn = np.full(120, 1.0)
    scrubs = replace(SMALL, scrub=1.0)
    dear = drive_commanded(scrubs, 0.0 * turn, turn).energy
    assert dear > drive_commanded(SMALL, 0.0 * turn, turn).energy + 0.8 * 2.0 / SMALL.efficiency
    assert not drive_commanded(SMALL, np.full(60, 3.0), 0.0 * turn[:60]).arrived


@pytest.mark.slow
def test_the_loop_closes(tmp_path):
    """Held-out drives, driven again by bodies of the preset, cost the same within 2 %."""
    ground, robot = exported(tmp_path, "small", rounds=8)
    judged = judge(ground)
    bodies = redrive(judged, most=60.0)
    assert len(bodies.measured) > 5
    assert bodies.arrived.all()
    assert bodies.body == pytest.approx(bodies.measured, rel=0.02)
    assert bodies.body == pytest.approx(bodies.law, rel=0.02)
    assert "take what was measured within" in redriven_sentence(bodies)
    assert robot_of(judged).power.linear == pytest.approx(robot.power.linear, rel=0.02)


def test_a_preset_without_electronics_is_a_robot(tmp_path):
    """Heat at standstill is not more than its constant, however its digits are rounded."""
    judged = judge(exported(tmp_path, "husky", rounds=4)[0])
    law = replace(judged.preset.law, coefficients=(38.5, 0.0, 112.0, 0.0, 0.0))
    law = replace(law, terms=("distance", "time", "angle", "turning", "square"))
    for rolling in np.linspace(20.0, 60.0, 12):
        law = replace(law, coefficients=(float(rolling), *law.coefficients[1:]))
        spec = robot_of(replace(judged, preset=replace(judged.preset, law=law)))
        assert resistance_of(spec).electronics < 1e-3
