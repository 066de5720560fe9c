"""Streams: many events at once, on a living fleet. Nothing hangs, nothing goes missing."""

from __future__ import annotations

import pytest
from played import Log, check_conservation, played, stream

import fleet
from fleet.assembly import prepare
from fleet.tasks import State, Task, TaskBook
from protocols.messages import Event


def same_course(one, other):
    """The same words, winners and drives, event by event."""
    for key, words in one.said.items():
        assert other.said[key] == words
    assert {k: a.winner for k, a in one.awards.items()} == {
        k: a.winner for k, a in other.awards.items()
    }


@pytest.mark.parametrize("motion", ["straight", "path", "physics"])
@pytest.mark.parametrize("protocol", ["rfta2", "rfta2ge", "gfgf2a"])
def test_a_stream_with_long_gaps_is_rounds(motion, protocol):
    common = {"protocol": protocol, "motion": motion, "seed": 3, "rounds": 12}
    _, rounds, spoken = played(**common)
    simulation, summary, streamed = played(**common, time=stream(rate=0.02, duration=3000.0))
    assert summary.served == rounds.served == 12
    same_course(spoken, streamed)
    for (_, a), (_, b) in zip(spoken.trips, streamed.trips, strict=True):
        assert b.end == pytest.approx(a.end, abs=1e-9)
        assert b.energy == pytest.approx(a.energy, abs=1e-9)
    check_conservation(simulation, summary)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_radio_without_loss_or_delay_is_the_ideal_one(seed):
    common = {
        "motion": "straight",
        "seed": seed,
        "rounds": 15,
        "time": stream(rate=0.02, duration=3000.0),
    }
    _, ideal, spoken = played(**common)
    _, lossy, heard = played(**common, radio={"name": "lossy", "latency": 1e-9, "validity": 2.0})
    assert lossy.served == ideal.served == 15
    same_course(spoken, heard)


def test_many_at_once_nobody_twice():
    class Engaged(Log):
        def departed(self, event, robot, time):
            assert robot not in self.under_way
            self.under_way.add(robot)
            self.most = max(self.most, len(self.under_way))

        def trip_ended(self, event, trip):
            self.under_way.discard(trip.robot)

    log = Engaged()
    log.under_way, log.most = set(), 0
    scenario = fleet.Scenario.of(
        motion="path", seed=4, time=stream(rate=4.0, duration=60.0),
        radio={"name": "lossy", "loss": 0.1},
    )  # fmt: skip
    simulation = prepare(scenario, [log])
    summary = simulation.run()
    assert log.most > 5
    check_conservation(simulation, summary)


def test_the_busy_do_not_bid_and_events_wait():
    """Three robots, work that takes long: what comes meanwhile waits, and is served in the end."""
    simulation, summary, _ = played(
        motion="straight", robots=3, range=12.0, seed=5, robot={"capacity": 1e4},
        time=stream(rate=0.1, duration=900.0, service=40.0), rounds=20,
    )  # fmt: skip
    figures = summary.stream
    assert figures.backlog_most > 2
    assert figures.response_p90 > 20.0
    assert summary.served == 20
    assert figures.utilisation > 0.25
    check_conservation(simulation, summary)


def test_events_expire_at_their_deadline():
    simulation, summary, _ = played(
        motion="straight", robots=2, range=12.0, seed=6, robot={"capacity": 1e4},
        time=stream(rate=0.2, duration=400.0, service=50.0, deadline=20.0),
    )  # fmt: skip
    assert summary.expired > 10
    for task in simulation.book.tasks:
        if task.state is State.EXPIRED:
            assert task.closed == pytest.approx(task.raised + 20.0)
        elif task.state is State.SERVED:
            assert task.taken - task.raised <= 20.0
    check_conservation(simulation, summary)


