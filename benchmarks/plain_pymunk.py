"""What one writes first: robots driven over pymunk's public interface, by a loop in Python.

The measure that ``motion.py`` takes of physics. It drives along the paths of this project's
planner, by the same profile: a turn on the spot, then a trapezoidal profile, steered by feedback.
"""

from __future__ import annotations

from math import atan2, copysign, cos, hypot, pi, remainder, sin, sqrt, tau

import pymunk

from fleet.motion.kernels.records import LINE
from fleet.robot import RobotSpec

SPEC = RobotSpec(capacity=1e6)
DT = 1.0 / 60.0  # [s]


class PlainWorld:
    """A space with everybody in it, and who bumped into what counted."""

    def __init__(self, points, headings):
        self.space = pymunk.Space()
        self.space.collision_slop = 1e-4
        self.contacts = 0
        self.bodies = []
        for point, heading in zip(points.tolist(), headings.tolist(), strict=True):
            body = pymunk.Body(body_type=pymunk.Body.STATIC)
            body.position, body.angle = tuple(point), heading
            circle = pymunk.Circle(body, SPEC.radius)
            circle.mass = SPEC.mass
            self.space.add(body, circle)
            self.bodies.append(body)
        walls = ((0, 0), (10, 0), (10, 10), (0, 10))
        for k, corner in enumerate(walls):
            wall = pymunk.Segment(self.space.static_body, corner, walls[k - 1], 0.0)
            self.space.add(wall)

    def drive(self, robot, segments):
        """Turn towards the path, then follow it: (steps, energy [J])."""
        body = self.bodies[robot]
        body.body_type = pymunk.Body.DYNAMIC
        steps, energy = self._turn(body, segments[0])
        rest = [
            sum(segment["length"] for segment in segments[k + 1 :]) for k in range(len(segments))
        ]
        speed = 0.0
        for k, segment in enumerate(segments):
            while True:
                along, off, heading, bend = locate(segment, body.position)
                if along >= segment["length"] - 1e-4:
                    break
                to_go = segment["length"] - along + rest[k]
                braking = sqrt(2.0 * SPEC.acceleration * max(to_go - 0.5 * speed * DT, 0.0))
                last = min(SPEC.cruise, speed + SPEC.acceleration * DT, braking)
                mean = min(0.5 * (speed + last), to_go / DT)
                error = remainder(body.angle - heading, tau)
                spin = mean * bend - mean * off / 0.04 - 10.0 * mean * error
                middle = body.angle + 0.5 * spin * DT
                self._step(body, mean * cos(middle), mean * sin(middle), spin)
                steps += 1
                square = (speed * speed + speed * last + last * last) / 3.0
                energy += (6.25 * square + 9.79 * 0.5 * (speed + last) + 3.66) * DT
                speed = last
                if to_go < 1e-3:
                    break
        body.body_type = pymunk.Body.STATIC
        return steps, energy

    def _turn(self, body, segment):
        steps, spin = 0, 0.0
        goal = locate(segment, body.position)[2]
        ease = SPEC.turn_acceleration * DT
        while True:
            error = remainder(goal - body.angle, tau)
            if abs(error) < 0.02 and abs(spin) <= ease:
                return steps, 3.66 * DT * steps
            wish = copysign(min(SPEC.turn_rate, sqrt(2.0 * ease / DT * abs(error))), error)
            spin = min(max(wish, spin - ease), spin + ease)
            self._step(body, 0.0, 0.0, spin)
            steps += 1

    def _step(self, body, vx, vy, spin):
        body.velocity = (vx, vy)
        body.angular_velocity = spin
        self.space.step(DT)
        ux, uy = body.velocity
        if hypot(ux - vx, uy - vy) > 1e-9:
            self.contacts += 1


def locate(segment, position):
    """Where on a segment of path: how far along, how far to the left, heading, curvature."""
    dx, dy = position.x - segment["x"], position.y - segment["y"]
    if segment["kind"] == LINE:
        along = dx * segment["cos"] + dy * segment["sin"]
        return along, dy * segment["cos"] - dx * segment["sin"], segment["angle"], 0.0
    sense, radius = segment["sense"], segment["radius"]
    angle = atan2(dy, dx)
    half = 0.5 * segment["length"] / radius
    ahead = remainder(sense * (angle - segment["angle"]) - half, tau) + half
    heading = angle + sense * 0.5 * pi
    return radius * ahead, sense * (radius - hypot(dx, dy)), heading, sense / radius
