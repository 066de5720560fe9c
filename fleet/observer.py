"""Watching a run: hooks that do nothing by default. Nothing in a run depends on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from difflib import get_close_matches
from functools import partial
from inspect import getattr_static
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.motion import Trip
from protocols.messages import Award, Event, Heard, Move, RobotId, Transmission

if TYPE_CHECKING:
    from fleet.faults import Blackout, Breakdown
    from fleet.fleet import Fleet
    from fleet.results import Summary
    from fleet.robot import Appraisal
    from fleet.tasks import Task


class TranscriptLine(NamedTuple):
    """One transmission, when it was on the air, and who heard it."""

    number: int  # counts the transmissions of the run, from 1
    time: float  # [s]
    event: int  # the id of the event it was about
    transmission: Transmission
    heard: Heard
    attempts: int = 1  # frames it took


class Excerpt(NamedTuple):
    """Lines of the transcript in a row: about one event, on the air at one time."""

    first: int  # the number of the first; the others follow
    time: float  # [s]
    event: int  # the id of the event they were about
    transmissions: Sequence[Transmission]
    heard: Sequence[Heard]  # by whom each
    attempts: Sequence[int]  # frames each took

    def lines(self) -> list[TranscriptLine]:
        """One by one."""
        count = len(self.transmissions)
        numbers = range(self.first, self.first + count)
        times, events = (self.time,) * count, (self.event,) * count
        return [
            *map(
                TranscriptLine,
                numbers, times, events, self.transmissions, self.heard, self.attempts,
            )
        ]  # fmt: skip


class Observer:
    """Watches a run. Override what you want to see; the rest costs nothing.

    The fleet is live: copy what you keep. Poses under way and links under way are kept and
    computed only if an observer asks for them by an interval.
    """

    sample_interval: float | None = None  # [s] between poses of a moving robot
    link_interval: float | None = None  # [s] between updates of the links while robots drive

    def noticed(self, said: str) -> None:
        """Something about the scenario that its author may want to know, in a sentence."""

    def placement_tried(self, tried: int, most: int) -> None:
        """Starting places were drawn and make no network: so often, of so many times at most."""

    def run_started(self, fleet: Fleet) -> None:
        """Everybody is in place, nothing has happened yet."""

    def air_changed(self, on_air: Sequence[RobotId], time: float) -> None:
        """Robots fell silent or are heard again: these can be talked to from now on."""

    def broke_down(self, fault: Breakdown) -> None:
        """A robot's motor, or all of it, failed."""

    def exhausted(self, robot: RobotId, time: float) -> None:
        """A robot's battery is empty."""

    def blacked_out(self, blackout: Blackout) -> None:
        """The radio of a region falls silent."""

    def lifted(self, blackout: Blackout) -> None:
        """The radio of a region is back."""

    def event_occurred(self, task: Task) -> None:
        """Something happened at ``task.site``; robots will be told ``task.event``, or never."""

    def event_raised(self, event: Event, source: RobotId, time: float) -> None:
        """``source`` is told of the event; again, by another robot, if a trip failed."""

    def transmitted(self, excerpt: Excerpt) -> None:
        """Transmissions were made; ``excerpt.lines()`` has them one by one.

        Over a radio that takes no time it is all of a conversation at once, after its last.
        """

    def appraised(self, event: Event, appraisals: Sequence[Appraisal], time: float) -> None:
        """What those who were asked believed of the trip, in this order; before the award."""

    def awarded(self, event: Event, award: Award, time: float) -> None:
        """A conversation has ended."""

    def broken_off(self, event: Event, reason: str, time: float) -> None:
        """A conversation came to no end: somebody fell silent, or a packet went in circles."""

    def event_closed(self, event: Event, outcome: str, time: float) -> None:
        """An event is over: "served", "expired" or "lost"."""

    def departed(self, event: Event, robot: RobotId, time: float) -> None:
        """A robot sets off to an event."""

    def planned(self, robot: RobotId, way: NDArray[np.float64], time: float) -> None:
        """A robot that has departed takes a ``way`` (k, 2) [m] that bends, or had to plan anew.

        Only if an observer asks for poses.
        """

    def relocating(self, event: Event, move: Move, time: float) -> None:
        """A robot sets off to a place that is no event: an award of this event has sent it."""

    def relocated(self, event: Event, trip: Trip) -> None:
        """It came to rest: there, or short of it."""

    def moved(self, samples: NDArray[np.float64]) -> None:
        """Poses (k, 8) of the robots under way: :data:`fleet.motion.SAMPLE_FIELDS`."""

    def relinked(self, time: float) -> None:
        """The links have been brought up to date with robots that moved."""

    def trip_ended(self, event: Event, trip: Trip) -> None:
        """A robot came to rest: at the event, or short of it."""

    def run_ended(self, summary: Summary) -> None:
        """The last round is over."""

    def closed(self) -> None:
        """Called last, also when the run broke off: let go of files."""


HOOKS = tuple(name for name in vars(Observer) if callable(getattr(Observer, name)))
"""What a run tells of."""
RENAMED = {"sent": "transmitted", "transcribed": "transmitted"}
"""What hooks were called before."""
_nearest = partial(get_close_matches, possibilities=HOOKS, n=1, cutoff=0.75)


class Audience(Observer):
    """All observers of a run as one: what happens is told to those who override its hook."""

    def __init__(self, observers: Sequence[Observer] = ()) -> None:
        self.present = len(observers) > 0
        self.sample_interval = _shortest([o.sample_interval for o in observers])
        self.link_interval = _shortest([o.link_interval for o in observers])
        for observer in observers:
            _check_hooks(observer)
        self.listens = any(_overrides(o, "transmitted") for o in observers)
        self.weighs = any(_overrides(o, "appraised") for o in observers)
        self._observers = tuple(observers)
        for hook in set(HOOKS) - {"closed"}:
            told = [getattr(o, hook) for o in observers if _overrides(o, hook)]
            setattr(self, hook, told[0] if len(told) == 1 else partial(_tell, told))

    def closed(self) -> None:
        """Tell everybody, whatever one of them raises."""
        with ExitStack() as stack:
            for observer in reversed(self._observers):
                stack.callback(observer.closed)


def _tell(told: Sequence[Callable[..., None]], *what: Any) -> None:
    for hook in told:
        hook(*what)


def _overrides(observer: Observer, hook: str) -> bool:
    """Whether it has the hook of its own, by its class or as an attribute."""
    own = getattr(observer, hook)
    return getattr(own, "__func__", own) is not getattr(Observer, hook)


def _check_hooks(observer: Observer) -> None:
    """Raises TypeError if a public method is called nearly as a hook is, which would never be told,
    or a hook is hidden by something else.
    """
    for hook in HOOKS:
        if not callable(found := getattr(observer, hook)):
            raise TypeError(
                f"{type(observer).__name__}.{hook} is a {type(found).__name__}; expected the hook"
                " of that name, a method"
            )
    for name in dir(observer):
        if name.startswith("_") or hasattr(Observer, name):
            continue
        near = RENAMED.get(name) or "".join(_nearest(name))
        if near and callable(getattr_static(observer, name)):
            raise TypeError(
                f"{type(observer).__name__}.{name} is no hook of a run, which would never call it;"
                f" did you mean {near!r}?"
            )


def _shortest(intervals: Sequence[float | None]) -> float | None:
    return min(filter(None, intervals), default=None)
