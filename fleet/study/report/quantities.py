"""What is measured, and what is varied: names and units for people to read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fleet.scenario.errors import bad, unknown
from fleet.study.frame import is_numeric
from fleet.study.report.runs import Runs

MEASURES = {
    "lifetime": "lifetime [events served]",
    "before_death": "served before a robot died on its way [events]",
    "stream_response_mean": "response time, mean [s]",
    "stream_response_p90": "response time, 90 % below [s]",
    "stream_within_deadline": "reached by the deadline [share]",
    "served_share": "events served [share]",
    "stream_throughput": "events served [1/s]",
    "stream_utilisation": "utilisation of robots [share]",
    "drained_per_served": "drained per event served [J]",
    "messages_per_event": "messages per event",
    "messages_per_robot": "messages per robot",
    "energy_left_sd": "energy left, SD over robots [J]",
    "distance_per_robot": "distance per robot [m]",
    "path_per_robot": "path per robot [m]",
    "closest_found": "closest robot found [share]",
    "energy_drained": "energy drained [J]",
    "failed": "trips that failed",
    "messages": "messages",
    "energy_left_mean": "energy left per robot [J]",
    "energy_left_min": "least energy left [J]",
    "energy_predicted": "energy by Eq. (1) [J]",
    "predicted_per_served": "Eq. (1) per event served [J]",
    "events": "events raised",
    "served": "events served",
    "waiting": "events still open",
    "expired": "events expired",
    "lost": "events lost",
    "reactions_per_robot": "reactions per robot",
    "simulated_time": "simulated time [s]",
    "hops_greedy": "greedy hops",
    "hops_face": "face hops",
}
"""Columns that a report looks at, in the order in which it takes them."""

AXES = {
    "range": "radio range [m]",
    "search_radius": "search radius [m]",
    "robots": "robots",
    "robot_capacity": "battery capacity [J]",
    "robot_cruise": "cruise speed [m/s]",
    "robot_radius": "robot radius [m]",
    "world_width": "width of the floor [m]",
    "protocol_metric": "metric",
}

AT_A_TIME = 6  # measures in a figure, unless the study names others


def name_of(column: str) -> str:
    """A column's name with its unit."""
    if column.startswith("energy_by_account_"):
        account = column.removeprefix("energy_by_account_").removesuffix("_per_served")
        return f"{account.replace('_', ' ')} [J]"
    if column.startswith("lost_by_reason_"):
        return f"lost: {column.removeprefix('lost_by_reason_').replace('_', ' ')}"
    return MEASURES.get(column) or AXES.get(column) or column.replace("_", " ")


def short_name(column: str) -> str:
    """A column's name without its unit."""
    return name_of(column).partition(" [")[0]


def measures(runs: Runs, asked: Sequence[str] | None) -> list[str]:
    """The measures that are asked for, or the first few, of those that differ between runs.

    Raises:
        BadInput: one that is asked for is not there.
    """
    if asked is not None:
        for name in asked:
            if name not in runs.columns or not is_numeric(runs[name]):
                numeric = [n for n, column in runs.columns.items() if is_numeric(column)]
                raise bad("report.measures", unknown("measure", name, numeric))
        return list(asked)
    found: list[str] = []
    for name in (*MEASURES, *_others(runs)):
        if name in runs.columns and _varies(runs, name) and not _seen(runs, name, found):
            found.append(name)
    if not found:  # as of a single run
        found = [n for n in MEASURES if n in runs.columns and np.isfinite(runs[n]).any()]
    return found[:AT_A_TIME]


def _others(runs: Runs) -> list[str]:
    """Columns of work functions of another kind; of a scenario's play, those above will do."""
    if "lifetime" in runs.columns:
        return []
    return [name for name in runs.columns if name not in {*runs.axes, "seed", "wall_time"}]


def _varies(runs: Runs, name: str) -> bool:
    column = runs[name]
    return is_numeric(column) and len(np.unique(column[np.isfinite(column)])) > 1


def _seen(runs: Runs, name: str, found: Sequence[str]) -> bool:
    """Whether another measure says the same: the path is the distance where robots go straight."""
    return any(np.allclose(runs[name], runs[other], rtol=1e-9) for other in found)
