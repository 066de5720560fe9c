"""Geographic routing: greedy, face traversal, and the two joined.

The packet carries the event, and in the face phase where that phase began; each robot
decides from its own position and its neighbours'. Everything here is a part of a
conversation: a generator of transmissions that returns the robot it ended at.

References: Bose, Morin, Stojmenovic and Urrutia, Wireless Networks 7(6), 2001 (GFG,
doi:10.1023/A:1012319418150); Frey and Stojmenovic, MobiCom 2006 (face changes,
doi:10.1145/1161089.1161144); Stanulovic, Mitton and Mezei, Sensors 21(18):6149, 2021
(GFGF and its stop rules, doi:10.3390/s21186149).
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Literal, TypeAlias

from protocols.geometry import angle_between, bearing, crossing, next_around, squared_distance
from protocols.messages import Event, Heard, Point, RobotId, RobotView, Transmission, View

Routing: TypeAlias = Generator[Transmission, Heard, RobotId]


@dataclass(frozen=True, slots=True)
class Search:
    """How the robot near an event is looked for.

    ``stop="edge"`` calls a face walked when its first edge comes up again, ``"node"`` when
    a robot would be visited twice (the paper's pseudo-code). ``check`` says where the radius
    is looked at while routing is greedy: in the local minimum, or at every hop. ``hand`` is
    the rule that faces are walked by, ``change`` whether the next face is entered before or
    after passing the edge that the line to the event cuts, or by the edge that points best.

    Raises:
        ValueError: the radius is negative.
    """

    radius: float = 2.0  # SR [m]; 0: walk the whole face, as GFGF1 does
    stop: Literal["edge", "node"] = "edge"
    check: Literal["minimum", "hop"] = "minimum"
    hand: Literal["right", "left"] = "right"
    change: Literal["before", "after", "best-angle"] = "before"

    def __post_init__(self) -> None:
        if not self.radius >= 0.0:
            raise ValueError(f"search radius {self.radius} m; expected 0 or more")


TWO_SR = Search()  # the paper's best: 2 SR = 0.2 of the unit square
WHOLE_FACE = Search(radius=0.0)


def greedy(view: View, source: RobotId, site: Point, reach: float = 0.0) -> Routing:
    """Hop to the neighbour nearest to ``site`` until none is nearer: a local minimum.

    Stops early at a robot within ``reach`` [m] of the site. Of robots in one place the lowest
    id is the one that is linked to others, and so the one to go on from.
    """
    here = source
    enough = reach * reach
    while True:
        me = view[here]
        least = squared_distance(me.position, site)
        if least <= enough:
            return here
        nearest = here
        for robot, position in me.neighbours.items():
            d = squared_distance(position, site)
            if d < least or (d == least and robot < here and position == me.position):
                nearest, least = robot, d
        if nearest == here:
            return here
        if (yield Transmission("route-greedy", here, nearest)):
            here = nearest


def find(view: View, source: RobotId, event: Event, search: Search) -> Routing:
    """Greedy-face-greedy-find: the robot that the search for the event ends at.

    With a search radius this is GFGF2: it ends at a robot within that radius of the event.
    With radius 0 it is GFGF1: it ends when the face around the event has been walked, at
    the robot nearest to it.
    """
    site = event.position
    enough = search.radius * search.radius
    reach = search.radius if search.check == "hop" else 0.0
    here = source
    while True:
        here = yield from greedy(view, here, site, reach)
        minimum = squared_distance(view[here].position, site)
        if minimum <= enough:
            return here
        here = yield from walk_face(view, here, site, search)
        reached = squared_distance(view[here].position, site)
        if reached <= enough or reached >= minimum:
            return here


def deliver(
    view: View, source: RobotId, destination: RobotId, site: Point, search: Search = WHOLE_FACE
) -> Routing:
    """Greedy-face-greedy to the robot ``destination``, last known at ``site``.

    Returns the robot reached: ``destination`` on every connected static planar graph in which
    it has its place to itself; any other means that it cannot be reached.
    """
    here = source
    while True:
        here = yield from greedy(view, here, site)
        if here == destination:
            return here
        minimum = squared_distance(view[here].position, site)
        here = yield from walk_face(view, here, site, search)
        if here == destination or squared_distance(view[here].position, site) >= minimum:
            return here


def follow_faces(view: View, source: RobotId, site: Point, search: Search) -> Routing:
    """Walk the faces that the line from ``source`` to ``site`` cuts, one after another.

    Ends at the first robot within the search radius, or where the last face closes.
    """
    if squared_distance(view[source].position, site) <= search.radius * search.radius:
        return source
    return (yield from walk_face(view, source, site, search, until_nearer=False))


def walk_face(
    view: View, start: RobotId, site: Point, search: Search, *, until_nearer: bool = True
) -> Routing:
    """Walk the face that the ray from ``start`` to ``site`` enters, until something is found.

    Returns the first robot entered that is within the search radius or, ``until_nearer``,
    nearer to the site than ``start``; else the robot where the walk closed. Where links are no
    disc, or known at one end alone, a walk may run into its own middle: the packet, which knows
    the edges that it has passed, then tries the other hand, and no edge a second time.
    """
    origin = view[start].position
    entry = squared_distance(origin, site)
    enough = search.radius * search.radius
    left = search.hand == "left"
    here, came_from = start, None
    reference = bearing(origin, site)
    crossed = entry  # squared distance from the site to the last change of face
    first: tuple[RobotId, RobotId] | None = None
    walked: set[tuple[RobotId, RobotId]] = set()  # since the last change of face
    turned = False
    seen = {start}
    while True:
        me = view[here]
        ahead = next_around(
            me.neighbours, me.position, reference, came_from=came_from, clockwise=left
        )
        if ahead is None:
            return here
        cut = crossing(me.position, me.neighbours[ahead], origin, site)
        if cut is not None and squared_distance(cut, site) < crossed:
            crossed = squared_distance(cut, site)
            first = None
            walked.clear()
            if _enters_before(search, me, ahead, site, left):
                reference, came_from = bearing(me.position, me.neighbours[ahead]), ahead
                continue
            left = not left
        again = (here, ahead) in walked
        if again and not turned and (here, ahead) != first:
            left, turned = not left, True
            continue
        if again or (search.stop == "node" and ahead in seen):
            return here
        if not (yield Transmission("route-face", here, ahead)):
            continue
        first = first or (here, ahead)
        walked.add((here, ahead))
        behind = me.position
        here, came_from = ahead, here
        seen.add(here)
        position = view[here].position
        distance = squared_distance(position, site)
        if distance <= enough or (until_nearer and distance < entry):
            return here
        reference = bearing(position, behind)


def _enters_before(search: Search, me: RobotView, ahead: RobotId, site: Point, left: bool) -> bool:
    """Whether to enter the next face without passing over the edge that the line cuts."""
    if search.change != "best-angle":
        return search.change == "before"
    over = bearing(me.position, me.neighbours[ahead])
    beside = next_around(me.neighbours, me.position, over, came_from=ahead, clockwise=left)
    if beside is None:
        return False
    towards = bearing(me.position, site)
    return angle_between(bearing(me.position, me.neighbours[beside]), towards) < angle_between(
        over, towards
    )
