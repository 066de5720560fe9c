"""What the author of a scenario may not have meant: keys that do nothing, and units mixed up.

None of it is wrong, so the run goes on; each is one sentence.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields
from math import hypot, pi

from fleet.robot import PRESETS, RobotSpec
from fleet.scenario.binding import keywords
from fleet.scenario.choices import functions_of
from fleet.scenario.model import Scenario
from worlds.arena import Arena

FAR = 3.0  # diagonals of the floor, from which on a range is no range
FAST = 15.0  # [m/s] from which on no robot drives on a floor
SPINS = 16.0 * pi  # [rad/s] eight turns a second
LARGE = 2.0  # [m] the radius of a robot
UNKNOWN = ("payload", "error")  # to the controller
WITH_STRAIGHT = ("cruise", "power", "capacity", "extra")
"""The keys of a robot that ``straight`` motion, which is Eq. (1) and a speed, looks at."""


def advice(scenario: Scenario, arena: Arena) -> Iterator[str]:
    """Sentences, of which each names a key."""
    for rule in RULES:
        yield from rule(scenario, arena)


def mixed_up(scenario: Scenario, arena: Arena) -> Iterator[str]:
    """Lengths that look like centimetres, and angles that look like degrees."""
    diagonal = hypot(arena.width, arena.height)
    floor = f"on a floor of {arena.width:g} m × {arena.height:g} m"
    robot = scenario.robot
    if scenario.range > FAR * diagonal:
        yield f"range is {scenario.range:g} m {floor}: in centimetres? It is in metres"
    if scenario.search_radius > FAR * diagonal:
        yield f"search_radius is {scenario.search_radius:g} m {floor}: it is in metres"
    if robot.cruise > FAST:
        yield f"robot.cruise is {robot.cruise:g} m/s: in centimetres? It is in metres a second"
    if robot.radius > LARGE:
        yield f"robot.radius is {robot.radius:g} m: in centimetres? It is in metres"
    if robot.turn_rate > SPINS and robot.turn_rate != PRESETS["ideal"].turn_rate:
        yield f"robot.turn_rate is {robot.turn_rate:g} rad/s: in degrees? It is in radians a second"


def idle_robot(scenario: Scenario, _arena: Arena) -> Iterator[str]:
    """What a robot without a body does not have, and what a prediction does not know."""
    plain = RobotSpec()
    if scenario.motion.name == "path":
        unknown = [f"robot.{n}" for n in UNKNOWN if getattr(scenario.robot, n) != 0.0]
        yield from does_nothing(
            unknown, 'in motion "path", the prediction of a controller that does not know of it'
        )
    if scenario.motion.name != "straight":
        return
    given = [f.name for f in fields(plain) if f.name not in WITH_STRAIGHT]
    idle = [f"robot.{n}" for n in given if getattr(scenario.robot, n) != getattr(plain, n)]
    yield from does_nothing(idle, "in straight motion, which is Eq. (1) and a speed")


def idle_search(scenario: Scenario, _arena: Arena) -> Iterator[str]:
    """A protocol that searches for nobody has no search radius."""
    accepted = keywords(functions_of(scenario)["protocol"])
    if scenario.search_radius != Scenario().search_radius and not accepted.keys() & {
        "search",
        "search_radius",
    }:
        yield from does_nothing(["search_radius"], f"in {scenario.protocol.name!r}")


def idle_motion(scenario: Scenario, _arena: Arena) -> Iterator[str]:
    """What only one belief, one kind of traffic or one way to go looks at."""
    given = scenario.motion.parameters
    belief = given.get("belief", "straight")
    if belief != "corrected":
        idle = [f"motion.{n}" for n in ("per_metre", "per_launch") if n in given]
        yield from does_nothing(idle, 'without motion.belief = "corrected"')
    if belief != "straight" and "reachability" in given:
        yield from does_nothing(["motion.reachability"], 'without motion.belief = "straight"')
    if scenario.motion.name == "path" and "bridge" in given:
        yield from does_nothing(["motion.bridge"], 'in motion "path", which has no engine')
    if given.get("traffic") == "free" and "headway" in given:
        yield from does_nothing(["motion.headway"], 'with motion.traffic = "free"')


def idle_time(scenario: Scenario, _arena: Arena) -> Iterator[str]:
    """What only a stream, a radio that loses frames, or drawn events look at."""
    given = scenario.time.parameters
    if scenario.time.name == "rounds" and scenario.radio.name == "ideal" and "offers" in given:
        yield from does_nothing(["time.offers"], "over a radio that loses nothing")
    if scenario.events.name == "trace" and "rate" in given:
        yield from does_nothing(["time.rate"], "with the events of a trace")


def idle_radio(scenario: Scenario, _arena: Arena) -> Iterator[str]:
    """What only losses by distance, or shadowing, look at."""
    given = scenario.radio.parameters
    if "falloff" in given and not given.get("loss_at_range"):
        yield from does_nothing(["radio.falloff"], "without radio.loss_at_range")
    if "path_loss" in given and not given.get("shadowing"):
        yield from does_nothing(["radio.path_loss"], "without radio.shadowing")


def idle_hole(scenario: Scenario, _arena: Arena) -> Iterator[str]:
    """A hole that is drawn corner by corner has no radius."""
    given = scenario.world.parameters
    if scenario.world.name == "random-hole" and given.get("corners"):
        idle = [f"world.{name}" for name in ("radius", "shape") if name in given]
        yield from does_nothing(idle, "with world.corners")


def does_nothing(keys: Iterable[str], where: str) -> Iterator[str]:
    """One sentence about keys that are set in vain; none if there are none."""
    names = list(keys)
    if names:
        verb = "does" if len(names) == 1 else "do"
        yield f"{', '.join(names)} {verb} nothing {where}"


RULES: tuple[Callable[[Scenario, Arena], Iterator[str]], ...] = (
    mixed_up, idle_robot, idle_search, idle_motion, idle_time, idle_radio, idle_hole,
)  # fmt: skip
