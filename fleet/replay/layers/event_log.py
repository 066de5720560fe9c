"""The log: a line for every transmission and every decision, each with the event it is about."""

from __future__ import annotations

from collections.abc import Mapping
from math import dist
from typing import Any

import rerun as rr

from fleet.replay.columns import Moment, colours, column, texts
from fleet.replay.journal import RELOCATED, RecordedLine, TripEnd
from fleet.replay.scheme import (
    EVENT_COLOUR,
    KIND_LABELS,
    LOG,
    LOST_COLOUR,
    MARK_COLOURS,
    MARK_LABELS,
    RELOCATION_COLOUR,
    WINNER_TEXT,
    kind_colour,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer, Region
from protocols.messages import Award, RobotId

SAID, DECIDED, FAILED = "TRACE", "INFO", "WARN"  # log levels
PLAIN = 0x93A0B4FF


class EventLog(Layer):
    """The log, whose level tells transmissions from decisions."""

    def __init__(self) -> None:
        self._lines: list[tuple[Moment, str, str, int]] = []
        self._kinds: dict[int, str] = {}  # the latest, by event

    def run_started(self, state: FleetState) -> None:
        """Nothing has been said."""
        self._state = state

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """An event, and who is told."""
        x, y = self._state.sites[event]
        self._kinds[event] = ""
        self._decide(at, event, f"at ({x:.2f}, {y:.2f}) m, r{source} is told", EVENT_COLOUR)

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """A transmission, and what it says about a decision."""
        before, colour = self._kinds.get(line.event, ""), kind_colour(line.kind)
        if line.kind == "route-face" and before != "route-face":
            what = f"r{line.sender} is nearer than its neighbours{self._off(line)}: face routing"
            self._decide(at, line.event, what, colour)
        elif line.kind == "call" and before != "call":
            self._decide(at, line.event, f"r{line.sender} calls an auction", colour)
        self._kinds[line.event] = line.kind
        colour = WINNER_TEXT if line.kind == "assign" else colour
        self._lines.append((at, say(line), SAID, colour if line.heard else LOST_COLOUR))

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """Who goes."""
        winner, bids = award.winner, award.bids
        for robot, (x, y) in award.moves:
            self._decide(at, event, f"r{robot} is sent to ({x:.2f}, {y:.2f}) m", RELOCATION_COLOUR)
        if winner is None and award.moves:
            return
        if winner is None:
            what = f"r{award.auctioneer} finds nobody who can go"
            self._decide(at, event, what, EVENT_COLOUR, FAILED)
            return
        among = f"of {len(bids)} bids" if len(bids) > 1 else "the only bid"
        unit = self._state.scene.unit
        cost = next((f"{b.cost:.2f} {unit}".rstrip() for b in bids if b.robot == winner), "")
        what = f"r{winner} wins: {cost + ', ' if cost else ''}{among}"
        self._decide(at, event, what if bids else f"r{winner} is chosen", WINNER_TEXT)

    def broken_off(self, at: Moment, event: int, reason: str) -> None:
        """Nothing came of it."""
        self._decide(at, event, f"nothing came of it, {reason}", EVENT_COLOUR, FAILED)

    def event_closed(self, at: Moment, event: int, outcome: str) -> None:
        """What was not served."""
        self._kinds.pop(event, None)
        if outcome != "served":
            self._decide(at, event, outcome, EVENT_COLOUR, FAILED)

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """How it went."""
        took = f"{trip.ended - trip.departed:.2f} s, {trip.path:.2f} m, {trip.energy:.2f} J"
        if trip.outcome == RELOCATED:
            self._decide(at, event, f"r{trip.robot} has relocated: {took}", PLAIN)
        elif trip.outcome == "arrived":
            self._decide(at, event, f"r{trip.robot} arrived: {took}", PLAIN)
        else:
            what = f"r{trip.robot} did not arrive ({trip.outcome}): {took}"
            self._decide(at, event, what, EVENT_COLOUR, FAILED)

    def exhausted(self, at: Moment, robot: RobotId) -> None:
        """A battery is empty."""
        self._fault(at, robot, "exhausted")

    def broke_down(self, at: Moment, robot: RobotId, what: str) -> None:
        """A motor fails, or a robot."""
        self._fault(at, robot, "motor" if what == "motor" else "broken")

    def blacked_out(self, at: Moment, region: Region) -> None:
        """A region falls silent."""
        where = f"within {region.radius:g} m of ({region.x:g}, {region.y:g}) m"
        self._line(at, f"radio silence {where}", FAILED, MARK_COLOURS["silenced"])

    def lifted(self, at: Moment, region: Region) -> None:
        """It is heard again."""
        where = f"within {region.radius:g} m of ({region.x:g}, {region.y:g}) m"
        self._line(at, f"radio silence is over {where}", DECIDED, PLAIN)

    def run_ended(self, at: Moment, summary: Mapping[str, Any] | None) -> None:
        """How far the recording goes."""
        if summary is None:
            self._line(at, f"the run broke off at {at.time:.2f} s", FAILED, EVENT_COLOUR)

    def send(self, sink: Sink) -> None:
        """The lines."""
        if self._lines:
            when, bodies, levels, paint = zip(*self._lines, strict=True)
            sink.rows(
                LOG,
                when,
                column(rr.TextLog.descriptor_text(), texts(bodies)),
                column(rr.TextLog.descriptor_level(), texts(levels)),
                column(rr.TextLog.descriptor_color(), colours(paint)),
            )
        self._lines = []

    def _off(self, line: RecordedLine) -> str:
        """How far from the event the sender is."""
        site = self._state.sites.get(line.event)
        return "" if site is None else f", {dist(self._state.at(line.sender), site):.2f} m off"

    def _fault(self, at: Moment, robot: RobotId, why: str) -> None:
        self._line(at, f"r{robot} is {MARK_LABELS[why]}", FAILED, MARK_COLOURS[why])

    def _decide(self, at: Moment, event: int, text: str, colour: int, level: str = DECIDED) -> None:
        self._line(at, f"event {event + 1}: {text}", level, colour)

    def _line(self, at: Moment, text: str, level: str, colour: int) -> None:
        self._lines.append((at, text, level, colour))


def say(line: RecordedLine) -> str:
    """A transmission as a line of the log."""
    heard = " ".join(f"r{robot}" for robot in line.heard[:8])
    if len(line.heard) > 8:
        heard += f" … {len(line.heard)}"
    if not line.heard:
        heard = "nobody" if line.receiver is None else f"r{line.receiver}, lost"
    offer = ""
    if line.cost is not None:
        offer = f"  {line.cost:.2f}"
        if line.bidder not in (line.sender, line.receiver):
            offer += f" of r{line.bidder}"
    if line.attempts > 1:
        offer += f"  ×{line.attempts}"
    label = KIND_LABELS.get(line.kind, line.kind)
    return f"{line.number:>6}  e{line.event + 1:<4} {label:<10} r{line.sender} → {heard}{offer}"
