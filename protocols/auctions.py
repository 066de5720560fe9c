"""The second phase: from the robot that was found to the robot that should go.

Every auction here is a part of a conversation: a generator of transmissions that returns
the award. A call spreads outwards hop by hop, bids come back along the way it took.

References: Mezei, Malbasa and Stojmenovic, IEEE Robotics & Automation Magazine 17(4), 2010
(k-SAP and k-SAAP) and Ad Hoc & Sensor Wireless Networks 17(1-2), 2013 (greedy extension);
Stanulovic, Mitton and Mezei, Sensors 21(18):6149, 2021, sections 4.1 to 4.4
(doi:10.3390/s21186149).
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

from protocols.messages import Award, Bid, Event, Heard, RobotId, RobotView, Transmission, View
from protocols.metrics import Metric

Auction: TypeAlias = Generator[Transmission, Heard, Award]
Part: TypeAlias = Generator[Transmission, Heard, list[Bid]]
Tree: TypeAlias = dict[RobotId, RobotId]  # who heard the call: from whom, in that order


@dataclass(frozen=True, slots=True, kw_only=True)
class AuctionRules:
    """How a call spreads and how bids come back.

    ``hops`` deep; ``aggregate``: a robot waits for those below it and passes on only the best
    bid; ``separately``: a call goes to each neighbour by itself instead of once to all;
    ``reserve``: the call carries the auctioneer's own bid, and only better ones are sent;
    ``outbid``: a call passed on carries the bid of whom it comes from, with the same effect;
    ``auctioneer_bids``: it competes, instead of going only if nobody else bids.

    Raises:
        ValueError: hops is below 1.
    """

    hops: int = 1
    aggregate: bool = False
    separately: bool = False
    reserve: bool = False
    outbid: bool = False
    auctioneer_bids: bool = False

    def __post_init__(self) -> None:
        if self.hops < 1:
            raise ValueError(f"hops is {self.hops}; expected 1 or more")


ONE_HOP = AuctionRules()
TWO_HOPS = AuctionRules(hops=2)


def offer(robot: RobotView, event: Event, metric: Metric) -> Bid | None:
    """The robot's bid, or None if it believes that the trip is more than it can afford."""
    if robot.energy < robot.cost_to(event.position):
        return None
    return Bid(metric(robot, event.position), robot.id)


def keep(view: View, found: RobotId, event: Event, metric: Metric) -> Award:
    """No auction: the robot that was found goes, if it can afford to."""
    bid = offer(view[found], event, metric)
    return Award(None, found) if bid is None else Award(found, found, (bid,))


def auction(
    view: View,
    auctioneer: RobotId,
    event: Event,
    metric: Metric,
    rules: AuctionRules = ONE_HOP,
    may_bid: Callable[[RobotView], bool] | None = None,
) -> Auction:
    """Call, collect the bids along the tree of calls, award the event to the best.

    ``may_bid`` keeps robots from bidding for reasons of their own. The auctioneer takes the
    event only if nobody else bids, unless the rules let it compete.
    """

    def to_beat(caller: RobotId) -> Bid | None:
        """The bid that a call from ``caller`` carries."""
        if rules.reserve and caller == auctioneer:
            return Bid(metric(view[caller], event.position), caller)
        competes = caller != auctioneer or rules.auctioneer_bids
        return offer(view[caller], event, metric) if rules.outbid and competes else None

    own = offer(view[auctioneer], event, metric)
    tree = yield from call(view, auctioneer, rules, to_beat)
    offers = []
    for robot, caller in tree.items():
        bid, limit = offer(view[robot], event, metric), to_beat(caller)
        if bid is None or (limit is not None and bid.cost >= limit.cost):
            continue
        if may_bid is None or may_bid(view[robot]):
            offers.append(bid)
    collect = aggregate if rules.aggregate else relay
    bids = yield from collect(auctioneer, tree, offers)
    if own is not None and (rules.auctioneer_bids or not bids):
        bids.append(own)
    return (yield from award(auctioneer, tree, bids))


