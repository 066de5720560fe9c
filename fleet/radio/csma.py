"""A radio on which robots take turns: carrier sense, back-off, collisions, acknowledgements.

Frames have a length and take their time at a bit rate; those that overlap drown one another
(:mod:`fleet.radio.medium`), also where senders cannot hear each other. Beacons and messages
compete for the same air. A sender that gets no acknowledgement does not know whether it was
heard: it looks for another way, whatever has become of the frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import ceil, inf
from typing import Literal

import numpy as np

from fleet.agenda import Action, Agenda
from fleet.radio import AirCounts, Received, Reception
from fleet.radio.access import Timing
from fleet.radio.hearsay import AirSpec, HearsayRadio, Scattered
from fleet.radio.stations import Delivery, Standard, Stations
from protocols.messages import Kind, RobotId, Transmission

SECOND = 1_000_000_000  # [ns]
MICROSECOND = 1_000  # [ns]

BYTES: dict[Kind | Literal["beacon", "listed"], int] = {
    "beacon": 8,  # where its sender is: two single precision numbers
    "listed": 2,  # each robot that a beacon lists
    "route-greedy": 18,  # event and its place, sender's place
    "route-face": 34,  # and where the face was entered, and by which edge
    "call": 24,  # as greedy, with the bid to beat
    "bid": 16,  # event, sender's place, cost and robot
    "assign": 18,
}
"""Payload of a frame, by what it says; a header of the standard's comes on top."""


@dataclass(frozen=True, slots=True)
class _Named:
    """What a standard says, for all but the air."""

    timing: Timing
    rate: float  # [bit/s]
    header: int  # of a frame, checksum included [bytes]
    distributed: bool
    retries: int


STANDARDS = {
    # IEEE 802.15.4-2020, 2.4 GHz O-QPSK: tables 8-93 and 8-94, 10.1.3, 11.1, 12.1; symbols of
    # 16 µs; header with short addresses in one network
    "802.15.4": _Named(
        Timing(
            slot=320 * MICROSECOND,
            sense=128 * MICROSECOND,
            turnaround=192 * MICROSECOND,
            acknowledgement=352 * MICROSECOND,
            patience=864 * MICROSECOND,
            preamble=192 * MICROSECOND,
            least=8,
            most=32,
            looks=4,
        ),
        rate=250e3,
        header=11,
        distributed=False,
        retries=3,
    ),
    # IEEE 802.11-2020, DSSS, section 15: long preamble, 1 Mbit/s
    "802.11b": _Named(
        Timing(
            slot=20 * MICROSECOND,
            sense=50 * MICROSECOND,
            turnaround=10 * MICROSECOND,
            acknowledgement=304 * MICROSECOND,
            patience=334 * MICROSECOND,
            preamble=192 * MICROSECOND,
            least=32,
            most=1024,
            looks=0,
        ),
        rate=1e6,
        header=36,
        distributed=True,
        retries=6,
    ),
}


@dataclass(frozen=True, kw_only=True)
class CsmaSpec(AirSpec):
    """Which standard robots take turns by, and when frames drown: see the base class, too.

    Raises:
        ValueError: a value is out of its range.
    """

    standard: Literal["802.15.4", "802.11b"] = "802.15.4"
    rate: float | None = None  # [bit/s]; None: the standard's
    retries: int | None = None  # further attempts for a frame that was not acknowledged
    capture: float = 3.0  # signal over interference from which a frame is received [dB]
    sensing: float = 0.0  # from how far above the weakest that is received air is busy [dB]

    def __post_init__(self) -> None:
        AirSpec.__post_init__(self)
        if self.standard not in STANDARDS:
            names = " or ".join(STANDARDS)
            raise ValueError(f"radio standard is {self.standard!r}; expected {names}")
        if self.rate is not None and not 1e3 <= self.rate <= 1e9:
            raise ValueError(f"radio rate is {self.rate} bit/s; expected 1e3 to 1e9")
        if self.retries is not None and not 0 <= self.retries <= 30:
            raise ValueError(f"radio retries is {self.retries}; expected 0 to 30")
        if not 0.0 < self.capture < inf:
            raise ValueError(f"radio capture is {self.capture} dB; expected more than 0")
        if not -inf < self.sensing < inf:
            raise ValueError(f"radio sensing is {self.sensing} dB; expected a number")

    def over(self, fleet: Scattered, seed: int, agenda: Agenda) -> CsmaRadio:
        """The radio of this kind among these robots; see the base class."""
        return CsmaRadio(self, fleet, seed, agenda)

    def as_standard(self) -> Standard:
        """The standard, with what was asked to be different."""
        named = STANDARDS[self.standard]
        rate = self.rate or named.rate
        return Standard(
            named.timing,
            ceil(SECOND / rate),
            named.distributed,
            named.retries if self.retries is None else self.retries,
            10.0 ** (self.capture / 10.0),
            10.0 ** (self.sensing / 10.0),
        )


