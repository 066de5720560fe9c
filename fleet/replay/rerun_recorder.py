"""An observer that records the run. It only takes notes; another process turns them into a file."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fleet.motion import Trip
from fleet.observer import Excerpt, Observer
from fleet.replay.journal import RELOCATED, Note, Scene, TripEnd
from fleet.replay.writer_process import WriterProcess
from protocols.messages import Award, Event, Move, RobotId

if TYPE_CHECKING:
    from fleet.fleet import Fleet
    from fleet.power import Battery
    from fleet.results import Summary

MANY_POSES = 50_000  # that are held back at most
MANY_LINES = 50_000  # of the transcript that are held back at most
FLAT = len(TripEnd._fields)  # of a trip's fields go into the recording: the first
LIVE_PAUSE = 0.1  # [s] between looks of a live viewer


class RerunRecorder(Observer):
    """Records a run as a Rerun recording (.rrd), for a live viewer, or for both at once.

    If the run is killed, the file lacks at most the last ``flush_rounds`` rounds; if it breaks
    off in any other way, nothing.

    Args:
        path: the file to write; None: none.
        key: names the run; recordings of one key are the same run.
        properties: what the run was made from, kept with the recording: plain values,
            nested mappings too.
        live: True opens a viewer and streams to it; an address, such as
            "rerun+http://127.0.0.1:9876/proxy", streams to the viewer that listens there.
        flush_rounds: rounds between two times that the notes are handed on.
        sample_interval: simulated time between recorded poses of a moving robot [s].
        strict: data that Rerun would warn of ends the recording.
        writer: who draws; None: one is started.

    Raises:
        ValueError: there is nowhere to record to, or the file cannot be written.
    """

    def __init__(
        self,
        path: Path | None,
        *,
        key: str,
        properties: Mapping[str, Any],
        live: bool | str = False,
        flush_rounds: int = 25,
        sample_interval: float = 0.05,
        strict: bool = False,
        writer: WriterProcess | None = None,
    ) -> None:
        if path is None and not live:
            raise ValueError("neither a file nor a viewer to record to; expected at least one")
        if flush_rounds < 1:
            raise ValueError(f"flush_rounds is {flush_rounds}; expected 1 or more")
        if not sample_interval > 0.0:
            raise ValueError(f"sample_interval is {sample_interval} s; expected more than 0")
        if path is not None:
            _check_writable(path)
        self.path = path
        self.sample_interval = sample_interval
        self._flush_rounds = flush_rounds
        self._live = bool(live)
        self._batteries: list[Battery] = []
        self._all_drain = True  # also robots that stand still
        self._notes: list[Note] = []
        self._note = self._notes.append
        self._lines = 0  # of the transcript, and
        self._poses = 0  # since the last flush
        self._latest = -1  # id of the latest event
        self._rounds = 0  # events since the last flush
        self._flushed = time.monotonic()
        if live is True:
            from fleet.replay.viewer import spawn_viewer

            live = spawn_viewer()
        self.writer = WriterProcess() if writer is None else writer
        self.writer.name = str(path) if path is not None else "for the viewer"
        self.writer.tell(
            "open", None if path is None else str(path.absolute()), live or None, key,
            _plain(properties), strict,
        )  # fmt: skip

    def run_started(self, fleet: Fleet) -> None:
        """Tell the writer what the world looks like."""
        self._all_drain = bool(fleet.spec.extra.idle or fleet.spec.extra.transmission)
        self._batteries = [robot.battery for robot in fleet.robots]
        hole, labels, spec = fleet.arena.hole, fleet.labels, fleet.spec
        scene = Scene(
            width=fleet.arena.width,
            height=fleet.arena.height,
            hole=None if hole is None else hole.outline().tolist(),
            obstacles=[shape.outline().tolist() for shape in fleet.arena.obstacles],
            positions=[robot.position for robot in fleet.robots],
            energies=[battery.charge for battery in self._batteries],
            capacities=[battery.capacity for battery in self._batteries],
            radius=spec.radius,
            per_metre=spec.power.per_metre(spec.cruise),
            radio_range=fleet.topology.radio_range,
            search_radius=labels.search_radius,
            graph=fleet.topology.graph,
            protocol=labels.protocol,
            motion=labels.motion,
            world=labels.world,
            seed=labels.seed,
        )
        self.writer.tell("scene", scene)

    def air_changed(self, on_air: Sequence[RobotId], time: float) -> None:
        """Note it."""
        self._note(("air_changed", time, list(on_air)))

    def event_raised(self, event: Event, source: RobotId, time: float) -> None:
        """Note it; a new event is also the moment to send what the last rounds left."""
        if event.id != self._latest:
            self._latest = event.id
            if self._rounds == self._flush_rounds or self._due():
                self.flush()
            self._rounds += 1
        self._note(("event_raised", time, event.id, event.position, source))

    def transmitted(self, excerpt: Excerpt) -> None:
        """Note it."""
        first, time, event, transmissions, heard, attempts = excerpt
        kinds, senders, receivers, bids = zip(*transmissions, strict=True)
        offers = [None if bid is None else tuple(bid) for bid in bids]
        self._note(
            ("transmitted", time, event, first, kinds, senders, receivers, offers, heard, attempts)
        )
        self._lines += len(kinds)
        if self._lines > MANY_LINES:
            self.flush()

    def awarded(self, event: Event, award: Award, time: float) -> None:
        """Note it."""
        bids, moves = [*zip(*award.bids, strict=True)], [*zip(*award.moves, strict=True)]
        self._note(("awarded", time, event.id, award.winner, award.auctioneer, bids, moves))

    def broken_off(self, event: Event, reason: str, time: float) -> None:
        """Note it."""
        self._note(("broken_off", time, event.id, reason))

    def event_closed(self, event: Event, outcome: str, time: float) -> None:
        """Note it."""
        self._note(("event_closed", time, event.id, outcome))

    def departed(self, event: Event, robot: RobotId, time: float) -> None:
        """Note it."""
        self._note(("departed", time, event.id, robot, event.position, False))

    def planned(self, robot: RobotId, way: NDArray[np.float64], time: float) -> None:
        """Note it."""
        self._note(("planned", time, robot, way.tobytes()))

    def relocating(self, event: Event, move: Move, time: float) -> None:
        """Note it."""
        self._note(("departed", time, event.id, move.robot, move.position, True))

    def relocated(self, event: Event, trip: Trip) -> None:
        """Note the trip, and what batteries hold now."""
        end = trip.robot, RELOCATED, *trip[2:FLAT]
        self._note(("trip_ended", event.id, end, self._charges(trip.robot)))

    def moved(self, samples: NDArray[np.float64]) -> None:
        """Note the poses."""
        if len(samples):
            self._note(("moved", samples.tobytes()))
            self._poses += len(samples)
            if self._poses > MANY_POSES:
                self.flush()

    def trip_ended(self, event: Event, trip: Trip) -> None:
        """Note the trip, and what batteries hold now."""
        self._note(("trip_ended", event.id, trip[:FLAT], self._charges(trip.robot)))

    def run_ended(self, summary: Summary) -> None:
        """Keep the summary with the recording, but for what differs from run to run."""
        self.flush()
        figures = summary.as_dict()
        del figures["wall_time"]
        self.writer.tell("summary", _plain(figures))

    def closed(self) -> None:
        """Hand over the last notes and wait until the file is complete.

        Raises:
            RuntimeError: the recording could not be written.
        """
        if self.writer.alive:
            self.flush()
        self.writer.finish()

    def flush(self) -> None:
        """Send the notes taken since the last time."""
        if self._notes:
            self.writer.tell("batch", self._notes)
        self._notes.clear()
        self._lines = self._poses = self._rounds = 0
        self._flushed = time.monotonic()

    def _charges(self, robot: RobotId) -> list[float]:
        """What batteries hold: that of a robot that has driven, or all if all are drained."""
        drained = self._batteries if self._all_drain else [self._batteries[robot]]
        return [battery.charge for battery in drained]

    def _due(self) -> bool:
        """Whether a live viewer waits for news."""
        return self._live and time.monotonic() - self._flushed > LIVE_PAUSE


def _check_writable(path: Path) -> None:
    """Raises ValueError if it is not. What is there stays, until there is a run to record."""
    new = not path.exists()
    try:
        path.open("ab").close()
        if new:
            path.unlink()
    except OSError as error:
        raise ValueError(f"cannot record to {path}: {error.strerror}") from error


def _plain(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested mappings as one level, ``robot_radius`` for ``robot.radius``: Rerun takes the two
    for the same name and refuses a file that has both. Values that are not plain become text.
    """
    flat: dict[str, Any] = {}
    for key, value in values.items():
        if isinstance(value, Mapping):
            flat |= _plain(value, f"{prefix}{key}_")
        elif isinstance(value, bool | int | float | str):
            flat[f"{prefix}{key}"] = value
        elif value is not None:
            flat[f"{prefix}{key}"] = str(value)
    return flat