@pytest.mark.parametrize("what", ["motor", "all"])
def test_a_deadline_holds_whatever_became_of_the_robot(what):
    """The robot that set off breaks down, and is only missed after the deadline."""
    keys = {"motion": "straight", "seed": 4, "rounds": 1, "time": stream(deadline=1.5, rate=0.2)}
    _, _, log = played(**keys)
    ((_, trip),) = log.trips
    assert trip.ended - trip.departed > 0.5
    fault = {"time": trip.departed + 0.4, "robot": trip.robot, "what": what}
    simulation, summary, _ = played(**keys, faults={"planned": [fault]})
    task = simulation.book.tasks[0]
    assert task.state in (State.EXPIRED, State.SERVED)
    assert task.state is State.EXPIRED or task.taken <= task.raised + 1.5
    assert what == "motor" or summary.expired == 1  # silent: missed after 5 s


def test_a_breakdown_of_a_robot_that_is_not_there_is_refused():
    planned = [{"time": 1.0, "robot": 100}]
    with pytest.raises(ValueError, match=r"faults.planned: robot is 100; expected 0 to 99"):
        played(faults={"planned": planned})


def test_the_life_of_a_stream_ends_with_what_is_never_served():
    _, summary, _ = played(
        motion="straight", robots=10, range=6.0, seed=7,
        time=stream(rate=0.5, duration=800.0, deadline=30.0),
    )  # fmt: skip
    figures = summary.stream
    assert 0.0 < figures.lifetime_first <= figures.lifetime_tolerated < 800.0
    assert 0 < summary.lifetime < summary.served


def test_lost_frames_cost_repetitions_and_time_but_serve():
    def figures(**radio):
        _, summary, _ = played(
            motion="straight", seed=8, time=stream(rate=0.3, duration=300.0),
            radio={"name": "lossy", **radio},
        )  # fmt: skip
        return summary

    good, bad = figures(), figures(loss=0.25, retries=5)
    assert bad.repeated > 5 * max(good.repeated, 1)
    assert bad.stream.response_mean > good.stream.response_mean
    assert bad.served > 0.9 * good.served


def test_an_event_of_a_robot_that_dies_silently_is_raised_again_after_patience():
    breakdown = {"time": 1.0, "robot": 0, "what": "all"}
    events = [[0.5, 5.0, 5.0]]
    simulation, summary, log = played(
        world={"name": "placed", "positions": [[4.0, 5.0], [2.0, 5.0], [2.0, 4.0]]},
        motion="straight", protocol="gfgf1", range=3.0,
        time=stream(duration=60.0, patience=5.0),
        events={"name": "trace", "occurrences": events}, faults={"planned": [breakdown]},
    )  # fmt: skip
    first, second = (trip for _, trip in log.trips)
    assert (first.robot, first.outcome) == (0, "broken down")
    assert second.outcome == "arrived"
    assert second.departed == pytest.approx(1.0 + 5.0)
    assert summary.served == 1
    check_conservation(simulation, summary)


def test_a_robot_with_a_broken_motor_still_relays_but_does_not_bid():
    """The only way from 0 to 2 leads over 1, whose motor is broken."""
    _, summary, log = played(
        world={"name": "placed", "positions": [[1.0, 1.0], [3.0, 1.0], [5.0, 1.0]]},
        motion="straight", protocol="rfta2", range=2.5, search_radius=0.5,
        time=stream(duration=60.0), handler="nearest-known",
        events={"name": "trace", "occurrences": [[5.0, 3.0, 1.0]]},
        faults={"planned": [{"time": 1.0, "robot": 1, "what": "motor"}]},
    )  # fmt: skip
    assert log.awards[0].auctioneer == 1
    assert log.awards[0].winner in (0, 2)
    assert summary.served == 1


def test_a_blackout_silences_a_region_and_lifts_again():
    events = [[10.0, 5.0, 5.2], [100.0, 5.0, 5.2]]
    simulation, summary, log = played(
        world={"name": "placed", "positions": [[5.0, 5.0], [3.0, 5.0], [1.0, 5.0]]},
        motion="straight", protocol="gfgf1", range=2.5, robot={"capacity": 1e4},
        time=stream(duration=200.0), events={"name": "trace", "occurrences": events},
        faults={"blackouts": [{"start": 5.0, "duration": 50.0, "x": 5.0, "y": 5.0, "radius": 1.0}]},
    )  # fmt: skip
    assert log.awards[0].winner == 1  # the nearest cannot be talked to
    assert {trip.robot for _, trip in log.trips} == {1} or log.awards[1].winner in (0, 1)
    assert summary.served == 2
    check_conservation(simulation, summary)


