"""The closed form of a launch against robots that drive."""

from __future__ import annotations

from dataclasses import replace
from math import inf, isnan, pi

import numpy as np
import pytest

from fleet.experiments.energy.launching import launch_cost, pivot_cost, ramps_cost
from fleet.motion.driven import DrivenMotion
from fleet.power import Battery, ExtraPower
from fleet.robot import PRESETS, Robot, RobotSpec
from worlds.arena import Arena


def drive(spec, heading, distance=4.0):
    motion = DrivenMotion(spec, Arena(), engine=False)
    robot = Robot(0, (2.0, 5.0), heading, Battery(1e6), inf, [], motion)
    motion.place([robot])
    motion.depart(robot, (2.0 + distance, 5.0))
    (trip,) = motion.advance(inf)
    return trip


SPECS = {
    "the paper's": RobotSpec(),
    "slow to speed up": RobotSpec(acceleration=0.3),
    "Pioneer": PRESETS["pioneer"],
    "backwards too": RobotSpec(reverse=True),
    "kinetic": RobotSpec(extra=ExtraPower(kinetic=True)),
}


@pytest.mark.parametrize("name", SPECS)
def test_ramps_cost_what_the_formula_says(name):
    trip = drive(SPECS[name], 0.0)
    assert trip.energy_ramps == pytest.approx(ramps_cost(SPECS[name]), rel=0.01)
    assert trip.energy_pivots == 0.0


@pytest.mark.parametrize("name", SPECS)
def test_pivots_cost_what_the_formula_says_on_average(name):
    spec = replace(SPECS[name], extra=ExtraPower())
    headings = np.linspace(-pi, pi, 60, endpoint=False) + pi / 60
    mean = np.mean([drive(spec, float(heading)).energy_pivots for heading in headings])
    assert mean == pytest.approx(pivot_cost(spec), rel=0.02)


def test_the_paper_s_robot_launches_for_five_and_a_half_joules():
    assert launch_cost(RobotSpec()) == pytest.approx(1.867 + 3.780, abs=1e-3)
    assert pivot_cost(RobotSpec(drive="holonomic")) == 0.0
    assert isnan(pivot_cost(RobotSpec(extra=ExtraPower(per_wheel=True))))
    assert isnan(pivot_cost(RobotSpec(turn_rate=1.0)))
