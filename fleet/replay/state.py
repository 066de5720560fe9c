"""What the writer knows of the run so far, and the layers that draw it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import dist, inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.replay.columns import Moment
from fleet.replay.journal import RecordedLine, Scene, TripEnd
from fleet.replay.known_links import Changes
from fleet.replay.scheme import BEAT
from fleet.replay.sink import Sink
from protocols.messages import Award, Point, RobotId


class UnderWay(NamedTuple):
    """A robot that drives."""

    event: int
    origin: Point  # [m]
    site: Point  # [m]
    departed: float  # [s]
    errand: bool = False  # to a place that is no event


class OpenTask(NamedTuple):
    """What happened, and where."""

    position: Point  # as it is told [m]
    site: Point  # where it really is [m]
    raised: float  # [s]
    deadline: float  # [s] from raised; inf: none
    service: float  # [s]


class Belief(NamedTuple):
    """What a robot believed of the trip, as :class:`fleet.robot.Appraisal` has it."""

    robot: RobotId
    cost: float  # [J]
    energy: float  # [J]
    refusal: str


class Region(NamedTuple):
    """Where the radio is silent."""

    x: float  # [m]
    y: float  # [m]
    radius: float  # [m]


@dataclass(slots=True)
class OpenConversation:
    """What has been said about an event since it was last raised."""

    event: int
    site: Point  # [m] as it is told
    source: RobotId
    lines: list[RecordedLine] = field(default_factory=list)
    beliefs: dict[RobotId, Belief] = field(default_factory=dict)
    award: Award | None = None  # once it has ended
    talking: bool = True

    def count(self, *kinds: str) -> int:
        """Transmissions of some kinds so far."""
        return sum(line.kind in kinds for line in self.lines)

    @property
    def calls(self) -> int:
        """Calls for bids so far."""
        return self.count("call")

    @property
    def auctioneer(self) -> RobotId | None:
        """Whom the search ended at, as far as known."""
        if self.award is not None:
            return self.award.auctioneer
        return next((line.sender for line in self.lines if line.kind == "call"), None)

    @property
    def parents(self) -> dict[RobotId, RobotId]:
        """Whom each robot first heard the call from, in the order in which they heard it."""
        parents: dict[RobotId, RobotId] = {}
        callers: set[RobotId] = set()
        for line in self.lines:
            if line.kind == "call":
                callers.add(line.sender)
                for robot in line.heard:
                    if robot not in callers:
                        parents.setdefault(robot, line.sender)
        return parents

    @property
    def robots(self) -> list[RobotId]:
        """Who took part, in the order in which they did."""
        found = {self.source: None}
        for line in self.lines:
            found |= dict.fromkeys((line.sender, *line.heard))
        return list(found)


class FleetState:
    """The state of the fleet, kept up to what is being told.

    The event in ``focus`` is the one that is drawn in full. It stays in focus while it is talked
    over; then the next one is that is raised, or spoken of.

    Time also runs as a story: as it does in the simulation, but two transmissions are never less
    than :data:`scheme.BEAT` apart, and what must be seen takes a pause.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.n = len(scene.positions)
        self.positions = np.array(scene.positions, float).reshape(-1, 2)  # latest known [m]
        self.energies = np.array(scene.energies)  # (n,) [J]
        self.capacity = max(scene.capacities)  # [J]
        self.on_air = self.energies > 0.0  # (n,)
        self.failed: dict[RobotId, str] = {}  # "exhausted", "broken", or "motor"
        self.silent: list[Region] = []
        self.under_way: dict[RobotId, UnderWay] = {}
        self.tasks: dict[int, OpenTask] = {}  # that are not over, by event
        self.conversations: dict[int, OpenConversation] = {}  # by event, the latest about each open
        self.focus = -1  # the event that is drawn in full; -1: none
        self.round = 0
        self.now = 0.0  # [s]
        self.mark = mark_of(scene)
        self._lag = 0.0  # [s] that the story is behind
        self._spoke = -inf  # [s] of the story, the latest transmission

    @property
    def sites(self) -> dict[int, Point]:
        """Where open events are said to be [m]; those that robots have been told of."""
        return {event: talk.site for event, talk in self.conversations.items()}

    @property
    def story(self) -> float:
        """Where the story is now [s]."""
        return self.now + self._lag

    def speak(self) -> None:
        """The story goes on to the next transmission."""
        self._lag = max(self._lag, self._spoke + BEAT - self.now)
        self._spoke = self.story

    def pause(self, seconds: float) -> None:
        """The story stands still, so that something is seen."""
        self._lag += seconds

    def at(self, robot: RobotId) -> Point:
        """Where a robot is, as far as known [m]."""
        x, y = self.positions[robot].tolist()
        return x, y

    def foreseen(self, origin: Point, site: Point) -> float:
        """What Eq. (1) charges for the straight line to a site [J]."""
        return self.scene.per_metre * dist(origin, site)

    @property
    def in_focus(self) -> OpenConversation | None:
        """What has been said about the event in focus."""
        return self.conversations.get(self.focus)


