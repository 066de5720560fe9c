"""What the energy study runs: single tasks, streams with traffic, and whole lifetimes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from fleet.robot import RobotSpec
from fleet.scenario.loading import merged, scenario_from
from fleet.study.job import Job

DRIVE = "fleet.experiments.energy.measuring:drive_tasks"
PLAY = "fleet.experiments.energy.measuring:play"

PAPER = "the paper’s"  # setting, with the defaults
NO_INERTIA = "no inertia at all"  # the control
PIONEERS = "40 Pioneers 3-DX"  # as many as find their ways
HUSKIES = "8 Huskies"  # skid steer
SHORTEST, LONGEST = 0.05, 7.0  # straight distance of single tasks [m]
EVER = 1e6  # [J] a battery that energy plays no part in

PROTOCOLS = ("gfgf2a", "rfta2", "rfta2ge", "rfta3")
BIDS = ("straight", "path", "corrected", "driven")  # what robots believe a trip costs
RATES = (0.5, 1.0, 2.0, 4.0)  # events a second, of streams
STREAM = 120.0  # [s]
STANDBY = 3.66  # [W] of robots that stand, in reserved traffic, so that waiting costs: P(0)


@dataclass(frozen=True, slots=True)
class Size:
    """How much of everything is run."""

    placements: int = 20  # for each setting
    tasks: int = 250  # driven in each placement
    seeds: int = 60  # of lifetimes
    recorded: int = 20  # of these, with all their trips
    streams: int = 8  # seeds for each kind of traffic
    places: int = 5  # of :data:`PLACES`, where lifetimes are lived


FULL = Size()
QUICK = Size(placements=3, tasks=60, seeds=4, recorded=2, streams=1, places=1)


@dataclass(frozen=True, slots=True)
class Variation:
    """One thing that is different from the paper's setting, and what it is called."""

    group: str
    name: str
    scenario: Mapping[str, Any] = field(default_factory=dict)


def _robot(**keys: Any) -> dict[str, Any]:
    return {"robot": keys}


BODIES: Mapping[str, Mapping[str, Any]] = {
    "weighs 30 kg": _robot(mass=30.0),
    "efficiency 0.3": _robot(efficiency=0.3),
    "efficiency 0.9": _robot(efficiency=0.9),
    "scrubs with 1 N·m": _robot(scrub=1.0),
    "no heat in the motors": _robot(windings=0.0),
    "heat of 0.05 W/N² in the motors": _robot(windings=0.05),
    "carries 3 kg unknown to it": {"motion": "physics", **_robot(payload=3.0)},
    "parameters off by up to 20 %": {"motion": "physics", **_robot(error=0.2)},
}
"""Robots that differ from the paper's in what Eq. (1) does not speak of."""

SETTINGS = (
    Variation("paper", PAPER),
    *(Variation("radius", f"radius {r} m", _robot(radius=r)) for r in (0.05, 0.15, 0.2)),
    *(
        Variation("acceleration", f"acceleration {a} m/s²", _robot(acceleration=a))
        for a in (0.3, 0.5, 2.0)
    ),
    *(Variation("density", f"{n} robots", {"robots": n}) for n in (10, 50, 200)),
    *(Variation("world", world, {"world": world}) for world in ("pit", "rooms", "warehouse")),
    Variation("build", PIONEERS, {"robots": 40, **_robot(preset="pioneer")}),
    Variation("build", HUSKIES, {"robots": 8, **_robot(preset="husky")}),
    Variation("build", "drives backwards too", _robot(reverse=True)),
    Variation("build", "holonomic", _robot(drive="holonomic")),
    Variation("build", NO_INERTIA, _robot(preset="ideal")),
    *(Variation("body", name, varied) for name, varied in BODIES.items()),
)
"""The paper's arena and robots, and one thing different at a time.

What a controller does not know, its prediction does not either: these robots are driven by forces.
"""

PRESETS = {"small": PAPER, "pioneer": PIONEERS, "husky": HUSKIES, "ideal": NO_INERTIA}
"""In which setting each robot is that has a name."""

HEADLINES = {
    PAPER: {},
    **{f"scrubs with {s:g} N·m": _robot(scrub=s) for s in (0.6, 1.2, 2.4)},
    "acceleration 0.3 m/s²": _robot(acceleration=0.3),
    **BODIES,
}
"""Robots with which the protocols are compared: the paper's, and one thing different at a time."""

COMPARED = (("rfta3", "rfta2ge"), ("rfta2ge", "rfta2"), ("rfta2", "gfgf2a"))
"""Protocols whose lifetimes are divided, one by the other."""

ENGINE = Variation("engine", "in pymunk", {"motion": "physics"})
"""The paper's setting again, its bodies stepped by the engine."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where lifetimes are lived, and which setting's fit its robots know."""

    name: str
    setting: str
    scenario: Mapping[str, Any]


OPEN = "open floor"
AS_IN_THE_PAPER = "as in the paper"  # bid and driven by Eq. (1)
PLACES = (
    Place(OPEN, PAPER, {}),
    Place("pit", "pit", {"world": "pit"}),
    Place("rooms", "rooms", {"world": "rooms"}),
    Place("warehouse", "warehouse", {"world": "warehouse"}),
    Place("40 Pioneers", PIONEERS, {"robot": "pioneer", "robots": 40, "range": 4.0}),
)


