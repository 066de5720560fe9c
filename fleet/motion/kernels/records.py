"""What the kernels work on: records in arrays, and the numbers that stand for kinds.

Units are SI throughout. All records are aligned; the arrays belong to the Python side and are
changed in place.
"""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

Record: TypeAlias = Any  # one of those below, as numba and NumPy see them
Records: TypeAlias = NDArray[Any]
FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]

NOBODY = -1  # no robot, no disc, the end of a list

TURN, LINE, ARC = 0, 1, 2
"""Kinds of segments that a path is made of: on the spot, straight, along a circle."""

WAITING, DRIVING, ARRIVED, EMPTY, LOST, TOUCHED = 0, 1, 2, 3, 4, 5
"""Phases of a trip. From ARRIVED on the kernels leave it alone until Python has seen to it:
EMPTY: the battery is; LOST: it got stuck or left its path; TOUCHED: it left its reservation."""


def record_type(fields: list[tuple[str, str]]) -> np.dtype[Any]:
    """Records whose fields are attributes, for numba as for Python."""
    return np.dtype((np.record, np.dtype(fields, align=True)))


DISC = record_type(
    [
        ("x", "f8"),  # centre [m]; NaN: not there
        ("y", "f8"),
        ("core", "f8"),  # radius of what stands there [m]: a robot's, or 0 of a corner
        ("after", "i8"),  # the next disc of the same cell
    ]
)
"""A round obstacle: first the n places where robots rest or will rest, then the n bodies that
stand in the way without resting, then the corners of the polygons."""

EDGE = record_type(
    [
        ("ax", "f8"),  # from here [m]
        ("ay", "f8"),
        ("bx", "f8"),  # to here [m]
        ("by", "f8"),
        ("core", "f8"),  # 0 [m], less while a robot starts closer than it would pass
        ("a", "i8"),  # the discs of its two corners
        ("b", "i8"),
    ]
)
"""A side of a polygon."""

GRID = record_type(
    [
        ("width", "f8"),  # of the arena [m]
        ("height", "f8"),
        ("radius", "f8"),  # of a robot [m]
        ("cell", "f8"),  # side of a cell [m]
        ("columns", "i8"),
        ("rows", "i8"),
    ]
)

SEGMENT = record_type(
    [
        ("kind", "i8"),
        ("x", "f8"),  # where it starts; of an arc, the centre [m]
        ("y", "f8"),
        ("radius", "f8"),  # of an arc [m]
        ("angle", "f8"),  # heading of a line, or at the start of a turn; of an arc,
        #                   from its centre to its start [rad]
        ("sense", "f8"),  # of a turn or an arc: +1 counter-clockwise, -1 clockwise
        ("cos", "f8"),  # of the heading of a line
        ("sin", "f8"),
        ("length", "f8"),  # [m], of a turn [rad]
        ("limit", "f8"),  # top speed [m/s], of a turn [rad/s]
        ("exit", "f8"),  # the most it may do at its end
        ("rate", "f8"),  # of change of speed [m/s²], of a turn [rad/s²]
        ("quadratic", "f8"),  # power at speed v: quadratic·v² + linear·v + constant [W]
        ("linear", "f8"),
        ("constant", "f8"),
        ("inertia", "f8"),  # kinetic energy that is paid: inertia·v²/2 [J]
    ]
)
"""A segment of a path. What the drive has to know of the robot's build is written here, so that
turning and driving, wheels and bodies are all the same to it."""