def iterated_auction(
    view: View, auctioneer: RobotId, event: Event, metric: Metric, rules: AuctionRules = ONE_HOP
) -> Auction:
    """After the auction, let each winner call its neighbours, until nobody does better."""
    won = yield from auction(view, auctioneer, event, metric, rules)
    while won.winner is not None:
        holder = won.winner
        own = offer(view[holder], event, metric)
        tree = yield from call(view, holder, ONE_HOP)
        offers = [bid for robot in tree if (bid := offer(view[robot], event, metric)) is not None]
        bids = yield from relay(holder, tree, offers)
        better = [bid for bid in bids if own is None or bid < own]
        if not better:
            break
        next_won = yield from award(holder, tree, better)
        if next_won.winner is None:  # it was not told: the holder goes itself
            break
        won = Award(next_won.winner, auctioneer, (*won.bids, *better))
    return won


def nothing_to_beat(_caller: RobotId) -> None:
    """A call that carries no bid."""


def call(
    view: View,
    auctioneer: RobotId,
    rules: AuctionRules,
    to_beat: Callable[[RobotId], Bid | None] = nothing_to_beat,
) -> Generator[Transmission, Heard, Tree]:
    """Call for bids, hop by hop. A robot's parent is whom it heard the call from first."""
    tree: Tree = {}
    layer = [auctioneer]
    for _ in range(rules.hops):
        if not layer:
            break
        called: list[RobotId] = []
        for caller in layer:
            receivers: list[RobotId | None] = [None]
            if rules.separately:
                receivers = [r for r in view[caller].neighbours if r != tree.get(caller)]
            limit = to_beat(caller)
            for receiver in receivers:
                for robot in (yield Transmission("call", caller, receiver, limit)):
                    if robot != auctioneer and robot not in tree:
                        tree[robot] = caller
                        called.append(robot)
        layer = called
    return tree


def relay(auctioneer: RobotId, tree: Tree, offers: list[Bid]) -> Part:
    """Every bid travels up the tree by itself; returns those that reached the auctioneer."""
    arrived: list[Bid] = []
    for bid in offers:
        at = bid.robot
        while at != auctioneer and (yield Transmission("bid", at, tree[at], bid)):
            at = tree[at]
        if at == auctioneer:
            arrived.append(bid)
    return arrived


def aggregate(auctioneer: RobotId, tree: Tree, offers: list[Bid]) -> Part:
    """From the leaves up, each robot passes on the best of its own bid and those it heard."""
    best = {bid.robot: bid for bid in offers}
    arrived: list[Bid] = []
    for robot in reversed(tree):  # the farthest first
        bid = best.get(robot)
        if bid is not None and (yield Transmission("bid", robot, tree[robot], bid)):
            _pass_on(bid, tree[robot], auctioneer, best, arrived)
    return arrived


def add_up(
    auctioneer: RobotId, tree: Tree, offers: list[Bid]
) -> Generator[Transmission, Heard, tuple[int, list[Bid]]]:
    """As :func:`aggregate`, but everybody answers, with a bid or with none, and says for how many.

    Returns how many that were, as far as the auctioneer was told, and the bids.
    """
    best = {bid.robot: bid for bid in offers}
    below: dict[RobotId, int] = {}  # that answered by way of each
    arrived: list[Bid] = []
    for robot in reversed(tree):
        bid, above = best.get(robot), tree[robot]
        if not (yield Transmission("bid", robot, above, bid)):
            continue
        below[above] = below.get(above, 0) + below.get(robot, 0) + 1
        if bid is not None:
            _pass_on(bid, above, auctioneer, best, arrived)
    return below.get(auctioneer, 0), arrived


def _pass_on(
    bid: Bid, above: RobotId, auctioneer: RobotId, best: dict[RobotId, Bid], arrived: list[Bid]
) -> None:
    """A bid has come to the robot above: to the auctioneer, or to who will pass on the best."""
    if above == auctioneer:
        arrived.append(bid)
    else:
        best[above] = min(bid, best.get(above, bid))


def award(auctioneer: RobotId, tree: Tree, bids: list[Bid]) -> Auction:
    """Tell the best bidder, down the way its bid came. Nobody wins who was not told."""
    if not bids:
        return Award(None, auctioneer)
    best = min(bids)
    path = [best.robot]
    while path[-1] != auctioneer:
        path.append(tree[path[-1]])
    for sender, receiver in pairwise(reversed(path)):
        if not (yield Transmission("assign", sender, receiver, best)):
            return Award(None, auctioneer, tuple(bids))
    return Award(best.robot, auctioneer, tuple(bids))
