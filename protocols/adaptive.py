"""After AAP: the auction area adapts to how dense and how capable the neighbourhood is.

Reference: an adaptive auction protocol for task assignment in multi-hop wireless actuator
networks, International Journal of Distributed Sensor Networks, 2020
(doi:10.1177/1550147720932751).

The publication lets actuators that know of the target hold an auction whose area follows from
an adaptive factor of the network; the factor itself is fitted to its own simulations. Our
reading keeps the idea, from what the auctioneer itself hears: it wants a number of capable
bidders. The robots within k hops grow as k² at constant density, so if b of its neighbours
bid at one hop, k = √(wanted/b) hops should hold enough. A dense, full neighbourhood settles
the task at one hop; a sparse or tired one is asked deeper. As for RFTA, the search of GFGF2
brings the call to the neighbourhood of the event.
"""

from __future__ import annotations

from math import ceil, sqrt

from protocols.auctions import AuctionRules, aggregate, auction, award, call, offer
from protocols.messages import Conversation, Event, RobotId, View
from protocols.metrics import Metric, energy_left
from protocols.routing import TWO_SR, Search, find


def aap(
    view: View,
    event: Event,
    source: RobotId,
    *,
    search: Search = TWO_SR,
    metric: Metric = energy_left,
    wanted: int = 8,
    hops: int = 4,
) -> Conversation:
    """Route to the event, then auction as deep as the first ring's bids make necessary."""
    found = yield from find(view, source, event, search)
    ring = yield from call(view, found, AuctionRules())
    offers = [bid for robot in ring if (bid := offer(view[robot], event, metric)) is not None]
    bids = yield from aggregate(found, ring, offers)
    depth = min(hops, ceil(sqrt(wanted / max(len(bids), 1))))
    if depth > 1:
        rules = AuctionRules(hops=depth, aggregate=True, auctioneer_bids=True)
        return (yield from auction(view, found, event, metric, rules))
    return (yield from award(found, ring, bids))
