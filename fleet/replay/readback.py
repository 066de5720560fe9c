"""Reading a recording back, without a viewer: what was logged, and the state at any moment."""

from __future__ import annotations

import subprocess
import warnings
from collections.abc import Mapping
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from rerun.chunk import Chunk, RrdReader

from fleet.replay.scheme import (
    APPLICATION,
    COMPARISON,
    IN_SECONDS,
    LOG,
    MSG,
    ROUND,
    SIM_TIME,
    STORY,
    TIMELINES,
)
from fleet.replay.table_schemas import SCHEMAS, SORTED_BY

NANO = 1e9

Values: TypeAlias = NDArray[Any] | list[str] | list[NDArray[np.float32]]
"""Instances of a component: numbers (k,), points (k, 2), texts, or polylines (c, 2) each."""


class Rows(NamedTuple):
    """All that was logged of one component of one entity, in the order of the moments."""

    moments: dict[str, NDArray[np.int64]]  # by timeline; simulated time in ns
    values: list[Values]  # one entry a row


class Recording:
    """A recording, loaded whole.

    Raises:
        ValueError: the file is missing, or damaged, or is not a recording of a fleet.
    """

    def __init__(self, path: Path) -> None:
        if not path.is_file():
            what = "is a directory; expected a recording" if path.is_dir() else "no such file"
            raise ValueError(f"{path}: {what}")
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # about a footer missing after a crash
                reader = RrdReader(str(path))
                entries = reader.recordings()
                chunks = reader.stream().to_chunks()
        except (RuntimeError, ValueError) as error:
            if "Not an RRD" in str(error) or "too small" in str(error):
                raise ValueError(f"{path}: not a Rerun recording") from error
            raise ValueError(
                f"{path}: the recording is cut off or damaged;"
                f" `rerun rrd optimize {path} -o {path.stem}-mended.rrd` may save what is whole"
            ) from error
        if not any(entry.application_id in (APPLICATION, COMPARISON) for entry in entries):
            raise ValueError(f"{path}: not a recording of a fleet, but of something else")
        self.path = path
        self.key = entries[0].recording_id
        self.chunks = chunks
        self._by_entity: dict[str, list[Chunk]] = {}
        for chunk in chunks:
            self._by_entity.setdefault(chunk.entity_path.removeprefix("/"), []).append(chunk)
        self._batches: dict[str, list[pa.RecordBatch]] = {}
        self._sorted: dict[tuple[str, str, str], tuple[NDArray[np.int64], list[pa.Scalar]]] = {}

    @property
    def entities(self) -> set[str]:
        """The paths of everything that was logged."""
        return set(self._by_entity)

    @cached_property
    def properties(self) -> dict[str, dict[str, Any]]:
        """What is known of the run as a whole, by group: "run", "scene", "summary"."""
        prefix = "__properties/"
        return {
            entity.removeprefix(prefix): {
                name: batch.column(name)[0].as_py()[0]
                for batch in self.batches(entity)
                for name in batch.schema.names
                if not name.startswith("rerun.")
            }
            for entity in self.entities
            if entity.startswith(prefix)
        }

    @cached_property
    def temporal(self) -> set[str]:
        """The paths of what came and went, or moved."""
        return {e for e in self.entities if any(map(_is_temporal, self.batches(e)))}

    def batches(self, entity: str) -> list[pa.RecordBatch]:
        """The chunks of an entity as Arrow has them."""
        if entity not in self._batches:
            self._batches[entity] = [
                chunk.to_record_batch() for chunk in self._by_entity.get(entity, ())
            ]
        return self._batches[entity]

    def table(self, path: str) -> pa.Table:
        """A table of the recording, such as :data:`scheme.TRANSCRIPT`: its columns by name.

        Raises:
            ValueError: there is no such table.
        """
        if path not in SCHEMAS:
            raise ValueError(f"table {path!r}; expected one of {', '.join(SCHEMAS)}")
        prefix = f"{path.rpartition('/')[2]}:"
        parts = [self._part(batch, prefix, SCHEMAS[path]) for batch in self.batches(path)]
        schema = pa.schema([pa.field(name, kind) for name, kind in SCHEMAS[path].items()])
        return pa.Table.from_batches(parts, schema).sort_by(SORTED_BY[path])

    @staticmethod
    def _part(
        batch: pa.RecordBatch, prefix: str, schema: Mapping[str, pa.DataType]
    ) -> pa.RecordBatch:
        """The columns of a chunk; Rerun keeps a list of values in each cell."""
        cells = [
            batch.column(prefix + name)
            if pa.types.is_list(kind)
            else batch.column(prefix + name).flatten()
            for name, kind in schema.items()
        ]
        arrays = [cell.cast(kind) for cell, kind in zip(cells, schema.values(), strict=True)]
        return pa.record_batch(arrays, names=[*schema])

    def span(self, timeline: str) -> tuple[float, float]:
        """The first and the last moment of a timeline; simulated time in s."""
        ends = [
            (index.min(), index.max())
            for entity in self.entities
            for batch in self.batches(entity)
            if timeline in batch.schema.names and len(index := _times(batch, timeline))
        ]
        first, last = min(low for low, _ in ends), max(high for _, high in ends)
        scale = NANO if timeline in IN_SECONDS else 1
        return float(first) / scale, float(last) / scale

    def static(self, entity: str, component: str) -> Values | None:
        """What was logged of a component for all times, or None."""
        found = None
        for batch in self.batches(entity):
            if component in batch.schema.names and not _is_temporal(batch):
                found = _values(batch.column(component)[0])
        return found

    def rows(self, entity: str, component: str) -> Rows:
        """All rows of a component, by simulated time and then in the order they were logged."""
        found = [
            batch
            for batch in self.batches(entity)
            if component in batch.schema.names and _is_temporal(batch)
        ]
        cells = [cell for batch in found for cell in batch.column(component)]
        kept = [k for k, cell in enumerate(cells) if cell.is_valid]
        index = {
            timeline: np.concatenate(
                [np.empty(0, np.int64), *(_times(batch, timeline) for batch in found)]
            )[kept]
            for timeline in TIMELINES
        }
        ids = [id_.as_py() for batch in found for id_ in batch.column("rerun.controls.RowId")]
        logged = np.argsort(np.argsort(np.array([ids[k] for k in kept], "S16"), kind="stable"))
        order = np.lexsort([logged, index[SIM_TIME]])
        return Rows(
            {timeline: times[order] for timeline, times in index.items()},
            [_values(cells[kept[k]]) for k in order.tolist()],
        )

    def at(self, entity: str, component: str, timeline: str, moment: float) -> Values | None:
        """What a viewer shows of a component at a moment (in s, or a number), or None.

        That is the row latest on the timeline; of several at the same time, that logged last;
        without any, what was logged for all times.
        """
        key = entity, component, timeline
        if key not in self._sorted:
            self._sorted[key] = self._ordered(*key)
        times, cells = self._sorted[key]
        when = round(moment * NANO) if timeline in IN_SECONDS else moment
        place = int(np.searchsorted(times, when, side="right"))
        return _values(cells[place - 1]) if place else self.static(entity, component)

    def moment_at(self, timeline: str, moment: float) -> tuple[float, int, int]:
        """The simulated time [s], round and message of what was last said at a moment."""
        times, lines = np.empty(0, np.int64), np.empty((0, 3), np.int64)
        for batch in self.batches(LOG):
            if timeline in batch.schema.names:
                times = np.concatenate([times, _times(batch, timeline)])
                three = np.column_stack([_times(batch, name) for name in (SIM_TIME, ROUND, MSG)])
                lines = np.concatenate([lines, three])
        when = round(moment * NANO) if timeline in IN_SECONDS else moment
        said = np.flatnonzero(times <= when)
        if not len(said):
            return 0.0, 0, 0
        latest = said[np.lexsort([said, times[said]])[-1]]
        time, round_, msg = lines[latest].tolist()
        return time / NANO, round_, msg

    def check_moment(self, timeline: str, moment: float) -> None:
        """Raises ValueError unless the recording has that timeline and moment."""
        if timeline not in TIMELINES:
            raise ValueError(f"timeline {timeline!r}; expected one of {', '.join(TIMELINES)}")
        first, last = self.span(timeline)
        if not first <= moment <= last:
            unit = " s" if timeline in IN_SECONDS else ""
            name = {SIM_TIME: "time", STORY: "moment of the story", ROUND: "round"}.get(
                timeline, "message"
            )
            raise ValueError(
                f"{self.path}: there is no {name} {moment:g}{unit};"
                f" expected {first:g} to {last:g}{unit}"
            )

    def _ordered(
        self, entity: str, component: str, timeline: str
    ) -> tuple[NDArray[np.int64], list[pa.Scalar]]:
        """Moments of a component, ascending, and its cells."""
        rows: list[tuple[int, bytes, pa.Scalar]] = []
        for batch in self.batches(entity):
            if component in batch.schema.names and timeline in batch.schema.names:
                ids = batch.column("rerun.controls.RowId")
                times = _times(batch, timeline).tolist()
                for time, id_, cell in zip(times, ids, batch.column(component), strict=True):
                    if cell.is_valid:
                        rows.append((time, id_.as_py(), cell))
        rows.sort(key=lambda row: row[:2])
        return np.array([time for time, _, _ in rows], np.int64), [cell for _, _, cell in rows]


