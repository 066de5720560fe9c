"""A radio that takes time, loses frames, and knows its neighbours only by their beacons.

Robots announce their positions as GPSR does (Karp and Kung, MobiCom 2000): every so often,
jittered, valid for a while. A neighbour that does not acknowledge is struck off. Every frame
carries its sender's position, so that whoever hears it knows that too.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import hypot, inf
from typing import overload

import numpy as np
from numpy.typing import NDArray

from fleet.radio import BrokenProtocol, Reception
from fleet.robot import Robot
from protocols.messages import Point, RobotId, Transmission


@dataclass(frozen=True, slots=True, kw_only=True)
class RadioSpec:
    """What the lossy radio does to frames, and how often robots beacon.

    A frame is lost with probability ``loss`` wherever, and besides with ``loss_at_range`` times
    (distance/range) to the power of ``falloff``. Shadowing makes the range of each link
    another, 10^(X/10η) times r with X normal of deviation ``shadowing`` dB and path loss η.

    Raises:
        ValueError: a value is out of its range.
    """

    latency: float = 0.005  # of a frame that gets through, acknowledgement included [s]
    timeout: float = 0.02  # until a frame that was not acknowledged is sent again [s]
    retries: int = 3  # further attempts for a frame that was not acknowledged
    loss: float = 0.0
    loss_at_range: float = 0.0
    falloff: float = 4.0
    shadowing: float = 0.0  # [dB]
    path_loss: float = 3.0  # η
    beacon_interval: float = 1.0  # [s]
    beacon_jitter: float = 0.5  # share of the interval over which beacons are spread
    validity: float = 4.5  # how long a neighbour is believed to be where it said [s]

    def __post_init__(self) -> None:
        for name in ("latency", "timeout", "shadowing"):
            if not 0.0 <= getattr(self, name) < inf:
                raise ValueError(f"radio {name} is {getattr(self, name)}; expected 0 or more")
        for name in ("falloff", "path_loss", "beacon_interval", "validity"):
            if not 0.0 < getattr(self, name) < inf:
                raise ValueError(f"radio {name} is {getattr(self, name)}; expected more than 0")
        for name in ("loss", "loss_at_range", "beacon_jitter"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ValueError(f"radio {name} is {getattr(self, name)}; expected 0 to 1")
        if not 0 <= self.retries <= 30:
            raise ValueError(f"radio retries is {self.retries}; expected 0 to 30")
        if self.validity < self.beacon_interval:
            raise ValueError(
                f"radio validity is {self.validity} s; expected the beacon interval,"
                f" {self.beacon_interval} s, or more"
            )


class LossyRadio:
    """The air between robots that only know what they have heard.

    Raises:
        ValueError: the graph is one that robots cannot reduce to by what they know.
    """

    takes_time = True

    def __init__(
        self, robots: Sequence[Point], radio_range: float, graph: str, spec: RadioSpec, seed: int
    ) -> None:
        from fleet.radio import propagation
        from protocols.topology.cells import Cells
        from protocols.topology.neighbourhood import GRAPHS

        if graph not in GRAPHS:
            raise ValueError(
                f"graph is {graph!r}, which no robot can tell from its neighbours alone;"
                f" expected {', '.join(map(repr, GRAPHS))}, or radio ideal"
            )
        self.spec = spec
        self.beacons = 0
        self._kernels = propagation
        self._graph = GRAPHS[graph]
        self._air = propagation.Air(
            seed, radio_range, spec.loss, spec.loss_at_range, spec.falloff, spec.shadowing,
            spec.path_loss,
        )  # fmt: skip
        n = len(robots)
        self._now = 0.0
        self._frames = 0
        self._cells = Cells(robots, 0.5 * radio_range)
        for robot, position in enumerate(robots):
            self._cells.move(robot, position)
        self._on_air = np.ones(n, np.bool_)
        degree = n * np.pi * propagation.farthest(self._air) ** 2 / self._area(robots)
        capacity = int(min(max(32, 3 * degree), n))
        self._known = np.zeros((n, max(capacity, 1)), np.int64)
        self._x, self._y, self._heard_at = (np.zeros(self._known.shape) for _ in range(3))
        self._size = np.zeros(n, np.int64)
        self._chosen = np.zeros(self._known.shape[1], np.int64)
        self._sent = np.zeros(n, np.int64)
        phases = [propagation.chance(seed, propagation.PHASE, k, 0, 0) for k in range(n)]
        self._due = spec.beacon_interval * (np.array(phases) - 1.0)
        self.tables: Sequence[Mapping[RobotId, Point]] = _Tables(self)
        self._beacon(0.0)  # everybody has said hello once before the run begins

    @property
    def reach(self) -> NDArray[np.float64] | float:
        """How far robots hear one another [m], if nothing is lost: all, or pair by pair (n, n)."""
        if self.spec.shadowing == 0.0:
            return self._air.radio_range
        return np.asarray(self._kernels.all_reaches(self._air, len(self._size)))

    def refresh(self, moved: Iterable[Robot], time: float) -> None:
        """Robots are where they are now; beacons up to ``time`` [s] have been sent."""
        for robot in moved:
            self._cells.move(robot.id, robot.position)
        self._now = time
        self._beacon(time)

    def silence(self, robot: Robot) -> None:
        """The robot neither sends nor hears. Its neighbours will find out."""
        self._on_air[robot.id] = False

    def restore(self, robot: Robot) -> None:
        """The robot sends and hears again."""
        self._on_air[robot.id] = True

    def transmit(self, transmission: Transmission, time: float) -> Reception:
        """Send it, again if it must be; whoever hears it knows where the sender is."""
        self._frames += 1
        self._now = time
        self._beacon(time)
        sender, receiver = transmission.sender, transmission.receiver
        if receiver is None:
            heard = self._broadcast(sender)
            return Reception(heard, self.spec.latency)
        if receiver == sender or not 0 <= receiver < len(self._size):
            raise BrokenProtocol(f"{transmission} is addressed to no other robot")
        attempts = self.spec.retries + 1
        x, y = self._cells.x, self._cells.y
        distance = hypot(x[sender] - x[receiver], y[sender] - y[receiver])
        if self._on_air[receiver]:
            used = self._kernels.unicast(
                self._air, self._frames, attempts, sender, receiver, distance
            )
        else:
            used = -attempts
        delay = (abs(used) - 1) * self.spec.timeout + self.spec.latency
        if used > 0:
            self._note(receiver, sender)
            self._note(sender, receiver)
            return Reception((receiver,), delay, used)
        self._kernels.forget(
            sender, receiver, self._known, self._x, self._y, self._heard_at, self._size
        )
        return Reception((), delay, -used)

    def links_of(self, robot: RobotId) -> dict[RobotId, Point]:
        """What the robot takes for its neighbours in the routing graph, by ascending id."""
        count = self._kernels.local_links(
            robot, self._cells.x[robot], self._cells.y[robot], self._now, self.spec.validity,
            self._graph, self._known, self._x, self._y, self._heard_at, self._size, self._chosen,
        )  # fmt: skip
        slots = self._chosen[:count]
        ids = self._known[robot, slots].tolist()
        places = zip(self._x[robot, slots].tolist(), self._y[robot, slots].tolist(), strict=True)
        return dict(sorted(zip(ids, places, strict=True)))

    def _broadcast(self, sender: RobotId) -> tuple[RobotId, ...]:
        c = self._cells
        count = self._kernels.broadcast(
            self._air, 64 * self._frames, sender, self._on_air,
            c.x, c.y, c.head, c.after, c.grid, c.marked, c.near,
        )  # fmt: skip
        linked = self.links_of(sender)
        heard: list[RobotId] = c.near[:count].tolist()
        for robot in heard:
            self._note(robot, sender)
        return tuple(sorted(robot for robot in heard if robot in linked))

    def _note(self, robot: RobotId, other: RobotId) -> None:
        self._kernels.note(
            robot, other, self._cells.x[other], self._cells.y[other], self._now,
            self._known, self._x, self._y, self._heard_at, self._size, self.spec.validity,
        )  # fmt: skip

    def _beacon(self, time: float) -> None:
        c, spec = self._cells, self.spec
        self.beacons += self._kernels.beacons_until(
            time, self._air, spec.beacon_interval, spec.beacon_jitter, spec.validity,
            self._due, self._sent, self._on_air,
            c.x, c.y, c.head, c.after, c.grid, c.marked, c.near,
            self._known, self._x, self._y, self._heard_at, self._size,
        )  # fmt: skip

    @staticmethod
    def _area(positions: Sequence[Point]) -> float:
        """Of the box around all robots, at least a metre wide each way [m²]."""
        places = np.array(positions).reshape(-1, 2)
        span = np.maximum(np.ptp(places, axis=0), 1.0)
        return float(span[0] * span[1])


class _Tables(Sequence[Mapping[RobotId, Point]]):
    """The robots' routing tables, worked out when they are looked at."""

    def __init__(self, radio: LossyRadio) -> None:
        self._radio = radio

    @overload
    def __getitem__(self, robot: int) -> Mapping[RobotId, Point]: ...
    @overload
    def __getitem__(self, robot: slice) -> Sequence[Mapping[RobotId, Point]]: ...
    def __getitem__(
        self, robot: int | slice
    ) -> Mapping[RobotId, Point] | Sequence[Mapping[RobotId, Point]]:
        if isinstance(robot, slice):
            return [self._radio.links_of(k) for k in range(len(self))[robot]]
        return self._radio.links_of(robot)

    def __len__(self) -> int:
        return len(self._radio._size)

    def __iter__(self) -> Iterator[Mapping[RobotId, Point]]:
        return map(self._radio.links_of, range(len(self)))
