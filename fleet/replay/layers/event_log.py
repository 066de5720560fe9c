"""The conversation in words: a line for every transmission and every decision, and the phase."""

from __future__ import annotations

from math import dist

import numpy as np
import rerun as rr

from fleet.replay.columns import Moment, colours, column, texts
from fleet.replay.journal import RELOCATED, RecordedLine, TripEnd
from fleet.replay.scheme import (
    EVENT_COLOUR,
    KIND_COLOURS,
    KIND_LABELS,
    LOG,
    LOST_COLOUR,
    MOTION,
    MOTION_COLOUR,
    PHASE,
    RELOCATION_COLOUR,
    WINNER_TEXT,
    kind_colour,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import Award, RobotId

SAID, DECIDED, FAILED = "TRACE", "INFO", "WARN"  # log levels
PLAIN = 0x93A0B4FF


class EventLog(Layer):
    """The log, whose level tells transmissions from decisions, and the bar of phases."""

    def __init__(self) -> None:
        self._lines: list[tuple[Moment, str, str, int]] = []
        self._phases: list[tuple[Moment, str]] = []
        self._phase = ""

    def run_started(self, state: FleetState) -> None:
        """Nothing has been said."""
        self._state = state

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """An event, and who is told."""
        x, y = self._state.sites[event]
        self._phase = ""
        self._decide(
            at, f"event {event + 1} at ({x:.2f}, {y:.2f}) m, r{source} is told", EVENT_COLOUR
        )

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """A transmission, and what it says about a decision."""
        if line.kind == "route-face" and self._phase != "route-face":
            self._decide(
                at,
                f"r{line.sender} is nearer than its neighbours{self._off(line)}: face routing",
                kind_colour(line.kind),
            )
        elif line.kind == "call" and self._phase != "call":
            self._decide(at, f"r{line.sender} calls an auction", kind_colour(line.kind))
        self._enter(at, line.kind)
        colour = WINNER_TEXT if line.kind == "assign" else kind_colour(line.kind)
        self._lines.append((at, say(line), SAID, colour if line.heard else LOST_COLOUR))

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """Who goes."""
        winner, bids = award.winner, award.bids
        for robot, (x, y) in award.moves:
            self._decide(at, f"r{robot} is sent to ({x:.2f}, {y:.2f}) m", RELOCATION_COLOUR)
        if winner is None and award.moves:
            return
        if winner is None:
            self._decide(at, f"r{award.auctioneer} finds nobody who can go", EVENT_COLOUR, FAILED)
            return
        among = f"of {len(bids)} bids" if len(bids) > 1 else "the only bid"
        cost = next((f"{cost:.2f}, " for cost, robot in bids if robot == winner), "")
        self._decide(at, f"r{winner} wins: {cost}{among}", WINNER_TEXT)

    def broken_off(self, at: Moment, event: int, reason: str) -> None:
        """Nothing came of it."""
        self._decide(at, f"event {event + 1}: nothing came of it, {reason}", EVENT_COLOUR, FAILED)

    def event_closed(self, at: Moment, event: int, outcome: str) -> None:
        """What was not served."""
        if outcome != "served":
            self._decide(at, f"event {event + 1}: {outcome}", EVENT_COLOUR, FAILED)

    def departed(self, at: Moment, robot: RobotId) -> None:
        """Off it goes."""
        self._enter(at, MOTION)

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """How it went."""
        took = f"{trip.ended - trip.departed:.2f} s, {trip.path:.2f} m, {trip.energy:.2f} J"
        relocated = trip.outcome == RELOCATED
        arrived = trip.outcome == "arrived" or relocated
        self._decide(
            at,
            f"r{trip.robot} has relocated: {took}" if relocated
            else f"r{trip.robot} arrived: {took}" if arrived
            else f"r{trip.robot} did not arrive ({trip.outcome}): {took}",
            PLAIN if arrived else EVENT_COLOUR,
            DECIDED if arrived else FAILED,
        )  # fmt: skip
        if self._state.energies[trip.robot] <= 0.0:
            self._decide(at, f"r{trip.robot} is out of energy, off the air", EVENT_COLOUR, FAILED)

    def send(self, sink: Sink) -> None:
        """Log and phases."""
        if self._lines:
            when, bodies, levels, paint = zip(*self._lines, strict=True)
            sink.rows(
                LOG,
                when,
                column(rr.TextLog.descriptor_text(), texts(bodies)),
                column(rr.TextLog.descriptor_level(), texts(levels)),
                column(rr.TextLog.descriptor_color(), colours(paint)),
            )
        if self._phases:
            when, states = zip(*self._phases, strict=True)
            sink.rows(PHASE, when, column(rr.StateChange.descriptor_state(), texts(states)))
        self._lines, self._phases = [], []

    def _off(self, line: RecordedLine) -> str:
        """How far from the event the sender is."""
        site = self._state.sites.get(line.event)
        return "" if site is None else f", {dist(self._state.at(line.sender), site):.2f} m off"

    def _enter(self, at: Moment, phase: str) -> None:
        if phase != self._phase:
            self._phase = phase
            self._phases.append((at, phase))

    def _decide(self, at: Moment, text: str, colour: int, level: str = DECIDED) -> None:
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
    return f"{line.number:>6}  {label:<10} r{line.sender} → {heard}{offer}"


def describe_phases(sink: Sink) -> None:
    """Names and colours of the phases: those of the arrows."""
    sink.static(
        PHASE,
        rr.StateConfiguration(
            values=[*KIND_COLOURS, MOTION],
            labels=[*(KIND_LABELS[kind] for kind in KIND_COLOURS), MOTION],
            colors=np.array([*KIND_COLOURS.values(), MOTION_COLOUR], np.uint32),
        ),
    )
