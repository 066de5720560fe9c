"""How time goes: in rounds, as in the paper, or as a stream of events."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import inf
from typing import Protocol

from fleet.tasks import Task
from worlds.events import Occurrence

MOST_OFFERS = 1000  # of one event, whatever happens to it in between


@dataclass(frozen=True, slots=True, kw_only=True)
class Rounds:
    """One event at a time; the next happens when the last has been attended to.

    Life ends with the first event that nobody takes. Over a radio that loses frames an event
    is offered ``offers`` times before nobody is said to take it.

    Raises:
        ValueError: a value is out of its range.
    """

    offers: int = 5
    service: float = 0.0  # how long a robot works on an event [s]
    listening: float = 2.0  # how long bids count once an auction was called [s]

    def __post_init__(self) -> None:
        if self.offers < 1:
            raise ValueError(f"time offers is {self.offers}; expected 1 or more")
        for name in ("service", "listening"):
            if not 0.0 <= getattr(self, name) < inf:
                raise ValueError(f"time {name} is {getattr(self, name)}; expected 0 or more")

    @property
    def rate(self) -> float:
        """Events a second: the next is there as soon as it is asked for."""
        return inf

    @property
    def duration(self) -> float:
        """There is no end but those of the events [s]."""
        return inf

    def mode(self, limit: int | None, *, lossy: bool) -> OneAtATime:
        """How a run goes that ends once ``limit`` events were served."""
        return OneAtATime(self, limit, self.offers if lossy else 1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stream:
    """Events by the clock, many at once; who is busy does not bid.

    An event that nobody takes waits, and is offered again after ``backoff``, each time twice
    as long, up to ``backoff_most``. It expires if no robot has set off to it by its deadline.
    A robot that does not report is given up for lost after ``patience``.

    Raises:
        ValueError: a value is out of its range.
    """

    rate: float = 0.2  # events a second, on average
    duration: float = 600.0  # of the run [s]
    service: float = 0.0  # how long a robot works on an event [s]
    listening: float = 2.0  # how long bids count once an auction was called [s]
    deadline: float = inf  # [s]
    backoff: float = 2.0  # [s]
    backoff_most: float = 60.0  # [s]
    patience: float = 5.0  # [s]
    offers: int = 1000  # after so many an event is given up

    def __post_init__(self) -> None:
        for name in ("rate", "duration", "deadline", "backoff", "backoff_most"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"time {name} is {getattr(self, name)}; expected more than 0")
        for name in ("service", "listening", "patience"):
            if not 0.0 <= getattr(self, name) < inf:
                raise ValueError(f"time {name} is {getattr(self, name)}; expected 0 or more")
        if not self.rate <= 1e6:
            raise ValueError(f"time rate is {self.rate}; expected at most a million a second")
        if not self.duration <= 1e9:
            raise ValueError(f"time duration is {self.duration} s; expected at most 1e9")
        if self.offers < 1:
            raise ValueError(f"time offers is {self.offers}; expected 1 or more")

    def mode(self, limit: int | None, *, lossy: bool) -> ByTheClock:
        """How a run goes in which at most ``limit`` events happen."""
        return ByTheClock(self, limit)


class Mode(Protocol):
    """What differs between the ways for time to go, as a run asks for it."""

    @property
    def one_at_a_time(self) -> bool:
        """Whether an event happens only once the last has been attended to.

        Then the first that nobody takes ends the run; and while somebody drives nobody talks.
        """

    @property
    def duration(self) -> float:
        """When the run is over, whatever happens [s]."""

    @property
    def service(self) -> float:
        """How long a robot works on an event that does not say so itself [s]."""

    @property
    def listening(self) -> float:
        """How long bids count once an auction was called, where transmissions take time [s]."""

    @property
    def deadline(self) -> float:
        """Until when a robot must have set off to such an event, from when it happened [s]."""

    @property
    def longest_wait(self) -> float:
        """How old an open event is at least that counts as never served, at the end [s]."""

    def enough(self, raised: int, served: int) -> bool:
        """Whether there are to be no more events."""

    def when(self, occurrence: Occurrence, now: float) -> float:
        """When something that is to happen happens [s]."""

    def takes_turn(self, task: Task) -> bool:
        """Whether the task can be talked over now; else it stands in line."""

    def next_in_line(self, closed: Task) -> Task | None:
        """A task is over: whose turn it is now, if any stands in line."""

    def next_offer(self, task: Task, *, silent: bool, anybody: bool) -> float | None:
        """Nobody has taken the task: how long it waits for its next offer [s]; None: no more.

        ``silent`` if the handler was not told so, ``anybody`` if there is anybody on the air.
        """

    def missed_after(self, task: Task, *, on_air: bool) -> float:
        """The robot that had taken the task failed: how long until that is noticed [s]."""

    def carried_enough(self, task: Task) -> bool:
        """Whether a task has been told anew, by robots that carried it, as often as can be."""


class OneAtATime:
    """Rounds under way: one task is in hand, others that one event raised stand in line."""

    one_at_a_time = True
    duration = deadline = longest_wait = inf

    def __init__(self, options: Rounds, limit: int | None, patience: int) -> None:
        self.service, self.listening = options.service, options.listening
        self._limit = limit
        self._patience = patience
        self._in_hand: Task | None = None
        self._in_line: deque[Task] = deque()

    def enough(self, raised: int, served: int) -> bool:
        """Whether as many were served as were asked for."""
        return self._limit is not None and served >= self._limit

    def when(self, occurrence: Occurrence, now: float) -> float:
        """Now."""
        return now

    def takes_turn(self, task: Task) -> bool:
        """Whether no other task is in hand."""
        if self._in_hand not in (None, task):
            self._in_line.append(task)
            return False
        self._in_hand = task
        return True

    def next_in_line(self, closed: Task) -> Task | None:
        """The one that has stood there longest."""
        if self._in_hand is closed:
            self._in_hand = None
        return self._in_line.popleft() if self._in_line else None

    def next_offer(self, task: Task, *, silent: bool, anybody: bool) -> float | None:
        """At once, where a lossy radio may have kept those from hearing who could."""
        return 0.0 if task.offers < self._patience and anybody else None

    def missed_after(self, task: Task, *, on_air: bool) -> float:
        """At once; the task has all its offers before it again."""
        task.offers = 0
        return 0.0

    def carried_enough(self, task: Task) -> bool:
        """Whether it has been offered as often as nothing sensible is."""
        return task.offers >= MOST_OFFERS


class ByTheClock:
    """A stream under way."""

    one_at_a_time = False

    def __init__(self, options: Stream, limit: int | None) -> None:
        self.duration = options.duration
        self.service, self.listening = options.service, options.listening
        self.deadline = options.deadline
        self.longest_wait = options.backoff_most
        self._options = options
        self._limit = limit

    def enough(self, raised: int, served: int) -> bool:
        """Whether as many have happened as were asked for."""
        return self._limit is not None and raised >= self._limit

    def when(self, occurrence: Occurrence, now: float) -> float:
        """At the time of its own."""
        return occurrence.time

    def takes_turn(self, task: Task) -> bool:
        """Always: many are talked over at once."""
        return True

    def next_in_line(self, closed: Task) -> Task | None:
        """Nobody stands in line."""
        return None

    def next_offer(self, task: Task, *, silent: bool, anybody: bool) -> float | None:
        """After ``backoff``, doubled with each offer, up to ``backoff_most``."""
        options = self._options
        if task.offers >= options.offers:
            return None
        wait = min(options.backoff * 2.0 ** min(task.offers - 1, 30), options.backoff_most)
        return max(wait, options.patience) if silent else wait

    def missed_after(self, task: Task, *, on_air: bool) -> float:
        """At once if it can say so; else after ``patience``."""
        return 0.0 if on_air else self._options.patience

    def carried_enough(self, task: Task) -> bool:
        """Whether it has been offered as often as may be."""
        return task.offers >= self._options.offers
