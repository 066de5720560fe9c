"""The paper's radio: instant and lossless over the links of the live topology."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import dist

from fleet.radio import AirCounts, BrokenProtocol, Received, Reception
from fleet.robot import Robot
from protocols.messages import Point, RobotId, Transmission
from protocols.topology import Topology


class IdealRadio:
    """Every transmission reaches whom it is meant for, and takes no time.

    Robots always know where their neighbours are, so no beacons are sent.
    """

    takes_time = False
    disc = True

    def __init__(self, topology: Topology) -> None:
        self._topology = topology
        self.instant = self.transmit
        self.reach = topology.radio_range  # [m]
        self.tables: Sequence[Mapping[RobotId, Point]] = topology.neighbours

    def refresh(self, moved: Iterable[Robot], time: float) -> None:
        """Bring the links up to date with robots that moved."""
        heard = [robot for robot in moved if robot.on_air]
        if len(heard) == 1:
            self._topology.move(heard[0].id, heard[0].position)
        elif heard:
            ids, positions = [robot.id for robot in heard], [robot.position for robot in heard]
            self._topology.move_all(ids, positions)

    def counts(self) -> AirCounts:
        """Nothing worth counting."""
        return AirCounts()

    def hearers(self, robot: RobotId) -> list[RobotId]:
        """Whoever is within range; ascending."""
        x, y = self._topology.positions[robot]
        return [
            other
            for other, place in enumerate(self._topology.positions)
            if other != robot and dist(place, (x, y)) <= self.reach
        ]

    def silence(self, robot: Robot) -> None:
        """Nobody hears the robot any more."""
        self._topology.remove(robot.id)

    def restore(self, robot: Robot) -> None:
        """The robot is heard again."""
        self._topology.move(robot.id, robot.position)

    def send(self, transmission: Transmission, time: float, done: Received) -> None:
        """Send it; it has arrived."""
        done(self.transmit(transmission, time), time)

    def transmit(self, transmission: Transmission, time: float) -> Reception:
        """All neighbours hear a broadcast, the receiver what is addressed to it."""
        near = self.tables[transmission.sender]
        receiver = transmission.receiver
        if receiver is None:
            return Reception(tuple(near))
        if receiver not in near:
            raise BrokenProtocol(
                f"{transmission.kind} from robot {transmission.sender} to robot {receiver},"
                f" which is not among its neighbours {tuple(near)}"
            )
        return Reception((receiver,))


def ideal() -> None:
    """Every transmission arrives at once; neighbours' positions are always known."""
