"""The conversation: every transmission as an arrow, and who has taken which part in it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from fleet.replay.columns import Moment, colours, column, pairs
from fleet.replay.journal import RELOCATED, RecordedLine, TripEnd
from fleet.replay.scheme import (
    AUCTIONEER_COLOUR,
    CALLED_COLOUR,
    LOST,
    PACKET,
    PACKET_COLOUR,
    RINGS,
    SOURCE_COLOUR,
    WINNER_COLOUR,
    arrow_colour,
    kind_colour,
    messages,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import KINDS, Award, RobotId

RIM = 1.7  # where arrows begin and end, in radii of a robot from its middle
LANE = 0.4  # how far they keep to the right, in radii of a robot
MANY_ARROWS = 48  # of one kind; see Growing

Segment: TypeAlias = tuple[float, float, float, float]  # from x, y to x, y [m]


class Growing:
    """A list that grows row by row, such as the arrows of one kind in one conversation.

    Writing the whole list at every step would cost the square of its length. So a list that
    got long is only rewritten every so often; what came since is ``loose``, to be drawn
    elsewhere.
    """

    def __init__(self) -> None:
        self.rows: list[tuple[Moment, int, int]] = []  # when, from where to where in `items`
        self.items: list[Segment] = []
        self._start = 0
        self._drawn = 0  # where the latest row ended

    @property
    def loose(self) -> list[Segment]:
        """What no row shows yet."""
        return self.items[self._drawn :]

    def restart(self, at: Moment) -> None:
        """Empty it."""
        if len(self.items) > self._start:
            self._start = self._drawn = len(self.items)
            self.rows.append((at, self._start, self._start))

    def extend(self, at: Moment, new: Sequence[Segment]) -> None:
        """Add to it."""
        self.items.extend(new)
        if len(self.items) - self._drawn >= (len(self.items) - self._start) // MANY_ARROWS:
            self.complete(at)

    def complete(self, at: Moment) -> None:
        """Leave nothing loose."""
        if self._drawn < len(self.items):
            self._drawn = len(self.items)
            self.rows.append((at, self._start, self._drawn))

    def forget(self) -> None:
        """Drop what has been sent, but for the list as it stands."""
        self.items = self.items[self._start :]
        self._drawn -= self._start
        self._start = 0
        self.rows = []


class Arrows(Layer):
    """Arrows by kind, the transmission at the cursor, and rings around those involved.

    All of it is about the event in focus, but for the transmission at the cursor.
    """

    def __init__(self) -> None:
        self._arrows = {kind: Growing() for kind in (*(messages(kind) for kind in KINDS), LOST)}
        self._latest = Growing()  # the arrows that were added to last
        self._packets: list[tuple[Moment, list[tuple[Segment, int]]]] = []
        self._rings: list[tuple[Moment, list[tuple[float, float, int]]]] = []
        self._parts: dict[RobotId, tuple[float, float, int]] = {}

    def run_started(self, state: FleetState) -> None:
        """Nobody has spoken."""
        self._state = state

    def focused(self, at: Moment) -> None:
        """The floor is cleared, and what has been said about the event drawn."""
        for growing in self._arrows.values():
            growing.restart(at)
        self._parts.clear()
        self._packets.append((at, []))
        conversation = self._state.in_focus
        if conversation is not None:
            self._part(conversation.source, SOURCE_COLOUR)
            for line in conversation.lines:
                path, new = self._aims(line)
                self._arrows.setdefault(path, Growing()).extend(at, new)
                self._involve(line)
            self._complete(at)
        self._draw_rings(at)

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """One more arrow, or several if it was a broadcast."""
        path, new = self._aims(line)
        shown = [(arrow, PACKET_COLOUR) for arrow in new]
        if line.event != self._state.focus:
            self._packets.append((at, shown))
            return
        growing = self._arrows.setdefault(path, Growing())
        if growing is not self._latest:
            self._latest.complete(at)
            self._latest = growing
        loose, colour = growing.loose, arrow_colour(path)
        growing.extend(at, new)
        self._packets.append((at, [*((arrow, colour) for arrow in loose), *shown]))
        if self._involve(line):
            self._draw_rings(at)

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """The winner stands out."""
        self._hush(at)
        if event != self._state.focus:
            return
        self._complete(at)
        self._part(award.auctioneer, AUCTIONEER_COLOUR)
        if award.winner is not None:
            self._part(award.winner, WINNER_COLOUR)
        self._draw_rings(at)

    def broken_off(self, at: Moment, event: int, reason: str) -> None:
        """Nobody speaks of it any more."""
        if event == self._state.focus:
            self._complete(at)
        self._hush(at)

    def departed(self, at: Moment, robot: RobotId) -> None:
        """Who is under way is drawn as a mover."""
        if self._parts.pop(robot, None) is not None:
            self._draw_rings(at)

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """The one who went, where it stands now."""
        if trip.outcome != RELOCATED and event == self._state.focus:
            self._part(trip.robot, WINNER_COLOUR)
            self._draw_rings(at)

    def send(self, sink: Sink) -> None:
        """Arrows, packets, rings."""
        for path, growing in self._arrows.items():
            if growing.rows:
                when, starts, ends = zip(*growing.rows, strict=True)
                picked = [np.arange(a, b) for a, b in zip(starts, ends, strict=True)]
                ends_of = np.array(growing.items, float).reshape(-1, 4)
                self._send_arrows(
                    sink, path, when, ends_of[np.concatenate(picked)], [*map(len, picked)]
                )
            growing.forget()
        if self._packets:
            when, rows = zip(*self._packets, strict=True)
            flat = np.array([arrow for row in rows for arrow, _ in row], float).reshape(-1, 4)
            counts = [len(row) for row in rows]
            paint = colours([colour for row in rows for _, colour in row])
            tint = column(rr.Arrows2D.descriptor_colors(), paint, counts)
            self._send_arrows(sink, PACKET, when, flat, counts, tint)
        if self._rings:
            when, rows = zip(*self._rings, strict=True)
            marks = np.array([ring for row in rows for ring in row], float).reshape(-1, 3)
            counts = [len(row) for row in rows]
            sink.rows(
                RINGS,
                when,
                column(rr.Points2D.descriptor_positions(), pairs(marks[:, :2]), counts),
                column(rr.Points2D.descriptor_colors(), colours(marks[:, 2]), counts),
            )
        self._packets, self._rings = [], []

    def _send_arrows(
        self, sink: Sink, path: str, when: Sequence[Moment], ends: NDArray[np.float64],
        counts: list[int], *more: rr.ComponentColumn,
    ) -> None:  # fmt: skip
        origins, vectors = rim_to_rim(ends, self._state.mark)
        sink.rows(
            path,
            when,
            column(rr.Arrows2D.descriptor_origins(), pairs(origins), counts),
            column(rr.Arrows2D.descriptor_vectors(), pairs(vectors), counts),
            *more,
        )

    def _aims(self, line: RecordedLine) -> tuple[str, list[Segment]]:
        """Where a transmission is drawn, and from where to where."""
        speaker = self._state.at(line.sender)
        if line.heard:
            return messages(line.kind), [(*speaker, *self._state.at(r)) for r in line.heard]
        aim = speaker if line.receiver is None else self._state.at(line.receiver)
        return LOST, [(*speaker, *aim)]

    def _complete(self, at: Moment) -> None:
        for growing in self._arrows.values():
            growing.complete(at)

    def _hush(self, at: Moment) -> None:
        """No transmission is at the cursor; at the last message, it still stands out."""
        self._packets.append((at._replace(msg=at.msg + 1), []))

    def _involve(self, line: RecordedLine) -> bool:
        """A ring for who took part: the latest part of the sender, or being called."""
        parts = self._parts
        was, size = parts.get(line.sender), len(parts)
        if line.kind == "call":
            self._part(line.sender, AUCTIONEER_COLOUR)
            for robot in line.heard:
                parts.setdefault(robot, (*self._state.at(robot), CALLED_COLOUR))
        elif line.kind != "assign" and not (line.kind == "bid" and line.bidder != line.sender):
            self._part(line.sender, kind_colour(line.kind))
        return was != parts.get(line.sender) or size != len(parts)

    def _part(self, robot: RobotId, colour: int) -> None:
        self._parts[robot] = (*self._state.at(robot), colour)

    def _draw_rings(self, at: Moment) -> None:
        self._rings.append((at, list(self._parts.values())))


def rim_to_rim(
    ends: NDArray[np.float64], mark: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Origins and vectors (k, 2) [m] of arrows between ``ends`` (k, 4), robots of radius ``mark``.

    They keep off the robots' middles, and to the right, so that a call and the bid that answers
    it lie side by side.
    """
    along = ends[:, 2:] - ends[:, :2]
    length = np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-9)
    cut = np.minimum(RIM * mark / length, 0.4)[:, None]
    right = np.column_stack([along[:, 1], -along[:, 0]]) * (LANE * mark / length)[:, None]
    return ends[:, :2] + cut * along + right, (1.0 - 2.0 * cut) * along
