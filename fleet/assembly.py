"""From a scenario to a simulation that is ready to run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from math import inf, pi

import numpy as np

from fleet.fleet import Fleet, RunLabels
from fleet.handler import Handler
from fleet.modes import Stream
from fleet.motion.motions import MOTIONS
from fleet.observer import Audience, Observer
from fleet.power import Battery
from fleet.radio import Radio
from fleet.radio.ideal import IdealRadio
from fleet.radio.lossy import LossyRadio, RadioSpec
from fleet.results import Summary
from fleet.robot import Robot
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
from protocols.messages import Point
from protocols.topology import Topology, connected, unit_disc
from worlds.arena import FloatArray, ImpossibleWorld
from worlds.catalogue import World
from worlds.sensors import deploy

STREAMS = ("placement", "sites", "collector", "heading", "times", "radio", "faults", "sensors")
"""Independent random streams of a run. Append only: the order decides every run."""

ATTEMPTS = 2000  # placements drawn in search of a connected network
MOST_LINKS = 20_000_000  # twice the unit disc links that fit into memory and patience


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
    motion = make_motion(scenario.motion, scenario.robot, world.arena, audience.sample_interval)
    solid = MOTIONS[scenario.motion.name].solid
    points = start(world, scenario, scenario.robot.radius if solid else 0.0, random["placement"])
    radio_choice = radio_spec(scenario.radio)
    lossy = radio_choice and lossy_radio(points, scenario, radio_choice, random["radio"])
    live = audience.link_interval is not None  # links are asked for while robots drive
    topology = Topology(points, scenario.range, scenario.graph, compiled=live or None)
    radio: Radio = lossy or IdealRadio(topology)
    headings = (2.0 * pi * random["heading"].random(len(points)) - pi).tolist()
    robots = [
        Robot(
            id, point, heading, Battery(scenario.robot.capacity), scenario.range,
            radio.tables, motion,
        )
        for id, (point, heading) in enumerate(zip(points, headings, strict=True))
    ]  # fmt: skip
    motion.place(robots)
    labels = RunLabels(
        scenario.protocol.name, scenario.motion.name, scenario.world.name,
        scenario.seed, scenario.search_radius,
    )  # fmt: skip
    handler = make_handler(scenario, world, random)
    fleet = Fleet(labels, world.arena, scenario.robot, robots, topology, radio.reach, handler.field)
    return Simulation(
        fleet,
        protocol,
        radio,
        motion,
        handler,
        make_schedule(scenario, world, len(robots), random),
        audience,
    )


def make_schedule(
    scenario: Scenario, world: World, robots: int, random: Mapping[str, np.random.Generator]
) -> Schedule:
    """What will befall the fleet."""
    timing = make_timing(scenario.time)
    for fault in scenario.faults.planned:
        if fault.robot >= robots:
            raise bad("faults.planned", f"robot is {fault.robot}; expected 0 to {robots - 1}")
    rate = timing.rate if isinstance(timing, Stream) else inf
    try:
        occurrences = bind_events(scenario.events)(
            world.arena, rate, random["sites"], random["times"]
        )
        first = next(occurrences, None)  # what an event process refuses, it refuses here
    except ValueError as error:
        raise bad("events", str(error)) from error
    return Schedule(
        timing,
        iter(()) if first is None else chain([first], occurrences),
        tuple(scenario.faults.breakdowns(robots, random["faults"])),
        scenario.faults.blackouts,
        scenario.rounds,
    )


def make_handler(
    scenario: Scenario, world: World, random: Mapping[str, np.random.Generator]
) -> Handler:
    """Who is told of events, and by whom."""
    field = None
    if scenario.sensors is not None:
        field = deploy(world.arena, scenario.sensors, random["sensors"])
    shares = uniform_shares(random["collector"])
    return Handler(shares, scenario.handler, field, random["sensors"])


def lossy_radio(
    points: Sequence[Point], scenario: Scenario, spec: RadioSpec, rng: np.random.Generator
) -> LossyRadio:
    """The radio of that kind among robots at ``points`` [m]."""
    seed = int(rng.integers(2**62))
    try:
        return LossyRadio(points, scenario.range, scenario.graph, spec, seed)
    except ValueError as error:
        raise bad("graph", str(error)) from error


def streams(seed: int) -> dict[str, np.random.Generator]:
    """One generator for each purpose, all spawned from the run's one seed."""
    children = np.random.SeedSequence(seed).spawn(len(STREAMS))
    return dict(zip(STREAMS, map(np.random.default_rng, children), strict=True))


def start(world: World, scenario: Scenario, radius: float, rng: np.random.Generator) -> list[Point]:
    """Places [m] for the scenario's robots, of ``radius`` [m] each, that make one network.

    Raises:
        ImpossibleWorld: none of :data:`ATTEMPTS` placements was connected, where it must be.
    """
    count = scenario.robots or world.robots
    degree = count * pi * scenario.range**2 / (world.arena.width * world.arena.height)
    if count * min(degree, count) > MOST_LINKS:
        raise ImpossibleWorld(
            f"robots is {count}; {min(degree, count):.0f} of them within range of each"
            f" are too many links to keep; expected fewer robots or a shorter range"
        )
    attempts = 1 if world.fixed else ATTEMPTS
    for _ in range(attempts):
        positions: FloatArray = world.place(world.arena, count, radius, rng)
        if not scenario.connected or connected(count, unit_disc(positions, scenario.range)):
            return [(x, y) for x, y in positions.tolist()]
    placements = "the placement" if world.fixed else f"none of {attempts} placements"
    verb = "is not" if world.fixed else "made"
    raise ImpossibleWorld(
        f"range is {scenario.range} m; {placements} of {count} robots {verb} a connected network;"
        f" expected a longer range, more robots, or connected = false"
    )


def uniform_shares(rng: np.random.Generator) -> Iterator[float]:
    """Numbers in [0, 1) without end."""
    while True:
        yield from rng.random(1024).tolist()
