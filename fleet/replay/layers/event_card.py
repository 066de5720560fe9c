"""A card for every round: who was asked, who bid what, who went and why, and what it cost."""

from __future__ import annotations

from math import dist

import rerun as rr

from fleet.replay.columns import Moment, column, texts
from fleet.replay.journal import RELOCATED, RecordedLine, TripEnd
from fleet.replay.scheme import CARD
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer, OpenConversation
from protocols.messages import Award, Bid, RobotId

MANY_BIDS = 5  # shown
MANY_ASKED = 12  # named


class EventCard(Layer):
    """The card of the latest round; it grows as the round goes on."""

    def __init__(self) -> None:
        self._rows: list[tuple[Moment, str]] = []
        self._told: dict[int, list[str]] = {}  # by event: sentences about the search
        self._bids: dict[int, str] = {}  # by event: the table

    def run_started(self, state: FleetState) -> None:
        """A card to begin with."""
        self._state = state
        scene = state.scene
        self._rows.append(
            (
                Moment(0.0, 0, 0),
                (
                    f"## {state.n} robots, {scene.protocol}\n\n"
                    f"World `{scene.world}`, motion `{scene.motion}`, seed {scene.seed}.\n\n"
                    "Nothing has happened yet. *How to read* explains the picture."
                ),
            )
        )

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """What has happened, and who knows."""
        state = self._state
        x, y = state.sites[event]
        away = dist(state.at(source), state.sites[event])
        where = f"At **({x:.2f}, {y:.2f}) m**."
        self._told[event] = [f"{where} Collector **r{source}**, {away:.2f} m away, is told of it."]
        self._draw(at, event, f"Event {event + 1}")

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """The search is over when the first call is made."""
        conversation = self._state.conversations.get(line.event)
        if line.kind == "call" and conversation is not None and conversation.calls == 1:
            asked = f"**r{line.sender}** asks {_names(line.heard)} for bids."
            self._told[line.event].append(self._search(conversation, line.sender))
            self._draw(at, line.event, f"Event {line.event + 1}", asked)

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """Who bid what, and who goes."""
        state, conversation, told = self._state, self._state.conversations[event], self._told[event]
        if not conversation.calls:
            told.append(self._search(conversation, award.auctioneer))
        asked = tuple(conversation.parents)
        if asked:
            told.append(f"**r{award.auctioneer}** asked {_names(asked)}.")
        for robot, (x, y) in award.moves:
            why = "to carry the event on" if award.winner is None else "to keep the fleet connected"
            told.append(f"**r{robot}** is sent to ({x:.2f}, {y:.2f}) m, {why}.")
        winner, bids = award.winner, award.bids
        if winner is None and award.moves:
            self._draw(at, event, f"Event {event + 1} is carried on")
            return
        if winner is None:
            told.append("**Nobody can go**: all who were asked believe that they lack the energy.")
            self._draw(at, event, f"Event {event + 1}: nobody can go")
            return
        self._bids[event] = self._table(conversation, winner, bids)
        need, held = state.foreseen(winner, conversation.site), float(state.energies[winner])
        self._draw(
            at,
            event,
            f"Event {event + 1}: r{winner} goes",
            self._bids[event],
            f"Eq. (1) foresees **{need:.1f} J** of the {held:.1f} J that r{winner} holds,"
            f" for {dist(state.at(winner), conversation.site):.2f} m.",
        )

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """What it came to."""
        if trip.outcome == RELOCATED:
            return
        straight = dist(trip.origin, trip.site)
        foreseen = self._state.scene.per_metre * straight
        over = f" ({100.0 * (trip.energy / foreseen - 1.0):+.1f} %)" if foreseen > 0.0 else ""
        outcome = (
            f"| r{trip.robot} | way | energy | time | left |\n|---|---|---|---|---|\n"
            f"| Eq. (1), straight | {straight:.2f} m | {foreseen:.1f} J | | |\n"
            f"| driven | {trip.path:.2f} m | **{trip.energy:.1f} J**{over}"
            f" | {trip.ended - trip.departed:.1f} s"
            f" | {self._state.energies[trip.robot]:.1f} J |"
        )
        verb = "arrived" if trip.outcome == "arrived" else f"did not arrive: {trip.outcome}"
        title = f"Event {event + 1}: r{trip.robot} {verb}"
        self._draw(at, event, title, self._bids[event], outcome)

    def broken_off(self, at: Moment, event: int, reason: str) -> None:
        """Nothing came of it."""
        self._draw(
            at,
            event,
            f"Event {event + 1}: nothing came of it",
            f"The talk broke off: {reason}.",
        )

    def event_closed(self, at: Moment, event: int, outcome: str) -> None:
        """What was not served; and nothing more will be said of it."""
        if outcome != "served" and event in self._told:
            self._draw(at, event, f"Event {event + 1}: {outcome}")
        self._told.pop(event, None)
        self._bids.pop(event, None)

    def send(self, sink: Sink) -> None:
        """The cards."""
        if self._rows:
            when, cards = zip(*self._rows, strict=True)
            media = ["text/markdown"] * len(cards)
            sink.rows(
                CARD,
                when,
                column(rr.TextDocument.descriptor_text(), texts(cards)),
                column(rr.TextDocument.descriptor_media_type(), texts(media)),
            )
        self._rows = []

    def _draw(self, at: Moment, event: int, title: str, *more: str) -> None:
        self._rows.append((at, "\n\n".join([f"## {title}", " ".join(self._told[event]), *more])))

    def _search(self, conversation: OpenConversation, found: RobotId) -> str:
        greedy, face = conversation.count("route-greedy"), conversation.count("route-face")
        away = dist(self._state.at(found), conversation.site)
        if not greedy + face:
            return f"It is nearest itself, **r{found}**: no hops."
        hops = f"{greedy + face} hop{'s' * (greedy + face > 1)}"
        how = f" ({greedy} greedy, {face} face)" if face else ", all greedy"
        return f"The search took **{hops}**{how} to **r{found}**, {away:.2f} m from the event."

    def _table(self, conversation: OpenConversation, winner: RobotId, bids: tuple[Bid, ...]) -> str:
        state = self._state
        title = f"{len(bids)} bids, lowest wins" if len(bids) > 1 else "the only bid"
        rows = [f"| {title} | cost | way | holds | would be left |", "|---|---|---|---|---|"]
        for cost, robot in sorted(bids)[:MANY_BIDS]:
            held, need = float(state.energies[robot]), state.foreseen(robot, conversation.site)
            name = f"**r{robot}** goes" if robot == winner else f"r{robot}"
            way = dist(state.at(robot), conversation.site)
            rows.append(
                f"| {name} | {cost:.2f} | {way:.2f} m | {held:.1f} J | {held - need:.1f} J |"
            )
        if len(bids) > MANY_BIDS:
            rows.append(f"| and {len(bids) - MANY_BIDS} more | | | | |")
        return "\n".join(rows)


def _names(robots: tuple[RobotId, ...]) -> str:
    """Some robots by name."""
    named = ", ".join(f"r{robot}" for robot in robots[:MANY_ASKED])
    if len(robots) > MANY_ASKED:
        named += f" and {len(robots) - MANY_ASKED} more"
    return f"{len(robots)} neighbour{'s' * (len(robots) != 1)} ({named})"
