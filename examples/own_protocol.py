"""A protocol of one's own, with a bid metric of one's own.

    fleet run --protocol examples/own_protocol.py:first_there
    fleet run --set protocol.metric=examples/own_protocol.py:lone_wolf

From Python, as below, the scenario names them in the same way.
"""

from math import dist

import fleet
from protocols.auctions import AuctionRules, auction
from protocols.metrics import distance
from protocols.routing import Search, find


def first_there(view, event, source, *, search: Search = Search(radius=3.0)):
    """Route towards the event, then send whoever is nearest within two hops."""
    found = yield from find(view, source, event, search)
    rules = AuctionRules(hops=2, auctioneer_bids=True)
    return (yield from auction(view, found, event, distance, rules))


def lone_wolf(robot, site):
    """The lowest bid wins: near the event, and with few neighbours to miss it."""
    return dist(robot.position, site) * (1 + len(robot.neighbours))


def main() -> None:
    here = __file__
    for name, protocol in (
        ("rfta2", "rfta2"),
        ("first_there", f"{here}:first_there"),
        ("rfta2, lone_wolf", {"name": "rfta2", "metric": f"{here}:lone_wolf"}),
    ):
        run = fleet.run(fleet.Scenario.of(protocol=protocol, motion="straight", seed=1))
        print(
            f"{name:16} lives {run.lifetime:3} rounds"
            f" at {run.messages / run.events:4.1f} messages a round"
        )


if __name__ == "__main__":
    main()
