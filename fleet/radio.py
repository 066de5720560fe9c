"""Who receives what is sent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from protocols.messages import Heard, Point, RobotId, Transmission
from protocols.topology import Topology


class BrokenProtocol(RuntimeError):
    """A protocol did what no protocol may, such as sending over a link that is not there."""


class IdealRadio:
    """Instant and lossless, over the links of the live topology: the paper's radio."""

    def __init__(self, topology: Topology) -> None:
        self.tables: Sequence[Mapping[RobotId, Point]] = topology.neighbours

    def deliver(self, transmission: Transmission) -> Heard:
        """Who hears it: every neighbour, or the neighbour it is addressed to.

        Raises:
            BrokenProtocol: it is addressed to a robot out of the sender's reach.
        """
        near = self.tables[transmission.sender]
        receiver = transmission.receiver
        if receiver is None:
            return tuple(near)
        if receiver not in near:
            raise BrokenProtocol(
                f"{transmission.kind} from robot {transmission.sender} to robot {receiver},"
                f" which is not among its neighbours {tuple(near)}"
            )
        return (receiver,)
