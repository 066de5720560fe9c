"""Where everything in a recording is kept, and what it looks like: paths, timelines, colours.

The writer, the blueprint, the pictures and the tests all import it; nothing else names a path.

Message kinds have the hues of Okabe and Ito (jfly.uni-koeln.de/color), which readers with any
colour vision tell apart; energy is viridis, which grows lighter with energy in grey too.
"""

from __future__ import annotations

from typing import Final

APPLICATION: Final = "talking-fleet"
COMPARISON: Final = "talking-fleet-comparison"  # laid out differently, so another application

SIM_TIME: Final = "sim_time"  # simulated time [s], stored as a duration in ns
ROUND: Final = "round"  # events raised so far; 0: before the first
MSG: Final = "msg"  # the transmission on the air or next to come, from 1
TIMELINES: Final = (SIM_TIME, ROUND, MSG)

# What is seen from above. Drawn in this order, the later over the earlier.
WORLD: Final = "world"
GROUND: Final = "world/floor/ground"
WALLS: Final = "world/floor/walls"
HOLE: Final = "world/floor/hole"
OBSTACLES: Final = "world/floor/obstacles"
SCALES: Final = "world/floor/scales"
ENERGY_SCALE: Final = "world/floor/energy_scale"
UDG: Final = "world/links/udg"  # and one of LINK_PARTS: all pairs in range
ROUTING: Final = "world/links/routing"  # likewise: the graph that messages travel on
LINK_PARTS: Final = ("lasting", "resting", "moving")  # for some trips, for a trip, on a trip
SEARCH: Final = "world/search_radius"
STRAIGHT: Final = "world/trips/straight"  # the line that Eq. (1) charges for
RELOCATION: Final = "world/trips/relocation"  # the same, to a place that is no event
PLANNED: Final = "world/trips/planned"  # the way around others, if it is not that line
DRIVEN: Final = "world/trips/driven"
MESSAGES: Final = "world/messages"  # and /<kind>: what has been sent in this conversation
LOST: Final = "world/messages/lost"  # heard by nobody
PACKET: Final = "world/packet"  # the transmission at the cursor
RINGS: Final = "world/rings"  # who has done what in this conversation
ROBOTS: Final = "world/robots"  # at rest; NaN while under way
MOVERS: Final = "world/movers"  # under way
DEAD: Final = "world/dead"
EVENT: Final = "world/event"
NAMES: Final = "world/names"

# What is read.
PHASE: Final = "protocol/phase"
LOG: Final = "protocol/log"
CARD: Final = "protocol/card"
GUIDE: Final = "protocol/how_to_read"
TREE: Final = "protocol/auction"

# What is counted, once a round.
FLEET_ENERGY: Final = "fleet/energy"
FLEET_MESSAGES: Final = "fleet/messages"
TRIP_ENERGY: Final = "fleet/trip_energy"
TOTAL_ENERGY: Final = "fleet/total_energy"
LINK_COUNT: Final = "fleet/links"
COMPONENTS: Final = "fleet/components"
ON_AIR: Final = "fleet/on_air"

# The whole lifetime.
ENERGY_MAP: Final = "lifetime/energy_map"
ENERGY_MAP_SCALES: Final = "lifetime/energy_map/scales"
ENERGY_MAP_CURSOR: Final = "lifetime/energy_map/cursor"
GROUND_PLANE: Final = "lifetime/ground"
PATHS: Final = "lifetime/ground/paths"
STARTS: Final = "lifetime/ground/starts"
ENDS: Final = "lifetime/ground/ends"
HISTOGRAM: Final = "lifetime/energy_left"

# Columns of our own beside what is drawn.
ROBOT_ENERGY: Final = "energy"  # [J] of Robot, at ROBOTS

# Colours 0xRRGGBBAA.
KIND_COLOURS: Final[dict[str, int]] = {
    "route-greedy": 0x56B4E9FF,  # sky blue
    "route-face": 0xE69F00FF,  # orange
    "call": 0xCC79A7FF,  # reddish purple
    "bid": 0x1FBF8FFF,  # bluish green, lightened for dark ground
    "assign": 0xF0E442FF,  # yellow
}
OTHER_KIND: Final = 0x9AA5B5FF
KIND_LABELS: Final[dict[str, str]] = {
    "route-greedy": "greedy hop",
    "route-face": "face hop",
    "call": "call",
    "bid": "bid",
    "assign": "assignment",
}
MOTION: Final = "motion"
MOTION_COLOUR: Final = 0x6B7A90FF
LOST_COLOUR: Final = 0xD55E00FF  # vermillion
EVENT_COLOUR: Final = 0xFF6B4AFF
PACKET_COLOUR: Final = 0xFFFFFFFF
SEARCH_COLOUR: Final = 0xFF6B4A90
UDG_COLOUR: Final = 0x5B6B8230
ROUTING_COLOUR: Final = 0x7F9CB8A8
WALL_COLOUR: Final = 0x66748AFF
HOLE_COLOUR: Final = 0x8794A8FF
OBSTACLE_COLOUR: Final = 0xA7B0BEFF
RIM_COLOUR: Final = 0x0B0E14FF
DEAD_COLOUR: Final = 0x4A5058FF
CROSS_COLOUR: Final = 0xFF6B4AFF
SOURCE_COLOUR: Final = 0x56B4E9FF
AUCTIONEER_COLOUR: Final = 0xCC79A7FF
CALLED_COLOUR: Final = 0x8A5B80FF
WINNER_COLOUR: Final = 0xF0E442FF
PLANNED_COLOUR: Final = 0xF0E442B0
WINNER_TEXT: Final = 0xCDB300FF  # the same, dark enough to be read on white
RELOCATION_COLOUR: Final = 0xA6B4FFFF  # lavender
GROUND_COLOUR: Final = (11, 14, 20)
TEXT_COLOUR: Final = 0x93A0B4FF


def kind_colour(kind: str) -> int:
    """The colour of a kind of message; grey for kinds unknown here."""
    return KIND_COLOURS.get(kind, OTHER_KIND)


def messages(kind: str) -> str:
    """Where the transmissions of a kind are drawn."""
    return f"{MESSAGES}/{kind}"


def arrow_colour(path: str) -> int:
    """The colour of the arrows at a path under :data:`MESSAGES`."""
    return LOST_COLOUR if path == LOST else kind_colour(path.rpartition("/")[2])
