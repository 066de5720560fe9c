"""The tables of a recording as files: Parquet, and MCAP for those who live in Foxglove."""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from fleet.replay import scheme
from fleet.replay.readback import Recording, sound
from fleet.replay.table_schemas import SCHEMAS

TIMES = {"transcript": "time", "trips": "ended", "tasks": "raised", "poses": "time"}
"""By table: the column [s] that its rows are ordered by in time."""
JSON_TYPES = {"string": "string", "int32": "integer", "double": "number", "bool": "boolean"}


def export_tables(recording: Path, folder: Path, *, mcap: bool = False) -> list[Path]:
    """Write each table into a file of its own; returns the files.

    Args:
        recording: the .rrd file.
        folder: is made if there is none. It gets ``transcript.parquet``, ``trips.parquet``,
            ``tasks.parquet`` and ``poses.parquet``: robots under way, 20 times a second.
        mcap: also write all of them into ``recording.mcap``, a topic each, as JSON.

    Raises:
        ValueError: the recording cannot be read, or MCAP is asked for and not installed.
        OSError: a file cannot be written.
    """
    if mcap and find_spec("mcap") is None:
        raise ValueError("MCAP is not installed; expected: pip install 'talking-fleet[mcap]'")
    loaded = sound(recording)
    tables = {path.rpartition("/")[2]: loaded.table(path) for path in SCHEMAS}
    tables["poses"] = poses(loaded)
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, table in tables.items():
        written.append(folder / f"{name}.parquet")
        pq.write_table(table, written[-1])
    if mcap:
        written.append(folder / "recording.mcap")
        _write_mcap(tables, written[-1])
    return written


def poses(recording: Recording) -> pa.Table:
    """Where robots under way were: time [s], robot, x, y [m] and where by its plan, heading [rad],
    energy [J].
    """
    rows = recording.rows(scheme.MOVERS, "Robot:id")
    counts = [len(row) for row in rows.values]
    columns = {"time": np.repeat(rows.moments[scheme.SIM_TIME] / 1e9, counts)}
    columns["robot"] = _flat(rows.values, np.int32)
    places = recording.rows(scheme.MOVERS, "Points2D:positions").values
    spots = _flat([np.asarray(row).reshape(-1) for row in places], np.float32).reshape(-1, 2)
    columns |= {"x": spots[:, 0], "y": spots[:, 1]}
    off = recording.rows(scheme.MOVERS, f"Robot:{scheme.ROBOT_OFF_PLAN}").values
    due = spots + _flat([np.asarray(row).reshape(-1) for row in off], np.float32).reshape(-1, 2)
    columns |= {"planned_x": due[:, 0], "planned_y": due[:, 1]}
    for name in (scheme.ROBOT_HEADING, scheme.ROBOT_ENERGY):
        columns[name] = _flat(recording.rows(scheme.MOVERS, f"Robot:{name}").values, np.float32)
    return pa.table(columns)


def _flat(rows: Sequence[Any], kind: type[np.generic]) -> NDArray[Any]:
    return np.concatenate([np.empty(0, kind), *(np.asarray(row, kind) for row in rows)])


def _write_mcap(tables: dict[str, pa.Table], out: Path) -> None:
    """A topic for each table; a row is a JSON message at its time."""
    from mcap.writer import Writer

    with out.open("wb") as file:
        writer = Writer(file)
        writer.start()
        for name, table in tables.items():
            properties = {
                field.name: {"type": JSON_TYPES.get(str(field.type), "number")}
                if not pa.types.is_list(field.type)
                else {"type": "array", "items": {"type": "integer"}}
                for field in table.schema
            }
            schema = {"type": "object", "properties": properties}
            id_ = writer.register_schema(name, "jsonschema", json.dumps(schema).encode())
            channel = writer.register_channel(f"/{name}", "json", id_)
            for row in table.sort_by(TIMES[name]).to_pylist():
                time = round(1e9 * row[TIMES[name]])
                writer.add_message(channel, time, json.dumps(row).encode(), time)
        writer.finish()
