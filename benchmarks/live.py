"""The live world at scale: streams, lossy radio, everybody driving; and how cost grows with n.

Aims: 10 000 robots, an event a second, path motion, ideal radio: faster than real time on one
core. 1 000 robots with lossy radio and beacons: faster than real time. 100 and 1 000 robots all
driving with messages on: at least ten times ARGoS 3 with foot-bots, Lua controllers and messages,
which made 80 and 3.3 steps of 0.1 s a CPU second on a comparable core.
"""

from __future__ import annotations

import time
from math import inf

import fleet
from fleet.assembly import prepare
from fleet.observer import Observer

ARGOS = {100: 80.0, 1000: 3.3}  # steps of 0.1 s per CPU second


class Busy(Observer):
    """The share of robots under way, over time."""

    def __init__(self) -> None:
        self.departures = self.driven = 0.0

    def departed(self, event: object, robot: int, time: float) -> None:
        self.departures += 1

    def trip_ended(self, event: object, trip: object) -> None:
        self.driven += trip.ended - trip.departed - trip.waited


def speed(duration: float, **keys: object) -> tuple[float, fleet.Summary, Busy]:
    """Simulated seconds a CPU second."""
    side = float(keys["robots"]) ** 0.5
    scenario = {"world": {"name": "random", "width": side, "height": side}, **keys}
    busy = Busy()
    simulation = prepare(fleet.Scenario.of(**scenario), [busy])
    started = time.process_time()
    summary = simulation.run()
    return duration / (time.process_time() - started), summary, busy


def stream(rate: float, duration: float, deadline: float = inf) -> dict[str, object]:
    return {"name": "stream", "rate": rate, "duration": duration, "deadline": deadline}


def main() -> None:
    speed(10.0, robots=100, motion="path", time=stream(1.0, 10.0), radio="lossy", connected=False)
    print("an event a second, path motion, 1 robot/m²: simulated seconds a CPU second")
    for n, duration in ((100, 300.0), (1_000, 200.0), (10_000, 100.0)):
        for radio in ("ideal", "lossy"):
            fast, summary, _ = speed(
                duration, robots=n, motion="path", radio=radio, time=stream(1.0, duration),
                connected=False,
            )  # fmt: skip
            print(
                f"  {n:6} robots, {radio:5} radio: {fast:7.1f}; {summary.served} of"
                f" {summary.events} served, {summary.messages} messages,"
                f" {summary.beacons} beacons"
            )
    print("most of them driving, with messages: steps of 0.1 s a CPU second, and × ARGoS 3")
    for n, rate, duration in ((100, 60.0, 30.0), (1_000, 600.0, 10.0)):
        for motion in ("path", "physics"):
            fast, summary, busy = speed(
                duration, robots=n, motion=motion, protocol="rfta2",
                time=stream(rate, duration, 0.5), robot={"capacity": 1e6}, connected=False,
            )  # fmt: skip
            driving = busy.driven / (n * duration)
            print(
                f"  {n:6} robots, {motion:7}: {10 * fast:7.0f} steps,"
                f" {10 * fast / ARGOS[n]:5.1f} ×;"
                f" {driving:.0%} of them under way, {summary.messages / duration:.0f} messages/s"
            )


if __name__ == "__main__":
    main()
