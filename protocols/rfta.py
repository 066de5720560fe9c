"""RFTA: routing with face traversal, then an auction around the robot that was found.

Reference: Stanulovic, Mitton and Mezei, Sensors 21(18):6149, 2021, section 4
(doi:10.3390/s21186149).
"""

from __future__ import annotations

from protocols.auctions import AuctionRules, auction, iterated_auction
from protocols.messages import Conversation, Event, RobotId, View
from protocols.metrics import Metric, distance, energy_left
from protocols.routing import TWO_SR, Search, find


def rfta1(
    view: View,
    event: Event,
    source: RobotId,
    *,
    search: Search = TWO_SR,
    metric: Metric = distance,
) -> Conversation:
    """Route to the event; neighbours of the robot found bid if they are nearer than it."""
    found = yield from find(view, source, event, search)
    rules = AuctionRules(reserve=True, auctioneer_bids=True)
    return (yield from auction(view, found, event, metric, rules))


def rfta2(
    view: View,
    event: Event,
    source: RobotId,
    *,
    search: Search = TWO_SR,
    metric: Metric = energy_left,
    auctioneer_bids: bool = False,
) -> Conversation:
    """Route to the event, then auction among the neighbours of the robot found."""
    found = yield from find(view, source, event, search)
    rules = AuctionRules(auctioneer_bids=auctioneer_bids)
    return (yield from auction(view, found, event, metric, rules))


def rfta2ge(
    view: View,
    event: Event,
    source: RobotId,
    *,
    search: Search = TWO_SR,
    metric: Metric = energy_left,
    aggregate: bool = False,
    outbid: bool = False,
    auctioneer_bids: bool = False,
) -> Conversation:
    """Route to the event, then auction among the neighbours and their neighbours.

    The paper does not say how bids two hops away come back. Each is relayed by itself, or a
    neighbour passes on the best (``aggregate``), or hears only of better ones than its own
    (``outbid``). The winner is the same.
    """
    found = yield from find(view, source, event, search)
    rules = AuctionRules(
        hops=2, aggregate=aggregate, outbid=outbid, auctioneer_bids=auctioneer_bids
    )
    return (yield from auction(view, found, event, metric, rules))


def rfta2_iterated(
    view: View,
    event: Event,
    source: RobotId,
    *,
    search: Search = TWO_SR,
    metric: Metric = energy_left,
) -> Conversation:
    """As RFTA2, but each winner calls its own neighbours, until nobody does better."""
    found = yield from find(view, source, event, search)
    return (yield from iterated_auction(view, found, event, metric))