def test_nobody_left_on_the_air_hangs_nothing():
    breakdowns = [{"time": 1.0, "robot": k, "what": "all"} for k in range(3)]
    simulation, summary, _ = played(
        robots=3, range=12.0, motion="straight", time=stream(rate=0.2, duration=100.0),
        faults={"planned": breakdowns},
    )  # fmt: skip
    assert summary.breakdowns == 3
    assert summary.waiting + summary.served == summary.events
    check_conservation(simulation, summary)


def test_sensors_that_miss_lose_events_with_a_reason():
    simulation, summary, _ = played(
        motion="straight", seed=9, time=stream(rate=1.0, duration=100.0),
        sensors={"count": 60, "radio_range": 2.5, "miss": 0.4, "error": 0.3},
    )  # fmt: skip
    assert summary.lost_by_reason == {"no sensor noticed it": summary.lost}
    assert summary.lost > 3
    assert summary.sensor_messages > summary.served
    assert 0.1 < summary.stream.miss_mean < 1.0
    check_conservation(simulation, summary)


def test_duplicate_reports_raise_an_event_twice():
    _, once, _ = played(motion="straight", seed=9, rounds=30, sensors={})
    simulation, twice, _ = played(motion="straight", seed=9, rounds=30, sensors={"duplicates": 0.3})
    assert once.served == twice.served == 30
    happened = {task.raised for task in simulation.book.tasks}
    assert len(happened) < twice.events


def test_the_handler_that_knows_places_saves_hops():
    _, blind, _ = played(motion="straight", seed=10, rounds=60)
    _, knowing, _ = played(motion="straight", seed=10, rounds=60, handler="nearest-known")
    assert knowing.hops_greedy < 0.3 * blind.hops_greedy


def test_transmissions_and_standing_can_cost_energy():
    _, free, _ = played(motion="straight", seed=11, rounds=20)
    _, talk, _ = played(
        motion="straight", seed=11, rounds=20, robot={"extra": {"transmission": 0.01}}
    )
    assert talk.energy_drained - free.energy_drained == pytest.approx(0.01 * talk.messages)


@pytest.mark.parametrize("motion", ["straight", "physics"])
@pytest.mark.parametrize("radio", [{}, {"name": "lossy", "loss": 0.1}])
def test_standing_costs_idle_power_to_the_step(motion, radio):
    """Whoever is not under way pays, and nobody pays twice, neither for talk nor for standing."""
    simulation, stand, log = played(
        motion=motion, seed=11, radio=radio or "ideal", time=stream(rate=0.3, duration=120.0),
        robot={"capacity": 1e4, "extra": {"idle": 0.5, "transmission": 0.01}},
    )  # fmt: skip
    trips = [trip for _, trip in log.trips]
    assert len(trips) > 20
    assert not simulation.book.open_tasks
    driving = sum(trip.ended - trip.departed for trip in trips)
    frames = stand.messages + stand.repeated
    expected = 0.5 * (100 * 120.0 - driving) + 0.01 * frames + sum(trip.energy for trip in trips)
    step = 0.5 / 60.0 if motion == "physics" else 0.0  # a robot sets off with a step [J]
    assert stand.energy_drained == pytest.approx(expected, rel=1e-9, abs=step * len(trips))


def test_a_task_ends_once():
    book = TaskBook()
    task = Task(Event(0, (0.0, 0.0)), (0.0, 0.0), 0.0)
    book.open(task)
    book.close(task, State.SERVED, 1.0)
    with pytest.raises(ValueError, match="task 0"):
        book.close(task, State.LOST, 2.0, "twice")
    with pytest.raises(ValueError, match="task 1"):
        book.close(Task(Event(1, (0.0, 0.0)), (0.0, 0.0), 0.0), State.WAITING, 1.0)
