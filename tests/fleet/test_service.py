"""The figures of a stream, on events small enough in number to check by hand."""

from __future__ import annotations

from math import inf

import pytest

from fleet.service import never_served, stream_figures
from fleet.tally import Tally
from fleet.tasks import State, Task, TaskBook
from protocols.messages import Event


def task(raised, taken=inf, reached=inf, state=State.SERVED, closed=None, deadline=inf):
    """An event at ``raised`` [s]; it ended at ``closed``, or as soon as it was reached."""
    place = (0.0, 0.0)
    closed = reached if closed is None else closed
    return Task(
        Event(0, place), place, raised, deadline, state=state, taken=taken, reached=reached,
        closed=closed,
    )  # fmt: skip


def figures(tasks, end, *, tally=None, robots=1, longest_wait=60.0):
    book = TaskBook(tasks, sum(task.closed == inf for task in tasks))
    never = [never_served(task, end, longest_wait) for task in tasks]
    return stream_figures(book, tally or Tally(), robots, end, never, drained=30.0)


def test_the_backlog_is_those_that_wait_for_a_robot_to_set_off():
    """One waits from 0 to 4, one from 2 to 3, one from 8 to the end: 1, 2, 1, 0, 1 at a time."""
    tasks = [
        task(0.0, taken=4.0, reached=9.0),
        task(2.0, taken=3.0, reached=5.0),
        task(8.0, state=State.WAITING),
    ]
    found = figures(tasks, 10.0)
    assert found.backlog_mean == pytest.approx((4.0 + 1.0 + 2.0) / 10.0)
    assert found.backlog_most == 2


def test_one_that_is_taken_as_another_comes_is_not_two():
    tasks = [task(0.0, taken=1.0, reached=2.0), task(1.0, taken=2.0, reached=3.0)]
    assert figures(tasks, 4.0).backlog_most == 1


def test_an_expired_event_no_longer_waits():
    found = figures([task(0.0, state=State.EXPIRED, closed=5.0, deadline=5.0)], 10.0)
    assert found.backlog_mean == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("lost", "count", "until"),
    [
        ([0], 10, None),  # a tenth is tolerated
        ([0, 1], 20, 9.0),  # two of ten are not; below ten nothing is said
        ([5, 9], 20, 9.0),
        ([0, 19], 20, None),  # two of twenty: a tenth
        ([0, 10], 20, 10.0),  # two of eleven
    ],
)
def test_life_is_tolerated_while_no_more_than_a_tenth_was_never_served(lost, count, until):
    states = [State.LOST if k in lost else State.SERVED for k in range(count)]
    tasks = [task(float(k), k + 0.1, k + 0.2, state) for k, state in enumerate(states)]
    assert figures(tasks, 30.0).lifetime_tolerated == until


def test_who_waits_longer_than_offers_are_apart_counts_as_never_served():
    waiting = task(10.0, state=State.WAITING)
    assert not never_served(waiting, 70.0, 60.0)
    assert never_served(waiting, 70.1, 60.0)
    assert not never_served(task(10.0, taken=11.0, state=State.TAKEN), 500.0, 60.0)


def test_shares_and_costs_are_of_all_and_of_those_served():
    tasks = [
        task(0.0, 1.0, 4.0, deadline=5.0),
        task(0.0, 4.0, 8.0, deadline=5.0),  # somebody set off in time, and arrived too late
        task(1.0, state=State.EXPIRED, closed=6.0, deadline=5.0),
        task(2.0, 3.0, 5.0),
    ]
    tally = Tally(predicted=12.0)
    tally.kinds.update({"call": 6})
    found = figures(tasks, 10.0, tally=tally)
    assert found.within_deadline == 0.5
    assert found.response_mean == pytest.approx((4.0 + 8.0 + 3.0) / 3)
    assert found.energy_drained_per_served == pytest.approx(10.0)
    assert found.energy_predicted_per_served == pytest.approx(4.0)
    assert found.messages_per_served == pytest.approx(2.0)


def test_responses_are_of_those_served_and_in_time_if_not_later_than_the_deadline():
    """Answered after 1, 2, ... 10 s; the deadline is 5 s; and one that nobody has answered."""
    tasks = [task(100.0, 100.0, 100.0 + k, deadline=5.0) for k in range(1, 11)]
    tasks.append(task(110.0, state=State.EXPIRED, closed=115.0, deadline=5.0))
    found = figures(tasks, 200.0, tally=Tally(engaged=120.0), robots=4)
    assert found.within_deadline == pytest.approx(5.0 / 11.0)
    assert found.response_median == pytest.approx(5.5)
    assert found.response_p90 == pytest.approx(9.1)
    assert found.response_p99 == pytest.approx(9.91)
    assert found.throughput == pytest.approx(10.0 / 200.0)
    assert found.utilisation == pytest.approx(120.0 / (4 * 200.0))
    assert found.lifetime_first == 110.0


def test_a_miss_is_how_far_from_the_event_robots_were_sent():
    missed = Task(
        Event(0, (3.0, 4.0)),
        (0.0, 0.0),
        0.0,
        state=State.SERVED,
        taken=1.0,
        reached=2.0,
        closed=2.0,
    )
    assert figures([missed, task(0.0, 1.0, 2.0)], 5.0).miss_mean == pytest.approx(2.5)


def test_of_nothing_nothing_is_told():
    found = figures([], 0.5)
    assert found.within_deadline is found.response_p90 is found.lifetime_first is None
    assert found.throughput == found.backlog_mean == 0.0
    half = figures([task(0.0, 0.25, 0.4)], 0.5)
    assert half.throughput == pytest.approx(2.0)
    assert half.backlog_mean == pytest.approx(0.5)
