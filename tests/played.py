"""Runs that are over, with what was said and driven, and the sums that every run must come to."""

from __future__ import annotations

from collections import defaultdict
from math import fsum

import pytest

import fleet
from fleet.assembly import prepare
from fleet.observer import Observer
from fleet.tasks import OPEN, State


class Log(Observer):
    """Keeps what was said and driven, by event."""

    def __init__(self):
        self.said, self.awards, self.trips = defaultdict(list), {}, []

    def transmitted(self, excerpt):
        self.said[excerpt.event] += zip(excerpt.transmissions, excerpt.heard, strict=True)

    def awarded(self, event, award, time):
        self.awards[event.id] = award

    def trip_ended(self, event, trip):
        self.trips.append((event.id, trip))


def played(**keys):
    """A run that is over, with its book."""
    log = Log()
    simulation = prepare(fleet.Scenario.of(**keys), [log])
    return simulation, simulation.run(), log


def stream(**keys):
    return {"name": "stream", **keys}


def check_conservation(simulation, summary):
    book, raised = simulation.book, len(simulation.book.tasks)
    assert raised == summary.events
    assert raised == summary.served + summary.waiting + summary.expired + summary.lost
    assert summary.lost == sum(summary.lost_by_reason.values())
    assert all(task.reason for task in book.tasks if task.state is State.LOST)
    assert book.open_tasks == book.count(*OPEN)
    left = sum(robot.energy for robot in simulation.fleet.robots)
    assert summary.energy_initial == pytest.approx(left + summary.energy_drained, abs=1e-9)
    booked = fsum(summary.energy_by_account.values())
    assert booked == pytest.approx(summary.energy_drained, abs=1e-9)
