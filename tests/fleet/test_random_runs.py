"""Random runs of everything there is: no task and no joule goes missing, nobody hears too far.

The scenarios are the same every time: hypothesis draws them from the test's own name.
"""

from __future__ import annotations

import os
from collections import Counter
from math import dist

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from played import Log, check_conservation

import fleet
from fleet.assembly import prepare
from fleet.tasks import State
from protocols.catalogue import PROTOCOLS

FEW = 30  # runs in every test run; 0.15 s of CPU each
MANY = int(os.environ.get("RANDOM_RUNS", "600"))  # and in the slow tests
STALE = 0.1  # how old the positions may be that decide who hears [s]
PACE = 1.5  # as fast as a robot is ever, in what it cruises at: a body can be pushed

scenarios = st.fixed_dictionaries(
    {
        "protocol": st.sampled_from(sorted(PROTOCOLS)),
        "motion": st.sampled_from(["straight", "straight", "path", "physics"]),
        "world": st.sampled_from(["random", "random-hole"]),
        "robots": st.integers(2, 40),
        "range": st.sampled_from([2.0, 4.0, 8.0]),
        "connected": st.just(False),
        "seed": st.integers(0, 2**31),
        "robot": st.fixed_dictionaries({"capacity": st.sampled_from([20.0, 100.0, 500.0])}),
        "time": st.one_of(
            st.just("rounds"),
            st.fixed_dictionaries(
                {
                    "name": st.just("stream"),
                    "rate": st.sampled_from([0.1, 1.0, 5.0]),
                    "duration": st.sampled_from([20.0, 80.0]),
                    "service": st.sampled_from([0.0, 3.0]),
                    "deadline": st.sampled_from([5.0, 1e9]),
                }
            ),
        ),
        "events": st.sampled_from(["uniform", "bursts", "hot-spots"]),
        "radio": st.one_of(
            st.just("ideal"),
            st.fixed_dictionaries(
                {
                    "name": st.just("lossy"),
                    "loss": st.sampled_from([0.0, 0.2, 0.7]),
                    "shadowing": st.sampled_from([0.0, 6.0]),
                    "retries": st.integers(0, 3),
                    "beacon_interval": st.sampled_from([0.5, 3.0]),
                }
            ),
            st.fixed_dictionaries(
                {
                    "name": st.just("csma"),
                    "standard": st.sampled_from(["802.15.4", "802.11b"]),
                }
            ),
        ),
        "sensors": st.one_of(
            st.none(),
            st.fixed_dictionaries(
                {
                    "radio_range": st.just(3.0),
                    "miss": st.sampled_from([0.0, 0.5, 1.0]),
                    "error": st.sampled_from([0.0, 2.0]),
                    "duplicates": st.sampled_from([0.0, 0.5]),
                }
            ),
        ),
        "faults": st.fixed_dictionaries(
            {
                "motor_rate": st.sampled_from([0.0, 0.01]),
                "robot_rate": st.sampled_from([0.0, 0.01]),
                "blackouts": st.lists(
                    st.fixed_dictionaries(
                        {
                            "start": st.floats(0.0, 50.0),
                            "duration": st.floats(1.0, 40.0),
                            "x": st.floats(0.0, 10.0),
                            "y": st.floats(0.0, 10.0),
                            "radius": st.floats(0.5, 8.0),
                        }
                    ),
                    max_size=2,
                ),
            }
        ),
        "handler": st.sampled_from(["random", "nearest-known"]),
        "rounds": st.just(40),
    }
)  # fmt: skip


class Overheard:
    """A radio, and how far beyond its range anybody has heard anything [m].

    Beyond where its range ends plus what two robots drive while positions grow stale, and while
    the sender waits to be told.
    """

    def __init__(self, radio, fleet):
        self.radio, self.robots, self.cruise = radio, fleet.robots, fleet.spec.cruise
        self.beyond, self.heard = float("-inf"), 0

    def __getattr__(self, name):
        return getattr(self.radio, name)

    @property
    def instant(self):
        transmit = self.radio.instant
        return transmit and (lambda word, now: self.note(word, transmit(word, now), 0.0))

    def send(self, word, now, done):
        self.radio.send(word, now, lambda got, then: done(self.note(word, got, then - now), then))

    def note(self, word, reception, waited):
        sender = self.robots[word.sender]
        drive = 2.0 * PACE * self.cruise * (STALE + waited)
        for other in reception.heard:
            away = dist(sender.position, self.robots[other].position)
            self.beyond = max(self.beyond, away - self.radio.reach - drive)
            self.heard += 1
        return reception


def check_run(keys):
    log = Log()
    keys = {key: value for key, value in keys.items() if value is not None}
    simulation = prepare(fleet.Scenario.of(**keys), [log])
    talks = simulation._talks
    air = Overheard(getattr(talks, "radio", None), simulation.fleet)
    if air.radio:  # and not a dispatcher, which knows all without a word
        talks.radio = air
    summary = simulation.run()
    check_conservation(simulation, summary)
    states = Counter(task.state for task in simulation.book.tasks)
    assert states[State.SERVED] == summary.served <= summary.events
    for robot in simulation.fleet.robots:
        assert 0.0 <= robot.energy <= robot.battery.capacity
    drained = sum(trip.energy for _, trip in log.trips)
    assert summary.energy_drained >= drained - 1e-6
    said = [heard for words in log.said.values() for _, heard in words]
    assert air.heard == sum(map(len, said))
    if air.radio and air.disc:  # shadowing lets some be heard farther
        assert air.beyond <= 1e-9


def runs(count):
    """That many random runs, the same each time."""
    return settings(
        max_examples=count, deadline=None, derandomize=True, database=None,
        suppress_health_check=[HealthCheck.too_slow],
    )  # fmt: skip


@given(scenarios)
@runs(FEW)
def test_random_runs_keep_tasks_energy_and_range(keys):
    check_run(keys)


@pytest.mark.slow
@given(scenarios)
@runs(MANY)
def test_many_random_runs_keep_tasks_energy_and_range(keys):
    check_run(keys)
