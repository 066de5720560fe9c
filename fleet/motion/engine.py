"""The bodies: walls, obstacles and robots in a pymunk space.

Parked robots are static, which costs nothing however many there are; a robot's body is made
dynamic for its drive. Two bodies that are pressed together sink in by ``SLOP`` at most; nothing
rubs and nothing bounces.
"""

from __future__ import annotations

from collections.abc import Sequence

import pymunk

from fleet.motion.chipmunk import connect, trusted
from fleet.motion.kernels.bumps import parts
from fleet.motion.kernels.loop import drives, parks, press, witness
from fleet.motion.kernels.records import Floor, IntArray, Record, Records, Traffic, Wires
from fleet.robot import Robot
from worlds.arena import Arena
from worlds.shapes import Corner

SLOP = 1e-4  # [m] pymunk's own 0.1 is in units of a picture
ITERATIONS = 10  # of the contact solver in a step


class Engine:
    """A space with everybody in it. ``builds`` (n or more,): what robots are like; ``bridge``:
    whether compiled loops may call it directly.
    """

    def __init__(
        self,
        arena: Arena,
        radius: float,
        builds: Records,
        robots: Sequence[Robot],
        *,
        bridge: bool = True,
    ) -> None:
        self.space = pymunk.Space()
        self.space.iterations = ITERATIONS
        self.space.collision_slop = SLOP
        self._fence(arena)
        masses = builds["mass"].tolist()
        self.bodies = [self._body(radius, masses[robot.id], robot) for robot in robots]
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

    def _body(self, radius: float, mass: float, robot: Robot) -> pymunk.Body:
        body = pymunk.Body(body_type=pymunk.Body.STATIC)
        body.position, body.angle = robot.position, robot.heading
        circle = pymunk.Circle(body, radius)
        circle.mass = mass  # on the shape: a body forgets it when it is parked
        return body

    def park(self, robot: int) -> None:
        """The robot rests: its body cannot be moved."""
        self.bodies[robot].body_type = pymunk.Body.STATIC

    def step(self, floor: Floor, traffic: Traffic, active: IntArray, step: int) -> None:
        """A ``step`` of the ``active`` movers by the public interface."""
        params, builds = traffic.params[0], traffic.builds
        divided = int(params["substeps"])
        if divided > 1:
            divided = int(parts(traffic.movers, active, floor, params))
        for n in range(divided):
            driving = []
            for slot in active.tolist():
                mover, effort = traffic.movers[slot], traffic.efforts[slot]
                if drives(mover, params, step, n == 0):
                    build = builds[mover["robot"]]
                    press(mover, effort, traffic.references, params, build, builds[-1], divided)
                    self._push(mover, effort, builds)
                    driving.append((mover, effort, build))
            if not driving:
                continue
            self.space.step(float(params["dt"]) / divided)
            for mover, effort, build in driving:
                body = self.bodies[mover["robot"]]
                x, y = body.position
                vx, vy = body.velocity
                spin = body.angular_velocity
                witness(mover, effort, params, build, x, y, body.angle, vx, vy, spin, divided)
                if parks(mover):
                    self.park(mover["robot"])

    def _push(self, mover: Record, effort: Record, builds: Records) -> None:
        robot = int(mover["robot"])
        body = self.bodies[robot]
        if mover["awake"] == 2:
            body.body_type = pymunk.Body.DYNAMIC
            body.moment = float(builds[robot]["inertia"])
            mover["awake"] = 1
        body.force = (float(effort["fx"]), float(effort["fy"]))
        body.torque = float(effort["torque"])
