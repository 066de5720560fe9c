"""Letting protocols talk: one conversation after another or many at once, over any radio."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import inf

from fleet.agenda import Agenda
from fleet.observer import Audience, Excerpt
from fleet.power import ExtraPower
from fleet.radio import BrokenProtocol, Radio, Reception, Transmit
from fleet.robot import Robot
from fleet.tally import RADIO, Tally
from fleet.tasks import Task
from protocols.messages import (
    Award,
    Conversation,
    Heard,
    ProtocolFunction,
    RobotId,
    Transmission,
    View,
)

HOPS_PER_ROBOT = 10  # after which a packet is said to go round in circles
WORDS_PER_ROBOT = 1000  # after which a protocol is said to talk for ever
RESTARTS = 3  # searches begun anew from where the packet stands, before it is given up


@dataclass(slots=True, eq=False)
class Dialogue:
    """A conversation under way."""

    task: Task
    here: RobotId  # who has the packet: the collecting robot at first
    words: Conversation
    said: int = 0
    hops: int = 0
    restarts: int = 0
    called: float = inf  # when its auction was first called [s]


Concluded = Callable[[Task, Award], None]
Broken = Callable[[Task, str], None]


@dataclass(slots=True, eq=False)
class Conversations:
    """Plays protocols over a radio, and writes down what is said.

    Over a radio that takes no time a conversation is over when :meth:`start` returns. Else it
    goes on by the agenda, while robots drive, fail, and talk about other things.
    """

    protocol: ProtocolFunction
    view: View
    robots: Sequence[Robot]
    radio: Radio
    agenda: Agenda
    tally: Tally
    audience: Audience
    energy: ExtraPower  # what frames cost
    listening: float  # how long an auctioneer waits for bids once it has called [s]
    concluded: Concluded
    broken: Broken
    under_way: int = 0
    _number: int = field(default=0, init=False)

    def start(self, task: Task, source: RobotId, now: float) -> None:
        """Tell ``source`` of the task; what it comes to is told to ``concluded``."""
        self.under_way += 1
        task.offers += 1
        self.tally.conversations += 1
        words = self.protocol(self.view, task.event, source)
        if self.radio.instant is None:
            self._go_on(Dialogue(task, source, words), None, now)
        else:
            self._play_at_once(task, words, self.radio.instant, now)

    def _play_at_once(
        self, task: Task, words: Conversation, transmit: Transmit, now: float
    ) -> None:
        """The whole conversation, over a radio that takes no time and loses nothing."""
        say, kinds, costly = words.send, self.tally.kinds, self._costly
        first, listened = self._number + 1, self.audience.listens
        most = self._number + WORDS_PER_ROBOT * len(self.robots)
        said: list[Transmission] = []
        by_whom: list[Heard] = []
        heard = None
        try:
            while True:
                transmission = say(heard)  # type: ignore[arg-type]  # None starts a generator
                heard = transmit(transmission, now).heard
                kinds[transmission.kind] += 1
                self._number += 1
                if self._number > most:
                    raise _endless(task, transmission)
                if listened:
                    said.append(transmission)
                    by_whom.append(heard)
                if costly:
                    self._charge(transmission, heard, 1)
        except StopIteration as end:
            award: Award = end.value
        except BrokenProtocol as broken:
            words.throw(broken)  # to be raised where it was said
            raise
        finally:
            if said:
                once = (1,) * len(said)
                self.audience.transmitted(Excerpt(first, now, task.event.id, said, by_whom, once))
        self.under_way -= 1
        self.concluded(task, award)

    def _go_on(self, talk: Dialogue, heard: Heard | None, now: float) -> None:
        """Play until what is on the air has been heard, or all is said."""
        say, robots = talk.words.send, self.robots
        while True:
            try:
                transmission = say(heard)  # type: ignore[arg-type]  # None starts a generator
            except StopIteration as end:
                self.under_way -= 1
                self.concluded(talk.task, end.value)
                return
            if robots[transmission.sender].on_air:
                break
            if transmission.kind not in ("bid", "call"):
                self._break(talk, f"robot {transmission.sender} fell silent")
                return
            heard = ()  # it would have said it, were it still there
        talk.said += 1
        try:
            if talk.said > WORDS_PER_ROBOT * len(robots):
                raise _endless(talk.task, transmission)
            self.radio.send(transmission, now, partial(self._sent, talk, transmission))
        except BrokenProtocol as broken:
            talk.words.throw(broken)  # to be raised where it was said
            raise

    def _sent(
        self, talk: Dialogue, transmission: Transmission, reception: Reception, now: float
    ) -> None:
        """A transmission has been made: write it down, and go on once its sender knows."""
        self.tally.kinds[transmission.kind] += 1
        self._number += 1
        attempts = reception.attempts
        self.tally.repeated += attempts - 1
        self._charge(transmission, reception.heard, attempts)
        if self.audience.listens:
            line = [transmission], [reception.heard], [attempts]
            self.audience.transmitted(Excerpt(self._number, now, talk.task.event.id, *line))
        heard = self._in_time(talk, transmission, reception.heard, now)
        self._wait(talk, heard, now + reception.delay)

    @property
    def _costly(self) -> bool:
        return self.energy.transmission > 0.0 or self.energy.reception > 0.0

    def _charge(self, transmission: Transmission, heard: Heard, attempts: int) -> None:
        """What its sender, and those who heard it, pay for a transmission."""
        sent, received = self.energy.transmission * attempts, self.energy.reception
        if sent:
            battery = self.robots[transmission.sender].battery
            self.tally.accounts[RADIO] += battery.drain(sent)
        for robot in heard if received else ():
            self.tally.accounts[RADIO] += self.robots[robot].battery.drain(received)

    def _in_time(
        self, talk: Dialogue, transmission: Transmission, heard: Heard, now: float
    ) -> Heard:
        """What counts as heard over a radio that takes time: late bids do not."""
        if not heard:
            self.tally.unheard += 1
        if transmission.kind == "call":
            talk.called = min(talk.called, now)
        elif transmission.kind == "bid" and now - talk.called > self.listening:
            return ()
        elif transmission.kind.startswith("route"):
            talk.hops += 1
            if heard:
                talk.here = heard[0]
        return heard

    def _wait(self, talk: Dialogue, heard: Heard, until: float) -> None:
        if talk.hops > HOPS_PER_ROBOT * len(self.robots):
            self.agenda.at(until, lambda: self._restart(talk, until))
        else:
            self.agenda.at(until, lambda: self._go_on(talk, heard, until))

    def _restart(self, talk: Dialogue, now: float) -> None:
        """The packet has gone round in circles: search anew from where it stands."""
        talk.words.close()
        if talk.restarts == RESTARTS or not self.robots[talk.here].on_air:
            self._break(talk, "its packet went round in circles")
            return
        talk.restarts += 1
        self.tally.restarts += 1
        talk.hops, talk.called = 0, inf
        talk.words = self.protocol(self.view, talk.task.event, talk.here)
        self._go_on(talk, None, now)

    def _break(self, talk: Dialogue, why: str) -> None:
        talk.words.close()
        self.under_way -= 1
        self.tally.broken += 1
        self.broken(talk.task, why)


def _endless(task: Task, last: Transmission) -> BrokenProtocol:
    return BrokenProtocol(
        f"the conversation about event {task.event.id} does not end; last said: {last}"
    )
