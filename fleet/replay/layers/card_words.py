"""The sentences of an event's card, made of what was said, believed and done, and of nothing else.

What is said of the protocol is what it says of itself: whether it searches, what its bids are
worth, and what robots believe that a trip costs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from math import dist, inf, isinf

from fleet.replay.journal import Scene, TripEnd
from fleet.replay.state import Belief, OpenConversation, OpenTask
from protocols.messages import Award, Bid, Point, RobotId

MANY_BIDS = 5  # shown
MANY_SILENT = 4  # of those who did not bid
MANY_NAMED = 8
BELIEFS = {
    "straight": "Eq. (1) on the straight line",
    "path": "Eq. (1) on the planned path",
    "corrected": "Eq. (1), corrected, on the planned path",
    "driven": "what driving the planned path takes",
}
ELSEWHERE = 1e-9  # [m]


def where(task: OpenTask | None, talk: OpenConversation, at: Point) -> str:
    """Where it is, who is told, and what hurry there is."""
    x, y = talk.site
    away = dist(at, talk.site)
    words = (
        f"At **({x:.2f}, {y:.2f}) m**. Collector **r{talk.source}**, {away:.2f} m away, is told."
    )
    if task is None:
        return words
    if (off := dist(task.site, talk.site)) > ELSEWHERE:
        words += f" It really is {off:.2f} m from there."
    if task.deadline < inf:
        words += f" A robot must set off within {task.deadline:g} s."
    if task.service > 0.0:
        words += f" It takes {task.service:g} s of work."
    return words


def found(scene: Scene, talk: OpenConversation, auctioneer: RobotId, at: Point) -> str:
    """How the search went that ended at the auctioneer."""
    greedy, face = talk.count("route-greedy"), talk.count("route-face")
    away = f"{dist(at, talk.site):.2f} m from the event"
    if greedy + face:
        hops = f"{greedy + face} hop{'s' * (greedy + face > 1)}"
        how = f"{greedy} greedy, {face} face" if face else "all greedy"
        return f"The search took **{hops}** ({how}) and ended at **r{auctioneer}**, {away}."
    if auctioneer != talk.source:
        return f"**r{auctioneer}** decides, {away}; nothing was passed on to it."
    return (
        f"The search took no hops: it ends at the collector, {away}."
        if scene.routed
        else f"There is no search: the collector decides, {away}."
    )


def asked(talk: OpenConversation, auctioneer: RobotId) -> str:
    """Who was called, and how far away."""
    parents = talk.parents
    if not parents:
        return "Nobody was asked."
    hops = Counter(depth(parents, robot) for robot in parents)
    far = [
        f"{count} neighbour{'s' * (count > 1)}" if hop == 1 else f"{count} {hop} hops away"
        for hop, count in sorted(hops.items())
    ]
    return f"**r{auctioneer}** asked {', '.join(far)}: {_names(parents)}."


def depth(parents: dict[RobotId, RobotId], robot: RobotId) -> int:
    """Over how many hops a call came to a robot."""
    hops = 0
    while robot in parents and hops <= len(parents):
        robot, hops = parents[robot], hops + 1
    return hops


def why_not(belief: Belief | None, talk: OpenConversation, robot: RobotId) -> str:
    """Why a robot that was asked is not among the bids."""
    lines = [line for line in talk.lines if line.kind == "bid" and line.bidder == robot]
    if lines:
        return "its bid was lost" if not lines[-1].heard else "its bid was outdone on the way"
    if belief is None:
        return "did not answer"
    if belief.refusal:
        return belief.refusal
    if isinf(belief.cost):
        return "sees no way there"
    if belief.cost > belief.energy:
        return f"believes {belief.cost:.1f} J, holds {belief.energy:.1f} J"
    last = robot == talk.auctioneer
    return (
        "the auctioneer, goes only if nobody else can"
        if last
        else "would not have done better, or came too late"
    )


def silent(talk: OpenConversation, award: Award) -> list[RobotId]:
    """Those who were asked, or asked themselves, and are not among the bids."""
    among = {bid.robot for bid in award.bids}
    return [robot for robot in dict.fromkeys([*talk.parents, *talk.beliefs]) if robot not in among]


def bids(scene: Scene, talk: OpenConversation, award: Award) -> str:
    """The bids, the best first, and why others did not bid: a table."""
    offers = sorted(award.bids)
    count = f"{len(offers)} bids, the lowest wins" if len(offers) > 1 else "the only bid"
    metric = f"{scene.metric or 'bid'}{f' [{scene.unit}]' if scene.unit else ''}"
    rows = [f"| {count} | {metric} | believed | holds |", "|---|---|---|---|"]
    rows += [_offer(bid, talk.beliefs.get(bid.robot), award.winner) for bid in offers[:MANY_BIDS]]
    if len(offers) > MANY_BIDS:
        rows.append(f"| and {len(offers) - MANY_BIDS} more | | | |")
    for robot in silent(talk, award)[:MANY_SILENT]:
        rows.append(f"| r{robot}: {why_not(talk.beliefs.get(robot), talk, robot)} | – | | |")
    left = len(silent(talk, award)) - MANY_SILENT
    if left > 0:
        rows.append(f"| and {left} more without a bid | – | | |")
    return "\n".join(rows)


def nobody(talk: OpenConversation, award: Award) -> str:
    """Why nobody goes."""
    if award.bids:
        return "**Nobody goes**: whoever won was not told."
    reasons = Counter(
        "believed it to take more than they hold"
        if (why := why_not(talk.beliefs.get(robot), talk, robot)).startswith("believes")
        else why
        for robot in silent(talk, award)
    )
    words = "; ".join(f"{count} {why}" for why, count in reasons.most_common())
    return f"**Nobody can go**{': ' + words if words else ''}."


def belief(scene: Scene, talk: OpenConversation, winner: RobotId, at: Point) -> str:
    """What the winner believed of its trip."""
    held = talk.beliefs.get(winner)
    if held is None:
        return ""
    return (
        f"**r{winner}** believed that it takes **{held.cost:.1f} J**"
        f" ({BELIEFS.get(scene.belief, scene.belief)}) of the {held.energy:.1f} J that it held,"
        f" for {dist(at, talk.site):.2f} m as the crow flies."
    )


def driven(scene: Scene, trip: TripEnd, held: Belief | None, left: float) -> str:
    """What the trip came to, beside what was foreseen: a table."""
    straight = dist(trip.origin, trip.site)
    foreseen = scene.per_metre * straight
    over = f" ({100.0 * (trip.energy / foreseen - 1.0):+.1f} %)" if foreseen > 0.0 else ""
    rows = [
        f"| r{trip.robot} | way | energy | time | left |",
        "|---|---|---|---|---|",
        f"| Eq. (1), straight | {straight:.2f} m | {foreseen:.1f} J | | |",
    ]
    if held is not None and scene.belief != "straight":
        rows.append(f"| believed | | {held.cost:.1f} J | | |")
    if trip.planned > 0.0:
        rows.append(f"| planned | {trip.planned:.2f} m | | | |")
    waited = f", {trip.waited:.1f} s of it waiting" if trip.waited > 0.05 else ""
    rows.append(
        f"| driven | {trip.path:.2f} m | **{trip.energy:.1f} J**{over}"
        f" | {trip.ended - trip.departed:.1f} s{waited} | {left:.1f} J |"
    )
    return "\n".join(rows)


def _offer(bid: Bid, held: Belief | None, winner: RobotId | None) -> str:
    name = f"**r{bid.robot}** goes" if bid.robot == winner else f"r{bid.robot}"
    if held is None:
        return f"| {name} | {bid.cost:.2f} | | |"
    return f"| {name} | {bid.cost:.2f} | {held.cost:.1f} J | {held.energy:.1f} J |"


def _names(robots: Iterable[RobotId]) -> str:
    listed: Sequence[RobotId] = list(robots)
    named = ", ".join(f"r{robot}" for robot in listed[:MANY_NAMED])
    return f"{named} and {len(listed) - MANY_NAMED} more" if len(listed) > MANY_NAMED else named
