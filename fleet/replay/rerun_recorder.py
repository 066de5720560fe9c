"""An observer that records the run. It only takes notes; another process turns them into a file."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from fleet.motion import Trip
from fleet.observer import Excerpt, Observer
from fleet.replay.journal import RELOCATED, Note, Scene, TripEnd
from fleet.replay.known_links import Changes, KnownLinks
from fleet.replay.writer_process import WriterProcess
from protocols.messages import Award, Event, Move, RobotId
from protocols.topology import NOWHERE

if TYPE_CHECKING:
    from fleet.faults import Blackout, Breakdown
    from fleet.fleet import Fleet
    from fleet.power import Battery
    from fleet.results import Summary
    from fleet.robot import Appraisal
    from fleet.tasks import Task

MANY_POSES = 50_000  # that are held back at most
MANY_LINES = 50_000  # of the transcript that are held back at most
FLAT = len(TripEnd._fields)  # of a trip's fields go into the recording: the first
INTERVAL = 0.25  # [s] between two looks at the links while robots drive
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

    link_interval = INTERVAL

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

    @override
    def run_started(self, fleet: Fleet) -> None:
        """Tell the writer what the world looks like."""
        self._all_drain = bool(fleet.spec.extra.idle or fleet.spec.extra.transmission)
        self._batteries = [robot.battery for robot in fleet.robots]
        hole, labels, spec = fleet.arena.hole, fleet.labels, fleet.spec
        self._fleet = fleet
        self._neighbours, self._hearers = (
            KnownLinks(len(fleet.robots)),
            KnownLinks(len(fleet.robots)),
        )
        self._placed = dict.fromkeys(range(len(fleet.robots)), NOWHERE)
        self._heard_of = {robot.id for robot in fleet.robots if robot.on_air}
        self._linked = self._refreshed = -INTERVAL
        field = fleet.field
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
            disc=fleet.radio.disc,
            search_radius=labels.search_radius,
            sensors=[] if field is None else field.positions.tolist(),
            sensing=0.0 if field is None else field.spec.reach,
            graph=fleet.topology.graph,
            protocol=labels.protocol,
            motion=labels.motion,
            world=labels.world,
            seed=labels.seed,
            metric=labels.metric,
            unit=labels.unit,
            belief=labels.belief,
            routed=labels.routed,
        )
        self.writer.tell("scene", scene)
        self._note_links(0.0, always=True)

    @override
    def broke_down(self, fault: Breakdown) -> None:
        """Note it."""
        self._note(("broke_down", fault.time, fault.robot, fault.what))

    @override
    def exhausted(self, robot: RobotId, time: float) -> None:
        """Note it."""
        self._note(("exhausted", time, robot))

    @override
    def blacked_out(self, blackout: Blackout) -> None:
        """Note it."""
        region = blackout.x, blackout.y, blackout.radius
        self._note(("blacked_out", blackout.start, *region))

    @override
    def lifted(self, blackout: Blackout) -> None:
        """Note it."""
        region = blackout.x, blackout.y, blackout.radius
        self._note(("lifted", blackout.end, *region))

    @override
    def air_changed(self, on_air: Sequence[RobotId], time: float) -> None:
        """Note it, and whose links that has changed."""
        self._note(("air_changed", time, list(on_air)))
        toggled = self._heard_of ^ {*on_air}
        self._heard_of = {*on_air}
        self._note_links(time, toggled, always=True)

    @override
    def event_occurred(self, task: Task) -> None:
        """Note it."""
        event, place = task.event, task.event.position
        self._note(
            ("event_occurred", task.raised, event.id, place, task.site, task.deadline, task.service)
        )

    @override
    def event_raised(self, event: Event, source: RobotId, time: float) -> None:
        """Note it; a new event is also the moment to send what the last rounds left."""
        if event.id != self._latest:
            self._latest = event.id
            if self._rounds == self._flush_rounds or self._due():
                self.flush()
            self._rounds += 1
        self._note_links(time, always=False)
        self._note(("event_raised", time, event.id, source))

    @override
    def transmitted(self, excerpt: Excerpt) -> None:
        """Note it."""
        first, time, event, transmissions, heard, attempts = excerpt
        self._note_links(time, always=False)
        kinds, senders, receivers, bids = zip(*transmissions, strict=True)
        offers = [None if bid is None else tuple(bid) for bid in bids]
        self._note(
            ("transmitted", time, event, first, kinds, senders, receivers, offers, heard, attempts)
        )
        self._lines += len(kinds)
        if self._lines > MANY_LINES:
            self.flush()

    @override
    def appraised(self, event: Event, appraisals: Sequence[Appraisal], time: float) -> None:
        """Note it."""
        self._note(("appraised", time, event.id, [tuple(appraisal) for appraisal in appraisals]))

    @override
    def awarded(self, event: Event, award: Award, time: float) -> None:
        """Note it."""
        bids, moves = [*zip(*award.bids, strict=True)], [*zip(*award.moves, strict=True)]
        self._note(("awarded", time, event.id, award.winner, award.auctioneer, bids, moves))

    @override
    def broken_off(self, event: Event, reason: str, time: float) -> None:
        """Note it."""
        self._note(("broken_off", time, event.id, reason))

    @override
    def event_closed(self, event: Event, outcome: str, time: float) -> None:
        """Note it."""
        self._note(("event_closed", time, event.id, outcome))

    @override
    def departed(self, event: Event, robot: RobotId, time: float) -> None:
        """Note it."""
        self._note(("departed", time, event.id, robot, event.position, False))

    @override
    def planned(self, robot: RobotId, way: NDArray[np.float64], time: float) -> None:
        """Note it."""
        self._note(("planned", time, robot, way.tobytes()))

    @override
    def relocating(self, event: Event, move: Move, time: float) -> None:
        """Note it."""
        self._note(("departed", time, event.id, move.robot, move.position, True))

    @override
    def relocated(self, event: Event, trip: Trip) -> None:
        """Note the trip, and what batteries hold now."""
        noted = trip._replace(outcome=RELOCATED)  # type: ignore[arg-type]  # the journal's own
        self._note_trip(event, noted)

    @override
    def trip_ended(self, event: Event, trip: Trip) -> None:
        """Note the trip, and what batteries hold now."""
        self._note_trip(event, trip)

    @override
    def moved(self, samples: NDArray[np.float64]) -> None:
        """Note the poses."""
        if len(samples):
            self._note(("moved", samples.tobytes()))
            self._poses += len(samples)
            if self._poses > MANY_POSES:
                self.flush()

    @override
    def relinked(self, time: float) -> None:
        """Note the links, if they were noted long enough ago."""
        self._refreshed = time
        if time == self._linked or time - self._linked >= INTERVAL:
            self._note_links(time, always=False)

    @override
    def run_ended(self, summary: Summary) -> None:
        """Keep the summary with the recording, but for what differs from run to run."""
        self.flush()
        figures = summary.as_dict()
        del figures["wall_time"]
        self.writer.tell("summary", _plain(figures))

    @override
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

    def _note_trip(self, event: Event, trip: Trip) -> None:
        """A trip has ended; the links are as they are with that robot at rest."""
        self._note(("trip_ended", trip.ended, event.id, trip[:FLAT], self._charges(trip.robot)))
        self._note_links(trip.ended, always=True)

    def _note_links(self, time: float, toggled: Iterable[RobotId] = (), *, always: bool) -> None:
        """Which links are new, and which are gone, since the last time: those of the run's live
        graph, and, unless that goes without saying, who hears whom.

        ``toggled`` are on the air now and were not, or the other way round; ``always``: note it
        even if no link is another.
        """
        topology, radio = self._fleet.topology, self._fleet.radio
        changed = topology.changed() | {*toggled}
        changed.update(other for robot in toggled for other in topology.neighbours[robot])
        self._linked = time
        if not changed and not always:
            return
        moved = {r for r in changed if topology.positions[r] != self._placed[r]} | {*toggled}
        places = [(robot, *topology.positions[robot]) for robot in moved]
        self._placed |= {robot: topology.positions[robot] for robot in moved}
        linked = self._neighbours.update(
            (robot, self._on_air(robot, topology.neighbours[robot])) for robot in changed
        )
        heard: Changes = [], []
        if not radio.disc:
            heard = self._hearers.update(
                (robot, self._on_air(robot, radio.hearers(robot))) for robot in moved
            )
        self._note(("relinked", time, places, *linked, *heard, self._refreshed == time))

    def _on_air(self, robot: RobotId, others: Iterable[RobotId]) -> set[RobotId]:
        """Those of a robot's links that are on the air."""
        robots = self._fleet.robots
        return {o for o in others if robots[o].on_air} if robots[robot].on_air else set()

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
