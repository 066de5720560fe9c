"""Each metric ranks as its formula says."""

from __future__ import annotations

from math import inf

import pytest
from hand_drawn import PER_METRE, StillRobot

from protocols.catalogue import METRICS
from protocols.metrics import EnergyLeftMinusCost

SITE = (1.0, 0.0)
COST = PER_METRE


def at(distance, energy):
    return StillRobot(0, (1.0 - distance, 0.0), energy, {})


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("distance", 2.0),
        ("energy-left", 2 * COST - 80.0),
        ("cost-share", 2 * COST / 80.0),
        ("cost-over-left", 2 * COST / (80.0 - 2 * COST)),
        ("cost-times-left", 2 * COST * (80.0 - 2 * COST)),
        ("most-cost-times-left", -2 * COST * (80.0 - 2 * COST)),
    ],
)
def test_formulas(name, value):
    assert METRICS[name].function(at(2.0, 80.0), SITE) == pytest.approx(value)


def test_weight_turns_balance_into_thrift():
    near_tired, far_full = at(0.5, 60.0), at(2.0, 95.0)
    assert EnergyLeftMinusCost(weight=1.0)(far_full, SITE) < EnergyLeftMinusCost(weight=1.0)(
        near_tired, SITE
    )
    assert EnergyLeftMinusCost(weight=3.0)(far_full, SITE) > EnergyLeftMinusCost(weight=3.0)(
        near_tired, SITE
    )
    with pytest.raises(ValueError, match="weight is -1"):
        EnergyLeftMinusCost(weight=-1.0)


@pytest.mark.parametrize("name", ["cost-share", "cost-over-left"])
def test_an_empty_robot_is_worth_nothing(name):
    assert METRICS[name].function(at(1.0, 0.0), SITE) == inf
