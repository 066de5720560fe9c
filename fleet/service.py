"""What a stream comes to: how soon, how many, how busy, at what cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import dist, inf
from typing import TYPE_CHECKING

import numpy as np

from fleet.tasks import OPEN, State, Task, TaskBook

if TYPE_CHECKING:
    from fleet.results import Tally

TOLERATED = 0.1  # share of events not served at which a stream's life is said to be over
FEWEST = 10  # events from which that share is looked at


@dataclass(frozen=True, slots=True)
class StreamFigures:
    """Figures of a stream. Times in s; what cannot be told, for want of events, is None.

    An event was never served if it was lost, has expired, or has at the end waited longer than
    offers are ever apart. Raised = served + waiting + expired + lost.
    """

    waiting: int  # events still open at the end
    expired: int  # that no robot set off to by their deadline
    lost: int  # given up
    lost_by_reason: dict[str, int]
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
    energy_per_served: float | None  # [J] predicted by Eq. (1)
    lifetime_first: float | None  # when the first event happened that was never served
    lifetime_tolerated: float | None  # when a tenth of the events so far were never served
    served_before_first_loss: int
    conversations: int
    conflicts: int
    broken: int
    restarts: int
    breakdowns: int
    relocations: int
    repeated: int
    unheard: int
    beacons: int
    sensor_messages: int


def stream_figures(
    book: TaskBook,
    tally: Tally,
    robots: int,
    end: float,
    patience: float,
    beacons: int,
    sensor_messages: int,
) -> StreamFigures:
    """The figures of a stream that ended at ``end`` [s]."""
    tasks = book.tasks
    served = [task for task in tasks if task.state is State.SERVED]
    response = np.array([task.reached - task.raised for task in served])
    never = [_never_served(task, end, patience) for task in tasks]
    first = next((task.raised for task, lost in zip(tasks, never, strict=True) if lost), None)
    backlog_mean, backlog_most = _backlog(tasks, end)
    duration = max(end, 1e-9)

    def quantile(share: float) -> float | None:
        return float(np.quantile(response, share)) if len(response) else None

    def each(total: float) -> float | None:
        return total / len(served) if served else None

    return StreamFigures(
        waiting=book.count(*OPEN),
        expired=book.count(State.EXPIRED),
        lost=book.count(State.LOST),
        lost_by_reason=book.lost_by_reason(),
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
        energy_per_served=each(tally.predicted),
        lifetime_first=first,
        lifetime_tolerated=_tolerated(tasks, never),
        served_before_first_loss=sum(
            task.raised < (inf if first is None else first) for task in served
        ),
        conversations=tally.conversations,
        conflicts=tally.conflicts,
        broken=tally.broken,
        restarts=tally.restarts,
        breakdowns=tally.breakdowns,
        relocations=tally.relocations,
        repeated=tally.repeated,
        unheard=tally.unheard,
        beacons=beacons,
        sensor_messages=sensor_messages,
    )


def _never_served(task: Task, end: float, patience: float) -> bool:
    if task.state in (State.REPORTED, State.WAITING):
        return end - task.raised > patience
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
