"""A protocol or metric of the user's, put through what those of the catalogue are."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from math import isnan
from numbers import Real
from pathlib import Path
from typing import Any, NamedTuple

from fleet.scenario.binding import bind, made_by
from fleet.scenario.errors import bad, shown
from fleet.scenario.guard import begun
from fleet.scenario.plugins import load_object, what, where_in
from fleet.scenario.watchdog import Stuck, Watch
from protocols.conformance import CHECKS, GRAPHS, cases, problem
from protocols.messages import (
    Award,
    Conversation,
    Event,
    Point,
    ProtocolFunction,
    RobotId,
    RobotView,
    View,
)
from protocols.rules import BrokenRule, ReadOnlyRobot, all_knowing


class Verdict(NamedTuple):
    """What was checked, and what is wrong; "" if nothing is."""

    claim: str
    problem: str


def trial(reference: str) -> list[Verdict]:
    """Check what ``file.py:name`` means, a protocol or a metric.

    Raises:
        BadInput: it is neither, or is not there.
    """
    key = "check"
    function = load_object(reference, key)
    folder = Path(reference.rpartition(":")[0]).resolve().parent
    made = inspect.isclass(function)
    found: Any = made_by(function, reference, {}, key) if made else bind(function, {}, key)
    needed = [
        parameter
        for parameter in inspect.signature(found).parameters.values()
        if parameter.kind in (parameter.POSITIONAL_ONLY, parameter.POSITIONAL_OR_KEYWORD)
        and parameter.default is parameter.empty
    ]
    if len(needed) == 3:
        where = partial(where_in, folder=folder)
        protocol = _watched(found, reference, Watch(folder))
        checks = {claim: partial(problem, claim, protocol, GRAPHS, where) for claim in CHECKS}
        return _verdicts(checks, folder)
    if len(needed) == 2:
        checks = {claim: partial(check, found) for claim, check in METRIC.items()}
        with Watch(folder):
            return _verdicts(checks, folder)
    raise bad(
        key,
        f"{shown(reference)} takes {len(needed)} arguments; expected a protocol"
        " (view, event, source) or a metric (robot, site)",
    )


def _verdicts(checks: Mapping[str, Callable[[], str]], folder: Path) -> list[Verdict]:
    """What each check says; if the first one fails, the others say the same, and are left out."""
    verdicts: list[Verdict] = []
    for claim, check in checks.items():
        if verdicts and verdicts[0].problem:
            break
        try:
            found = check()
        except (Exception, Stuck) as error:
            where = where_in(error, folder)
            if not where:  # none of the user's lines had a part in it
                raise
            found = f"fails{where}: {what(error)}"
        verdicts.append(Verdict(claim, found))
    return verdicts


def _watched(protocol: ProtocolFunction, called: str, watch: Watch) -> ProtocolFunction:
    """The same, broken off if it does not come to say anything."""

    def watched(view: View, event: Event, source: RobotId) -> Conversation:
        heard: Any = None
        words: Any = None
        while True:
            try:
                with watch:
                    words = words or begun(protocol(view, event, source), called)
                    said = words.send(heard)
            except StopIteration as end:
                award: Award = end.value
                return award
            try:
                heard = yield said
            except BrokenRule as broken:
                words.throw(broken)  # to be raised where it was said
                raise

    watched.all_knowing = all_knowing(protocol)  # type: ignore[attr-defined]
    return watched


def _bids_numbers(metric: Callable[[RobotView, Point], Any]) -> str:
    for robot, site in _trips():
        cost = metric(ReadOnlyRobot(robot), site)
        if not isinstance(cost, Real) or isnan(cost):
            return f"robot {robot.id} bids {shown(cost)}; expected a number"
    return ""


def _bids_the_same_again(metric: Callable[[RobotView, Point], Any]) -> str:
    for robot, site in _trips():
        first, second = (metric(ReadOnlyRobot(robot), site) for _ in range(2))
        if first != second:
            return f"robot {robot.id} bids {shown(first)}, and then {shown(second)}"
    return ""


def _looks_at_no_name(metric: Callable[[RobotView, Point], Any]) -> str:
    for robot, site in _trips():
        named, renamed = robot, replace(robot, id=robot.id + 1000)
        if metric(ReadOnlyRobot(named), site) != metric(ReadOnlyRobot(renamed), site):
            return f"robot {robot.id} would bid another thing under another number"
    return ""


def _trips() -> list[tuple[Any, Point]]:
    networks = [case for graph in GRAPHS[:2] for case in cases(graph, 4)]
    return [(robot, case.event.position) for case in networks for robot in case.view()]


METRIC: dict[str, Callable[..., str]] = {
    "bids numbers": _bids_numbers,
    "bids the same again": _bids_the_same_again,
    "does not look at names": _looks_at_no_name,
}
"""What is checked of a metric, in words."""