MOVER = record_type(
    [
        # what every step needs
        ("robot", "i8"),
        ("slot", "i8"),  # its row in the arrays of the traffic
        ("phase", "i8"),
        ("start", "i8"),  # the step before which it sets off
        ("awake", "i8"),  # 0: its body is parked; 2: it has just set off
        ("off_path", "i8"),  # 1: pushed off its path; 2: and turning towards it
        ("touching", "i8"),  # the engine did not let it have the commanded velocity
        ("count", "i8"),  # segments of its path
        ("segment", "i8"),  # the one it is on
        ("along", "f8"),  # how far on that segment [m or rad]
        ("speed", "f8"),  # [m/s or rad/s]
        ("x", "f8"),  # [m]
        ("y", "f8"),
        ("heading", "f8"),  # [rad], not wrapped
        ("astern", "f8"),  # π if it drives backwards, otherwise 0 [rad]
        ("vx", "f8"),  # commanded for this step [m/s]
        ("vy", "f8"),
        ("spin", "f8"),  # [rad/s]
        ("ux", "f8"),  # velocity that it was left with after the step [m/s]
        ("uy", "f8"),
        ("held", "f8"),  # the battery's charge at departure [J]
        ("spent", "f8"),  # of it [J]
        ("path", "f8"),  # driven [m]
        ("steps", "i8"),  # driven
        # the rest of the account
        ("departed", "i8"),  # the step before which it was sent
        ("waited", "i8"),  # steps
        ("contacts", "i8"),
        ("jostled", "f8"),  # the part of its path that was driven off it [m]
        ("spent_turning", "f8"),  # the parts of what was spent, each kept by itself [J]
        ("spent_driving", "f8"),
        ("spent_waiting", "f8"),
        ("spent_off_path", "f8"),
        ("best", "f8"),  # off its path: the least that was left to go [m]
        ("since", "i8"),  # steps since that shrank
        # its track
        ("first", "i8"),  # tick of its first knot
        ("knots", "i8"),
    ]
)
"""A robot under way."""

PARAMS = record_type(
    [
        ("dt", "f8"),  # of a step [s]
        ("radius", "f8"),  # of a robot [m]
        ("cruise", "f8"),  # [m/s]
        ("acceleration", "f8"),  # [m/s²]
        ("turn_rate", "f8"),  # [rad/s]
        ("turn_acceleration", "f8"),  # [rad/s²]
        ("mass", "f8"),  # [kg]
        ("half_track", "f8"),  # from the middle to a wheel [m]
        ("quadratic", "f8"),  # of P(v)
        ("linear", "f8"),
        ("constant", "f8"),
        ("idle", "f8"),  # [W]
        ("kinetic", "i8"),  # whether kinetic energy is paid and lost
        ("per_wheel", "i8"),  # whether each wheel pays at its own speed
        ("holonomic", "i8"),
        ("reverse", "i8"),  # whether it may drive backwards
        ("reserved", "i8"),  # whether trips are reserved in space and time
        ("stride", "i8"),  # steps from knot to knot of a track
        ("gap", "f8"),  # nearer than this, centres of movers are in conflict [m]
        ("sample", "i8"),  # steps from sample to sample; 0: none
        ("substeps", "i8"),  # of the engine in a step
    ]
)
"""How robots drive: one for all."""

GRIP = 0.95  # share of the turn rate that arcs may take; the rest is for finding back

CIRCLE = record_type([("x", "f8"), ("y", "f8"), ("radius", "f8")])
"""What the path may wind around; start and goal have radius 0."""


class Floor(NamedTuple):
    """What the planner sees."""

    grid: Records  # (1,) GRID
    discs: Records  # (2n + corners,) DISC
    heads: IntArray  # (cells,) first disc of each cell
    edges: Records  # (m,) EDGE
    bins: IntArray  # (cells + 1,) where each cell's edges begin in binned
    binned: IntArray  # edges by cell
    near: IntArray  # 2 × (discs + edges,) work space
    marks: NDArray[np.bool_]  # (discs + edges,) work space, all false


class Traffic(NamedTuple):
    """Everybody under way, by slot."""

    params: Records  # (1,) PARAMS
    movers: Records  # (slots,) MOVER
    segments: Records  # (slots, room) SEGMENT; the first is the turn on the spot
    reservations: NDArray[np.float32]  # (slots, knots, 2) [m]
    boxes: FloatArray  # (slots, 4) bounds of the reservations: least x, y, greatest x, y [m]
    near: IntArray  # (slots,) work space
    ghost: Records  # (1,) MOVER, work space
    poses: FloatArray  # (slots, 4) x, y, heading, charge [m, m, rad, J]
    over: IntArray  # (slots, 2) places in the order of departure, and phases


class Wires(NamedTuple):
    """What the kernels need to call the engine: see :mod:`fleet.motion.chipmunk`."""

    calls: IntArray  # (7,) addresses of functions and buffers; 0: there is no engine
    bodies: IntArray  # (n,) addresses by robot
    numbers: FloatArray  # what is read from a body, or written to it
    counts: NDArray[np.int32]  # (1,) how many of them are in use
