"""How to read a recording, in words."""

from __future__ import annotations

from fleet.replay.state import FleetState

GRAPHS = {
    "gabriel": "Gabriel graph",
    "udg": "unit disc graph",
    "rng": "relative neighbourhood graph",
    "emst": "minimum spanning tree",
}


def guide(state: FleetState) -> str:
    """The text beside the picture, as Markdown."""
    scene = state.scene
    life_size = state.mark == scene.radius
    size = "" if life_size else f", drawn larger than it is ({scene.radius:g} m)"
    graph = GRAPHS.get(scene.graph, scene.graph)
    return f"""\
**Play** goes through the `story`: talk slow enough to be followed, a new event, an award and an \
arrival paused at, drives in real time. **Scrub** by `sim_time` to see who drives at once, by \
`msg` to go through the talk one transmission at a time (arrow keys step), by `round` to go from \
event to event. The timeline is chosen beside the play button.

One event is **in focus**, as long as it is talked over: circle, arrows, rings, names, the *Event* \
card and the *Sequence chart* are about it.

| on the floor | is |
|---|---|
| disc | a robot{size}; its colour is what its battery holds |
| red cross | a robot out of energy |
| white cross | a robot that has broken down |
| orange bar | a robot whose motor is broken: it talks, and does not drive |
| grey disc, one stroke | a robot that is silenced; a grey circle is the region without radio |
| ring | its part: blue, orange relayed; purple called; green bid; yellow won |
| thick grey line | a link of the {graph}, which messages travel on |
| thin grey line | any two robots within {scene.radio_range:g} m of each other |
| **blue** arrow | greedy hop, to the neighbour nearest to the event |
| **orange** arrow | face hop, where no neighbour is nearer: around a gap |
| **purple** arrow | call for bids, heard by all neighbours |
| **green** arrow | bid on its way to the auctioneer |
| **yellow** arrow | assignment to the winner |
| **vermillion** arrow | lost: nobody heard it |
| **white** arrow | the transmission at the cursor |
| red target | the event in focus; the circle is the search radius, {scene.search_radius:g} m |
| red dot | another open event; at the end of a line: where the event in focus really is |
| yellow dashes | the straight line: Eq. (1) charges {scene.per_metre:.1f} J/m for it |
| lavender dashes | likewise to a place that is no event, where a robot is sent to carry \
the event on, or to keep the fleet connected |
| thin yellow line | the way that it has planned around others, where it bends |
| thick yellow line | where a robot drove |
| hatched | the hole: no robot starts there; events happen there all the same |
| solid block | an obstacle: robots drive around it, the radio passes |

**Lanes** under the floor: a row for each open event and for collector, auctioneer and winner of \
the one in focus, coloured by what goes on. **Sequence chart**: robots from left to right as they \
joined in, transmissions downwards, in the colours of the arrows; the white line is the cursor. \
**Tables**: every task, trip and transmission as a row.

Point at a robot for what it holds; at one with a part, for what it is. A click shows it in the \
selection panel (top right corner opens it).

*Collector*: the robot that is told of the event. *Auctioneer*: where the search ends. \
In the log, ×3 says that a frame was sent three times.
"""
