"""The tables of a recording: what can be asked of its transmissions, trips and tasks.

Events are numbered as they are shown, from 1, and so are rounds and transmissions.
"""

from __future__ import annotations

import pyarrow as pa

from fleet.replay.scheme import TASKS, TRANSCRIPT, TRIPS

NOBODY = -1
"""Stands for the receiver of a broadcast, the bidder where there is no bid, and whoever did not
come.
"""
INT, REAL, TEXT, IDS = pa.int32(), pa.float64(), pa.string(), pa.list_(pa.int32())
SCHEMAS: dict[str, dict[str, pa.DataType]] = {
    TRANSCRIPT: {
        "number": INT, "time": REAL, "event": INT, "kind": TEXT, "sender": INT, "receiver": INT,
        "heard": IDS, "bidder": INT, "cost": REAL, "metric": TEXT, "attempts": INT,
    },
    TRIPS: {
        "event": INT, "robot": INT, "outcome": TEXT, "departed": REAL, "ended": REAL,
        "from_x": REAL, "from_y": REAL, "to_x": REAL, "to_y": REAL, "end_x": REAL, "end_y": REAL,
        "path": REAL, "planned": REAL, "waited": REAL, "energy": REAL, "foreseen": REAL,
        "believed": REAL, "energy_left": REAL,
    },
    TASKS: {
        "event": INT, "x": REAL, "y": REAL, "told_x": REAL, "told_y": REAL, "raised": REAL,
        "offers": INT, "taken": REAL, "reached": REAL, "closed": REAL, "outcome": TEXT,
        "robot": INT, "cost": REAL, "metric": TEXT, "deadline": REAL, "late": pa.bool_(),
    },
}  # fmt: skip
"""Columns of each table. Times in s, places and lengths in m, energies in J; a cost in the unit of
its metric; nothing for what did not come to be.
"""
SORTED_BY = {TRANSCRIPT: "number", TRIPS: "ended", TASKS: "event"}
