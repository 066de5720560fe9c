"""What a launch is predicted to cost, against robots that push themselves along."""

from __future__ import annotations

from math import inf, pi

import numpy as np
import pytest

from fleet.experiments.energy.launching import launch_cost, pivot_cost, ramps_cost
from fleet.motion.driven import DrivenMotion
from fleet.power import Battery
from fleet.robot import PRESETS, Robot, RobotSpec
from worlds.arena import Arena


def drive(spec, heading, distance=4.0):
    motion = DrivenMotion(spec, Arena(), engine=True)
    robot = Robot(0, (2.0, 5.0), heading, Battery(1e6), inf, [], motion)
    motion.place([robot])
    motion.depart(robot, (2.0 + distance, 5.0))
    (trip,) = motion.advance(inf)
    return trip.energy


SPECS = {
    "the paper's": RobotSpec(),
    "slow to speed up": RobotSpec(acceleration=0.3),
    "Pioneer": PRESETS["pioneer"],
    "backwards too": RobotSpec(reverse=True),
    "heavy": RobotSpec(mass=30.0),
}


@pytest.mark.parametrize("name", SPECS)
def test_launches_cost_what_is_predicted(name):
    spec = SPECS[name]
    eq1 = spec.power.per_metre(spec.cruise) * 4.0
    assert drive(spec, 0.0) - eq1 == pytest.approx(ramps_cost(spec), rel=0.02, abs=0.1)
    headings = np.linspace(-pi, pi, 24, endpoint=False) + pi / 24
    mean = np.mean([drive(spec, float(heading)) for heading in headings])
    assert mean - eq1 == pytest.approx(launch_cost(spec), rel=0.03, abs=0.1)


def test_only_those_that_turn_pay_for_it():
    assert pivot_cost(RobotSpec(drive="holonomic")) == pytest.approx(0.0, abs=1e-9)
    assert pivot_cost(RobotSpec()) > pivot_cost(RobotSpec(reverse=True)) > 1.0
