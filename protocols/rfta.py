"""RFTA: routing with face traversal, then an auction around the robot that was found.

Reference: Stanulovic, Mitton and Mezei, Sensors 21(18):6149, 2021, section 4
(doi:10.3390/s21186149).
"""

from __future__ import annotations

from protocols.auctions import tree_auction
from protocols.messages import Conversation, Event, RobotId, View
from protocols.metrics import Metric, energy_left
from protocols.routing import TWO_SR, Search, find


def rfta2(
    view: View,
    event: Event,
    source: RobotId,
    *,
    search: Search = TWO_SR,
    metric: Metric = energy_left,
    auctioneer_bids: bool = False,
) -> Conversation:
    """Route to the event, then auction among the neighbours of the robot found (section 4.2)."""
    found = yield from find(view, source, event, search)
    return (yield from tree_auction(view, found, event, metric, auctioneer_bids=auctioneer_bids))
