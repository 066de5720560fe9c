"""Everything that is drawn of a run."""

from __future__ import annotations

from collections.abc import Sequence

from fleet.replay.layers.arrows import Arrows
from fleet.replay.layers.bodies import Bodies
from fleet.replay.layers.curves import Curves
from fleet.replay.layers.drives import Drives
from fleet.replay.layers.event_card import EventCard
from fleet.replay.layers.event_log import EventLog
from fleet.replay.layers.lanes import Lanes
from fleet.replay.layers.lifetime import Lifetime
from fleet.replay.layers.links import Links
from fleet.replay.layers.roles import Roles
from fleet.replay.layers.sequence_chart import SequenceChart
from fleet.replay.layers.table_rows import TableRows
from fleet.replay.state import Layer


def layers() -> Sequence[Layer]:
    """One of each."""
    return (
        Bodies(),
        Links(),
        Drives(),
        Arrows(),
        Roles(),
        EventLog(),
        EventCard(),
        SequenceChart(),
        Lanes(),
        TableRows(),
        Curves(),
        Lifetime(),
    )
