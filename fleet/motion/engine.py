"""The bodies: walls, obstacles and robots in a pymunk space.

Parked robots are static, which costs nothing however many there are; a robot's body is made
dynamic for its drive. Two bodies that are pressed together sink in by ``SLOP`` at most; nothing
rubs and nothing bounces. So nothing turns a disc but its own wheels: bodies have no headings.
"""

from __future__ import annotations

from collections.abc import Sequence

import pymunk

from fleet.motion.chipmunk import connect, trusted
from fleet.motion.kernels.records import ARRIVED, EMPTY, IntArray, Records, Wires
from fleet.robot import Robot, RobotSpec
from worlds.arena import Arena
from worlds.shapes import Corner

SLOP = 1e-4  # [m] pymunk's own 0.1 is in units of a picture
ITERATIONS = 10  # of the contact solver in a step


class Engine:
    """A space with everybody in it. ``bridge``: whether compiled loops may call it directly."""

    def __init__(
        self, arena: Arena, spec: RobotSpec, robots: Sequence[Robot], *, bridge: bool = True
    ) -> None:
        self.space = pymunk.Space()
        self.space.iterations = ITERATIONS
        self.space.collision_slop = SLOP
        self._fence(arena)
        self.bodies = [self._body(spec, robot) for robot in robots]
        self.wires: Wires | None = None
        if bridge and trusted():
            self.wires, self._kept = connect(self.space, self.bodies)
        self.space.add(*self.bodies, *(shape for body in self.bodies for shape in body.shapes))

    def _fence(self, arena: Arena) -> None:
        """Walls and obstacles, as static segments."""
        w, h = arena.width, arena.height
        walls: tuple[Corner, ...] = ((0.0, 0.0), (w, 0.0), (w, h), (0.0, h))
        for loop in (walls, *(polygon.corners for polygon in arena.obstacles)):
            for a, b in zip(loop, (*loop[1:], loop[0]), strict=True):
                self.space.add(pymunk.Segment(self.space.static_body, a, b, 0.0))

    def _body(self, spec: RobotSpec, robot: Robot) -> pymunk.Body:
        body = pymunk.Body(body_type=pymunk.Body.STATIC)
        body.position = robot.position
        circle = pymunk.Circle(body, spec.radius)
        circle.mass = spec.mass  # on the shape: a body forgets it when it is parked
        return body

    def park(self, robot: int) -> None:
        """The robot rests: its body cannot be moved."""
        self.bodies[robot].body_type = pymunk.Body.STATIC

    def park_those_over(self, movers: Records, active: IntArray) -> None:
        """Park the robots whose trips have ended by themselves."""
        for slot in active:
            mover = movers[slot]
            if mover["awake"] and ARRIVED <= mover["phase"] <= EMPTY:
                mover["awake"] = 0
                self.park(mover["robot"])

    def step(self, movers: Records, active: IntArray, dt: float, substeps: int) -> None:
        """Carry out the commands of the ``active`` movers for a step, by the public interface."""
        awake = [movers[slot] for slot in active if movers[slot]["awake"]]
        for mover in awake:
            body = self.bodies[mover["robot"]]
            if mover["awake"] == 2:
                body.body_type = pymunk.Body.DYNAMIC
            body.velocity = (float(mover["vx"]), float(mover["vy"]))
        for _ in range(substeps):
            self.space.step(dt / substeps)
        for mover in awake:
            body = self.bodies[mover["robot"]]
            mover["x"], mover["y"] = body.position
            mover["ux"], mover["uy"] = body.velocity
