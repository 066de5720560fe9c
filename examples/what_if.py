"""What if the runner-up had gone? A run is stopped before an event and forked.

    python examples/what_if.py

The fork is the same run, to the bit, until it is told to go on otherwise.
"""

import fleet
from fleet.observer import Observer


class Auctions(Observer):
    """The bids of each event's auction, best first."""

    def __init__(self):
        self.bids = {}

    def awarded(self, event, award, time):
        self.bids[event.id] = sorted(award.bids)


def main() -> None:
    scenario = fleet.Scenario.of(protocol="rfta2", motion="straight", seed=1)
    auctions = Auctions()
    as_it_was = fleet.run(scenario, [auctions])
    event = next(event for event, bids in auctions.bids.items() if event >= 20 and len(bids) > 1)
    first, second = (bid.robot for bid in auctions.bids[event][:2])
    before = fleet.play(scenario).until(event=event)
    otherwise = before.fork(winner=second).finish()
    ge = before.fork(protocol="rfta2ge").finish()
    print(f"event {event}: robot {first} won, robot {second} came second")
    print(f"as it was                {as_it_was.lifetime:4} events served")
    print(f"had robot {second:2} gone        {otherwise.lifetime:4}")
    print(f"RFTA2GE from there on    {ge.lifetime:4}")


if __name__ == "__main__":
    main()
