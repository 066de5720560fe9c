"""RFTA3: thrifty auctions that ask further only when it pays, and carry events out of splinters.

RFTA2 and RFTA2GE send whoever would have most energy left, however far away; the robot that
was found, usually the nearest, may not even bid; and life ends with the first neighbourhood
that is spent. RFTA3 keeps their search and their auction and changes three things:

1. A bid is what the trip costs over the root of what the battery holds, less for robots that
   leave company close by: thrift before balance.
2. The call carries the caller's own bid, and only better ones are sent: the auctioneer
   competes, and most of the silence is agreement.
3. If the best bid is a poor one, the call goes out once more, a hop further, for better ones.
   While nobody can go, it reaches farther, up to the whole component. If the component is but a
   splinter of the network, one of its robots carries the event on towards it.

So an event is served whenever any robot of the component can serve it. How large the component is
nobody knows without asking: as long as it may be a splinter, whoever is reached by a wider call
answers, with its bid or with none, and answers are added up on their way back.
"""

from __future__ import annotations

from collections.abc import Generator
from math import dist
from typing import NamedTuple

from protocols.auctions import (
    Auction,
    AuctionRules,
    Tree,
    add_up,
    aggregate,
    award,
    call,
    offer,
)
from protocols.messages import (
    Award,
    Bid,
    Conversation,
    Event,
    Heard,
    Move,
    RobotId,
    Transmission,
    View,
)
from protocols.metrics import CompanyShare, Metric
from protocols.routing import TWO_SR, Search, find

COMPANY = CompanyShare()
ALL = 1 << 30  # hops enough for any component


RINGS = (1, 2, 4, ALL)  # hops that a call goes, while nobody can go


class Ring(NamedTuple):
    """Who was reached by a call, and what came back to the auctioneer."""

    tree: Tree
    bids: list[Bid]
    answers: int = 0  # robots that have answered, if they were asked to


def rfta3(
    view: View,
    event: Event,
    source: RobotId,
    *,
    search: Search = TWO_SR,
    metric: Metric = COMPANY,
    content: float = 5.0,
    carry: int = 10,
) -> Conversation:
    """Route to the event, then auction; ask farther as need be.

    A bid of neighbours above ``content``, in the metric's unit, is asked to be bettered by their
    neighbours. A component of fewer than ``carry`` robots in which nobody can go sends one of them
    towards the event, to find the others.
    """
    found = yield from find(view, source, event, search)
    others = len(view[found].neighbours)  # that the auctioneer knows of
    for hops in RINGS if others else RINGS[:1]:
        count = hops > 1 and others + 1 < carry
        ring = yield from ask(view, found, event, metric, hops, count=count)
        if hops == 1 and ring.bids and min(ring.bids).cost > content:
            wider = yield from ask(view, found, event, metric, 2, best=min(ring.bids))
            ring = Ring({**ring.tree, **wider.tree}, [*ring.bids, *wider.bids])
        if ring.bids:
            return (yield from award(found, ring.tree, ring.bids))
        if count and ring.answers <= others:
            break  # nobody new: that was the whole component
        others = max(others, ring.answers)
    if others + 1 < carry:
        return (yield from carry_on(view, found, event, metric))
    return Award(None, found)


def ask(
    view: View,
    auctioneer: RobotId,
    event: Event,
    metric: Metric,
    hops: int,
    *,
    best: Bid | None = None,
    count: bool = False,
) -> Generator[Transmission, Heard, Ring]:
    """Call ``hops`` deep for bids better than the callers' own, and than the ``best`` that there
    is; with ``count`` those who have none to make answer too.
    """

    def better(bid: Bid | None) -> Bid | None:
        return min((one for one in (bid, best) if one is not None), default=None)

    def to_beat(robot: RobotId) -> Bid | None:
        return better(offer(view[robot], event, metric))

    tree = yield from call(view, auctioneer, AuctionRules(hops=hops), to_beat)
    own = {robot: offer(view[robot], event, metric) for robot in (auctioneer, *tree)}
    offers = []
    for robot, caller in tree.items():
        bid, limit = own[robot], better(own[caller])
        if bid is not None and (limit is None or bid < limit):
            offers.append(bid)
    answers = 0
    if count:
        answers, bids = yield from add_up(auctioneer, tree, offers)
    else:
        bids = yield from aggregate(auctioneer, tree, offers)
    mine = offer(view[auctioneer], event, metric)
    return Ring(tree, bids if mine is None or best is not None else [*bids, mine], answers)


def carry_on(view: View, found: RobotId, event: Event, metric: Metric) -> Auction:
    """Elect a robot to carry the event a radio range further, where others may be heard."""
    (x, y), (ex, ey) = view[found].position, event.position
    away = dist((x, y), (ex, ey))
    share = min(1.0, view[found].radio_range / away) if away > 0.0 else 1.0
    ahead = (x + share * (ex - x), y + share * (ey - y))
    ring = yield from ask(view, found, Event(event.id, ahead), metric, ALL)
    elected = yield from award(found, ring.tree, ring.bids)
    if elected.winner is None:
        return Award(None, found)
    return Award(None, found, elected.bids, (Move(elected.winner, ahead),))
