"""What somebody who knew everything would do: bounds and baselines, not protocols to deploy.

They ask any robot at any time and say nothing, so their message counts mean nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from protocols.auctions import offer
from protocols.messages import Award, Conversation, Event, RobotId, View
from protocols.metrics import Metric, distance
from protocols.routing import deliver


def optimum(
    view: View, event: Event, source: RobotId, *, metric: Metric = distance
) -> Conversation:
    """The best of all robots by the metric, whoever can afford the trip; nothing is said."""
    yield from ()
    bids = [bid for robot in view if (bid := offer(robot, event, metric)) is not None]
    return Award(min(bids).robot if bids else None, source, tuple(bids))


def gfg(view: View, event: Event, source: RobotId) -> Conversation:
    """Deliver to the nearest able robot by greedy-face-greedy, as if its place were known."""
    bids = [bid for robot in view if (bid := offer(robot, event, distance)) is not None]
    if not bids:
        return Award(None, source)
    best = min(bids).robot
    reached = yield from deliver(view, source, best, view[best].position)
    return Award(best if reached == best else None, reached, tuple(bids))


optimum.all_knowing = gfg.all_knowing = True  # type: ignore[attr-defined]


@dataclass(frozen=True, slots=True, kw_only=True)
class Assignment:
    """Robots for all open events at once, at the least total cost; nothing is said.

    In a stream, events are collected for ``interval`` [s] and then assigned together, those
    that wait again too. In rounds there is one at a time, for the best of all robots.

    Raises:
        ValueError: the interval is not positive.
    """

    metric: Metric = distance
    interval: float = 1.0

    all_knowing: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if not 0.0 < self.interval < inf:
            raise ValueError(f"interval is {self.interval} s; expected more than 0")

    def __call__(self, view: View, event: Event, source: RobotId) -> Conversation:
        """One event by itself."""
        return optimum(view, event, source, metric=self.metric)

    def together(self, view: View, events: Sequence[Event]) -> dict[int, RobotId]:
        """Event id to robot, of those that can be served."""
        return assign_all(view, events, self.metric)


def assign_all(
    view: View, events: Sequence[Event], metric: Metric = distance
) -> dict[int, RobotId]:
    """Robots for several events at once, at the least total cost: event id to robot.

    As many events are served as there are able robots for; of the ways to serve that many,
    the one whose metric costs add up to least (the assignment problem, solved by the
    Jonker-Volgenant algorithm of ``scipy.optimize.linear_sum_assignment``).
    """
    from scipy.optimize import linear_sum_assignment

    costs: NDArray[np.float64] = np.full((len(events), len(view)), np.inf)
    for row, event in enumerate(events):
        for robot in view:
            bid = offer(robot, event, metric)
            if bid is not None:
                costs[row, robot.id] = bid.cost
    able = np.isfinite(costs)
    if not able.any():
        return {}
    spread = float(np.ptp(costs[able])) + 1.0
    refused = float(costs[able].max()) + spread * (min(costs.shape) + 1)
    rows, columns = linear_sum_assignment(np.where(able, costs, refused))
    return {
        events[row].id: int(robot)
        for row, robot in zip(rows.tolist(), columns.tolist(), strict=True)
        if able[row, robot]
    }
