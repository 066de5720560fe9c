"""After MIA-TA: a robot whose departure would cut the network stays where it is.

Reference: multi-robot task allocation with maintained connectivity, as described in
Stanulovic, Mitton and Mezei, Sensors 21(18):6149, 2021, Table 1 and section 6
(doi:10.3390/s21186149).

Our reading needs no more than what a robot knows: it bids only if those around it stay
connected to one another without it. The routing graph joins whatever the radio range joins,
so if a robot's neighbours in it can still reach each other directly or through one another,
whoever talked through the robot can talk round it. The test errs to the safe side: a detour
farther out is not known to the robot.
"""

from __future__ import annotations

from protocols.auctions import AuctionRules, auction
from protocols.geometry import squared_distance
from protocols.messages import Award, Conversation, Event, RobotId, RobotView, View
from protocols.metrics import Metric, energy_left
from protocols.routing import TWO_SR, Search, find


def mia_ta(
    view: View,
    event: Event,
    source: RobotId,
    *,
    search: Search = TWO_SR,
    metric: Metric = energy_left,
    hops: int = 2,
) -> Conversation:
    """Route to the event, then auction among robots that the network can spare."""
    found = yield from find(view, source, event, search)
    rules = AuctionRules(hops=hops, aggregate=True)
    won = yield from auction(view, found, event, metric, rules, may_bid=can_be_spared)
    if won.winner == found and not can_be_spared(view[found]):
        return Award(None, found, won.bids)
    return won


def can_be_spared(robot: RobotView) -> bool:
    """Whether the robot's neighbours hang together without it, each within range of another."""
    places = list(robot.neighbours.values())
    reach = robot.radio_range * robot.radio_range
    joined, waiting = places[:1], places[1:]
    while joined and waiting:
        here = joined.pop()
        near = [place for place in waiting if squared_distance(here, place) <= reach]
        waiting = [place for place in waiting if place not in near]
        joined.extend(near)
    return not waiting
