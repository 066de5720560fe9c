"""A card for the event in focus, its outcome first: who goes and why, and what it cost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import rerun as rr

from fleet.replay.columns import Moment, column, texts
from fleet.replay.journal import RELOCATED, RecordedLine, TripEnd
from fleet.replay.layers import card_words as words
from fleet.replay.scheme import CARD
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer, OpenConversation
from protocols.messages import Award, RobotId


class EventCard(Layer):
    """The card of the event in focus; it grows as its conversation goes on."""

    def __init__(self) -> None:
        self._rows: list[tuple[Moment, str]] = []
        self._told: dict[int, str] = {}  # by event: how it became known
        self._outcomes: dict[int, tuple[str, list[str]]] = {}  # by event: title, and what follows

    def run_started(self, state: FleetState) -> None:
        """A card to begin with."""
        self._state = state
        self._rows.append((Moment(0.0, 0, 0, 0.0), title_card(state)))

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """What has happened, and who knows."""
        state = self._state
        talk = state.conversations[event]
        self._told[event] = words.where(state.tasks.get(event), talk, state.at(source))
        self._outcomes.pop(event, None)

    def focused(self, at: Moment) -> None:
        """Another event; the card of one that is over stays until there is."""
        focus = self._state.in_focus
        if focus is not None:
            self._draw(at, focus)

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """The search is over when the first call is made."""
        focus = self._state.in_focus
        if focus is not None and line.event == focus.event and line.kind == "call":
            self._first_call(at, focus)

    def _first_call(self, at: Moment, talk: OpenConversation) -> None:
        if talk.calls == 1:
            self._draw(at, talk)

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """Who bid what, and who goes."""
        state = self._state
        talk, winner = state.conversations[event], award.winner
        sent = [
            f"**r{robot}** is sent to ({x:.2f}, {y:.2f}) m, "
            f"to {'carry the event on' if winner is None else 'keep the fleet connected'}."
            for robot, (x, y) in award.moves
        ]
        if winner is not None:
            outcome = f"r{winner} goes"
            more = [words.belief(state.scene, talk, winner, state.at(winner)), *sent]
        elif award.moves:
            outcome, more = "carried on", sent
        else:
            outcome, more = "nobody goes", [words.nobody(talk, award)]
        table = [words.bids(state.scene, talk, award)] if award.bids else []
        self._outcomes[event] = outcome, [" ".join(filter(None, more)), *table]
        self._draw_if_focused(at, talk)

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """What it came to."""
        talk = self._state.conversations.get(event)
        if trip.outcome == RELOCATED or talk is None:
            return
        verb = "arrived" if trip.outcome == "arrived" else f"did not arrive: {trip.outcome}"
        left = float(self._state.energies[trip.robot])
        came = words.driven(self._state.scene, trip, talk.beliefs.get(trip.robot), left)
        _, before = self._outcomes.get(event, ("", []))
        self._outcomes[event] = f"r{trip.robot} {verb}", [came, *before]
        self._draw_if_focused(at, talk)

    def broken_off(self, at: Moment, event: int, reason: str) -> None:
        """Nothing came of it."""
        self._outcomes[event] = "nothing came of it", [f"The talk broke off: {reason}."]
        self._draw_if_focused(at, self._state.conversations[event])

    def event_closed(self, at: Moment, event: int, outcome: str) -> None:
        """What was not served; and nothing more will be said of it."""
        talk = self._state.conversations.get(event)
        if outcome != "served" and talk is not None:
            self._outcomes[event] = outcome, self._outcomes.get(event, ("", []))[1]
            self._draw_if_focused(at, talk)
        if event != self._state.focus:
            self._told.pop(event, None)
        self._outcomes.pop(event, None)

    def run_ended(self, at: Moment, summary: Mapping[str, Any] | None) -> None:
        """How far the recording goes."""
        if summary is None:
            text = f"## The run broke off at {at.time:.2f} s\n\n{title_card(self._state)}"
            self._rows.append((at, text))

    def send(self, sink: Sink) -> None:
        """The cards."""
        if self._rows:
            when, cards = zip(*self._rows, strict=True)
            sink.rows(CARD, when, column(rr.TextDocument.descriptor_text(), texts(cards)))
        self._rows = []

    def _draw_if_focused(self, at: Moment, talk: OpenConversation) -> None:
        if talk.event == self._state.focus:
            self._draw(at, talk)

    def _draw(self, at: Moment, talk: OpenConversation) -> None:
        outcome, parts = self._outcomes.get(talk.event, ("", []))
        how = [self._told.get(talk.event, "")]
        auctioneer = talk.auctioneer
        if auctioneer is not None:
            place = self._state.at(auctioneer)
            how.append(words.found(self._state.scene, talk, auctioneer, place))
            how.append(words.asked(talk, auctioneer))
        title = f"## Event {talk.event + 1}{': ' + outcome if outcome else ''}"
        self._rows.append((at, "\n\n".join([title, *parts, " ".join(how)])))


def title_card(state: FleetState) -> str:
    """Which run it is."""
    scene = state.scene
    metric = f", bids are worth `{scene.metric}`" if scene.metric else ""
    return (
        f"## {scene.protocol}: {state.n} robots, {scene.world}, seed {scene.seed}\n\n"
        f"Motion `{scene.motion}`{metric}; a trip is believed to cost"
        f" {words.BELIEFS.get(scene.belief, scene.belief)}.\n\n"
        "*How to read* explains the picture."
    )
