"""Stepping through a run, and forking it: nothing changes but what was asked to."""

from __future__ import annotations

import pytest

import fleet
from fleet.observer import Observer

ROUNDS = {"protocol": "rfta2", "motion": "straight", "robots": 40, "range": 3.0, "seed": 5}
STREAM = ROUNDS | {
    "radio": {"name": "lossy", "loss": 0.1},
    "time": {"name": "stream", "rate": 0.5, "duration": 60.0},
}
PHYSICS = ROUNDS | {"motion": "physics", "rounds": 12}


def figures(summary):
    return summary.as_dict() | {"wall_time": 0.0}


@pytest.mark.parametrize("keys", [ROUNDS, STREAM, PHYSICS], ids=["rounds", "stream", "physics"])
def test_a_run_that_is_stepped_through_and_its_forks_equal_one_that_is_not(keys):
    scenario = fleet.Scenario.of(**keys)
    expected = figures(fleet.run(scenario))
    moment = fleet.play(scenario)
    fork = None
    while moment.step():
        if len(moment.tasks) == 7 and fork is None:
            fork = moment.fork()
            assert (fork.time, len(fork.tasks)) == (moment.time, 7)
            assert [r.position for r in fork.robots] == [r.position for r in moment.robots]
            assert [r.energy for r in fork.robots] == [r.energy for r in moment.robots]
    assert figures(moment.summary) == expected
    assert figures(fork.finish()) == expected
    assert figures(fork.fork().finish()) == expected


def test_a_fork_at_the_beginning_is_a_run_of_its_own():
    fork = fleet.play(fleet.Scenario.of(**ROUNDS)).fork(protocol="rfta3")
    own = fleet.run(fleet.Scenario.of(**ROUNDS | {"protocol": "rfta3"}))
    assert figures(fork.finish()) == figures(own)


def test_a_fork_leaves_its_origin_alone_and_goes_its_own_way():
    scenario = fleet.Scenario.of(**ROUNDS)
    moment = fleet.play(scenario).until(event=20)
    fork = moment.fork(protocol="gfgf2a")
    assert len(moment.tasks) == len(fork.tasks) == 20
    other = fork.finish()
    assert other.protocol == "gfgf2a"
    assert figures(moment.finish()) == figures(fleet.run(scenario))
    assert other.lifetime != moment.summary.lifetime


class Departures(Observer):
    def __init__(self):
        self.sent = []

    def departed(self, event, robot, time):
        self.sent.append((event.id, robot))


def test_what_if_another_had_gone():
    """Until the event all is as it was, to the event goes the other, whoever has won."""
    scenario = fleet.Scenario.of(**ROUNDS)
    was = Departures()
    fleet.run(scenario, [was])
    (won,) = [robot for event, robot in was.sent if event == 9]
    other = (won + 1) % 40
    instead = Departures()
    fleet.play(scenario).until(event=9).fork(winner=other, observers=[instead]).finish()
    assert instead.sent[:9] == was.sent[:9]
    assert instead.sent[9] == (9, other)
    later = [event for event, robot in instead.sent[10:] if robot == other]
    assert len(later) < len(instead.sent) - 10  # it is sent once, not always


def test_until_a_time():
    moment = fleet.play(fleet.Scenario.of(**STREAM)).until(time=30.0)
    assert 30.0 <= moment.time < 40.0
    assert "events" in repr(moment)
    with pytest.raises(ValueError, match="which has happened"):
        moment.until(event=0)
    with pytest.raises(ValueError, match="the run has"):
        moment.until(event=10_000)
    with pytest.raises(ValueError, match="ended at"):
        moment.until(time=1e6)


def test_a_robot_that_is_not_there_cannot_be_sent():
    with pytest.raises(ValueError, match="0 to 39"):
        fleet.play(fleet.Scenario.of(**ROUNDS)).fork(winner=40)
