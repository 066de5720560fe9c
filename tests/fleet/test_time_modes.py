"""How time goes: what is refused, how long is waited, and when enough is enough."""

from __future__ import annotations

from math import inf, nan

import pytest

from fleet.modes import MOST_OFFERS, Rounds, Stream
from fleet.tasks import Task
from protocols.messages import Event


def task(offers=0):
    made = Task(Event(0, (0.0, 0.0)), (0.0, 0.0), 0.0)
    made.offers = offers
    return made


@pytest.mark.parametrize("kind", [Rounds, Stream])
@pytest.mark.parametrize(
    ("name", "value"),
    [("offers", 0), ("service", -0.1), ("service", inf), ("listening", -1.0), ("listening", nan)],
)
def test_what_no_time_can_be_is_refused_by_its_name(kind, name, value):
    with pytest.raises(ValueError, match=f"time {name} is {value}; expected"):
        kind(**{name: value})
    assert kind(offers=1, service=0.0, listening=0.0).offers == 1


@pytest.mark.parametrize("name", ["rate", "duration", "deadline", "backoff", "backoff_most"])
def test_rates_and_waits_of_a_stream_are_more_than_nothing(name):
    with pytest.raises(ValueError, match=rf"time {name} is 0.0; expected more than 0"):
        Stream(**{name: 0.0})
    assert getattr(Stream(**{name: 0.5}), name) == 0.5


def test_a_stream_has_bounds():
    assert (Stream(rate=1e6).rate, Stream(duration=1e9).duration) == (1e6, 1e9)
    for keys in ({"rate": 1.1e6}, {"duration": 1.1e9}, {"patience": -1.0}):
        with pytest.raises(ValueError, match=next(iter(keys))):
            Stream(**keys)


def test_rounds_offer_again_at_once_over_a_lossy_radio_alone():
    lossy, ideal = (Rounds(offers=3).mode(7, lossy=loss) for loss in (True, False))
    ask = {"silent": False, "anybody": True}
    assert [lossy.next_offer(task(k), **ask) for k in (1, 2, 3)] == [0.0, 0.0, None]
    assert ideal.next_offer(task(1), **ask) is None
    assert lossy.next_offer(task(1), silent=False, anybody=False) is None
    assert [lossy.enough(99, served) for served in (6, 7, 8)] == [False, True, True]
    assert not Rounds().mode(None, lossy=False).enough(99, 99)


def test_rounds_have_one_task_in_hand_and_the_others_in_line():
    mode = Rounds().mode(None, lossy=False)
    first, second, third = task(), task(), task()
    assert mode.takes_turn(first)
    assert mode.takes_turn(first)
    assert not mode.takes_turn(second)
    assert not mode.takes_turn(third)
    assert mode.next_in_line(first) is second
    assert mode.takes_turn(second)
    assert mode.next_in_line(second) is third


def test_a_robot_that_fails_in_rounds_gives_the_task_all_its_offers_again():
    tried = task(4)
    assert Rounds().mode(None, lossy=True).missed_after(tried, on_air=False) == 0.0
    assert tried.offers == 0


def test_a_stream_waits_for_who_is_silent():
    mode = Stream(backoff=2.0, backoff_most=60.0, patience=5.0, offers=9).mode(3, lossy=True)
    waits = [mode.next_offer(task(k), silent=False, anybody=True) for k in (1, 2, 3, 6, 8, 9)]
    assert waits == [2.0, 4.0, 8.0, 60.0, 60.0, None]
    silent = [mode.next_offer(task(k), silent=True, anybody=True) for k in (1, 2, 3)]
    assert silent == [5.0, 5.0, 8.0]
    assert mode.missed_after(task(), on_air=True) == 0.0
    assert mode.missed_after(task(), on_air=False) == 5.0
    assert [mode.enough(raised, 0) for raised in (2, 3)] == [False, True]


def test_a_task_is_carried_on_as_often_as_it_may_be_offered():
    stream, rounds = Stream(offers=4).mode(None, lossy=False), Rounds().mode(None, lossy=False)
    assert [stream.carried_enough(task(k)) for k in (3, 4)] == [False, True]
    assert [rounds.carried_enough(task(MOST_OFFERS + k)) for k in (-1, 0)] == [False, True]
