"""The service that a stream of events gets: how soon, how many, how busy, at what cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import dist

import numpy as np

from fleet.tally import Tally
from fleet.tasks import State, Task, TaskBook

TOLERATED = 0.1  # share of events not served at which a stream's life is said to be over
FEWEST = 10  # events from which that share is looked at


@dataclass(frozen=True, slots=True)
class StreamFigures:
    """Figures that only a stream has. Times in s; what cannot be told, for want of events, is None.

    An event was never served if it was lost, has expired, or has at the end waited longer than
    offers are ever apart.
    """

    within_deadline: float | None  # share of all events that a robot reached by their deadline
    response_mean: float | None  # from an event to the arrival of a robot, of events served
    response_median: float | None
    response_p90: float | None
    response_p99: float | None
    miss_mean: float | None  # from where robots were sent to where events were [m]
    backlog_mean: float  # events waiting for a robot to set off, over time
    backlog_most: int
    throughput: float  # events served a second
    utilisation: float  # share of their time that robots were promised, driving or at work
    messages_per_served: float | None
    energy_drained_per_served: float | None  # [J]
    energy_predicted_per_served: float | None  # [J] by Eq. (1)
    lifetime_first: float | None  # when the first event happened that was never served
    lifetime_tolerated: float | None  # when a tenth of the events so far were never served


def stream_figures(
    book: TaskBook, tally: Tally, robots: int, end: float, never: Sequence[bool], drained: float
) -> StreamFigures:
    """The figures of a stream that ended at ``end`` [s].

    ``never`` tells of each task whether it was never served; ``drained`` is what batteries
    lost [J].
    """
    tasks = book.tasks
    served = [task for task in tasks if task.state is State.SERVED]
    response = np.array([task.reached - task.raised for task in served])
    in_time = sum(task.reached - task.raised <= task.deadline for task in served)
    first = next((task.raised for task, lost in zip(tasks, never, strict=True) if lost), None)
    backlog_mean, backlog_most = _backlog(tasks, end)
    duration = max(end, 1e-9)

    def quantile(share: float) -> float | None:
        return float(np.quantile(response, share)) if len(response) else None

    def each(total: float) -> float | None:
        return total / len(served) if served else None

    return StreamFigures(
        within_deadline=in_time / len(tasks) if tasks else None,
        response_mean=float(response.mean()) if len(response) else None,
        response_median=quantile(0.5),
        response_p90=quantile(0.9),
        response_p99=quantile(0.99),
        miss_mean=each(sum(dist(task.site, task.event.position) for task in served)),
        backlog_mean=backlog_mean,
        backlog_most=backlog_most,
        throughput=len(served) / duration,
        utilisation=tally.engaged / (robots * duration),
        messages_per_served=each(sum(tally.kinds.values())),
        energy_drained_per_served=each(drained),
        energy_predicted_per_served=each(tally.predicted),
        lifetime_first=first,
        lifetime_tolerated=_tolerated(tasks, never),
    )


def never_served(task: Task, end: float, longest_wait: float) -> bool:
    """Whether a task of a run that ended at ``end`` [s] was given up, or might as well be."""
    if task.state in (State.REPORTED, State.WAITING):
        return end - task.raised > longest_wait
    return task.state in (State.LOST, State.EXPIRED)


def _tolerated(tasks: Sequence[Task], never: Sequence[bool]) -> float | None:
    """When the share of events never served first exceeds what is tolerated [s]."""
    lost = 0
    for count, (task, gone) in enumerate(zip(tasks, never, strict=True), 1):
        lost += gone
        if count >= FEWEST and lost > TOLERATED * count:
            return task.raised
    return None


def _backlog(tasks: Sequence[Task], end: float) -> tuple[float, int]:
    """The mean and the largest number of events that wait for a robot to set off."""
    changes: list[tuple[float, int]] = []
    waited = 0.0
    for task in tasks:
        until = min(task.taken, task.closed, end)
        waited += until - task.raised
        changes += [(task.raised, 1), (until, -1)]
    most = level = 0
    for _, change in sorted(changes):
        level += change
        most = max(most, level)
    return waited / max(end, 1e-9), most
