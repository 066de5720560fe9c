"""From a scenario to a simulation that is ready to run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from math import pi

import numpy as np

from fleet.agenda import Agenda
from fleet.catalogue import look_up
from fleet.faults import Blackout
from fleet.fleet import Fleet, RunLabels
from fleet.handler import Handler
from fleet.observer import Audience, Observer
from fleet.placement import start
from fleet.power import Battery
from fleet.radio import Radio
from fleet.radio.hearsay import Scattered
from fleet.radio.ideal import IdealRadio
from fleet.results import Summary
from fleet.robot import Robot
from fleet.scenario.advice import advice
from fleet.scenario.choices import (
    bind_events,
    bind_protocol,
    make_motion,
    make_timing,
    make_world,
    radio_spec,
)
from fleet.scenario.errors import bad
from fleet.scenario.model import Scenario
from fleet.schedule import Schedule
from fleet.simulation import Simulation
from protocols.catalogue import PROTOCOLS, metric_of
from protocols.topology import Topology
from worlds.catalogue import World
from worlds.events import Occurrence
from worlds.ground import Ground, ground_of
from worlds.sensors import deploy
from worlds.shapes import Corner

STREAMS = (
    "placement",
    "sites",
    "collector",
    "heading",
    "times",
    "radio",
    "faults",
    "sensors",
    "builds",
)
"""Independent random streams of a run. Append only: the order decides every run."""


def run(scenario: Scenario, observers: Sequence[Observer] = ()) -> Summary:
    """Play the scenario to its end.

    Raises:
        BadInput: something in the scenario does not exist, or does not fit.
        ImpossibleWorld: no connected network of these robots was found in this world.
    """
    return prepare(scenario, observers).run()


def prepare(scenario: Scenario, observers: Sequence[Observer] = ()) -> Simulation:
    """The simulation of ``scenario``, everybody in place; see :func:`run`.

    Raises:
        BadInput: something in the scenario does not exist, or does not fit.
        ImpossibleWorld: no connected network of these robots was found in this world.
    """
    random = streams(scenario.seed)
    protocol = bind_protocol(scenario)
    world = make_world(scenario.world)
    audience = Audience(observers)
    motion = make_motion(
        scenario.motion, scenario.robot, world.arena, audience.sample_interval, random["builds"]
    )
    ground = ground_for(scenario, world)
    for said in remarks(scenario, world, ground):
        audience.noticed(said)
    points = start(world, ground, scenario, random["placement"], audience.placement_tried)
    agenda = Agenda()
    live = audience.link_interval is not None  # links are asked for while robots drive
    topology = Topology(points, scenario.range, scenario.graph, compiled=live or None)
    scattered = Scattered(points, scenario.range, scenario.graph, world.arena)
    radio = make_radio(scenario, scattered, random["radio"], agenda) or IdealRadio(topology)
    headings = (2.0 * pi * random["heading"].random(len(points)) - pi).tolist()
    robots = [
        Robot(
            id, point, heading, Battery(scenario.robot.capacity), scenario.range,
            radio.tables, motion,
        )
        for id, (point, heading) in enumerate(zip(points, headings, strict=True))
    ]  # fmt: skip
    motion.place(robots)
    known = PROTOCOLS.get(scenario.protocol.name)
    searches = known is None or known.searches
    labels = RunLabels(
        scenario.protocol.name, scenario.motion.name, scenario.world.name,
        scenario.seed, scenario.search_radius, *metric_of(protocol), searches,
        scenario.motion.parameters.get("belief", "straight"),
    )  # fmt: skip
    handler = make_handler(scenario, world, random)
    fleet = Fleet(labels, world.arena, scenario.robot, robots, topology, radio, handler.field)
    return Simulation(
        fleet,
        protocol,
        radio,
        agenda,
        motion,
        handler,
        make_schedule(scenario, ground, len(robots), random, audience.noticed),
        audience,
    )


def ground_for(scenario: Scenario, world: World) -> Ground:
    """Where the scenario's robots can be; those without a body are points.

    Raises:
        ImpossibleWorld: there is no room for them.
    """
    solid = look_up("motion", scenario.motion.name, "motion").solid
    return ground_of(world.arena, scenario.robot.radius if solid else 0.0, world.start)


def remarks(scenario: Scenario, world: World, ground: Ground) -> Iterator[str]:
    """What the author of a scenario may not have meant, or known: a sentence each."""
    yield from world.notices
    if said := ground.notice():
        yield said
    yield from advice(scenario, world.arena)


def make_schedule(
    scenario: Scenario,
    ground: Ground,
    robots: int,
    random: Mapping[str, np.random.Generator],
    noticed: Callable[[str], None] = lambda _said: None,
) -> Schedule:
    """What will befall the fleet."""
    timing = make_timing(scenario.time)
    for fault in scenario.faults.planned:
        if fault.robot >= robots:
            raise bad("faults.planned", f"robot is {fault.robot}; expected 0 to {robots - 1}")
    try:
        occurrences = bind_events(scenario.events)(
            ground, timing.rate, random["sites"], random["times"]
        )
        first = next(occurrences, None)  # what an event process refuses, it refuses here
    except ValueError as error:
        raise bad("events", f"{_file_of(scenario)}{error}") from error
    if first is not None and scenario.events.name == "trace":
        occurrences = _within(timing.duration, [first, *occurrences], scenario, noticed)
        first = next(occurrences)
    return Schedule(
        timing,
        iter(()) if first is None else chain([first], occurrences),
        tuple(scenario.faults.breakdowns(robots, random["faults"])),
        [_moved(blackout, ground.arena.corner) for blackout in scenario.faults.blackouts],
        scenario.rounds,
    )


def _moved(blackout: Blackout, corner: Corner) -> Blackout:
    """The same in the frame of the floor, of which the map's has its lower left ``corner`` [m]."""
    return replace(blackout, x=blackout.x - corner[0], y=blackout.y - corner[1])


