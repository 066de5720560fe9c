"""The energy study of a scenario of the user's: its robot, its floor, its motion."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot
from typing import Any

from fleet.experiments.energy.settings import Place, Subject, Variation
from fleet.scenario.choices import check, make_world
from fleet.scenario.errors import BadInput, bad
from fleet.scenario.loading import merged, scenario_from
from fleet.scenario.model import Scenario

NAME = "as it is"
PLACE = "this floor"
WAYS = {"path": "foreseen, without forces", "physics": "pushed by forces"}
"""Motions with a body, and what the other one of the two is called beside it."""


def own_subject(scenario: Scenario) -> Subject:
    """What is studied of a scenario, instead of the paper's.

    Single tasks go over straight distances of up to half the floor's diagonal. One thing at a time
    is different in its robots; what such a robot cannot be is left out. The protocols that are
    compared are those of the study, lifetimes are lived in rounds.

    Raises:
        BadInput: its robots have no body, or its events come by a clock.
    """
    motion = scenario.motion.name
    if motion not in WAYS:
        said = f"is {motion!r}, where trips cost Eq. (1) by definition"
        raise bad("motion", f"{said}; expected 'path' or 'physics'")
    if scenario.time.name != "rounds":
        raise bad("time", f"is {scenario.time.name!r}; the study lives lifetimes in 'rounds'")
    tables = scenario.as_dict()
    base = {key: value for key, value in tables.items() if key not in ("seed", "protocol")}
    arena = make_world(scenario.world).arena
    other = next(way for way in WAYS if way != motion)
    return Subject(
        name=NAME,
        floor=f"its floor of {arena.width:g} m × {arena.height:g} m",
        settings=(Variation("as it is", NAME), *_possible(base, _variations(scenario))),
        engine=Variation("engine", WAYS[other], {"motion": other}),
        longest=0.5 * hypot(arena.width, arena.height),
        places=(Place(PLACE, NAME, {}),),
        base=base,
        traffic=False,
    )


def _variations(scenario: Scenario) -> Iterator[Variation]:
    """One thing different at a time, in measures of the robot that there is."""
    robot = scenario.robot

    def body(name: str, motion: str | None = None, **keys: float) -> Variation:
        varied: dict[str, Any] = {"robot": keys}
        return Variation("body", name, varied | ({"motion": motion} if motion else {}))

    yield body("weighs half", mass=0.5 * robot.mass)
    yield body("weighs twice as much", mass=2.0 * robot.mass)
    yield body("speeds up half as fast", acceleration=0.5 * robot.acceleration)
    yield body("scrubs half as much", scrub=0.5 * robot.scrub)
    yield body("scrubs twice as much", scrub=2.0 * robot.scrub)
    yield body("cruises at half the speed", cruise=0.5 * robot.cruise)
    yield body("carries a tenth of its weight unknown to it", "physics", payload=0.1 * robot.mass)
    yield body("parameters off by up to 20 %", "physics", error=0.2)
    if scenario.robots is not None and scenario.robots >= 6:
        yield Variation("density", "a third of the robots", {"robots": scenario.robots // 3})


def _possible(base: dict[str, Any], varied: Iterator[Variation]) -> Iterator[Variation]:
    """Those that differ from the base, and that there can be."""
    plain = scenario_from(base)
    for variation in varied:
        try:
            scenario = scenario_from(merged(base, variation.scenario))
            check(scenario)
        except BadInput:
            continue
        if scenario != plain:
            yield variation
