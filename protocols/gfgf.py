"""Greedy-face-greedy-find with energy: whoever is found goes.

Reference: Stanulovic, Mitton and Mezei, Sensors 21(18):6149, 2021, sections 2.5 and 4.3
(doi:10.3390/s21186149).
"""

from __future__ import annotations

from protocols.auctions import keep
from protocols.messages import Conversation, Event, RobotId, View
from protocols.metrics import energy_left
from protocols.routing import TWO_SR, Search, find


def gfgf2a(
    view: View,
    event: Event,
    source: RobotId,
    *,
    search: Search = TWO_SR,
) -> Conversation:
    """Route to the event; the robot that the search ends at takes the task (section 4.3)."""
    found = yield from find(view, source, event, search)
    return keep(view, found, event, energy_left)
