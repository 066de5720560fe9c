"""A run to step through: look at it, go on, or ask what would have come of something else.

A run is decided by its scenario, so a fork is the same run, played anew as far as its origin has
come, and different from there: equal to the bit until then, and for good if nothing is changed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

from fleet.assembly import prepare
from fleet.observer import Observer
from fleet.results import Summary
from fleet.scenario.choices import bind_protocol
from fleet.scenario.model import Scenario
from fleet.tasks import State
from protocols.messages import Conversation, Event, ProtocolFunction, RobotId, View

if TYPE_CHECKING:
    from fleet.robot import Robot
    from fleet.tasks import Task


def play(scenario: Scenario, observers: Sequence[Observer] = ()) -> Playthrough:
    """The scenario at its beginning: everybody is in place, nothing has happened yet.

    Raises:
        BadInput: something in the scenario does not exist, or does not fit.
        ImpossibleWorld: no connected network of these robots was found in this world.
    """
    return Playthrough(scenario, observers)


class Fork(NamedTuple):
    """From which step on a run goes otherwise, and how."""

    step: int
    scenario: Scenario  # whose protocol robots talk by from then on
    winner: RobotId | None  # whoever is sent to the next event, whatever they say

    def protocol(self) -> ProtocolFunction:
        """What robots talk by from then on."""
        bound = bind_protocol(self.scenario)
        return bound if self.winner is None else SentInstead(bound, self.winner)


class Playthrough:
    """A run under way. Use it in a ``with`` statement if observers write files.

    ``time`` [s], ``robots`` and ``tasks`` are the run's own, live: look, but change nothing.
    """

    def __init__(
        self, scenario: Scenario, observers: Sequence[Observer] = (), forks: Sequence[Fork] = ()
    ) -> None:
        self.scenario = forks[-1].scenario if forks else scenario
        self.summary: Summary | None = None  # once the run is over
        self._origin = scenario
        self._forks = tuple(forks)
        self._simulation = prepare(self.scenario, observers)
        if forks:
            self._simulation.switch(bind_protocol(scenario))
        self._steps = 0  # 0: it has not begun
        self._started = perf_counter()

    def __enter__(self) -> Playthrough:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def __repr__(self) -> str:
        served = sum(task.state is State.SERVED for task in self.tasks)
        over = f"; {self.ended}" if self.ended else ""
        return f"<{self.time:.2f} s: {len(self.tasks)} events, {served} served{over}>"

    @property
    def time(self) -> float:
        """How far the run has come [s]."""
        return self._simulation.now

    @property
    def robots(self) -> Sequence[Robot]:
        """The robots, by id."""
        return self._simulation.fleet.robots

    @property
    def tasks(self) -> Sequence[Task]:
        """What has happened so far, and what has become of it; by the event's id."""
        return self._simulation.book.tasks

    @property
    def ended(self) -> str | None:
        """Why the run is over; None: it is not."""
        return self._simulation.ended

    def step(self) -> bool:
        """Go on to the next thing that happens. False: the run is over."""
        if self.summary is not None:
            return False
        if self.ended is not None:
            self.summary = self._simulation.finish(perf_counter() - self._started)
            self.close()
            return False
        for fork in self._forks:
            if fork.step == self._steps:
                self._simulation.switch(fork.protocol())
        if self._steps == 0:
            self._simulation.begin()
        else:
            self._simulation.go_on()
        self._steps += 1
        return True

    def until(self, *, time: float | None = None, event: int | None = None) -> Playthrough:
        """Go on to the first moment at ``time`` [s] or later; or right before an event happens.

        An event's number is not known before it has happened, so a second run of the same
        scenario, which nobody observes, goes ahead and finds it: that takes as long again.

        Raises:
            ValueError: that moment is over, or the run ends before it.
        """
        if event is not None:
            scout = Playthrough(self._origin, forks=self._forks)
            while len(scout.tasks) <= event:
                if not scout.step():
                    raise ValueError(f"event is {event}; the run has {len(scout.tasks)}")
            if scout._steps <= self._steps:
                raise ValueError(f"event is {event}, which has happened")
            self._play_to(scout._steps - 1)
        while time is not None and self.time < time:
            if not self.step():
                raise ValueError(f"time is {time} s; the run ended at {self.time} s")
        return self

    def finish(self) -> Summary:
        """Play to the end."""
        while self.step():
            pass
        assert self.summary is not None
        return self.summary

    def fork(
        self,
        *,
        protocol: str | Mapping[str, Any] | None = None,
        winner: RobotId | None = None,
        observers: Sequence[Observer] = (),
    ) -> Playthrough:
        """The same run at the same moment, to go on otherwise; this one is left as it is.

        With another ``protocol`` from here on, as a scenario names it; or with ``winner`` sent
        to the next event that is talked over, whoever wins it. Its observers see all of the
        run, so that it can be replayed beside its origin.

        Raises:
            BadInput: the protocol does not exist, or a parameter does not fit.
            ValueError: a dispatcher would have to take over, or there is no such robot.
        """
        keys = self.scenario.as_dict()
        other = Scenario.of(**(keys | ({} if protocol is None else {"protocol": protocol})))
        if winner is not None and not 0 <= winner < len(self.robots):
            raise ValueError(f"winner is {winner}; expected 0 to {len(self.robots) - 1}")
        here = Fork(self._steps, other, winner)
        fork = Playthrough(self._origin, observers, (*self._forks, here))
        fork._play_to(self._steps)
        return fork

    def close(self) -> None:
        """Let observers go; the run cannot go on."""
        self._simulation.close()

    def _play_to(self, steps: int) -> None:
        while self._steps < steps:
            self.step()


class SentInstead:
    """A protocol whose first conversation ends with the award going to ``winner``."""

    def __init__(self, protocol: ProtocolFunction, winner: RobotId) -> None:
        self._protocol = protocol
        self._winner: RobotId | None = winner

    def __call__(self, view: View, event: Event, source: RobotId) -> Conversation:
        """The conversation as it would have been, but for how it ends."""
        award = yield from self._protocol(view, event, source)
        winner, self._winner = self._winner, None
        return award if winner is None else award._replace(winner=winner, moves=())
