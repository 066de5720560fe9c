"""From the names in a scenario to what they stand for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from inspect import isclass
from typing import Any

from numpy.random import Generator

from fleet.catalogue import look_up, parameters_of, takers
from fleet.faults import Faults
from fleet.modes import Rounds, Stream
from fleet.motion import Motion
from fleet.power import ExtraPower, PowerModel
from fleet.radio.hearsay import RadioParameters
from fleet.robot import RobotSpec
from fleet.scenario.binding import bind, build, field_types, keywords, made_by
from fleet.scenario.errors import BadInput, bad, shown
from fleet.scenario.model import Choice, Scenario, plain
from fleet.scenario.plugins import load_object, looks_like_file
from fleet.scenario.rehearsal import guarded, rehearse
from protocols.messages import ProtocolFunction
from worlds.arena import Arena
from worlds.catalogue import World
from worlds.events import Occurrence
from worlds.sensors import SensorSpec

TABLES = {
    "robot": RobotSpec,
    "robot.power": PowerModel,
    "robot.extra": ExtraPower,
    "faults": Faults,
    "sensors": SensorSpec,
}
"""The tables of a scenario that are not picked by name."""


def check(scenario: Scenario) -> None:
    """Look everything up that the scenario names.

    Raises:
        BadInput: something of a name does not exist, or a parameter does not fit.
    """
    problems: list[tuple[str, str]] = []
    for bound in (
        lambda: bind_protocol(scenario),
        lambda: make_world(scenario.world),
        lambda: motion_options(scenario.motion),
        lambda: make_timing(scenario.time),
        lambda: radio_spec(scenario.radio),
        lambda: bind_events(scenario.events),
    ):
        try:
            bound()
        except BadInput as error:
            problems.extend(error.problems)
    if problems:
        raise BadInput(problems)


def functions_of(scenario: Scenario) -> dict[str, Callable[..., Any]]:
    """What the parameters of each choice are given to, by the scenario's key."""
    kinds = ("world", "motion", "time", "radio", "events")
    found = {kind: look_up(kind, getattr(scenario, kind).name, kind) for kind in kinds}
    return {
        "protocol": protocol_function(scenario.protocol.name),
        **{kind: parameters_of(entry) for kind, entry in found.items()},
    }


OTHER_WORDS = {"speed": "cruise", "velocity": "cruise", "battery": "capacity", "energy": "capacity"}
"""What others call our keys."""


def homes(name: str) -> Iterator[str]:
    """The tables of a scenario that have a key of that name, as ``table.name``."""
    name = OTHER_WORDS.get(name, name)
    for table in ("protocol", "world", "motion", "time", "radio", "events"):
        if any(name in keywords(function) for function in takers(table).values()):
            yield f"{table}.{name}"
    for table, kind in TABLES.items():
        if name in field_types(kind):
            yield f"{table}.{name}"


def bind_protocol(scenario: Scenario) -> ProtocolFunction:
    """The scenario's protocol with its parameters: from the catalogue, or a file of the user's.

    Raises:
        BadInput: there is none of that name, or a parameter does not fit.
    """
    name, parameters = scenario.protocol.name, dict(scenario.protocol.parameters)
    function = protocol_function(name)
    accepted = keywords(function)
    search = parameters.get("search", {})
    if not isinstance(search, Mapping):
        raise bad("protocol.search", f"is {shown(search)}; expected a table")
    if "radius" in search or "search_radius" in parameters:
        wrong = "search_radius" if "search_radius" in parameters else "search.radius"
        raise bad(f"protocol.{wrong}", "is the scenario's; set search_radius instead")
    if "search" in accepted:
        parameters["search"] = {**search, "radius": scenario.search_radius}
    elif "search_radius" in accepted:
        parameters["search_radius"] = scenario.search_radius
    given = (parameters, "protocol", takers("protocol"))
    made: ProtocolFunction = (
        made_by(function, name, *given) if isclass(function) else bind(function, *given)
    )
    made = guarded(made, name, plain(scenario.protocol))
    rehearse(made, name)
    return made


def protocol_function(name: str) -> Any:
    """A protocol, or a class of them, of the catalogue or of a file of the user's.

    Raises:
        BadInput: there is none of that name.
    """
    if looks_like_file(name):
        return load_object(name, "protocol")
    return look_up("protocol", name, "protocol").function


def _made(kind: str, choice: Choice) -> Any:
    """What the parameters of a choice come to."""
    taker = parameters_of(look_up(kind, choice.name, kind))
    return build(taker, choice.parameters, kind, takers(kind))


def make_world(choice: Choice) -> World:
    """The world of that name, with its parameters.

    Raises:
        BadInput: there is none of that name, or a parameter does not fit.
    """
    made: World = _made("world", choice)
    return made


def make_motion(
    choice: Choice,
    spec: RobotSpec,
    arena: Arena,
    sample_interval: float | None,
    rng: Generator | None = None,
) -> Motion:
    """The motion of that name, with its parameters; ``rng`` draws how each robot differs.

    Raises:
        BadInput: there is none of that name, or a parameter does not fit.
    """
    options = motion_options(choice)
    motion: Motion
    try:
        motion = look_up("motion", choice.name, "motion").function(
            spec, arena, options, sample_interval, rng
        )
    except ValueError as error:
        raise bad("motion", str(error)) from error
    return motion


def motion_options(choice: Choice) -> Any:
    """The parameters of the motion of that name.

    Raises:
        BadInput: there is none of that name, or a parameter does not fit.
    """
    return _made("motion", choice)


def make_timing(choice: Choice) -> Rounds | Stream:
    """How time goes, by name.

    Raises:
        BadInput: there is none of that name, or a parameter does not fit.
    """
    timing: Rounds | Stream = _made("time", choice)
    return timing


def radio_spec(choice: Choice) -> RadioParameters | None:
    """What the radio is like; None: it is ideal.

    Raises:
        BadInput: there is none of that name, or a parameter does not fit.
    """
    spec: RadioParameters | None = _made("radio", choice)
    return spec


def bind_events(choice: Choice) -> Callable[..., Iterator[Occurrence]]:
    """The event process of that name: to be called with arena, rate and two generators.

    Raises:
        BadInput: there is none of that name, or a parameter does not fit.
    """
    function: Callable[..., Iterator[Occurrence]] = look_up(
        "events", choice.name, "events"
    ).function
    return bind(function, choice.parameters, "events", takers("events"))
