"""The process that draws a recording: it reads what happens from its input, and keeps the file.

Run by :class:`fleet.replay.scribe.Scribe` as ``python -m fleet.replay.writer``.
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
from fleet.replay.journal import Entry, Told, TripEnd, receive
from fleet.replay.story import Conversation, Page, Story, UnderWay
from fleet.replay.stream import Stream
from protocols.messages import Award, Bid, Move, Point, RobotId

BACKLOG = 64  # frames that wait to be drawn before the run must wait too
CHUNK_ROUNDS = 50  # that are written together: a chunk costs 2 kB, however little is in it
CHUNK_POSES = 100_000  # or so many poses


class Teller:
    """Takes the notes of a run and tells them, in order, to every page."""

    def __init__(
        self, story: Story, pages: Sequence[Page], stream: Stream, chunk_rounds: int = CHUNK_ROUNDS
    ) -> None:
        self._chunk_rounds = chunk_rounds
        self._poses = 0  # told since pages were sent
        self._sent_round = 0
        self._story = story
        self._pages = pages
        self._stream = stream
        self._number = 0  # transmissions told so far
        self._floor = 0  # of the msg timeline: it never runs backwards
        for page in pages:
            page.started(story)

    def tell(self, entries: Sequence[Entry]) -> None:
        """Replay some rounds; now and then, pass on what the pages made of them."""
        for name, *what in entries:
            getattr(self, f"_{name}")(*what)
        waiting = self._story.round - self._sent_round
        if waiting >= self._chunk_rounds or self._poses >= CHUNK_POSES:
            self._send()

    def finish(self, summary: dict[str, Any] | None) -> None:
        """The end."""
        at = self._moment(self._number + 1)
        for page in self._pages:
            page.finished(at, summary)
        self._send()

    def _said(self, time: float, event: int, first: int, *columns: Sequence[Any]) -> None:
        story = self._story
        story.now = time
        talk = story.talks.get(event)
        for number, (kind, sender, receiver, bid, heard, attempts) in enumerate(
            zip(*columns, strict=True), first
        ):
            self._number = number
            cost, bidder = bid or (None, None)
            line = Told(number, time, event, kind, sender, receiver, cost, bidder, heard, attempts)
            if talk is not None:
                talk.lines.append(line)
            at = self._moment(number)
            for page in self._pages:
                page.told(at, line)

    def _air(self, time: float, on_air: list[RobotId]) -> None:
        story = self._story
        story.now = time
        story.on_air = np.zeros(story.n, bool)
        story.on_air[on_air] = True

    def _raised(self, time: float, event: int, site: Point, source: RobotId) -> None:
        story = self._story
        story.now = time
        story.round = max(story.round, event + 1)
        story.sites[event] = site
        story.talks[event] = Conversation(event, site, source)
        at = self._moment(self._number + 1)
        for page in self._pages:
            page.raised(at, event, source)

    def _awarded(
        self, time: float, event: int, winner: RobotId | None, auctioneer: RobotId,
        bids: list[tuple[Any, ...]], moves: list[tuple[Any, ...]],
    ) -> None:  # fmt: skip
        self._story.now = time
        at = self._moment(self._number)
        offers = map(Bid._make, zip(*bids, strict=True))
        ways = map(Move._make, zip(*moves, strict=True))
        award = Award(winner, auctioneer, tuple(offers), tuple(ways))
        for page in self._pages:
            page.awarded(at, event, award)

    def _broken(self, time: float, event: int, reason: str) -> None:
        self._story.now = time
        at = self._moment(self._number)
        for page in self._pages:
            page.broken(at, event, reason)

    def _over(self, time: float, event: int, outcome: str) -> None:
        self._story.now = time
        self._story.sites.pop(event, None)
        at = self._moment(self._number + 1)
        for page in self._pages:
            page.over(at, event, outcome)
        self._story.talks.pop(event, None)

    def _departed(self, time: float, event: int, robot: RobotId, site: Point, errand: bool) -> None:
        story = self._story
        story.now = time
        story.under_way[robot] = UnderWay(event, story.at(robot), site, time, errand)
        at = self._moment(self._number)
        for page in self._pages:
            page.departed(at, robot)

    def _planned(self, time: float, robot: RobotId, way: bytes) -> None:
        self._story.now = time
        at = self._moment(self._number)
        for page in self._pages:
            page.planned(at, robot, np.frombuffer(way).reshape(-1, 2))

    def _moved(self, rows: bytes) -> None:
        samples = np.frombuffer(rows).reshape(-1, len(SAMPLE_FIELDS))
        self._poses += len(samples)
        self._story.now = float(samples[-1, 1])
        robots = samples[:, 0].astype(int)
        self._story.positions[robots] = samples[:, 2:4]
        self._story.energies[robots] = samples[:, 5]
        at = self._moment(self._number + 1)
        for page in self._pages:
            page.moved(at, samples)

    def _ended(self, event: int, trip: tuple[Any, ...], charges: list[float]) -> None:
        story, end = self._story, TripEnd(*trip)
        story.now = end.ended
        story.positions[end.robot] = end.end
        story.energies[slice(None) if len(charges) == story.n else [end.robot]] = charges
        story.on_air &= story.energies > 0.0
        del story.under_way[end.robot]
        at = self._moment(self._number + 1)
        for page in self._pages:
            page.ended(at, event, end)

    def _moment(self, msg: int) -> Moment:
        self._floor = max(self._floor, msg)
        return Moment(self._story.now, self._story.round, self._floor)

    def _send(self) -> None:
        self._poses, self._sent_round = 0, self._story.round
        for page in self._pages:
            page.send(self._stream)


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
    from fleet.replay.pages import pages
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
    stream = Stream(path, live, key)
    teller: Teller | None = None
    summary: dict[str, Any] | None = None
    try:
        for tag, *content in frames:
            if tag == "scene":
                (scene,) = content
                story = Story(scene)
                stage = Stage(scene.width, scene.height, story.mark, story.capacity)
                stream.open(blueprint(stage))
                describe(stream, scene, key, properties)
                draw_scene(stream, story)
                teller = Teller(story, pages(), stream, 1 if live else CHUNK_ROUNDS)
            elif tag == "batch":
                assert teller is not None
                (entries,) = content
                teller.tell(entries)
            elif tag == "summary":
                (summary,) = content
                stream.properties("summary", summary)
        if teller is not None:
            teller.finish(summary)
    finally:
        stream.close()


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
