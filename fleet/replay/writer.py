"""The process that draws a recording: it reads what happens from its input, and keeps the file.

Run by :class:`fleet.replay.writer_process.WriterProcess` as ``python -m fleet.replay.writer``.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator, Sequence
from importlib.abc import MetaPathFinder
from queue import Queue
from threading import Thread
from typing import IO, Any

import numpy as np

from fleet.motion import SAMPLE_FIELDS
from fleet.replay.columns import Moment
from fleet.replay.journal import Note, RecordedLine, TripEnd, receive
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer, OpenConversation, UnderWay
from protocols.messages import Award, Bid, Move, Point, RobotId

BACKLOG = 64  # frames that wait to be drawn before the run must wait too
CHUNK_ROUNDS = 50  # that are written together: a chunk costs 2 kB, however little is in it
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
        self._poses = 0  # told since layers were sent
        self._sent_round = 0
        self._state = state
        self._layers = layers
        self._sink = sink
        self._number = 0  # transmissions told so far
        self._floor = 0  # of the msg timeline: it never runs backwards
        for layer in layers:
            layer.run_started(state)

    def tell(self, notes: Sequence[Note]) -> None:
        """Replay some rounds; now and then, pass on what the layers made of them."""
        for name, *what in notes:
            getattr(self, f"_{name}")(*what)
        waiting = self._state.round - self._sent_round
        if waiting >= self._chunk_rounds or self._poses >= CHUNK_POSES:
            self._send()

    def finish(self, summary: dict[str, Any] | None) -> None:
        """The end."""
        at = self._moment(self._number + 1)
        for layer in self._layers:
            layer.run_ended(at, summary)
        self._send()

    def _transmitted(self, time: float, event: int, first: int, *columns: Sequence[Any]) -> None:
        state = self._state
        state.now = time
        conversation = state.conversations.get(event)
        for number, (kind, sender, receiver, bid, heard, attempts) in enumerate(
            zip(*columns, strict=True), first
        ):
            self._number = number
            cost, bidder = bid or (None, None)
            line = RecordedLine(
                number, time, event, kind, sender, receiver, cost, bidder, heard, attempts
            )
            if conversation is not None:
                conversation.lines.append(line)
            at = self._moment(number)
            for layer in self._layers:
                layer.transmitted(at, line)

    def _air_changed(self, time: float, on_air: list[RobotId]) -> None:
        state = self._state
        state.now = time
        state.on_air = np.zeros(state.n, bool)
        state.on_air[on_air] = True

    def _event_raised(self, time: float, event: int, site: Point, source: RobotId) -> None:
        state = self._state
        state.now = time
        state.round = max(state.round, event + 1)
        state.sites[event] = site
        state.conversations[event] = OpenConversation(event, site, source)
        at = self._moment(self._number + 1)
        for layer in self._layers:
            layer.event_raised(at, event, source)

    def _awarded(
        self, time: float, event: int, winner: RobotId | None, auctioneer: RobotId,
        bids: list[tuple[Any, ...]], moves: list[tuple[Any, ...]],
    ) -> None:  # fmt: skip
        self._state.now = time
        at = self._moment(self._number)
        offers = map(Bid._make, zip(*bids, strict=True))
        ways = map(Move._make, zip(*moves, strict=True))
        award = Award(winner, auctioneer, tuple(offers), tuple(ways))
        for layer in self._layers:
            layer.awarded(at, event, award)

    def _broken_off(self, time: float, event: int, reason: str) -> None:
        self._state.now = time
        at = self._moment(self._number)
        for layer in self._layers:
            layer.broken_off(at, event, reason)

    def _event_closed(self, time: float, event: int, outcome: str) -> None:
        self._state.now = time
        self._state.sites.pop(event, None)
        at = self._moment(self._number + 1)
        for layer in self._layers:
            layer.event_closed(at, event, outcome)
        self._state.conversations.pop(event, None)

    def _departed(self, time: float, event: int, robot: RobotId, site: Point, errand: bool) -> None:
        state = self._state
        state.now = time
        state.under_way[robot] = UnderWay(event, state.at(robot), site, time, errand)
        at = self._moment(self._number)
        for layer in self._layers:
            layer.departed(at, robot)

    def _planned(self, time: float, robot: RobotId, way: bytes) -> None:
        self._state.now = time
        at = self._moment(self._number)
        for layer in self._layers:
            layer.planned(at, robot, np.frombuffer(way).reshape(-1, 2))

    def _moved(self, rows: bytes) -> None:
        samples = np.frombuffer(rows).reshape(-1, len(SAMPLE_FIELDS))
        self._poses += len(samples)
        self._state.now = float(samples[-1, 1])
        robots = samples[:, 0].astype(int)
        self._state.positions[robots] = samples[:, 2:4]
        self._state.energies[robots] = samples[:, 5]
        at = self._moment(self._number + 1)
        for layer in self._layers:
            layer.moved(at, samples)

    def _trip_ended(self, event: int, trip: tuple[Any, ...], charges: list[float]) -> None:
        state, end = self._state, TripEnd(*trip)
        state.now = end.ended
        state.positions[end.robot] = end.end
        state.energies[slice(None) if len(charges) == state.n else [end.robot]] = charges
        state.on_air &= state.energies > 0.0
        del state.under_way[end.robot]
        at = self._moment(self._number + 1)
        for layer in self._layers:
            layer.trip_ended(at, event, end)

    def _moment(self, msg: int) -> Moment:
        self._floor = max(self._floor, msg)
        return Moment(self._state.now, self._state.round, self._floor)

    def _send(self) -> None:
        self._poses, self._sent_round = 0, self._state.round
        for layer in self._layers:
            layer.send(self._sink)


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
                stage = Stage(scene.width, scene.height, state.mark, state.capacity)
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
