"""The process that draws a recording: it reads what happens from its input, and keeps the file.

Run by :class:`fleet.replay.writer_process.WriterProcess` as ``python -m fleet.replay.writer``.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator, Sequence
from importlib.abc import MetaPathFinder
from math import inf
from queue import Queue
from threading import Thread
from typing import IO, Any

import numpy as np

from fleet.motion import SAMPLE_FIELDS
from fleet.replay.columns import Moment
from fleet.replay.journal import Note, RecordedLine, TripEnd, receive
from fleet.replay.scheme import BEAT, PAUSE
from fleet.replay.sink import Sink
from fleet.replay.state import (
    HOOKS,
    Belief,
    FleetState,
    Layer,
    OpenConversation,
    OpenTask,
    Region,
    UnderWay,
)
from protocols.messages import Award, Bid, Move, Point, RobotId

BACKLOG = 64  # frames that wait to be drawn before the run must wait too
CHUNK_ROUNDS = 200  # that are written together: a chunk costs 2 kB, however little is in it
CHUNK_POSES = 100_000  # or so many poses


class LayerDispatcher:
    """Takes the notes of a run and tells them, in order, to every layer."""

    def __init__(
        self,
        state: FleetState,
        layers: Sequence[Layer],
        sink: Sink,
        chunk_rounds: int = CHUNK_ROUNDS,
    ) -> None:
        self._chunk_rounds = chunk_rounds
        self._poses = 0  # told since rows were sent
        self._sent_round = 0
        self._state = state
        self._layers = layers
        self._sink = sink
        self._number = 0  # transmissions told so far
        self._floor = 0  # of the msg timeline: it never runs backwards
        self._over: float | None = None  # [s] since when the event in focus is, still to be seen
        idle = vars(Layer)
        self._hooks = {
            hook: [
                getattr(layer, hook) for layer in layers if getattr(type(layer), hook) != idle[hook]
            ]
            for hook in HOOKS
        }
        for tell in self._hooks["run_started"]:
            tell(state)

    def tell(self, notes: Sequence[Note]) -> None:
        """Replay some rounds; now and then, pass on what the layers made of them."""
        for name, *what in notes:
            if self._over is not None and (name == "event_raised" or _time_of(what) > self._over):
                self._clear(1 if name == "event_raised" and what[0] == self._over else 0)
            getattr(self, f"_{name}")(*what)
        waiting = self._state.round - self._sent_round
        if waiting >= self._chunk_rounds or self._poses >= CHUNK_POSES:
            self._send()

    def finish(self, summary: dict[str, Any] | None) -> None:
        """The end."""
        if summary is not None:
            self._state.now = max(self._state.now, summary["simulated_time"])
        if self._over is not None and self._state.now > self._over:
            self._clear(0)
        self._tell("run_ended", self._moment(self._number + 1), summary)
        self._send()

    def _tell(self, hook: str, *what: Any) -> None:
        for tell in self._hooks[hook]:
            tell(*what)

    def _now(self, hook: str, time: float, *what: Any) -> None:
        """Something happens between transmissions."""
        self._state.now = time
        self._tell(hook, self._moment(self._number + 1), *what)

    def _transmitted(self, time: float, event: int, first: int, *columns: Sequence[Any]) -> None:
        state = self._state
        state.now = time
        conversation = state.conversations.get(event)
        told = self._hooks["transmitted"]
        for number, (kind, sender, receiver, bid, heard, attempts) in enumerate(
            zip(*columns, strict=True), first
        ):
            self._number = number
            cost, bidder = bid or (None, None)
            line = RecordedLine(
                number, time, event, kind, sender, receiver, cost, bidder, heard, attempts
            )
            state.speak()
            at = self._moment(number)
            if conversation is not None:
                if event != state.focus and not self._held:
                    self._focus(at, event)
                conversation.lines.append(line)
            for tell in told:
                tell(at, line)

    @property
    def _held(self) -> bool:
        """Whether the event in focus is being talked over."""
        conversation = self._state.in_focus
        return conversation is not None and conversation.talking

    def _focus(self, at: Moment, event: int) -> None:
        self._state.focus = event
        self._tell("focused", at)

    def _relinked(
        self, time: float, places: Sequence[tuple[RobotId, float, float]], new: list[int],
        gone: list[int], heard: list[int], unheard: list[int], fresh: bool,
    ) -> None:  # fmt: skip
        now = {robot: (x, y) for robot, x, y in places}
        self._now("relinked", time, now, (new, gone), (heard, unheard))
        if fresh:
            self._now("linked_at", time, now)

    def _broke_down(self, time: float, robot: RobotId, what: str) -> None:
        self._state.failed[robot] = "motor" if what == "motor" else "broken"
        self._now("broke_down", time, robot, what)

    def _exhausted(self, time: float, robot: RobotId) -> None:
        self._state.failed.setdefault(robot, "exhausted")
        self._now("exhausted", time, robot)

    def _blacked_out(self, time: float, *region: float) -> None:
        self._state.silent.append(Region(*region))
        self._now("blacked_out", time, Region(*region))

    def _lifted(self, time: float, *region: float) -> None:
        self._state.silent.remove(Region(*region))
        self._now("lifted", time, Region(*region))

    def _air_changed(self, time: float, on_air: list[RobotId]) -> None:
        state = self._state
        state.on_air = np.zeros(state.n, bool)
        state.on_air[on_air] = True
        self._now("air_changed", time)

    def _event_occurred(
        self, time: float, event: int, position: Point, site: Point, *times: float
    ) -> None:
        self._state.tasks[event] = OpenTask(position, site, time, *times)
        self._now("event_occurred", time, event)

    def _event_raised(self, time: float, event: int, source: RobotId) -> None:
        state = self._state
        state.now = time
        state.round = max(state.round, event + 1)
        held = self._held and state.focus != event
        state.conversations[event] = OpenConversation(event, state.tasks[event].position, source)
        at = self._moment(self._number + 1)
        self._tell("event_raised", at, event, source)
        if not held:
            self._focus(at, event)
            state.pause(PAUSE)

    def _appraised(self, time: float, event: int, appraisals: list[tuple[Any, ...]]) -> None:
        conversation = self._state.conversations[event]
        conversation.beliefs |= {belief[0]: Belief(*belief) for belief in appraisals}

    def _awarded(
        self, time: float, event: int, winner: RobotId | None, auctioneer: RobotId,
        bids: list[tuple[Any, ...]], moves: list[tuple[Any, ...]],
    ) -> None:  # fmt: skip
        offers = map(Bid._make, zip(*bids, strict=True))
        ways = map(Move._make, zip(*moves, strict=True))
        award = Award(winner, auctioneer, tuple(offers), tuple(ways))
        self._conclude("awarded", time, event, award)

    def _broken_off(self, time: float, event: int, reason: str) -> None:
        self._conclude("broken_off", time, event, reason)

    def _conclude(self, hook: str, time: float, event: int, what: Award | str) -> None:
        """A conversation is over: its last transmission has been seen, and its end is."""
        state = self._state
        conversation = state.conversations[event]
        conversation.talking = False
        if isinstance(what, Award):
            conversation.award = what
        state.now = time
        if event == state.focus:
            state.pause(BEAT)
        self._tell(hook, self._moment(self._number), event, what)
        if event == state.focus:
            state.pause(PAUSE)

    def _event_closed(self, time: float, event: int, outcome: str) -> None:
        """All that was drawn of the event in focus stays in sight until time goes on, or, where
        the next event follows at once, for the rest of its round.
        """
        state = self._state
        self._now("event_closed", time, event, outcome)
        state.tasks.pop(event, None)
        if event in state.conversations:
            state.conversations[event].talking = False
        if event == state.focus:
            self._over = time
        else:
            state.conversations.pop(event, None)

    def _clear(self, later: int) -> None:
        """The event in focus is over; on the timeline of rounds so many ``later``."""
        state, self._over = self._state, None
        del state.conversations[state.focus]
        at = self._moment(self._number + 1)
        self._focus(at._replace(round=at.round + later), -1)

    def _departed(self, time: float, event: int, robot: RobotId, site: Point, errand: bool) -> None:
        state = self._state
        state.now = time
        state.under_way[robot] = UnderWay(event, state.at(robot), site, time, errand)
        self._tell("departed", self._moment(self._number), robot)

    def _planned(self, time: float, robot: RobotId, way: bytes) -> None:
        self._state.now = time
        self._tell("planned", self._moment(self._number), robot, np.frombuffer(way).reshape(-1, 2))

    def _moved(self, rows: bytes) -> None:
        samples = np.frombuffer(rows).reshape(-1, len(SAMPLE_FIELDS))
        self._poses += len(samples)
        robots = samples[:, 0].astype(int)
        self._state.positions[robots] = samples[:, 2:4]
        self._state.energies[robots] = samples[:, 5]
        self._now("moved", float(samples[-1, 1]), samples)

    def _trip_ended(
        self, time: float, event: int, trip: tuple[Any, ...], charges: list[float]
    ) -> None:
        state, end = self._state, TripEnd(*trip)
        state.now = time
        state.positions[end.robot] = end.end
        state.energies[slice(None) if len(charges) == state.n else [end.robot]] = charges
        del state.under_way[end.robot]
        self._tell("trip_ended", self._moment(self._number + 1), event, end)
        if event == state.focus:
            state.pause(PAUSE)

    def _moment(self, msg: int) -> Moment:
        self._floor = max(self._floor, msg)
        return Moment(self._state.now, self._state.round, self._floor, self._state.story)

    def _send(self) -> None:
        self._poses, self._sent_round = 0, self._state.round
        for layer in self._layers:
            layer.send(self._sink)


def _time_of(what: Sequence[Any]) -> float:
    """When something happened [s]; poses are of all the time since."""
    return inf if isinstance(what[0], bytes) else what[0]


class NoPandas(MetaPathFinder):
    """Keeps out pandas, which pyarrow would load to see whether what it converts is pandas'.

    None of it is, and loading takes a quarter of a second.
    """

    def find_spec(self, name: str, path: object = None, target: object = None) -> None:
        """Raise ImportError: pyarrow then does without."""
        if name == "pandas":
            raise ModuleNotFoundError("kept out", name=name)


def main() -> None:
    """Draw what the input tells until it ends, however it ends."""
    # A file object of the reader's own: the interpreter must not wait for it when it ends.
    frames = _read_ahead(open(0, "rb", closefd=False))  # noqa: SIM115 - as long as we live
    sys.meta_path.insert(0, NoPandas())
    from fleet.replay.blueprint import Stage, blueprint
    from fleet.replay.layers import layers
    from fleet.replay.scene import describe, draw_scene

    gc.freeze()  # what was imported is here to stay; looking through it takes time
    gc.set_threshold(20_000)
    opening = next(frames, None)
    if opening is None:
        return  # nothing came of the run
    tag, path, live, key, properties, strict = opening
    assert tag == "open"
    if strict:
        import rerun

        rerun.set_strict_mode(True)
    sink = Sink(path, live, key)
    dispatcher: LayerDispatcher | None = None
    summary: dict[str, Any] | None = None
    try:
        for tag, *content in frames:
            if tag == "scene":
                (scene,) = content
                state = FleetState(scene)
                stage = Stage(scene.width, scene.height, state.mark, state.capacity, scene.title)
                sink.open(blueprint(stage))
                describe(sink, scene, key, properties)
                draw_scene(sink, state)
                dispatcher = LayerDispatcher(state, layers(), sink, 1 if live else CHUNK_ROUNDS)
            elif tag == "batch":
                assert dispatcher is not None
                (notes,) = content
                dispatcher.tell(notes)
            elif tag == "summary":
                (summary,) = content
                sink.properties("summary", summary)
        if dispatcher is not None:
            dispatcher.finish(summary)
    finally:
        sink.close()


def _read_ahead(pipe: IO[bytes]) -> Iterator[tuple[Any, ...]]:
    """The frames of the pipe, read by a thread so that the run finds the pipe empty."""
    waiting: Queue[tuple[Any, ...] | None] = Queue(BACKLOG)

    def read() -> None:
        for frame in receive(pipe):
            waiting.put(frame)
        waiting.put(None)

    Thread(target=read, daemon=True).start()
    while (frame := waiting.get()) is not None:
        yield frame


if __name__ == "__main__":
    main()
