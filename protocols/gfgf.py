"""Greedy, face, greedy-face-greedy and greedy-face-greedy-find: whoever is found goes.

References: Finn, ISI/RR-87-180, 1987 (greedy); Bose, Morin, Stojmenovic and Urrutia, Wireless
Networks 7(6), 2001 (face and GFG, doi:10.1023/A:1012319418150); Mezei and Stanulovic et al.
(GFGF1, GFGF2), as described in Stanulovic, Mitton and Mezei, Sensors 21(18):6149, 2021,
sections 2.2 to 2.5 and 4.3 (doi:10.3390/s21186149).
"""

from __future__ import annotations

from dataclasses import replace

from protocols.auctions import keep
from protocols.messages import Conversation, Event, RobotId, View
from protocols.metrics import energy_left
from protocols.routing import TWO_SR, WHOLE_FACE, Search, find, follow_faces, greedy


def greedy_only(view: View, event: Event, source: RobotId) -> Conversation:
    """Route greedily to a local minimum; that robot takes the task, however far it is."""
    found = yield from greedy(view, source, event.position)
    return keep(view, found, event, energy_left)


def face(view: View, event: Event, source: RobotId, *, search: Search = TWO_SR) -> Conversation:
    """Walk the faces along the line to the event; the robot that the walk ends at goes."""
    found = yield from follow_faces(view, source, event.position, search)
    return keep(view, found, event, energy_left)


def gfgf1(
    view: View, event: Event, source: RobotId, *, search: Search = WHOLE_FACE
) -> Conversation:
    """Route and walk the whole face around the event: the nearest robot is found, and goes."""
    found = yield from find(view, source, event, replace(search, radius=0.0))
    return keep(view, found, event, energy_left)


def gfgf2a(view: View, event: Event, source: RobotId, *, search: Search = TWO_SR) -> Conversation:
    """Route until a robot within the search radius is found; that robot goes."""
    found = yield from find(view, source, event, search)
    return keep(view, found, event, energy_left)