def mark_of(scene: Scene) -> float:
    """The radius that robots are drawn with [m]: theirs, unless they would be hard to see."""
    return max(scene.radius, 0.0055 * max(scene.width, scene.height))


class Layer:
    """One part of the picture: it is told what happens and turns it into rows.

    Hooks are called as the observer's are. The state is up to date when a layer is told, and
    knows the trip that ended no more.
    """

    def run_started(self, state: FleetState) -> None:
        """Everybody is in place."""

    def focused(self, at: Moment) -> None:
        """Another event is in focus, or none; something may have been said about it before."""

    def broke_down(self, at: Moment, robot: RobotId, what: str) -> None:
        """A robot's "motor", or "all" of it, failed."""

    def exhausted(self, at: Moment, robot: RobotId) -> None:
        """A robot's battery is empty."""

    def blacked_out(self, at: Moment, region: Region) -> None:
        """The radio of a region falls silent."""

    def lifted(self, at: Moment, region: Region) -> None:
        """The radio of a region is back."""

    def air_changed(self, at: Moment) -> None:
        """Robots fell silent, or are heard again."""

    def event_occurred(self, at: Moment, event: int) -> None:
        """Something happened."""

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """An event is told to a robot; again, by another, if nobody went or arrived."""

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """A transmission was made."""

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """A conversation is over."""

    def broken_off(self, at: Moment, event: int, reason: str) -> None:
        """A conversation came to no end."""

    def event_closed(self, at: Moment, event: int, outcome: str) -> None:
        """An event is "served", "expired" or "lost"; the state knows it no more."""

    def departed(self, at: Moment, robot: RobotId) -> None:
        """A robot sets off; the state knows where to, and whether that is an event."""

    def planned(self, at: Moment, robot: RobotId, way: NDArray[np.float64]) -> None:
        """A robot that has set off is going to drive along ``way`` (k, 2) [m]."""

    def moved(self, at: Moment, samples: NDArray[np.float64]) -> None:
        """Poses (k, 8) of those under way, up to now; the moment's time is that of the last."""

    def relinked(
        self, at: Moment, places: Mapping[RobotId, Point], linked: Changes, heard: Changes
    ) -> None:
        """Links of the routing graph came and went, and who hears whom, if that is told.

        ``places`` [m] are those of who moved, when the run linked them.
        """

    def linked_at(self, at: Moment, places: Mapping[RobotId, Point]) -> None:
        """Where robots are now [m], as told with their links."""

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """A robot came to rest: at an event, short of it, or elsewhere, see :data:`RELOCATED`."""

    def run_ended(self, at: Moment, summary: Mapping[str, Any] | None) -> None:
        """Nothing more happens; without a summary, the run broke off."""

    def send(self, sink: Sink) -> None:
        """Pass on the rows made since the last time."""


HOOKS = tuple(name for name in vars(Layer) if not name.startswith("_"))
"""What layers are told."""
