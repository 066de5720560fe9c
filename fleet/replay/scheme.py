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
STORY: Final = "story"  # talk, slow enough to be followed, and drives in real time: see FleetState
TIMELINES: Final = (STORY, SIM_TIME, ROUND, MSG)
IN_SECONDS: Final = (STORY, SIM_TIME)
BEAT: Final = 0.15  # [s] on the story timeline from one transmission to the next
PAUSE: Final = 0.6  # [s] likewise for a new event, an award and the end of a trip to be seen

# What is seen from above. Drawn in this order, the later over the earlier.
WORLD: Final = "world"
FLOOR: Final = "world/floor"
GROUND: Final = "world/floor/ground"
WALLS: Final = "world/floor/walls"
HOLE: Final = "world/floor/hole"
OBSTACLES: Final = "world/floor/obstacles"
SCALES: Final = "world/floor/scales"
ENERGY_SCALE: Final = "world/floor/energy_scale"
LINKS: Final = "world/links"
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
MARKS: Final = "world/marks"  # of those that failed or are silenced
EVENT: Final = "world/event"
NAMES: Final = "world/names"
PARTS: Final = "world/parts"  # who is what, said when it is pointed at
LEADERS: Final = "world/leaders"  # from names to what they name
OPEN_EVENTS: Final = "world/open_events"  # that are not in focus
TRUE_SITE: Final = "world/true_site"  # of the event in focus, if it was reported elsewhere
SILENT: Final = "world/silent"  # regions without radio
SENSORS: Final = "world/floor/sensors"

# What is read.
LANES: Final = "lanes"  # of states: see event_lane and robot_lane
LOG: Final = "protocol/log"
CARD: Final = "protocol/card"
GUIDE: Final = "protocol/how_to_read"

# What can be asked: a row for each transmission, trip and task.
TRANSCRIPT: Final = "data/transcript"
TRIPS: Final = "data/trips"
TASKS: Final = "data/tasks"

# The event in focus as protocol people draw it: robots across, transmissions down.
CHART: Final = "chart"
CHART_ROBOTS: Final = "chart/robots"
CHART_LIFELINES: Final = "chart/lifelines"
CHART_MESSAGES: Final = "chart/messages"
CHART_CURSOR: Final = "chart/cursor"

# What is counted, once a round.
FLEET_ENERGY: Final = "fleet/energy"
FLEET_MESSAGES: Final = "fleet/messages"
TRIP_ENERGY: Final = "fleet/trip_energy"
TOTAL_ENERGY: Final = "fleet/total_energy"
LINK_COUNT: Final = "fleet/links"
COMPONENTS: Final = "fleet/components"
ON_AIR: Final = "fleet/on_air"

# Several recordings beside each other: the same curves, under the path of each.
COMPARED_ENERGY: Final = "compared/energy"
COMPARED_TOTAL: Final = "compared/total_energy"
COMPARED_MESSAGES: Final = "compared/messages"
COMPARED_ON_AIR: Final = "compared/on_air"
DIFFERENCE: Final = "difference"  # in words, and as curves, each to the first
DIFFERENCE_ENERGY: Final = "difference/energy"
DIFFERENCE_MESSAGES: Final = "difference/messages"

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
ROBOT_ENERGY: Final = "energy"  # [J] of Robot, at ROBOTS and MOVERS
ROBOT_ID: Final = "id"  # at MOVERS; at ROBOTS it is the place in the row
ROBOT_OFF_PLAN: Final = "off_plan"  # [m] at MOVERS: from where it is to where its plan has it
ROBOT_IS: Final = "is"  # at PARTS, in words
ROBOT_HEADING: Final = "heading"  # [rad] at MOVERS

# Colours 0xRRGGBBAA.
KIND_COLOURS: Final[dict[str, int]] = {
    "route-greedy": 0x56B4E9FF,  # sky blue
    "route-face": 0xE69F00FF,  # orange
    "call": 0xCC79A7FF,  # reddish purple
    "bid": 0x1FBF8FFF,  # bluish green, lightened for dark ground
    "assign": 0xF0E442FF,  # yellow
}
KINDS_ON_WHITE: Final[dict[str, int]] = {  # the same hues, dark enough
    "route-greedy": 0x0072B2FF,
    "route-face": 0xE08A00FF,
    "call": 0xB8528FFF,
    "bid": 0x009E73FF,
    "assign": 0x8F7A00FF,
}
OTHER_KIND: Final = 0x9AA5B5FF
KIND_LABELS: Final[dict[str, str]] = {
    "route-greedy": "greedy hop",
    "route-face": "face hop",
    "call": "call",
    "bid": "bid",
    "assign": "assignment",
}
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
MARK_COLOURS: Final[dict[str, int]] = {
    "exhausted": 0xFF6B4AFF,
    "broken": 0xF5F7FAFF,
    "motor": 0xE69F00FF,
    "silenced": 0x93A0B4FF,
}
MARK_LABELS: Final[dict[str, str]] = {
    "exhausted": "out of energy",
    "broken": "broken down",
    "motor": "motor broken",
    "silenced": "silenced",
}
SILENT_COLOUR: Final = 0x93A0B480
TRUE_COLOUR: Final = 0xFF6B4AFF
OPEN_COLOUR: Final = 0xFF6B4AA0
SENSOR_COLOUR: Final = 0x56B4E960
LEADER_COLOUR: Final = 0x93A0B4B0
SOURCE_COLOUR: Final = 0x56B4E9FF
AUCTIONEER_COLOUR: Final = 0xCC79A7FF
CALLED_COLOUR: Final = 0x8A5B80FF
WINNER_COLOUR: Final = 0xF0E442FF
PLANNED_COLOUR: Final = 0xF0E442B0
WINNER_ON_WHITE: Final = 0xB39A00FF
WINNER_TEXT: Final = 0xCDB300FF  # the same, dark enough to be read on white
RELOCATION_COLOUR: Final = 0xA6B4FFFF  # lavender
GROUND_COLOUR: Final = (11, 14, 20)
TEXT_COLOUR: Final = 0x93A0B4FF


def kind_colour(kind: str) -> int:
    """The colour of a kind of message; grey for kinds unknown here."""
    return KIND_COLOURS.get(kind, OTHER_KIND)


def event_lane(slot: int) -> str:
    """The lane of the open event that is at one of a few places."""
    return f"{LANES}/events/{slot + 1}"


def robot_lane(part: str) -> str:
    """The lane of the robot that has a part in the conversation in focus."""
    return f"{LANES}/{part}"


def messages(kind: str) -> str:
    """Where the transmissions of a kind are drawn."""
    return f"{MESSAGES}/{kind}"


def arrow_colour(path: str) -> int:
    """The colour of the arrows at a path under :data:`MESSAGES`."""
    return LOST_COLOUR if path == LOST else kind_colour(path.rpartition("/")[2])
