"""Measuring a run in one's own way: an observer that keeps what every trip drained.

An observer overrides the hooks of what it wants to see; fleet/observer.py lists them all.
"""

from math import dist

import fleet


class Trips(fleet.Observer):
    """How far each trip went, what Eq. (1) says of it, and what it drained."""

    def __init__(self):
        self.rows = []

    def run_started(self, fleet):
        """Everybody is in place."""
        self.per_metre = fleet.spec.power.per_metre(fleet.spec.cruise)  # Eq. (1) [J/m]

    def trip_ended(self, event, trip):
        """A robot came to rest: at the event, or short of it."""
        if trip.outcome == "arrived":
            straight = dist(trip.origin, trip.site)
            self.rows.append((straight, self.per_metre * straight, trip.energy))


def main() -> None:
    trips = Trips()
    for seed in range(5):
        fleet.run(fleet.Scenario.of(protocol="rfta2", seed=seed), [trips])
    print(f"{len(trips.rows)} trips of RFTA2, drained energy as a multiple of Eq. (1):")
    for low, high in ((0.05, 0.5), (0.5, 1.0), (1.0, 2.0), (2.0, 5.0)):
        some = [(said, drained) for far, said, drained in trips.rows if low <= far < high]
        said, drained = map(sum, zip(*some, strict=True))
        print(f"  {low:4} to {high} m: {drained / said:.2f} over {len(some)} trips")


if __name__ == "__main__":
    main()
