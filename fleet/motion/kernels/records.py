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
    ]
)
"""A segment of a path. What the drive has to know of the robot's build is written here, so that
turning and driving are all the same to it."""

ACCOUNTS = (
    "electronics",
    "rolling",
    "viscous",
    "scrub",
    "windings",
    "braking",
    "slip",
    "contact",
    "waiting",
)
"""What a battery pays for, each kept by itself [J]: fields of MOVER."""

MOVER = record_type(
    [
        # what every step needs
        ("robot", "i8"),
        ("slot", "i8"),  # its row in the arrays of the traffic
        ("phase", "i8"),
        ("start", "i8"),  # the step before which it sets off
        ("awake", "i8"),  # 0: its body is parked; 2: it has just set off
        ("touching", "i8"),  # its body was pushed in the last step
        ("lags", "i8"),  # its reference waits for it
        ("stopping", "i8"),  # it brakes against its reservation, to plan anew
        ("count", "i8"),  # samples of its reference
        ("due", "f8"),  # the sample that it should be at after this step
        ("x", "f8"),  # [m]
        ("y", "f8"),
        ("heading", "f8"),  # [rad], not wrapped
        ("vx", "f8"),  # velocity of its body [m/s]
        ("vy", "f8"),
        ("spin", "f8"),  # turn rate of its body [rad/s]
        ("ahead", "f8"),  # speed of the reference in the step before [m/s]; holonomic: in x
        ("aside", "f8"),  # its turn rate [rad/s]; holonomic: its speed in y [m/s]
        ("error", "f8"),  # from where it will be to where it should be [m]
        ("held", "f8"),  # the battery's charge at departure [J]
        ("spent", "f8"),  # of it [J]
        ("path", "f8"),  # driven [m]
        ("steps", "i8"),  # driven
        # the rest of what became of it
        ("departed", "i8"),  # the step before which it was sent
        ("waited", "i8"),  # steps
        ("contacts", "i8"),
        ("late", "f8"),  # since the end of its reference [s]
        ("best", "f8"),  # the sample that was due when it last got on
        ("since", "f8"),  # how long ago that was [s]
        *((account, "f8") for account in ACCOUNTS),
        # its track
        ("first", "i8"),  # tick of its first knot
        ("knots", "i8"),
    ]
)
"""A robot under way."""

EFFORT = record_type(
    [
        ("left", "f8"),  # force of a wheel's motor [N]; holonomic: of all motors, in x and y
        ("right", "f8"),
        ("roll_left", "f8"),  # rolling resistance of a wheel [N]; holonomic: in x and y
        ("roll_right", "f8"),
        ("viscous_left", "f8"),  # viscous resistance of a wheel [N]; holonomic: in x and y
        ("viscous_right", "f8"),
        ("scrub", "f8"),  # torque of the floor against turning [N·m]
        ("spin_left", "f8"),  # how much faster than the floor a wheel turns [m/s]
        ("spin_right", "f8"),
        ("side", "f8"),  # force of the floor across the wheels [N]
        ("fx", "f8"),  # what all that comes to: the force on the body [N]
        ("fy", "f8"),
        ("torque", "f8"),  # and the torque [N·m]
        ("cos", "f8"),  # of the heading that the body will have
        ("sin", "f8"),
        ("faced", "f8"),  # a heading [rad] near it, and
        ("faced_cos", "f8"),  # its cosine
        ("faced_sin", "f8"),
        ("turning", "f8"),  # share of the power of turning, 0 to 1
        ("along", "f8"),  # from where the body will be to where it should be, as it will
        ("across", "f8"),  # face [m]; holonomic: in x and y
        ("turn", "f8"),  # [rad]
        ("stop", "i8"),  # whether it should come to rest now
    ]
)
"""What pushes a body in a step, and what resists."""

BUILD = record_type(
    [
        ("mass", "f8"),  # [kg]
        ("inertia", "f8"),  # about the vertical axis [kg·m²]
        ("per_mass", "f8"),  # the inverses of both
        ("per_inertia", "f8"),
        ("rolling", "f8"),  # resistance of both wheels [N]
        ("viscous", "f8"),  # resistance of both wheels, times speed [N·s/m]
        ("scrub", "f8"),  # torque against turning [N·m]
        ("grip", "f8"),  # the most that the floor holds of one wheel's push [N]
    ]
)
"""What a robot is like: in truth, or as its controller believes."""

PARAMS = record_type(
    [
        ("dt", "f8"),  # of a step [s]
        ("radius", "f8"),  # of a robot [m]
        ("half_track", "f8"),  # from the middle to a wheel [m]
        ("cruise", "f8"),  # [m/s]
        ("acceleration", "f8"),  # [m/s²]
        ("turn_rate", "f8"),  # [rad/s]
        ("turn_acceleration", "f8"),  # [rad/s²]
        ("cornering", "f8"),  # the most acceleration across an arc [m/s²]
        ("window", "f8"),  # over which a change of curvature is spread [s]
        ("motor", "f8"),  # the most that a wheel pushes with [N]
        ("cost", "f8"),  # what a joule at the wheels takes from the battery [J]
        ("back", "f8"),  # what a joule of braking gives it [J]
        ("windings", "f8"),  # [W/N²]
        ("electronics", "f8"),  # [W]
        ("turning", "f8"),  # [W]
        ("idle", "f8"),  # [W]
        ("onset", "f8"),  # turning per metre from which scrub is full [rad/m]
        ("servo", "f8"),  # by which the controller takes errors of speed away [1/s]
        ("along_gain", "f8"),  # [1/s]
        ("heading_gain", "f8"),  # [1/s]
        ("across_gain", "f8"),  # [1/m²]
        ("margin", "f8"),  # how far from its reservation a robot may be [m]
        ("holonomic", "i8"),
        ("reverse", "i8"),  # whether it may drive backwards
        ("reserved", "i8"),  # whether trips are reserved in space and time
        ("stride", "i8"),  # steps from knot to knot of a track
        ("gap", "f8"),  # nearer than this, centres of movers are in conflict [m]
        ("sample", "i8"),  # steps from sample to sample; 0: none
        ("substeps", "i8"),  # of control and engine in a step
    ]
)
"""How robots drive, as their controllers believe: one for all."""

TURN_SHARE = 0.95  # of the turn rate that arcs may take; the rest is for finding back

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
    builds: Records  # (n + 1,) BUILD by robot; the last is what controllers believe
    movers: Records  # (slots,) MOVER
    efforts: Records  # (slots,) EFFORT
    references: FloatArray  # (slots, samples, 4) x, y, heading, way: see kernels.reference
    reservations: NDArray[np.float32]  # (slots, knots, 2) [m]
    boxes: FloatArray  # (slots, 4) bounds of the reservations: least x, y, greatest x, y [m]
    near: IntArray  # (slots,) work space
    ghost: Records  # (1,) MOVER, work space
    draft: FloatArray  # (samples, 4) a reference, work space
    poses: FloatArray  # (slots, 4) x, y, heading, charge [m, m, rad, J]
    over: IntArray  # (slots, 2) places in the order of departure, and phases


class Wires(NamedTuple):
    """What the kernels need to call the engine: see :mod:`fleet.motion.chipmunk`."""

    calls: IntArray  # (8,) addresses of functions and buffers; 0: there is no engine
    bodies: IntArray  # (n,) addresses by robot
    numbers: FloatArray  # what is read from a body, or written to it
    counts: NDArray[np.int32]  # (1,) how many of them are in use
