"""A radio that takes time, loses frames, and knows its neighbours only by their beacons.

Neighbours are valid for a while after they were heard; one that does not acknowledge is struck
off. Every frame carries its sender's position, so that whoever hears it knows that too.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TypeVar

from fleet.agenda import Agenda
from fleet.radio import Received, Reception
from fleet.radio.hearsay import AirSpec, BeaconSpec, HearsayRadio, Scattered
from protocols.messages import RobotId, Transmission


@dataclass(frozen=True, kw_only=True)
class Repetition(BeaconSpec):
    """How long frames take, and how often they are sent again.

    Raises:
        ValueError: a value is out of its range.
    """

    latency: float = 0.005  # of a frame that gets through, acknowledgement included [s]
    timeout: float = 0.02  # until a frame that was not acknowledged is sent again [s]
    retries: int = 3  # further attempts for a frame that was not acknowledged

    def __post_init__(self) -> None:
        BeaconSpec.__post_init__(self)
        for name in ("latency", "timeout"):
            if not 0.0 <= getattr(self, name) < inf:
                raise ValueError(f"radio {name} is {getattr(self, name)}; expected 0 or more")
        if not 0 <= self.retries <= 30:
            raise ValueError(f"radio retries is {self.retries}; expected 0 to 30")


@dataclass(frozen=True, kw_only=True)
class RadioSpec(AirSpec, Repetition):
    """What the lossy radio does to frames: see its bases.

    Raises:
        ValueError: a value is out of its range.
    """

    def __post_init__(self) -> None:
        AirSpec.__post_init__(self)
        Repetition.__post_init__(self)

    def over(self, fleet: Scattered, seed: int, agenda: Agenda) -> LossyRadio[RadioSpec]:
        """The radio of this kind among these robots; see the base class."""
        return LossyRadio(self, fleet, seed, agenda)


Repeating = TypeVar("Repeating", bound=Repetition)


class LossyRadio(HearsayRadio[Repeating]):
    """Frames are lost one by one, each by chance of its own; the air has room for all."""

    _frames = 0

    def send(self, transmission: Transmission, time: float, done: Received) -> None:
        """Send it now; what becomes of it is told at once, and when its sender knows."""
        done(self.transmit(transmission, time), time)

    def transmit(self, transmission: Transmission, time: float) -> Reception:
        """Send it, again if it must be; whoever hears it knows where the sender is."""
        self._frames += 1
        self.beacon(time)
        sender, receiver = transmission.sender, transmission.receiver
        if receiver is None:
            return Reception(self._broadcast(sender), self.spec.latency)
        self.check_receiver(transmission)
        attempts = self.spec.retries + 1
        used = -attempts
        if self.on_air[receiver]:
            x, y = self.places.x, self.places.y
            used = self._kernels.propagation.unicast(
                self.air, self._frames, attempts, sender, receiver,
                x[sender], y[sender], x[receiver], y[receiver],
            )  # fmt: skip
        delay = (abs(used) - 1) * self.spec.timeout + self.spec.latency
        if used > 0:
            self.note(receiver, sender)
            self.note(sender, receiver)
            return Reception((receiver,), delay, used)
        self.forget(sender, receiver)
        return Reception((), delay, -used)

    def _broadcast(self, sender: RobotId) -> tuple[RobotId, ...]:
        frame = 64 * self._frames
        count = self._kernels.beacons.broadcast(self.air, self.places, frame, sender, self.on_air)
        linked = self.tables[sender]
        heard: list[RobotId] = self.places.near[:count].tolist()
        for robot in heard:
            self.note(robot, sender)
        return tuple(sorted(robot for robot in heard if robot in linked))
