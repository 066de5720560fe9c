"""The second phase: from the robot that was found to the robot that should go.

Every auction here is a part of a conversation: a generator of transmissions that returns
the award. A call spreads outwards hop by hop, bids come back along the way it took.

References: Mezei, Malbasa and Stojmenovic, IEEE Robotics & Automation Magazine 17(4), 2010
(k-SAP and k-SAAP); Stanulovic, Mitton and Mezei, Sensors 21(18):6149, 2021, sections 4.1
to 4.4 (doi:10.3390/s21186149).
"""

from __future__ import annotations

from collections.abc import Generator
from itertools import pairwise
from typing import TypeAlias

from protocols.messages import Award, Bid, Event, Heard, Robot, RobotId, Transmission, View
from protocols.metrics import Metric

Auction: TypeAlias = Generator[Transmission, Heard, Award]


def offer(robot: Robot, event: Event, metric: Metric) -> Bid | None:
    """The robot's bid, or None if it believes that the trip is more than it can afford."""
    if robot.energy < robot.cost_to(event.position):
        return None
    return Bid(metric(robot, event.position), robot.id)


def keep(view: View, found: RobotId, event: Event, metric: Metric) -> Award:
    """No auction: the robot that was found goes, if it can afford to."""
    bid = offer(view[found], event, metric)
    return Award(None, found) if bid is None else Award(found, found, (bid,))


def tree_auction(
    view: View,
    auctioneer: RobotId,
    event: Event,
    metric: Metric,
    *,
    hops: int = 1,
    aggregate: bool = False,
    auctioneer_bids: bool = False,
) -> Auction:
    """Call ``hops`` deep, collect the bids along the tree of calls, award to the best.

    Each robot that hears the call for the first time remembers whom from: its parent. It
    calls on unless it is ``hops`` away. Bids travel from parent to parent; with
    ``aggregate`` a robot waits for those below it and passes on only the best.
    The auctioneer takes the task only if nobody else bids, unless ``auctioneer_bids``.
    """
    parent: dict[RobotId, RobotId] = {}
    layer = [auctioneer]
    for _ in range(hops):
        called: list[RobotId] = []
        for caller in layer:
            heard = yield Transmission("call", caller, None)
            for robot in heard:
                if robot != auctioneer and robot not in parent:
                    parent[robot] = caller
                    called.append(robot)
        layer = called
    gather = _aggregated if aggregate else _relayed
    bids = yield from gather(view, auctioneer, event, metric, parent)
    own = offer(view[auctioneer], event, metric) if auctioneer_bids or not bids else None
    if own is not None:
        bids.append(own)
    if not bids:
        return Award(None, auctioneer)
    best = min(bids)
    arrived = yield from assign(auctioneer, best, parent)
    return Award(best.robot if arrived else None, auctioneer, tuple(bids))


Gathering: TypeAlias = Generator[Transmission, Heard, list[Bid]]


def _relayed(
    view: View, auctioneer: RobotId, event: Event, metric: Metric, parent: dict[RobotId, RobotId]
) -> Gathering:
    """Every bid goes all the way up by itself."""
    bids: list[Bid] = []
    for robot in parent:
        bid = offer(view[robot], event, metric)
        if bid is None:
            continue
        at = robot
        while at != auctioneer:
            if not (yield Transmission("bid", at, parent[at], bid)):
                break
            at = parent[at]
        else:
            bids.append(bid)
    return bids


def _aggregated(
    view: View, auctioneer: RobotId, event: Event, metric: Metric, parent: dict[RobotId, RobotId]
) -> Gathering:
    """From the leaves up, each robot passes on the best of its own bid and those it heard."""
    best: dict[RobotId, Bid] = {}
    bids: list[Bid] = []
    for robot in reversed(parent):
        bid = offer(view[robot], event, metric)
        passed_on = best.get(robot)
        if bid is None or (passed_on is not None and passed_on < bid):
            bid = passed_on
        if bid is None:
            continue
        above = parent[robot]
        if not (yield Transmission("bid", robot, above, bid)):
            continue
        if above == auctioneer:
            bids.append(bid)
        elif above not in best or bid < best[above]:
            best[above] = bid
    return bids


def assign(
    auctioneer: RobotId, best: Bid, parent: dict[RobotId, RobotId]
) -> Generator[Transmission, Heard, bool]:
    """Tell the winner, back down the way its bid came. Returns whether it was told."""
    path = [best.robot]
    while path[-1] != auctioneer:
        path.append(parent[path[-1]])
    path.reverse()
    for sender, receiver in pairwise(path):
        if not (yield Transmission("assign", sender, receiver, best)):
            return False
    return True
