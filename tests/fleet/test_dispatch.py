"""Assigning together what is open: the centralised baseline of streams."""

from __future__ import annotations

import pytest

import fleet
from fleet.assembly import prepare


def played(**keys):
    """A run that is over, with its book."""
    simulation = prepare(fleet.Scenario.of(motion="straight", **keys))
    return simulation, simulation.run()


def stream(**keys):
    return {"name": "stream", **keys}


def test_events_are_assigned_together_and_nobody_twice():
    simulation, summary = played(
        protocol="assignment", seed=2,
        time=stream(rate=3.0, duration=60.0), robot={"capacity": 1e4},
    )  # fmt: skip
    assert summary.messages == 0
    assert summary.served > 150
    assert summary.conflicts == 0
    waits = [task.taken - task.raised for task in simulation.book.tasks if task.offers == 1]
    assert min(waits) > 0.0
    assert max(wait for wait in waits if wait < 1e9) <= 1.0 + 1e-9


def test_together_costs_less_than_one_after_another():
    """Bursts in one place: the greedy dispatcher takes the nearest from under the rest."""

    def distance(protocol):
        keys = {"robots": 12, "range": 9.0, "robot": {"capacity": 1e6}}
        drives = [
            played(
                protocol=protocol, seed=seed, **keys, events={"name": "bursts", "size": 6.0,
                "spacing": 0.0}, time=stream(rate=0.2, duration=200.0),
            )[1].distance_per_robot
            for seed in range(6)
        ]  # fmt: skip
        return sum(drives)

    assert distance({"name": "assignment", "interval": 0.5}) < distance("optimum")


def test_in_rounds_it_is_the_optimum():
    one, other = (
        played(protocol=protocol, seed=4)[1].as_dict() for protocol in ("assignment", "optimum")
    )
    for figures in (one, other):
        del figures["wall_time"], figures["protocol"]
    assert one == other


def test_an_interval_that_cannot_be():
    with pytest.raises(ValueError, match=r"interval is 0\.0 s; expected more than 0"):
        fleet.run(fleet.Scenario.of(protocol={"name": "assignment", "interval": 0.0}))
