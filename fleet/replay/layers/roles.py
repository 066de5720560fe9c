"""The event, how near to it the search ends, and who is who: collector, auctioneer, winner."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import rerun as rr

from fleet.replay.columns import Moment, colours, column, pairs, texts
from fleet.replay.journal import RELOCATED, RecordedLine, TripEnd
from fleet.replay.layers.label_placement import LabelPlacement
from fleet.replay.scheme import (
    AUCTIONEER_COLOUR,
    EVENT,
    EVENT_COLOUR,
    NAMES,
    SEARCH,
    SOURCE_COLOUR,
    WINNER_TEXT,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import Award, Point, RobotId

TARGET = 2.3  # radius of the ring around an event, in radii of a robot
MANY_NAMES = 16  # at a time
COLOURS = {
    "collector": SOURCE_COLOUR,
    "auctioneer": AUCTIONEER_COLOUR,
    "winner": WINNER_TEXT,
}


class Roles(Layer):
    """Names of those who take part in the latest conversation, and of all events that are open."""

    def __init__(self) -> None:
        self._event_rows: list[tuple[Moment, list[Point]]] = []
        self._name_rows: list[tuple[Moment, list[tuple[str, int, Point]]]] = []
        self._held: dict[RobotId, list[str]] = {}
        self._names: dict[str, tuple[str, int, Point]] = {}  # text, colour, anchor, by whose it is
        self._event = -1

    def run_started(self, state: FleetState) -> None:
        """Nothing to name."""
        self._state = state
        self._labels = LabelPlacement((state.scene.width, state.scene.height))

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """The event and who is told of it."""
        self._event = event
        self._held, self._names = {}, {}
        self._labels.clear(self._state.positions)
        sites = self._state.sites
        for site in sites.values():
            self._labels.keep_off(site)
        self._name(f"event {event + 1}", sites[event], EVENT_COLOUR)
        self._assume(source, "collector")
        for other in [e for e in sites if e != event][:MANY_NAMES]:
            self._name(f"event {other + 1}", sites[other], EVENT_COLOUR)
        self._draw_events(at)
        self._draw_names(at)

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """The first to call is the auctioneer."""
        if line.kind == "call" and line.event == self._event:
            self._assume(line.sender, "auctioneer", once=True)
            self._draw_names(at)

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """The winner, and where the search ended if nobody called."""
        if event == self._event:
            self._assume(award.auctioneer, "auctioneer", once=True)
            if award.winner is not None:
                self._assume(award.winner, "winner")
            self._draw_names(at)

    def departed(self, at: Moment, robot: RobotId) -> None:
        """A mover carries its own name; other names keep off its way."""
        _, (x, y), (to_x, to_y), *_ = self._state.under_way[robot]
        for share in (0.2, 0.4, 0.6, 0.8):
            self._labels.keep_off((x + share * (to_x - x), y + share * (to_y - y)))
        if self._held.pop(robot, None):
            del self._names[f"r{robot}"]
            self._draw_names(at)

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """The one who went, where it stands now."""
        if event == self._event and trip.outcome != RELOCATED:
            self._assume(trip.robot, "winner")
            self._draw_names(at)

    def event_closed(self, at: Moment, event: int, outcome: str) -> None:
        """Off the map; but the last one stays until the next is raised."""
        if self._state.sites:
            self._draw_events(at)

    def send(self, sink: Sink) -> None:
        """Events with their circles, and names."""
        if self._event_rows:
            when, sites = zip(*self._event_rows, strict=True)
            counts = [len(row) for row in sites]
            centres = pairs(np.array([site for row in sites for site in row]).reshape(-1, 2))
            sink.rows(
                EVENT,
                when,
                column(rr.Points2D.descriptor_positions(), centres, counts),
                *_circles(centres, counts, TARGET * self._state.mark),
            )
            radius = self._state.scene.search_radius
            if radius > 0.0:
                sink.rows(SEARCH, when, *_circles(centres, counts, radius))
        if self._name_rows:
            when, rows = zip(*self._name_rows, strict=True)
            counts = [len(row) for row in rows]
            words, paint, places = zip(*(name for row in rows for name in row), strict=True)
            sink.rows(
                NAMES,
                when,
                column(rr.Points2D.descriptor_positions(), pairs(places), counts),
                column(rr.Points2D.descriptor_labels(), texts(words), counts),
                column(rr.Points2D.descriptor_colors(), colours(paint), counts),
            )
        self._event_rows, self._name_rows = [], []

    def _assume(self, robot: RobotId, role: str, *, once: bool = False) -> None:
        """The robot has a role; one that can be had ``once`` is the first one's to keep."""
        if once and any(role in held for held in self._held.values()):
            return
        held = self._held.setdefault(robot, [])
        if role not in held:
            held.append(role)
            text = f"{', '.join(held)} r{robot}"
            self._name(f"r{robot}", self._state.at(robot), COLOURS[role], text)

    def _name(self, whose: str, place: Point, colour: int, text: str = "") -> None:
        text = text or whose
        self._names[whose] = text, colour, self._labels.place(*place, len(text))

    def _draw_events(self, at: Moment) -> None:
        self._event_rows.append((at, list(self._state.sites.values())))

    def _draw_names(self, at: Moment) -> None:
        self._name_rows.append((at, list(self._names.values())))


def _circles(centres: pa.Array, counts: list[int], radius: float) -> list[rr.ComponentColumn]:
    """Circles of one radius [m]; each needs a size of its own to be drawn."""
    return [
        column(rr.Ellipses2D.descriptor_centers(), centres, counts),
        column(
            rr.Ellipses2D.descriptor_half_sizes(),
            pairs(np.full((len(centres), 2), radius)),
            counts,
        ),
    ]
