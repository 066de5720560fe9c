"""Eq. (1), and batteries that only ever lose."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fleet.power import Battery, PowerModel
from fleet.robot import RobotSpec


def test_eq_1_at_the_paper_s_speed():
    assert PowerModel().per_metre(0.76) == pytest.approx(19.3558, abs=1e-4)
    assert 100.0 / PowerModel().per_metre(0.76) == pytest.approx(5.17, abs=0.005)


def test_the_paper_drives_near_its_cheapest_speed():
    speeds = np.linspace(0.1, 2.0, 19001)
    cheapest = speeds[np.argmin([PowerModel().per_metre(v) for v in speeds])]
    assert cheapest == pytest.approx(np.sqrt(3.66 / 6.25), abs=1e-4)


@given(st.floats(0.05, 3.0), st.floats(0.01, 20.0))
def test_eq_1_is_the_integral_of_the_power_over_a_steady_drive(speed, length):
    power = PowerModel()
    assert power.per_metre(speed) * length == pytest.approx(power.power(speed) * length / speed)


@given(st.lists(st.floats(0.0, 50.0), max_size=8))
def test_a_battery_never_gains_and_never_owes(drains):
    battery = Battery(100.0)
    left = battery.charge
    for energy in drains:
        battery.drain(energy)
        assert 0.0 <= battery.charge <= left
        left = battery.charge


@pytest.mark.parametrize(
    ("make", "arguments"),
    [
        (Battery, {"capacity": 0.0}),
        (Battery(100.0).drain, {"energy": -1.0}),
        (Battery(100.0).drain, {"energy": float("nan")}),
        (PowerModel, {"quadratic": -1.0}),
        (PowerModel, {"quadratic": 0.0, "linear": 0.0, "constant": 0.0}),
        (RobotSpec, {"radius": 0.0}),
        (RobotSpec, {"cruise": float("inf")}),
    ],
    ids=range(7),
)
def test_bad_values_are_refused_with_a_sentence(make, arguments):
    with pytest.raises(ValueError, match="expected"):
        make(**arguments)
