"""What radios have in common that know their neighbours only by what they heard of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from fleet.agenda import Agenda
from fleet.radio import AirCounts, BrokenProtocol, Radio
from fleet.robot import Robot
from protocols.messages import Point, RobotId, Transmission
from worlds.arena import Arena

if TYPE_CHECKING:
    from fleet.radio.propagation import Air


@dataclass(frozen=True, kw_only=True)
class BeaconSpec:
    """How often robots beacon, and how long what was heard is believed.

    Raises:
        ValueError: a value is out of its range.
    """

    beacon_interval: float = 1.0  # [s]
    beacon_jitter: float = 0.5  # share of the interval over which beacons are spread
    validity: float = 4.5  # how long a neighbour is believed to be where it said [s]

    def __post_init__(self) -> None:
        for name in ("beacon_interval", "validity"):
            if not 0.0 < getattr(self, name) < inf:
                raise ValueError(f"radio {name} is {getattr(self, name)}; expected more than 0")
        if not 0.0 <= self.beacon_jitter <= 1.0:
            raise ValueError(f"radio beacon_jitter is {self.beacon_jitter}; expected 0 to 1")
        if self.validity < self.beacon_interval:
            raise ValueError(
                f"radio validity is {self.validity} s; expected beacon_interval,"
                f" {self.beacon_interval:g} s, or more"
            )

    @property
    def a_disc(self) -> bool:
        """Whether robots hear one another within a radius, whatever is between them."""
        return False

    def air(self, fleet: Scattered, seed: int) -> Air:
        """The physical layer between these robots; by default nothing is lost."""
        from fleet.radio import kernels

        return kernels.air(AirSpec(), fleet, seed)


@dataclass(frozen=True, kw_only=True)
class AirSpec(BeaconSpec):
    """What the air does to frames.

    A frame is lost with probability ``loss`` wherever, and besides with ``loss_at_range`` times
    (distance/range) to the power of ``falloff``. Shadowing and walls make the range of each
    link another, 10^(X/10η) times r, with path loss η: X is normal of deviation ``shadowing``
    dB, alike within ``shadow_distance``, less ``wall_loss`` dB for each obstacle on the way.

    Raises:
        ValueError: a value is out of its range.
    """

    loss: float = 0.0
    loss_at_range: float = 0.0
    falloff: float = 4.0
    shadowing: float = 0.0  # [dB]
    shadow_distance: float = 5.0  # over which shadowing's correlation falls to 1/e [m]
    path_loss: float = 3.0  # η
    wall_loss: float = 0.0  # [dB]

    def __post_init__(self) -> None:
        BeaconSpec.__post_init__(self)
        for name in ("shadowing", "wall_loss"):
            if not 0.0 <= getattr(self, name) < inf:
                raise ValueError(f"radio {name} is {getattr(self, name)}; expected 0 or more")
        for name in ("falloff", "path_loss", "shadow_distance"):
            if not 0.0 < getattr(self, name) < inf:
                raise ValueError(f"radio {name} is {getattr(self, name)}; expected more than 0")
        for name in ("loss", "loss_at_range"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ValueError(f"radio {name} is {getattr(self, name)}; expected 0 to 1")

    @property
    def a_disc(self) -> bool:
        """Whether robots hear one another within a radius, whatever is between them."""
        return self.shadowing == 0.0 and self.wall_loss == 0.0

    def air(self, fleet: Scattered, seed: int) -> Air:
        """The physical layer between these robots."""
        from fleet.radio import kernels

        return kernels.air(self, fleet, seed)


Spec = TypeVar("Spec", bound=BeaconSpec)


class Scattered(NamedTuple):
    """Robots at their starting places, as their radios find them."""

    points: Sequence[Point]  # [m]
    radio_range: float  # r [m]
    graph: str  # that they route on
    arena: Arena


class HearsayRadio(Generic[Spec]):
    """The air between robots that only know what they have heard.

    Raises:
        ValueError: the graph is one that robots cannot reduce to by what they know.
    """

    takes_time = True
    instant: None = None

    def __init__(self, spec: Spec, fleet: Scattered, seed: int, agenda: Agenda) -> None:
        from fleet.radio import kernels
        from protocols.topology.cells import cells_over, put
        from protocols.topology.neighbourhood import GRAPHS

        robots, radio_range = fleet.points, fleet.radio_range
        if fleet.graph not in GRAPHS:
            raise ValueError(
                f"graph is {fleet.graph!r}, which no robot can tell from its neighbours alone;"
                f" expected {', '.join(map(repr, GRAPHS))}, or radio ideal"
            )
        self.spec = spec
        self.beacons = 0
        self.agenda = agenda
        self._kernels = kernels
        self.reach, self.disc = radio_range, spec.a_disc
        self.air = spec.air(fleet, seed)
        n = len(robots)
        self._put = put
        self.places = cells_over(robots, 0.5 * radio_range)
        for robot, position in enumerate(robots):
            put(self.places, robot, *position)
        self.on_air = np.ones(n, np.bool_)
        degree = n * np.pi * kernels.propagation.farthest(self.air) ** 2 / _area(robots)
        capacity = int(min(max(32, 3 * degree), n))
        mutual = not spec.a_disc
        heard = kernels.tables.nothing_heard(n, capacity, spec.validity, mutual=mutual)
        self.tables = kernels.tables.HearsayTables(heard, GRAPHS[fleet.graph], self._where)
        self._now = 0.0
        greetings = 2 if mutual else 1  # who is to list whom it hears must have heard them
        self._rota = kernels.beacons.rota(
            self.air, n, spec.beacon_interval, spec.beacon_jitter, greetings
        )
        self._announce(0.0)  # everybody has said hello before the run begins

    def refresh(self, moved: Iterable[Robot], time: float) -> None:
        """Robots are where they are now; beacons up to ``time`` [s] have been sent."""
        for robot in moved:
            self._put(self.places, robot.id, *robot.position)
        self.beacon(time)

    def counts(self) -> AirCounts:
        """What went over the air so far."""
        return AirCounts(self.beacons)

    def hearers(self, robot: RobotId) -> list[RobotId]:
        """Who hears the robot where it is now, if nothing is lost; ascending."""
        count = self._kernels.beacons.hearers(self.air, self.places, robot, self.on_air)
        return sorted(self.places.near[:count].tolist())

    def silence(self, robot: Robot) -> None:
        """The robot neither sends nor hears. Its neighbours will find out."""
        self.on_air[robot.id] = False

    def restore(self, robot: Robot) -> None:
        """The robot sends and hears again."""
        self.on_air[robot.id] = True

    def beacon(self, time: float) -> None:
        """It is ``time`` [s] now; beacons that were due until now have been sent."""
        self._announce(time)

    def _announce(self, time: float) -> None:
        """Send the beacons that are due up to ``time`` [s], each heard but by chance."""
        self._now = time
        self.beacons += self._kernels.beacons.beacons_until(
            time, self.air, self._rota, self.places, self.tables.heard, self.on_air
        )

    def note(self, robot: RobotId, other: RobotId) -> None:
        """The robot hears where the other is now."""
        x, y = self.places.x[other], self.places.y[other]
        self._kernels.tables.note(self.tables.heard, robot, other, x, y, self._now)

    def forget(self, robot: RobotId, other: RobotId) -> None:
        """The robot strikes the other off."""
        self._kernels.tables.forget(self.tables.heard, robot, other)

    def check_receiver(self, transmission: Transmission) -> None:
        """Refuse what is addressed to no other robot.

        Raises:
            BrokenProtocol: it is.
        """
        sender, receiver = transmission.sender, transmission.receiver
        if receiver == sender or receiver is None or not 0 <= receiver < len(self.on_air):
            raise BrokenProtocol(f"{transmission} is addressed to no other robot")

    def _where(self, robot: RobotId) -> tuple[float, float, float]:
        return self.places.x[robot], self.places.y[robot], self._now


def _area(positions: Sequence[Point]) -> float:
    """Of the box around all robots, at least a metre wide each way [m²]."""
    places = np.array(positions).reshape(-1, 2)
    span = np.maximum(np.ptp(places, axis=0), 1.0)
    return float(span[0] * span[1])


class RadioParameters(Protocol):
    """The parameters of a radio that robots know one another by."""

    def over(self, fleet: Scattered, seed: int, agenda: Agenda) -> Radio:
        """The radio of this kind among these robots.

        Raises:
            ValueError: they cannot tell their routing graph from what they hear.
        """