def _within(
    last: float, listed: list[Occurrence], scenario: Scenario, noticed: Callable[[str], None]
) -> Iterator[Occurrence]:
    """The events of a trace that happen up to ``last`` [s]; it is said how many are not."""
    kept = [occurrence for occurrence in listed if occurrence.time <= last]
    count, file = len(listed) - len(kept), _file_of(scenario)
    if not kept:
        raise bad(
            "events",
            f"{file}none of {count} events happens within time.duration = {last:g} s;"
            f" the first is at {listed[0].time:g} s",
        )
    if count:
        noticed(
            f"{file}{count} of {len(listed)} events happen after time.duration = {last:g} s"
            f" and are left out"
        )
    return iter(kept)


def _file_of(scenario: Scenario) -> str:
    """The file of the user's that the events come from, to begin a sentence with."""
    file = scenario.events.parameters.get("occurrences")
    return f"{file}: " if isinstance(file, str) else ""


def make_handler(
    scenario: Scenario, world: World, random: Mapping[str, np.random.Generator]
) -> Handler:
    """Who is told of events, and by whom."""
    field = None
    if scenario.sensors is not None:
        field = deploy(world.arena, scenario.sensors, random["sensors"])
    shares = uniform_shares(random["collector"])
    return Handler(shares, scenario.handler, field, random["sensors"])


def make_radio(
    scenario: Scenario, fleet: Scattered, rng: np.random.Generator, agenda: Agenda
) -> Radio | None:
    """The radio that was asked for, among the fleet's robots; None: the ideal one."""
    spec = radio_spec(scenario.radio)
    if spec is None:
        return None
    seed = int(rng.integers(2**62))
    try:
        return spec.over(fleet, seed, agenda)
    except ValueError as error:
        raise bad("radio", str(error)) from error


def streams(seed: int) -> dict[str, np.random.Generator]:
    """One generator for each purpose, all spawned from the run's one seed."""
    children = np.random.SeedSequence(seed).spawn(len(STREAMS))
    return dict(zip(STREAMS, map(np.random.default_rng, children), strict=True))


def uniform_shares(rng: np.random.Generator) -> Iterator[float]:
    """Numbers in [0, 1) without end."""
    while True:
        yield from rng.random(1024).tolist()
