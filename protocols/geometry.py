"""Angles and crossings in the plane, with the degenerate cases decided."""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2, pi

from protocols.messages import Point, RobotId

TURN = 2.0 * pi  # [rad]


def squared_distance(a: Point, b: Point) -> float:
    """|ab|² [m²]."""
    dx = a[0] - b[0]
    dy = a[1] - b[1]
    return dx * dx + dy * dy


def bearing(origin: Point, target: Point) -> float:
    """Direction from ``origin`` to ``target`` [rad], in (-π, π]; 0 where they coincide."""
    return atan2(target[1] - origin[1], target[0] - origin[0])


def angle_between(a: float, b: float) -> float:
    """The angle between two directions [rad], in [0, π]."""
    turn = abs(a - b) % TURN
    return min(turn, TURN - turn)


def next_around(
    neighbours: Mapping[RobotId, Point],
    here: Point,
    reference: float,
    *,
    came_from: RobotId | None = None,
    clockwise: bool = False,
) -> RobotId | None:
    """The first neighbour met when turning from the direction ``reference`` [rad].

    Turns counter-clockwise unless told otherwise. A neighbour exactly on the reference is met
    at once on setting out; ``came_from`` is met last, after a full turn, so that a dead end is
    left the way it was entered. Neighbours in one direction, as those in the robot's own place
    are, stand side by side in the order of their ids, and each is met once in a turn. None if
    there is nobody.
    """
    best: RobotId | None = None
    least = (2.0 * TURN, 0)
    sense = -1 if clockwise else 1
    for robot, position in neighbours.items():
        turn = sense * (bearing(here, position) - reference) % TURN
        beside = sense * robot
        if robot == came_from:
            turn = 1.5 * TURN
        elif came_from is not None and turn == 0.0 and beside < sense * came_from:
            turn = TURN  # it stands just before the one that we came from
        if (turn, beside) < least:
            best, least = robot, (turn, beside)
    return best


def orientation(a: Point, b: Point, c: Point) -> float:
    """Twice the signed area of the triangle abc [m²]: positive if it turns left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def crossing(a: Point, b: Point, c: Point, d: Point) -> Point | None:
    """Where the segment ab crosses the segment cd [m], or None.

    Segments that only touch at an end of ab do not cross; neither do parallel ones.
    """
    side_a = orientation(c, d, a)
    side_b = orientation(c, d, b)
    if (side_a > 0.0) == (side_b > 0.0) or side_a == 0.0 or side_b == 0.0:
        return None
    side_c = orientation(a, b, c)
    side_d = orientation(a, b, d)
    if (side_c > 0.0 and side_d > 0.0) or (side_c < 0.0 and side_d < 0.0):
        return None
    share = side_a / (side_a - side_b)
    return (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))
