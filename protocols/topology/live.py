"""The live graph of the fleet, kept up to date as robots move."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, get_args, overload

import numpy as np

from protocols.messages import Point, RobotId
from protocols.topology.graphs import Edges, GraphName, edges

if TYPE_CHECKING:
    from protocols.topology.neighbourhood import Neighbourhood

COMPILE_ABOVE = 200  # robots from which loading the compiler pays within one run
NOWHERE: Point = (float("nan"), float("nan"))  # of a robot that is off the air


class Topology:
    """The routing graph over a fleet in the plane, changed robot by robot.

    ``neighbours[robot]`` maps the ids of its neighbours, ascending, to their positions [m].
    The sequence stays the same object; its mappings are replaced, not changed, so one that was
    read stays as it was.

    Compiled, a moved robot costs time by the size of its neighbourhood, whatever the size of
    the fleet. For the spanning tree all is computed anew, as it is for a small fleet while the
    compiler is not loaded: that takes as long as some 400 moves of 100 robots. Tests choose
    by ``compiled``.

    Raises:
        ValueError: the range is not positive, or there is no graph of that name.
    """

    def __init__(
        self,
        positions: Sequence[Point],
        radio_range: float,
        graph: GraphName = "gabriel",
        *,
        compiled: bool | None = None,
    ) -> None:
        if not radio_range > 0.0:
            raise ValueError(f"radio range {radio_range} m; expected more than 0")
        if graph not in get_args(GraphName):
            names = ", ".join(get_args(GraphName))
            raise ValueError(f"graph {graph!r}; expected one of {names}")
        self.radio_range = radio_range
        self.graph = graph
        self.positions: list[Point] = list(positions)
        self._links: Neighbourhood | None = None
        self.neighbours = Tables(self.positions)
        if compiled is None:
            compiled = len(positions) > COMPILE_ABOVE or "numba" in sys.modules
        if compiled and graph != "emst":
            from protocols.topology.neighbourhood import Neighbourhood

            self._links = Neighbourhood(self.positions, radio_range, graph)
            self.neighbours.read_from(self._links.of)
        else:
            self._rebuild()

    def move(self, robot: RobotId, position: Point) -> None:
        """The robot is at ``position`` [m] now."""
        self.positions[robot] = position
        if self._links is None:
            self._rebuild()
        else:
            self.neighbours.forget(self._links.move(robot, position))

    def move_all(self, robots: Sequence[RobotId], positions: Sequence[Point]) -> None:
        """The robots are at ``positions`` [m] now, all at once."""
        for robot, position in zip(robots, positions, strict=True):
            self.positions[robot] = position
        if self._links is None:
            self._rebuild()
        else:
            self.neighbours.forget(self._links.move_all(robots, positions))

    def remove(self, robot: RobotId) -> None:
        """The robot is off the air: nobody hears it any more."""
        self.move(robot, NOWHERE)

    def changed(self) -> set[RobotId]:
        """Robots whose neighbours, or where those are, may have changed since the last call.

        The first call has no last one: it names all.
        """
        return self.neighbours.take_stale()

    def edges(self) -> Edges:
        """The edges of the routing graph as they are now."""
        listed = [(u, v) for u, near in enumerate(self.neighbours) for v in near if u < v]
        return np.array(listed, dtype=np.intp).reshape(-1, 2)

    def _rebuild(self) -> None:
        near: list[list[RobotId]] = [[] for _ in self.positions]
        for u, v in edges(np.array(self.positions), self.radio_range, self.graph).tolist():
            near[u].append(v)
            near[v].append(u)
        self.neighbours.forget(range(len(near)))
        self.neighbours.read_from(lambda robot: sorted(near[robot]))


class Tables(Sequence[Mapping[RobotId, Point]]):
    """Neighbours and their positions by robot, each listed when it is first looked at."""

    def __init__(self, positions: list[Point]) -> None:
        self._positions = positions
        self._listed: list[Mapping[RobotId, Point] | None] = [None] * len(positions)
        self._stale: set[RobotId] | None = None  # until somebody asks
        self._of: Callable[[RobotId], Iterable[RobotId]] = lambda _: ()

    def read_from(self, neighbours_of: Callable[[RobotId], Iterable[RobotId]]) -> None:
        """Where to ask for the neighbours of a robot, ascending."""
        self._of = neighbours_of

    def forget(self, robots: Iterable[RobotId]) -> None:
        """These robots' neighbours, or where those are, have changed."""
        listed = self._listed
        for robot in robots:
            listed[robot] = None
        if self._stale is not None:
            self._stale.update(robots)

    def take_stale(self) -> set[RobotId]:
        """Those forgotten since the last call; at first, all."""
        stale, self._stale = self._stale, set()
        return set(range(len(self._listed))) if stale is None else stale

    @overload
    def __getitem__(self, robot: int) -> Mapping[RobotId, Point]: ...
    @overload
    def __getitem__(self, robot: slice) -> list[Mapping[RobotId, Point]]: ...
    def __getitem__(
        self, robot: int | slice
    ) -> Mapping[RobotId, Point] | list[Mapping[RobotId, Point]]:
        if isinstance(robot, slice):
            return [self[k] for k in range(len(self))[robot]]
        near = self._listed[robot]
        if near is None:
            positions = self._positions
            near = self._listed[robot] = {v: positions[v] for v in self._of(robot)}
        return near

    def __len__(self) -> int:
        return len(self._listed)
