"""What a run is made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

from fleet.faults import Faults
from fleet.handler import HandlerName
from fleet.robot import RobotSpec
from fleet.scenario.errors import shown
from protocols.topology import GraphName
from worlds.sensors import SensorSpec


@dataclass(frozen=True, slots=True)
class Choice:
    """Something picked by name, with its parameters.

    In a file or an option either the name alone, ``"rfta2"``, or a table with ``name`` and
    the parameters: ``{name = "rfta2", auctioneer_bids = true}``.
    """

    name: str
    parameters: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """One run, described in full: the same scenario gives the same run. Defaults: the paper's.

    Raises:
        ValueError: a value is out of its range.
    """

    protocol: Choice = Choice("rfta2")
    world: Choice = Choice("random")
    motion: Choice = Choice("physics")
    robots: int | None = None  # None: as many as the world has, which is 100 as a rule
    range: float = 2.5  # r, of the radio [m]
    search_radius: float = 2.0  # SR [m]
    graph: GraphName = "gabriel"
    connected: bool = True  # whether the network must be connected at the start
    rounds: int | None = None  # served; in a stream, events raised. None: a whole lifetime
    time: Choice = Choice("rounds")
    events: Choice = Choice("uniform")
    radio: Choice = Choice("ideal")
    faults: Faults = Faults()
    sensors: SensorSpec | None = None  # None: the handler knows of every event at once
    handler: HandlerName = "random"
    seed: int = 0
    robot: RobotSpec = RobotSpec()

    def __post_init__(self) -> None:
        for name, low, high in (
            ("robots", 1, 1_000_000),
            ("rounds", 1, 10**12),
            ("seed", 0, 2**63 - 1),
            ("search_radius", 0, 10**6),
        ):
            value = getattr(self, name)
            if value is not None and not low <= value <= high:
                upto = f"to {high}" if value > high or name == "robots" else "or more"
                raise ValueError(f"{name} is {shown(value)}; expected {low} {upto}")
        if not 1e-6 <= self.range <= 1e6:
            raise ValueError(f"range is {self.range} m; expected more than 0, up to 1000 km")

    @classmethod
    def of(cls, **keys: Any) -> Scenario:
        """A scenario from keys as a file has them: ``Scenario.of(protocol="rfta2", robots=50)``.

        Raises:
            BadInput: an unknown key, a value of another type or out of its range.
        """
        from fleet.scenario.loading import scenario_from

        return scenario_from(keys)

    def as_dict(self) -> dict[str, Any]:
        """The scenario as a file would have it: tables, lists, numbers and text."""
        described: dict[str, Any] = plain(self)
        return described


def plain(value: Any) -> Any:
    """A scenario, or a part of one, as tables, lists, numbers and text."""
    if isinstance(value, Choice):
        return {"name": value.name, **value.parameters} if value.parameters else value.name
    if is_dataclass(value) and not isinstance(value, type):
        return {f.name: plain(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [plain(item) for item in value]
    return value
