"""Auctions around the collecting robot: no routing, the call is flooded some hops deep.

References: Mezei, Malbasa and Stojmenovic, IEEE Robotics & Automation Magazine 17(4), 2010
(k-SAP, k-SAAP); RODAA, a task allocation on the breadth-first search tree, as described in
Stanulovic, Mitton and Mezei, Sensors 21(18):6149, 2021, sections 2.1 and 5
(doi:10.3390/s21186149).
"""

from __future__ import annotations

from protocols.auctions import AuctionRules, auction, iterated_auction
from protocols.messages import Conversation, Event, RobotId, View
from protocols.metrics import Metric, energy_left


def k_sap(
    view: View,
    event: Event,
    source: RobotId,
    *,
    hops: int = 7,
    metric: Metric = energy_left,
    greedy_extension: bool = False,
) -> Conversation:
    """Auction k hops around the collecting robot; every bid travels back by itself."""
    hold = iterated_auction if greedy_extension else auction
    rules = AuctionRules(hops=hops, auctioneer_bids=True)
    return (yield from hold(view, source, event, metric, rules))


def k_saap(
    view: View,
    event: Event,
    source: RobotId,
    *,
    hops: int = 7,
    metric: Metric = energy_left,
    greedy_extension: bool = False,
) -> Conversation:
    """Auction k hops around the collecting robot; bids are aggregated on their way back."""
    hold = iterated_auction if greedy_extension else auction
    rules = AuctionRules(hops=hops, aggregate=True, auctioneer_bids=True)
    return (yield from hold(view, source, event, metric, rules))


def bfs(
    view: View, event: Event, source: RobotId, *, hopmax: int = 7, metric: Metric = energy_left
) -> Conversation:
    """Auction on the breadth-first tree of the collecting robot, hopmax deep (after RODAA).

    As the search runs along every edge (its complexity is O(diameter·|E|), Table 1), a robot
    calls each neighbour but its parent by itself; bids travel back one by one.
    """
    rules = AuctionRules(hops=hopmax, separately=True, auctioneer_bids=True)
    return (yield from auction(view, source, event, metric, rules))
