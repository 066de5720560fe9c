"""How to read a recording, in words."""

from __future__ import annotations

from fleet.replay.story import Story

GRAPHS = {
    "gabriel": "Gabriel graph",
    "udg": "unit disc graph",
    "rng": "relative neighbourhood graph",
    "emst": "minimum spanning tree",
}


def guide(story: Story) -> str:
    """The text beside the picture, as Markdown."""
    scene = story.scene
    size = (
        "drawn in its size"
        if story.mark == scene.radius
        else f"drawn larger than it is ({scene.radius:g} m)"
    )
    return f"""\
**Scrub** by `sim_time` to see robots drive, by `msg` to go through the conversation one \
transmission at a time (arrow keys step), by `round` to go from event to event. \
The timeline is chosen beside the play button.

| on the floor | is |
|---|---|
| disc | a robot, {size}; its colour is what its battery holds, see the scale |
| grey disc with a cross | out of energy, off the air |
| ring | its part in this conversation: blue or orange relayed the request, purple called or was \
called, green bid, yellow won |
| grey lines | radio links: thick ones of the {GRAPHS[scene.graph]} that messages travel on, thin \
ones of all pairs within {scene.radio_range:g} m |
| **blue** arrow | greedy hop: to the neighbour nearest to the event |
| **orange** arrow | face hop: around a hole in the network, when no neighbour is nearer |
| **purple** arrow | call for bids, heard by all neighbours |
| **green** arrow | bid on its way to the auctioneer |
| **yellow** arrow | assignment to the winner |
| **vermillion** arrow | lost: nobody heard it |
| **white** arrow | the transmission at the cursor |
| red target | the event; the wide circle is the search radius, {scene.search_radius:g} m |
| yellow dashes | the straight line that Eq. (1) charges {scene.per_metre:.1f} J/m for |
| yellow line | where the robot drove |
| hatched | the hole: no robot starts there, but events happen there and robots may cross it |

*Collector*: the robot that was told of the event. *Auctioneer*: where the search ended.
"""