def sound(path: Path) -> Recording:
    """A recording of anybody's, looked through by another process first.

    Rerun ends the process that reads some files that are damaged; this one goes on.

    Raises:
        ValueError: as :class:`Recording` does.
    """
    from fleet.replay.viewer import viewer_binary, viewer_environment

    if path.is_file():
        looked = subprocess.run(  # noqa: S603 - the program inside the wheel
            [str(viewer_binary()), "rrd", "stats", str(path)],
            env=viewer_environment(), capture_output=True, check=False,
        )  # fmt: skip
        if looked.returncode not in (0, 1):  # 1: it could say what is wrong, and so can we
            raise ValueError(f"{path}: the recording is damaged")
    return Recording(path)


def _is_temporal(batch: pa.RecordBatch) -> bool:
    return any(timeline in batch.schema.names for timeline in TIMELINES)


def _times(batch: pa.RecordBatch, timeline: str) -> NDArray[np.int64]:
    if timeline not in batch.schema.names:
        return np.empty(0, np.int64)
    times: NDArray[np.int64] = batch.column(timeline).cast(pa.int64()).to_numpy()
    return times


def _values(cell: pa.Scalar) -> Values:
    """A cell as NumPy has it."""
    values = cell.values
    kind = values.type
    if pa.types.is_fixed_size_list(kind):
        return np.asarray(values.flatten().to_numpy()).reshape(-1, kind.list_size)
    if pa.types.is_list(kind):
        starts = np.asarray(values.offsets.to_numpy())
        inner = values.flatten()
        if pa.types.is_fixed_size_list(inner.type):
            whole = np.asarray(inner.flatten().to_numpy()).reshape(-1, inner.type.list_size)
        else:
            whole = np.asarray(inner.to_numpy())
        return [whole[a - starts[0] : b - starts[0]] for a, b in pairwise(starts)]
    if pa.types.is_string(kind):
        texts: list[str] = values.to_pylist()
        return texts
    if pa.types.is_struct(kind):
        return np.array([tuple(row.values()) for row in values.to_pylist()], object)
    return np.asarray(values.to_numpy(zero_copy_only=False))
