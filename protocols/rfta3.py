"""RFTA3: thrifty auctions that ask further only when it pays, and carry events out of splinters.

RFTA2 and RFTA2GE send whoever would have most energy left, however far away; the robot that
was found, usually the nearest, may not even bid; and life ends with the first neighbourhood
that is spent. RFTA3 keeps their search and their auction and changes three things:

1. A bid is what the trip costs over the root of what the battery holds, less for robots that
   leave company close by: thrift before balance.
2. The call carries the caller's own bid, and only better ones are sent: the auctioneer
   competes, and most of the silence is agreement.
3. If the best bid is a poor one, the call goes out once more, a hop further, for better ones.
   While nobody can go, it reaches twice as far, up to the whole component. If the component is
   but a splinter of the network, one of its robots carries the event on towards it.

On request a robot whose departure would cut its neighbours off from one another stays for as
long as anybody else can go; with splinters carrying events on, that costs more than it gains.

So an event is served whenever any robot of the component can serve it.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from math import dist, inf
from typing import TypeAlias

from protocols.auctions import (
    Auction,
    AuctionRules,
    Tree,
    aggregate,
    award,
    call,
    offer,
)
from protocols.connectivity import can_be_spared
from protocols.messages import (
    Award,
    Bid,
    Conversation,
    Event,
    Heard,
    Move,
    RobotId,
    RobotView,
    Transmission,
    View,
)
from protocols.metrics import CompanyShare, Metric
from protocols.routing import TWO_SR, Search, find

Ring: TypeAlias = Generator[Transmission, Heard, tuple[Tree, list[Bid]]]

COMPANY = CompanyShare()
ALL = 1 << 30  # hops enough for any component


def rfta3(
    view: View,
    event: Event,
    source: RobotId,
    *,
    search: Search = TWO_SR,
    metric: Metric = COMPANY,
    content: float = 5.0,
    spare: int = 0,
    carry: int = 10,
) -> Conversation:
    """Route to the event, then auction; ask farther as need be.

    A bid of neighbours above ``content``, in the metric's unit, is asked to be bettered by their
    neighbours. For up to ``spare`` hops only robots bid that the network can spare; then all do,
    ring by ring. A component of fewer than ``carry`` robots in which nobody can go sends one of
    them towards the event, to find the others.
    """
    found = yield from find(view, source, event, search)
    reached = 0
    for eligible, most in ((can_be_spared, spare), (anybody, inf)):
        hops, reached, before = 1, 0, -1
        while hops <= most and reached > before:
            tree, bids = yield from ring(view, found, event, metric, hops, eligible)
            if hops == 1 and bids and min(bids).cost > content:
                wider, more = yield from ring(view, found, event, metric, 2, eligible, min(bids))
                tree, bids = {**tree, **wider}, [*bids, *more]
            if bids:
                return (yield from award(found, tree, bids))
            hops, reached, before = 2 * hops, len(tree), reached
    if reached + 1 < carry:
        return (yield from carry_on(view, found, event, metric))
    return Award(None, found)


def anybody(_robot: RobotView) -> bool:
    """No robot is too precious to go."""
    return True


def ring(
    view: View,
    auctioneer: RobotId,
    event: Event,
    metric: Metric,
    hops: int,
    eligible: Callable[[RobotView], bool],
    best: Bid | None = None,
) -> Ring:
    """Call ``hops`` deep for bids better than the callers' own, and than the ``best`` that there
    is; who was reached, and the bids.
    """

    def own(robot: RobotId) -> Bid | None:
        me = view[robot]
        return offer(me, event, metric) if eligible(me) else None

    def to_beat(robot: RobotId) -> Bid | None:
        return min((bid for bid in (own(robot), best) if bid is not None), default=None)

    tree = yield from call(view, auctioneer, AuctionRules(hops=hops), to_beat)
    offers = []
    for robot, caller in tree.items():
        bid, limit = own(robot), to_beat(caller)
        if bid is not None and (limit is None or bid < limit):
            offers.append(bid)
    bids = yield from aggregate(auctioneer, tree, offers)
    mine = own(auctioneer)
    return tree, bids if mine is None or best is not None else [*bids, mine]


def carry_on(view: View, found: RobotId, event: Event, metric: Metric) -> Auction:
    """Elect a robot to carry the event a radio range further, where others may be heard."""
    (x, y), (ex, ey) = view[found].position, event.position
    away = dist((x, y), (ex, ey))
    share = min(1.0, view[found].radio_range / away) if away > 0.0 else 1.0
    ahead = (x + share * (ex - x), y + share * (ey - y))
    tree, bids = yield from ring(view, found, Event(event.id, ahead), metric, ALL, anybody)
    elected = yield from award(found, tree, bids)
    if elected.winner is None:
        return Award(None, found)
    return Award(None, found, elected.bids, (Move(elected.winner, ahead),))
