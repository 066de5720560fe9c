"""What has happened and must be attended to: tasks, and the book that accounts for all of them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from enum import Enum
from math import inf

from protocols.messages import Event, Point


class State(Enum):
    """Where a task stands. The last three are final."""

    REPORTED = "reported"  # it happened; word of it is on the way, or it is being talked over
    WAITING = "waiting"  # nobody could take it; it will be offered again
    TAKEN = "taken"  # a robot is under way to it, or at work on it
    SERVED = "served"
    EXPIRED = "expired"  # its deadline passed before a robot took it
    LOST = "lost"  # given up, with a reason


OPEN = (State.REPORTED, State.WAITING, State.TAKEN)


@dataclass(slots=True, eq=False)
class Task:
    """An event from its beginning to its end."""

    event: Event  # as it is told: its position may be off
    site: Point  # where it really is [m]
    raised: float  # [s]
    deadline: float = inf  # [s] from raised: nobody may set off later
    service: float = 0.0  # how long a robot works on it [s]
    state: State = State.REPORTED
    offers: int = 0  # conversations held over it
    taken: float = inf  # when a robot last set off to it [s]
    reached: float = inf  # when a robot arrived [s]
    closed: float = inf  # when its state became final [s]
    reason: str = ""  # why it was lost


@dataclass(slots=True)
class TaskBook:
    """All tasks of a run. Each is in one state, so that none can go missing."""

    tasks: list[Task] = field(default_factory=list)
    open_tasks: int = 0

    def open(self, task: Task) -> None:
        """Enter a new task."""
        self.tasks.append(task)
        self.open_tasks += 1

    def close(self, task: Task, state: State, time: float, reason: str = "") -> None:
        """A task comes to its end. It has only one.

        Raises:
            ValueError: it has ended already, or ``state`` is not an end.
        """
        if task.state not in OPEN or state in OPEN:
            raise ValueError(f"task {task.event.id} goes from {task.state} to {state}")
        task.state, task.closed, task.reason = state, time, reason
        self.open_tasks -= 1

    def count(self, *states: State) -> int:
        """How many tasks are in one of the states."""
        return sum(task.state in states for task in self.tasks)

    def lost_by_reason(self) -> dict[str, int]:
        """Why tasks were lost, and how many."""
        return dict(Counter(task.reason for task in self.tasks if task.state is State.LOST))
