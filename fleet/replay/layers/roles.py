"""The event in focus, how near to it the search ends, and who is who; the others as marks."""

from __future__ import annotations

from math import dist, hypot
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import rerun as rr

from fleet.replay.colormap import energy_colours
from fleet.replay.columns import Moment, colours, column, own, pairs, segments, texts
from fleet.replay.journal import RELOCATED, RecordedLine, TripEnd
from fleet.replay.layers.label_placement import HANG, LabelPlacement
from fleet.replay.scheme import (
    AUCTIONEER_COLOUR,
    DEAD_COLOUR,
    EVENT,
    EVENT_COLOUR,
    LEADERS,
    NAMES,
    OPEN_EVENTS,
    PARTS,
    ROBOT_IS,
    SEARCH,
    SILENT,
    SOURCE_COLOUR,
    TRUE_SITE,
    WINNER_TEXT,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer, Region
from protocols.messages import Award, Point, RobotId

TARGET = 2.3  # radius of the ring around an event, in radii of a robot
ELSEWHERE = 1e-9  # [m] from where an event is said to be
COLOURS = {
    "collector": SOURCE_COLOUR,
    "auctioneer": AUCTIONEER_COLOUR,
    "winner": WINNER_TEXT,
}


class Name(NamedTuple):
    """A label, and what it is for."""

    text: str
    colour: int
    anchor: Point  # [m]
    named: Point  # where what it names is [m]


class PartHeld(NamedTuple):
    """A robot at rest that has a part in the conversation in focus."""

    place: Point  # [m]
    energy: float  # [J]
    on_air: bool
    words: str  # what it is


NO_PART = PartHeld((-1e6, -1e6), 0.0, False, "")  # out of sight


class Roles(Layer):
    """Names of those who take part in the conversation in focus, and of its event."""

    def __init__(self) -> None:
        self._event_rows: list[tuple[Moment, list[Point]]] = []
        self._open_rows: list[tuple[Moment, list[Point]]] = []
        self._true_rows: list[tuple[Moment, list[tuple[Point, Point]]]] = []
        self._silent_rows: list[tuple[Moment, list[Region]]] = []
        self._name_rows: list[tuple[Moment, list[Name]]] = []
        self._part_rows: list[tuple[Moment, list[PartHeld]]] = []
        self._parts: list[PartHeld] | None = None  # of the latest row
        self._held: dict[RobotId, list[str]] = {}
        self._names: dict[str, Name] = {}  # by whose it is

    def run_started(self, state: FleetState) -> None:
        """Nothing to name."""
        self._state = state
        self._labels = LabelPlacement((state.scene.width, state.scene.height))

    def focused(self, at: Moment) -> None:
        """Another event; a name goes with its event."""
        state, focus = self._state, self._state.in_focus
        self._held, self._names = {}, {}
        self._labels.clear(state.positions)
        true: list[tuple[Point, Point]] = []
        if focus is not None:
            self._labels.keep_off(focus.site)
            self._name("event", focus.site, EVENT_COLOUR, f"event {focus.event + 1}")
            self._assume(focus.source, "collector")
            if focus.auctioneer is not None:
                self._assume(focus.auctioneer, "auctioneer")
            task = state.tasks.get(focus.event)
            if task is not None and dist(task.site, task.position) > ELSEWHERE:
                true = [(task.position, task.site)]
        self._event_rows.append((at, [] if focus is None else [focus.site]))
        self._true_rows.append((at, true))
        self._draw_open(at)
        self._draw_names(at)

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """One more, while another is in focus."""
        self._draw_open(at)

    def event_closed(self, at: Moment, event: int, outcome: str) -> None:
        """One less."""
        self._draw_open(at, gone=event)

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """The first to call is the auctioneer."""
        if line.kind == "call" and line.event == self._state.focus:
            held = self._held.get(line.sender, ())
            self._assume(line.sender, "auctioneer", once=True)
            if held != self._held.get(line.sender, ()):
                self._draw_names(at)

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """The winner, and where the search ended if nobody called."""
        if event == self._state.focus:
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
        if event == self._state.focus and trip.outcome != RELOCATED:
            self._assume(trip.robot, "winner")
            self._draw_names(at)

    def blacked_out(self, at: Moment, region: Region) -> None:
        """A region falls silent."""
        self._silent_rows.append((at, list(self._state.silent)))

    def lifted(self, at: Moment, region: Region) -> None:
        """It is back."""
        self._silent_rows.append((at, list(self._state.silent)))

    def send(self, sink: Sink) -> None:
        """Events with their circles, and names."""
        mark, radius = self._state.mark, self._state.scene.search_radius
        if self._event_rows:
            when, sites = zip(*self._event_rows, strict=True)
            counts = [len(row) for row in sites]
            centres = pairs(np.array([site for row in sites for site in row]).reshape(-1, 2))
            sink.rows(
                EVENT,
                when,
                column(rr.Points2D.descriptor_positions(), centres, counts),
                *_circles(centres, counts, np.full(len(centres), TARGET * mark)),
            )
            if radius > 0.0:
                sink.rows(SEARCH, when, *_circles(centres, counts, np.full(len(centres), radius)))
        if self._open_rows:
            when, sites = zip(*self._open_rows, strict=True)
            places = pairs(np.array([site for row in sites for site in row]).reshape(-1, 2))
            counts = [len(row) for row in sites]
            sink.rows(OPEN_EVENTS, when, column(rr.Points2D.descriptor_positions(), places, counts))
        if any(row for _, row in self._true_rows):
            when, lines = zip(*self._true_rows, strict=True)
            ends = np.array([line for row in lines for line in row]).reshape(-1, 2, 2)
            counts = [len(row) for row in lines]
            sink.rows(
                TRUE_SITE,
                when,
                column(rr.LineStrips2D.descriptor_strips(), segments(ends), counts),
                column(rr.Points2D.descriptor_positions(), pairs(ends[:, 1]), counts),
            )
        if self._silent_rows:
            when, regions = zip(*self._silent_rows, strict=True)
            flat = np.array([region for row in regions for region in row]).reshape(-1, 3)
            counts = [len(row) for row in regions]
            sink.rows(SILENT, when, *_circles(pairs(flat[:, :2]), counts, flat[:, 2]))
        if self._name_rows:
            self._send_names(sink)
        if self._part_rows:
            self._send_parts(sink)
        self._event_rows, self._name_rows, self._open_rows = [], [], []
        self._silent_rows, self._true_rows = [], []

    def _send_names(self, sink: Sink) -> None:
        when, rows = zip(*self._name_rows, strict=True)
        counts = [len(row) for row in rows]
        names = [name for row in rows for name in row]
        sink.rows(
            NAMES,
            when,
            column(
                rr.Points2D.descriptor_positions(),
                pairs(np.array([name.anchor for name in names]).reshape(-1, 2)),
                counts,
            ),
            column(rr.Points2D.descriptor_labels(), texts([n.text for n in names]), counts),
            column(rr.Points2D.descriptor_colors(), colours([n.colour for n in names]), counts),
        )
        side = max(self._state.scene.width, self._state.scene.height)
        leaders = [[leader(name, side) for name in row] for row in rows]
        drawn = [[line for line in row if line is not None] for row in leaders]
        sink.rows(
            LEADERS,
            when,
            column(
                rr.LineStrips2D.descriptor_strips(),
                segments(np.array([line for row in drawn for line in row]).reshape(-1, 2, 2)),
                [len(row) for row in drawn],
            ),
        )

    def _send_parts(self, sink: Sink) -> None:
        """What the viewer says of a robot that is pointed at. It says so where there are several;
        nobody, nowhere, is the first.
        """
        when, rows = zip(*self._part_rows, strict=True)
        parts = [part for row in rows for part in (NO_PART, *row)]
        counts = [len(row) + 1 for row in rows]
        energies = [part.energy for part in parts]
        tints = energy_colours(energies, self._state.capacity)
        paint = np.where([part.on_air for part in parts], tints, np.uint32(DEAD_COLOUR))
        sink.rows(
            PARTS,
            when,
            column(
                rr.Points2D.descriptor_positions(), pairs([part.place for part in parts]), counts
            ),
            column(rr.Points2D.descriptor_colors(), colours(paint), counts),
            column(own("Robot", ROBOT_IS), texts([part.words for part in parts]), counts),
        )
        self._part_rows = []

    def _assume(self, robot: RobotId, role: str, *, once: bool = False) -> None:
        """The robot has a role; one that can be had ``once`` is the first one's to keep."""
        if once and any(role in held for held in self._held.values()):
            return
        held = self._held.setdefault(robot, [])
        if role not in held and robot not in self._state.under_way:
            self._held[robot] = [*held, role]
            text = f"{', '.join(self._held[robot])} r{robot}"
            self._name(f"r{robot}", self._state.at(robot), COLOURS[role], text)

    def _name(self, whose: str, place: Point, colour: int, text: str) -> None:
        self._names[whose] = Name(text, colour, self._labels.place(*place, len(text)), place)

    def _draw_open(self, at: Moment, gone: int = -1) -> None:
        """The events that are open and not in focus."""
        others = {self._state.focus, gone}
        sites = [site for event, site in self._state.sites.items() if event not in others]
        if sites or self._open_rows or self._drawn_open:
            self._open_rows.append((at, sites))
        self._drawn_open = bool(sites)

    _drawn_open = False

    def _draw_names(self, at: Moment) -> None:
        self._name_rows.append((at, list(self._names.values())))
        state = self._state
        event = f"of event {state.focus + 1}"
        parts = [
            PartHeld(
                state.at(robot),
                float(state.energies[robot]),
                bool(state.on_air[robot]),
                f"robot {robot} · {state.energies[robot]:.0f} J · {each} {event}",
            )
            for robot, each in ((robot, ", ".join(held)) for robot, held in self._held.items())
        ]
        if parts != self._parts:
            self._parts = parts
            self._part_rows.append((at, parts))


def leader(name: Name, side: float) -> tuple[Point, Point] | None:
    """The line from what a name is for to the name; None: they are side by side."""
    x, y = name.named
    to_x, to_y = name.anchor[0], name.anchor[1] - HANG * side
    away = hypot(to_x - x, to_y - y)
    if away < 0.05 * side:
        return None
    start, end = 0.014 * side / away, 1.0 - 0.02 * side / away
    return (
        (x + start * (to_x - x), y + start * (to_y - y)),
        (x + end * (to_x - x), y + end * (to_y - y)),
    )


def _circles(
    centres: pa.Array, counts: list[int], radii: np.ndarray[tuple[int], np.dtype[np.float64]]
) -> list[rr.ComponentColumn]:
    """Circles of some radii [m]; each needs a size of its own to be drawn."""
    return [
        column(rr.Ellipses2D.descriptor_centers(), centres, counts),
        column(
            rr.Ellipses2D.descriptor_half_sizes(), pairs(np.column_stack([radii, radii])), counts
        ),
    ]
