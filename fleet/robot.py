"""Robots: what they are made of, and what they know."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, pi
from typing import Literal, NamedTuple, Protocol

from fleet.power import Battery, ExtraPower, PowerModel
from protocols.messages import Point, RobotId

POSITIVE = (
    "radius",
    "mass",
    "cruise",
    "acceleration",
    "turn_rate",
    "turn_acceleration",
    "capacity",
    "motor",
    "traction",
    "scrub_onset",
)
"""What of a robot must be more than 0."""


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """How a robot is built.

    Raises:
        ValueError: a value is out of its range.
    """

    radius: float = 0.1  # [m]
    mass: float = 9.0  # [kg]
    drive: Literal["differential", "holonomic"] = "differential"
    reverse: bool = False  # drives backwards where that saves turning
    cruise: float = 0.76  # [m/s] the paper's speed, near the cheapest for its power model
    acceleration: float = 1.0  # [m/s²] both ways
    turn_rate: float = 1.6667 * pi  # [rad/s]
    turn_acceleration: float = 1.6667 * pi  # [rad/s²] turning on the spot
    track: float | None = None  # [m] from wheel to wheel; None: 1.5 radii
    capacity: float = 100.0  # [J] of the battery, full at the start
    power: PowerModel = field(default_factory=PowerModel)
    extra: ExtraPower = field(default_factory=ExtraPower)
    inertia: float | None = None  # about the vertical axis [kg·m²]; None: a solid disc's
    motor: float = 40.0  # the most that a wheel pushes with [N]
    efficiency: float = 0.6  # of motors and gears: what of the battery's power arrives at wheels
    regeneration: float = 0.0  # share of the power of braking wheels that is led back
    windings: float = 0.014  # heat of a motor, times its force squared [W/N²]
    traction: float = 0.7  # coefficient of friction between wheels and floor
    scrub: float = 0.2  # torque against turning on the spot [N·m]
    scrub_onset: float = 100.0  # turning per metre from which scrub is full [rad/m]
    turning: float = 0.0  # power while it turns, besides what scrub takes [W]
    payload: float = 0.0  # mass on top, unknown to its controller [kg]
    error: float = 0.0  # how far true parameters are from what its controller believes, at most

    def __post_init__(self) -> None:
        for name in POSITIVE:
            value = getattr(self, name)
            if not 0.0 < value < inf:
                raise ValueError(f"robot {name} is {value}; expected more than 0, and finite")
        for name in ("windings", "scrub", "turning", "payload"):
            value = getattr(self, name)
            if not 0.0 <= value < inf:
                raise ValueError(f"robot {name} is {value}; expected 0 or more, and finite")
        for name, most in (("efficiency", 1.0), ("regeneration", 1.0), ("error", 0.5)):
            value = getattr(self, name)
            if not 0.0 <= value <= most or (name == "efficiency" and value == 0.0):
                least = "more than 0" if name == "efficiency" else "0"
                raise ValueError(f"robot {name} is {value}; expected {least} to {most}")
        if self.inertia is not None and not 0.0 < self.inertia < inf:
            raise ValueError(f"robot inertia is {self.inertia}; expected more than 0, and finite")
        if self.drive not in ("differential", "holonomic"):
            raise ValueError(
                f"robot drive is {self.drive!r}; expected 'differential' or 'holonomic'"
            )
        if self.track is not None and not 0.0 < self.track <= 2.0 * self.radius:
            raise ValueError(
                f"robot track is {self.track}; expected more than 0, at most {2.0 * self.radius}"
            )

    @property
    def wheel_track(self) -> float:
        """From wheel to wheel [m]; by default as on the e-puck, 53 mm at a radius of 35 mm."""
        return 1.5 * self.radius if self.track is None else self.track


PRESETS: dict[str, RobotSpec] = {
    # The paper's arena at its density of robots: 100 discs of 0.1 m cover 3 % of 10 m × 10 m.
    # Mass, cruise and power: the paper's. Scrub: round contacts of radius a = 5 mm that carry the
    # weight and turn on the spot hold 2/3·µ·m·g·a = 0.2 N·m (Johnson, Contact Mechanics, 1985);
    # rolling on, it fades as 1/a. Windings: resistance over the square of force per ampere, 5.95 Ω
    # and 16 × 0.0514 N·m/A on wheels of 40 mm, Robotino 2. Motor, efficiency, traction: assumed;
    # rubber on a floor, and motors of its size with gears.
    "small": RobotSpec(),
    # Pioneer 3-DX. Radius 250 mm: its parameter file in ARIA, p3dx.p. Mass 9 kg and turn rate
    # 300 °/s: the maker's data sheet. Acceleration 300 mm/s² and 100 °/s²: TRANSACC and ROTACC
    # as shipped, Pioneer 3 Operations Manual (2007). Track 330 mm: CoppeliaSim's model of it.
    # Cruise and power: the paper's. Scrub: as above with contacts of 10 mm, for tyres of 195 mm.
    "pioneer": RobotSpec(
        radius=0.25,
        mass=9.0,
        acceleration=0.3,
        turn_rate=300.0 * pi / 180.0,
        turn_acceleration=100.0 * pi / 180.0,
        track=0.33,
        scrub=0.4,
    ),
    # Clearpath Husky A200 on flooring, skid steer, from the logs of BorealTC (LaRocque et al.,
    # IROS 2024, doi 10.1109/IROS58592.2024.10801407), whose authors give mass 70 kg, efficiency
    # 0.7, 0.46 Ω and 27.2 N/A at the wheels' rim, before losses. Fitted: 55 N of rolling
    # resistance and 180 N of scrub at the rim of each side, before losses; 10 W is what is left of
    # 102 J/m straight at 0.22 m/s. Computers are not in these logs. Track: 0.89 m, as the
    # gyroscope has it; the wheels are 0.55 m apart. Radius: around 0.99 m × 0.67 m. Motor: at
    # 27 A, what it took on loam; more than tyres hold. Onset of scrub, accelerations: assumed.
    "husky": RobotSpec(
        radius=0.6,
        mass=70.0,
        cruise=0.5,
        acceleration=0.5,
        turn_rate=1.0,
        turn_acceleration=1.0,
        track=0.89,
        capacity=2000.0,
        power=PowerModel(0.0, 55.0, 10.0),
        motor=500.0,
        efficiency=0.7,
        windings=0.46 / (0.7 * 27.2) ** 2,
        scrub=0.7 * 180.0 * 0.89,
        scrub_onset=0.4,
    ),
    # The paper's limit, with a body: Eq. (1) holds but for detours. No robot is built like this.
    "ideal": RobotSpec(
        drive="holonomic",
        acceleration=1e4,
        turn_rate=1e4,
        turn_acceleration=1e6,
        motor=1e6,
        efficiency=1.0,
        regeneration=1.0,
        windings=0.0,
        traction=1e5,
        scrub=0.0,
    ),
}
"""Robots by name, for scenario files."""


class Estimator(Protocol):
    """Whoever can tell what a drive would cost."""

    def cost(self, robot: Robot, site: Point) -> float:
        """The energy that ``robot`` believes going to ``site`` [m] takes [J]; inf: it cannot."""


class Appraisal(NamedTuple):
    """What a robot believed of a trip when it was asked for."""

    robot: RobotId
    cost: float  # that it believed the trip takes [J]; inf: it could not go
    energy: float  # that it held [J]
    refusal: str  # why it could not go, whatever the cost; "": it could


class Robot:
    """One robot of a running fleet. Motion moves it and drains it; protocols only ask it.

    It is the :class:`protocols.messages.RobotView` that conversations see.
    """

    __slots__ = (
        "_motion", "_tables", "able", "alive", "appraisals", "battery", "engaged",
        "failed_sites", "heading", "id", "position", "radio_range", "silenced",
    )  # fmt: skip

    def __init__(
        self,
        id: RobotId,
        position: Point,
        heading: float,
        battery: Battery,
        radio_range: float,
        tables: Sequence[Mapping[RobotId, Point]],
        motion: Estimator,
    ) -> None:
        self.id = id
        self.position = position  # [m]
        self.heading = heading  # [rad]
        self.battery = battery
        self.radio_range = radio_range  # r [m]
        self.alive = True  # False: its battery is empty, or it broke down altogether
        self.able = True  # False: its motor broke down; it stays, and still relays
        self.silenced = False  # it stands where no radio works for a while
        self.engaged = False  # it is promised to an event, on its way, or at work
        self.failed_sites: set[Point] = set()  # it was sent there and did not get there
        self.appraisals: dict[Point, dict[RobotId, Appraisal]] | None = None  # if anybody asks
        self._tables = tables
        self._motion = motion

    @property
    def on_air(self) -> bool:
        """Whether it can be talked to."""
        return self.alive and not self.silenced

    @property
    def energy(self) -> float:
        """What the battery holds [J]."""
        return self.battery.charge

    @property
    def neighbours(self) -> Mapping[RobotId, Point]:
        """Radio neighbours in the routing graph: last known positions [m]."""
        return self._tables[self.id]

    def cost_to(self, site: Point) -> float:
        """The energy it believes that going to ``site`` takes [J]; inf if it cannot go."""
        cost = inf
        if not (self.engaged or not self.able or not self.alive or site in self.failed_sites):
            cost = self._motion.cost(self, site)
        if self.appraisals is not None:
            appraisal = Appraisal(self.id, cost, self.energy, self._refusal(site))
            self.appraisals.setdefault(site, {})[self.id] = appraisal
        return cost

    def _refusal(self, site: Point) -> str:
        """Why it cannot go to ``site`` [m]; "" if it can."""
        if self.engaged:
            return "engaged"
        if not self.able:
            return "broken down"
        if not self.alive:
            return "out of energy"
        return "did not get there before" if site in self.failed_sites else ""


class SeenRobot:
    """A robot as a conversation sees it while it may be driving.

    Its position is that at the last time links were brought up to date, so that it agrees with
    what its neighbours know; all else is as it is.
    """

    __slots__ = ("_robot", "position")

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self.position = robot.position  # [m]

    @property
    def id(self) -> RobotId:
        """Its number, from 0."""
        return self._robot.id

    @property
    def radio_range(self) -> float:
        """How far its radio reaches: r [m]."""
        return self._robot.radio_range

    @property
    def energy(self) -> float:
        """What the battery holds [J]."""
        return self._robot.energy

    @property
    def neighbours(self) -> Mapping[RobotId, Point]:
        """Radio neighbours in the routing graph: last known positions [m]."""
        return self._robot.neighbours

    def cost_to(self, site: Point) -> float:
        """The energy it believes that going to ``site`` takes [J]; inf if it cannot go."""
        return self._robot.cost_to(site)
