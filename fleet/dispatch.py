"""A dispatcher in place of conversations: it knows all robots, and assigns events together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

from fleet.agenda import Agenda
from fleet.tally import Tally
from fleet.tasks import State, Task
from protocols.messages import Award, Conversation, Event, RobotId, View


@runtime_checkable
class Dispatcher(Protocol):
    """A protocol that also assigns several events at once."""

    @property
    def interval(self) -> float:
        """How long events are collected for [s]."""

    def __call__(self, view: View, event: Event, source: RobotId) -> Conversation:
        """One event by itself."""

    def together(self, view: View, events: Sequence[Event]) -> Mapping[int, RobotId]:
        """Event id to robot, of those that can be served."""


@dataclass(slots=True, eq=False)
class Dispatch:
    """Collects what is offered and has it assigned every so often; a baseline for streams.

    Used as :class:`fleet.conversations.Conversations` is, by streams alone.
    """

    dispatcher: Dispatcher
    view: View
    agenda: Agenda
    tally: Tally
    concluded: Callable[[Task, Award], None]
    _open: list[tuple[Task, RobotId]] = field(default_factory=list, init=False)

    def start(self, task: Task, source: RobotId, now: float) -> None:
        """Take the task up; what it comes to is told to ``concluded``."""
        task.offers += 1
        self.tally.conversations += 1
        if not self._open:
            self.agenda.at(now + self.dispatcher.interval, self._assign)
        self._open.append((task, source))

    def _assign(self) -> None:
        offered, self._open = self._open, []
        events = [task.event for task, _ in offered if task.state is State.REPORTED]
        chosen = self.dispatcher.together(self.view, events)
        for task, source in offered:
            self.concluded(task, Award(chosen.get(task.event.id), source))
