"""What batteries lost is on an account, to the last nanojoule."""

from __future__ import annotations

from dataclasses import replace
from math import fsum

import pytest

import fleet
from fleet.summary_lines import summary_lines
from fleet.tally import RADIO, STANDING


@pytest.mark.parametrize("motion", ["straight", "path", "physics"])
@pytest.mark.parametrize("radio", ["ideal", "lossy"])
@pytest.mark.parametrize("time", ["rounds", {"name": "stream", "rate": 2.0, "duration": 9.0}])
def test_the_accounts_add_up_to_what_was_drained(motion, radio, time):
    """Some are still under way as the stream ends, some run empty on the way."""
    summary = fleet.run(
        fleet.Scenario.of(
            motion=motion, radio=radio, time=time, seed=7, robots=30, range=5.0, rounds=30,
            robot={"capacity": 40.0, "extra": {"idle": 0.2, "transmission": 0.01}},
            faults={"motor_rate": 0.005},
        )
    )  # fmt: skip
    accounts = summary.energy_by_account
    assert fsum(accounts.values()) == pytest.approx(summary.energy_drained, abs=1e-9)
    assert accounts[STANDING] > 10.0
    assert accounts[RADIO] == pytest.approx(0.01 * (summary.messages + summary.repeated), rel=0.05)
    assert 0.0 < accounts[RADIO] <= 0.01 * (summary.messages + summary.repeated) + 1e-9


def test_what_robots_drove_before_the_end_is_counted():
    """One robot, alone, still under way: all that was lost is what the drive so far has cost."""
    summary = fleet.run(
        fleet.Scenario.of(
            motion="straight", connected=False,
            world={"name": "placed", "positions": [[1.0, 1.0]]},
            events={"name": "trace", "occurrences": [[1.0, 9.0, 1.0]]},
            time={"name": "stream", "duration": 5.0}, robot={"capacity": 1e4},
        )
    )  # fmt: skip
    assert summary.energy_drained == pytest.approx(19.355789473684212 * 0.76 * 4.0)
    booked = fsum(summary.energy_by_account.values())
    assert booked == pytest.approx(summary.energy_drained, abs=1e-9)


def test_an_account_of_nothing_but_rounding_is_not_written():
    summary = fleet.run(fleet.Scenario.of(motion="path", robots=20, range=4.0, rounds=2))
    accounts = {"rolling": 12.34, "slip": -3e-14, "contact": 0.0, "braking": -0.06}
    said = dict(summary_lines(replace(summary, energy_by_account=accounts)))
    assert "rolling 12.3 J, braking -0.1 J" in said.values()
