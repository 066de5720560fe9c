"""Networks that stand still, and conversations over them that are watched word by word."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from protocols.conformance import (
    PER_METRE,
    StillRobot,
    Talk,
    converse,
    network,
    random_connected,
    random_points,
)
from protocols.messages import Conversation, Event, RobotId, View

__all__ = [
    "PER_METRE",
    "StillRobot",
    "Talk",
    "converse",
    "network",
    "random_connected",
    "random_points",
    "routed",
]


def routed(routing: Callable[..., object], view: Sequence[StillRobot], *arguments: object) -> Talk:
    """Play a routing (a part of a conversation) by itself; the award is where it ended."""
    ended: list[RobotId] = []

    def alone(told: View, _event: Event, source: RobotId) -> Conversation:
        from protocols.messages import Award

        ended.append((yield from routing(told, *arguments)))
        return Award(None, source)

    talk = converse(alone, view, Event(0, (0.0, 0.0)), arguments[0])
    talk.award = ended[0]
    return talk
