"""Lanes of states: what is going on about each open event, and with the robots in focus."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import rerun as rr

from fleet.replay.columns import Moment, column, texts
from fleet.replay.journal import RELOCATED, RecordedLine, TripEnd
from fleet.replay.scheme import (
    AUCTIONEER_COLOUR,
    EVENT_COLOUR,
    KIND_LABELS,
    MOTION_COLOUR,
    SOURCE_COLOUR,
    WINNER_COLOUR,
    event_lane,
    kind_colour,
    robot_lane,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import Award, RobotId

MANY = 6  # lanes of events, at most; of more that are open at once the later have none
WORK_COLOUR = 0x8FD0A8FF
DRIVES, WORKS = "drives", "works"
PARTS = ("collector", "auctioneer", "winner")


class Lane:
    """The states of one thing, one after the other."""

    def __init__(self) -> None:
        self.rows: list[tuple[Moment, str | None]] = []
        self.colours: dict[str, int] = {}  # of all states so far
        self._now = ""

    def enter(self, at: Moment, state: str, colour: int) -> None:
        """From now on it is in this state."""
        if state != self._now:
            self._now = state
            self.colours[state] = colour
            self.rows.append((at, state))

    def leave(self, at: Moment) -> None:
        """It is over."""
        if self._now:
            self._now = ""
            self.rows.append((at, None))


class Lanes(Layer):
    """A lane for each open event, with the colours of the arrows, and for those with a part."""

    def __init__(self) -> None:
        self._lanes: dict[str, Lane] = {}
        self._slots: dict[int, int] = {}  # lane of each open event

    def run_started(self, state: FleetState) -> None:
        """Nothing is going on."""
        self._state = state

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """It gets the first lane that is free."""
        free = (k for k in range(MANY) if k not in self._slots.values())
        slot = self._slots.get(event, next(free, None))
        if slot is not None:
            self._slots[event] = slot
            self._enter(at, event, f"event {event + 1}", EVENT_COLOUR)

    def focused(self, at: Moment) -> None:
        """Others have a part."""
        for part in PARTS:
            self._lane(robot_lane(part)).leave(at)
        focus = self._state.in_focus
        if focus is not None:
            self._play(at, "collector", focus.source, "is told", SOURCE_COLOUR)
            if focus.auctioneer is not None:
                self._play(at, "auctioneer", focus.auctioneer, "asks", AUCTIONEER_COLOUR)

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """What is said is the phase that a talk is in."""
        colour = kind_colour(line.kind)
        self._enter(at, line.event, KIND_LABELS.get(line.kind, line.kind), colour)
        focus = self._state.in_focus
        if focus is None or line.event != focus.event:
            return
        if line.kind.startswith("route") and line.sender == focus.source:
            self._play(at, "collector", line.sender, "passes it on", colour)
        auctioneer = focus.auctioneer
        if auctioneer is not None:
            doing = {"call": "asks", "bid": "hears bids", "assign": "decides"}.get(line.kind)
            if doing:
                self._play(at, "auctioneer", auctioneer, doing, colour)

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """Who goes."""
        if event == self._state.focus and award.winner is not None:
            self._play(at, "winner", award.winner, "wins", WINNER_COLOUR)

    def departed(self, at: Moment, robot: RobotId) -> None:
        """Off it goes."""
        event = self._state.under_way[robot].event
        self._enter(at, event, DRIVES, MOTION_COLOUR)
        if event == self._state.focus:
            self._play(at, "winner", robot, DRIVES, MOTION_COLOUR)

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """At work, or not."""
        if trip.outcome == RELOCATED:
            return
        task = self._state.tasks.get(event)
        works = trip.outcome == "arrived" and task is not None and task.service > 0.0
        state = WORKS if works else trip.outcome
        colour = WORK_COLOUR if trip.outcome == "arrived" else EVENT_COLOUR
        self._enter(at, event, state, colour)
        if event == self._state.focus:
            self._play(at, "winner", trip.robot, state, colour)

    def event_closed(self, at: Moment, event: int, outcome: str) -> None:
        """Its lane is free."""
        slot = self._slots.pop(event, None)
        if slot is not None:
            self._lane(event_lane(slot)).leave(at)

    def run_ended(self, at: Moment, summary: Mapping[str, Any] | None) -> None:
        """All over."""
        for lane in self._lanes.values():
            lane.leave(at)

    def send(self, sink: Sink) -> None:
        """The states, and their colours."""
        for path, lane in self._lanes.items():
            if lane.rows:
                when, states = zip(*lane.rows, strict=True)
                entered = texts([state for state in states if state is not None])
                counts = [int(state is not None) for state in states]
                sink.rows(path, when, column(rr.StateChange.descriptor_state(), entered, counts))
                lane.rows = []
                names, paint = [*lane.colours], [*lane.colours.values()]
                sink.static(
                    path,
                    rr.StateConfiguration(
                        values=names, labels=names, colors=np.array(paint, np.uint32)
                    ),
                )

    def _lane(self, path: str) -> Lane:
        return self._lanes.setdefault(path, Lane())

    def _enter(self, at: Moment, event: int, state: str, colour: int) -> None:
        if event in self._slots:
            self._lane(event_lane(self._slots[event])).enter(at, state, colour)

    def _play(self, at: Moment, part: str, robot: RobotId, doing: str, colour: int) -> None:
        self._lane(robot_lane(part)).enter(at, f"r{robot} {doing}", colour)