class CsmaRadio(HearsayRadio[CsmaSpec]):
    """The shared air between robots."""

    def __init__(self, spec: CsmaSpec, fleet: Scattered, seed: int, agenda: Agenda) -> None:
        super().__init__(spec, fleet, seed, agenda)
        standard = spec.as_standard()
        n = len(fleet.points)
        self._header = STANDARDS[spec.standard].header
        self._power = np.zeros(n + 1)
        self._weakest = min(1.0 / standard.capture, standard.sensing)
        self._draws = [0] * n
        self.doubts = 0  # frames that were heard, though their senders do not know
        self.stations = Stations(
            n, self._audible, self._survives, standard, self._schedule, self._draw
        )
        self._await_beacon()

    def send(self, transmission: Transmission, time: float, done: Received) -> None:
        """Send it once the air is free; ``done`` is told when its sender gives up or knows."""
        self.beacon(time)
        if transmission.receiver is not None:
            self.check_receiver(transmission)
        bits = 8 * (self._header + BYTES.get(transmission.kind, BYTES["call"]))
        self.stations.send(
            transmission.sender,
            transmission.receiver,
            bits,
            partial(self._delivered, transmission, done),
            round(time * SECOND),
        )

    def counts(self) -> AirCounts:
        """What went over the air so far; see the base class."""
        medium = self.stations.medium
        return AirCounts(self.beacons, medium.frames, medium.overlapped, self.doubts)

    def beacon(self, time: float) -> None:
        """It is ``time`` [s] now; beacons go by the agenda."""
        self._now = time

    def _delivered(self, transmission: Transmission, done: Received, delivery: Delivery) -> None:
        """A frame is dealt with: who heard it knows where its sender is."""
        now = delivery.end / SECOND
        self.beacon(now)
        sender, receiver = transmission.sender, transmission.receiver
        heard = tuple(robot for robot in delivery.heard if self.on_air[robot])
        linked = self.tables[sender] if receiver is None else ()
        for robot in heard:
            self.note(robot, sender)
        if receiver is None:
            heard = tuple(robot for robot in heard if robot in linked)
        elif delivery.known:
            self.note(sender, receiver)
        else:
            self.forget(sender, receiver)
            if heard:
                self.doubts += 1
            if transmission.kind.startswith("route"):
                heard = ()  # its sender looks for another way
        done(Reception(heard, 0.0, delivery.attempts), now)

    def _await_beacon(self) -> None:
        """Put down the next beacon that is due."""
        rota = self._rota
        if len(rota.order):
            self.agenda.at(float(rota.due[rota.order[0]]), self._send_beacon)

    def _send_beacon(self) -> None:
        rota, heard = self._rota, self.tables.heard
        now = float(rota.due[rota.order[0]])
        robot = self._kernels.beacons.postponed(rota, self.air.seed)
        if self.on_air[robot]:
            self.beacons += 1
            listed = int(heard.size[robot]) if heard.told.shape[1] else 0
            bits = 8 * (self._header + BYTES["beacon"] + BYTES["listed"] * listed)
            done = partial(self._beaconed, robot)
            self.stations.send(robot, None, bits, done, round(now * SECOND))
        self._await_beacon()

    def _beaconed(self, robot: RobotId, delivery: Delivery) -> None:
        self.beacon(delivery.end / SECOND)
        self._kernels.tables.tell(self.tables.heard, robot)
        for other in delivery.heard:
            if self.on_air[other]:
                self.note(other, robot)

    def _schedule(self, time: int, action: Action) -> None:
        self.agenda.at(time / SECOND, action)

    def _draw(self, robot: RobotId, most: int) -> int:
        """Below ``most``, by the robot's own chance."""
        self._draws[robot] += 1
        p = self._kernels.propagation
        return int(most * p.chance(self.air.seed, p.BACKOFF, robot, self._draws[robot], 0))

    def _audible(self, sender: RobotId) -> list[tuple[RobotId, float]]:
        """Whom a frame matters to, and how strong it is there."""
        count = self._kernels.beacons.audible(
            self.air, self.places, sender, self.on_air, self._weakest, self._power
        )
        return list(
            zip(self.places.near[:count].tolist(), self._power[:count].tolist(), strict=True)
        )

    def _survives(self, sender: RobotId, receiver: RobotId, frame: int) -> bool:
        """Whether a frame survives what may befall it besides collisions."""
        if not self.spec.loss and not self.spec.loss_at_range:
            return True
        x, y = self.places.x, self.places.y
        here, there = (x[sender], y[sender]), (x[receiver], y[receiver])
        p = self._kernels.propagation
        share = float(np.hypot(here[0] - there[0], here[1] - there[1])) / p.reach(
            self.air, *here, *there
        )
        return bool(p.survives(self.air, frame, sender, receiver, share))