@dataclass(frozen=True, slots=True)
class Subject:
    """Whose energy is studied: a scenario, and everything that is varied in it."""

    name: str  # of the setting in which nothing is varied
    floor: str  # in captions
    settings: tuple[Variation, ...]  # the first is the one of that name
    engine: Variation  # the same robots as in the first, driven in the other way
    longest: float  # straight distance of single tasks [m]
    places: tuple[Place, ...]
    base: Mapping[str, Any] = field(default_factory=dict)  # the scenario of all of them
    traffic: bool = True  # streams are run as well
    headlines: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @property
    def motion(self) -> str:
        """How robots are driven in it."""
        return scenario_from({"motion": "path", **self.base}).motion.name

    @property
    def spec(self) -> RobotSpec:
        """The robots in which nothing is varied."""
        return scenario_from(dict(self.base)).robot


def papers() -> Subject:
    """The paper's arena and robots."""
    return Subject(
        PAPER, "the paper’s open floor", SETTINGS, ENGINE, LONGEST, PLACES, headlines=HEADLINES
    )


def single_tasks(size: Size, seed: int, subject: Subject) -> Iterator[Job]:
    """Every setting in the same number of placements, each with so many tasks in turn."""
    for placement in range(seed, seed + size.placements):
        for setting in (*subject.settings, subject.engine):
            scenario = merged({"motion": "path", **subject.base}, setting.scenario)
            scenario = merged(
                scenario, {"connected": False, "seed": placement, "robot": {"capacity": EVER}}
            )
            yield Job.of(
                {"scenario": scenario, "tasks": size.tasks, "longest": subject.longest},
                cell=setting.name,
                labels={
                    "part": "single", "group": setting.group, "setting": setting.name,
                    "placement": placement,
                },
                tables=("trips",),
                function=DRIVE,
            )  # fmt: skip


def streams(size: Size, seed: int) -> Iterator[Job]:
    """Several movers at once, in both kinds of traffic, ever more of them."""
    for number in range(seed, seed + size.streams):
        for radius in (0.1, 0.2):
            for traffic in ("reserved", "free"):
                for rate in RATES:
                    idle = STANDBY if traffic == "reserved" else 0.0
                    scenario = {
                        "motion": {"name": "physics", "traffic": traffic},
                        "time": {"name": "stream", "rate": rate, "duration": STREAM},
                        "robot": {
                            "radius": radius, "capacity": EVER, "extra": {"idle": idle}
                        },
                        "seed": number,
                    }  # fmt: skip
                    labels = {"traffic": traffic, "radius": radius, "rate": rate}
                    yield Job.of(
                        scenario,
                        cell=f"{traffic} traffic, radius {radius} m, {rate} events/s",
                        labels={"part": "stream", **labels, "seed": number},
                        tables=("trips",),
                        function=PLAY,
                    )


def lifetimes(
    size: Size, seed: int, launch: Mapping[str, float], subject: Subject
) -> Iterator[Job]:
    """Every protocol, place and way to bid on the same seeds, and the paper's motion.

    ``launch`` has the cost of a launch [J] for each setting, as it was fitted.
    """
    for number in range(seed, seed + size.seeds):
        for place in subject.places[: size.places]:
            ways: dict[str, Any] = {bid: {"name": subject.motion, "belief": bid} for bid in BIDS}
            ways["corrected"]["per_launch"] = launch[place.setting]
            if place.name == OPEN and not subject.base:
                ways = {AS_IN_THE_PAPER: "straight"} | ways
            for protocol in PROTOCOLS:
                for bids, motion in ways.items():
                    scenario = {"protocol": protocol, "motion": motion, "seed": number}
                    scenario = merged(subject.base, scenario)
                    if bids == AS_IN_THE_PAPER:  # the points start where the bodies do
                        scenario["world"] = {"name": "random", "room": RobotSpec().radius}
                    kept = bids == "straight" and number < seed + size.recorded
                    yield Job.of(
                        {**scenario, **place.scenario},
                        cell=f"{place.name}, {protocol}, bids {bids}",
                        labels={
                            "part": "lifetime", "place": place.name, "protocol": protocol,
                            "bids": bids, "seed": number,
                        },
                        tables=("trips",) if kept else (),
                        function=PLAY,
                    )  # fmt: skip


def headlines(size: Size, seed: int, subject: Subject) -> Iterator[Job]:
    """Lifetimes of all protocols with other robots, bids and all else as they are by default."""
    for number in range(seed, seed + size.seeds):
        for name, varied in subject.headlines.items():
            for protocol in PROTOCOLS:
                yield Job.of(
                    {"motion": "path", **varied, "protocol": protocol, "seed": number},
                    cell=f"{name}, {protocol}",
                    labels={
                        "part": "headline", "setting": name, "protocol": protocol, "seed": number,
                    },
                    function=PLAY,
                )  # fmt: skip
