"""Progress of long work, on standard error, for those who watch a terminal."""

from __future__ import annotations

from time import monotonic

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from fleet.fleet import Fleet
from fleet.motion import Trip
from fleet.observer import Observer
from fleet.results import Summary
from protocols.messages import Event


class RunProgress(Observer):
    """Rounds served and energy left. Without a number of rounds the estimate is by energy."""

    def __init__(self, rounds: int | None) -> None:
        self._rounds = rounds
        self._served = 0
        self._drawn = 0.0
        self._bar = Progress(
            TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[state]}"),
            TimeElapsedColumn(), TimeRemainingColumn(), console=Console(stderr=True),
            transient=True,
        )  # fmt: skip
        ready = "getting ready; the first run compiles its loops, which takes half a minute"
        self._task = self._bar.add_task(ready, total=None, state="")
        self._bar.start()

    def placement_tried(self, tried: int, most: int) -> None:
        """Say that starting places are drawn again and again."""
        said = "drawing starting places that make one network"
        self._bar.update(self._task, description=said, state=f"{tried} of {most} at most")

    def run_started(self, fleet: Fleet) -> None:
        """Everybody is in place."""
        self._fleet = fleet
        self._bar.update(self._task, description=fleet.labels.protocol, total=1.0)

    def trip_ended(self, event: Event, trip: Trip) -> None:
        """Redraw, a few times a second at the most."""
        self._served += trip.outcome == "arrived"
        if monotonic() - self._drawn < 0.1:
            return
        self._drawn = monotonic()
        batteries = [robot.battery for robot in self._fleet.robots]
        left = sum(b.charge for b in batteries) / sum(b.capacity for b in batteries)
        done = self._served / self._rounds if self._rounds else 1.0 - left
        state = f"{self._served} events served, {left:.0%} energy left"
        self._bar.update(self._task, completed=done, state=state)

    def run_ended(self, summary: Summary) -> None:
        """All done."""
        self._bar.update(self._task, completed=1.0)

    def closed(self) -> None:
        """Give the terminal back."""
        self._bar.stop()
