"""What breaks, and when."""

from __future__ import annotations

import numpy as np
import pytest

from fleet.faults import Faults


def times(what, seed=1, robots=4000, **rates):
    drawn = Faults(**rates).breakdowns(robots, np.random.default_rng(seed))
    return np.array([fault.time for fault in drawn if fault.what == what])


@pytest.mark.parametrize(("rate", "what"), [("motor_rate", "motor"), ("robot_rate", "all")])
def test_breakdowns_come_at_the_rate_that_was_asked_for(rate, what):
    often, seldom = times(what, **{rate: 0.02}), times(what, **{rate: 0.005})
    assert often.mean() == pytest.approx(50.0, rel=0.05)  # [s]
    assert (often > 50.0).mean() == pytest.approx(np.exp(-1.0), abs=0.03)  # exponential
    assert seldom == pytest.approx(4.0 * often)


def test_motors_and_robots_break_down_independently():
    motor, robot = (times(what, motor_rate=0.01, robot_rate=0.01) for what in ("motor", "all"))
    assert abs(np.corrcoef(motor, robot)[0, 1]) < 0.05
