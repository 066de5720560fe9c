"""Where rows go: into a file, to a viewer, or both."""

from __future__ import annotations

import socket
from collections.abc import Mapping, Sequence
from typing import Any
from urllib.parse import urlsplit

import rerun as rr
import rerun.blueprint as rrb

from fleet.replay.columns import Index, Moment, single
from fleet.replay.scheme import APPLICATION


class Sink:
    """An open recording."""

    def __init__(self, path: str | None, live: str | None, key: str) -> None:
        self._recording = rr.RecordingStream(APPLICATION, recording_id=key, send_properties=False)
        # The wall clock would make two recordings of one run differ.
        self._recording.set_log_time_enabled(False)
        self._recording.set_log_tick_enabled(False)
        self._live = live
        self._sinks: list[Any] = []
        if path is not None:
            self._sinks.append(rr.FileSink(path))
        if live is not None:
            self._sinks.append(rr.GrpcSink(live))

    def open(self, blueprint: rrb.Blueprint) -> None:
        """Begin, with the way it wants to be looked at."""
        if self._live is not None:
            _check_listens(self._live)
        self._recording.set_sinks(*self._sinks, default_blueprint=blueprint)

    def name(self, name: str) -> None:
        """What a viewer lists the recording as."""
        self._recording.send_recording_name(name)

    def properties(self, group: str, values: Mapping[str, Any]) -> None:
        """Keep plain values with the recording."""
        self._recording.send_property(group, [single(key, value) for key, value in values.items()])

    def static(self, path: str, *what: rr.AsComponents) -> None:
        """What is true at all times."""
        self._recording.log(path, *what, static=True)

    def rows(self, path: str, when: Index | Sequence[Moment], *columns: rr.ComponentColumn) -> None:
        """Rows of one entity; none are not worth a chunk."""
        index = when if isinstance(when, Index) else Index.of(when)
        if len(index.times):
            self._recording.send_columns(path, index.columns(), columns)

    def close(self) -> None:
        """Write what is under way, and the footer that makes the file quick to open."""
        try:
            self._recording.flush()
        except RuntimeError:
            if self._live is None:
                raise  # else the viewer was closed before the run was over, which it may be
        finally:
            self._recording.disconnect()


def _check_listens(address: str) -> None:
    """Raises ConnectionError if nobody does: Rerun would wait for them for ever."""
    parts = urlsplit(address.removeprefix("rerun+"))
    try:
        socket.create_connection((parts.hostname or "", parts.port or 0), timeout=5.0).close()
    except OSError as error:
        raise ConnectionError(f"no viewer listens at {address}") from error
