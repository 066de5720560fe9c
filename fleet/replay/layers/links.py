"""The radio links, following the bodies, and how well they hold the fleet together."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import NamedTuple, cast

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from fleet.replay.columns import Index, Moment, column, doubles, segments
from fleet.replay.journal import TripEnd
from fleet.replay.layers.frames import Poses, frames
from fleet.replay.layers.network import (
    Codes,
    MoverReach,
    Spell,
    any_spell,
    component_counts,
    disc_spell,
    gabriel_spell,
    in_all,
    whole,
    without,
)
from fleet.replay.scheme import COMPONENTS, LINK_COUNT, ROUTING, UDG
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import RobotId
from protocols.topology import GraphName

INTERVAL = 0.25  # [s] between two updates of the links of a mover

FloatArray = NDArray[np.float64]
NOBODY = np.empty((1, 0, 2))


class MoverPath(NamedTuple):
    """Where everybody was from one departure or arrival to the next."""

    base: FloatArray  # (n, 2) of those at rest [m]; NaN: off the air
    robots: list[RobotId]  # (j,) those under way
    when: Index  # (k,)
    places: FloatArray  # (k, j, 2) of those under way [m]


class Links(Layer):
    """Both graphs, spell by spell: a spell lasts until somebody sets off or arrives."""

    def __init__(self) -> None:
        self._courses: list[MoverPath] = []
        self._disc_spells: list[Spell] = []
        self._routing_spells: list[Spell] = []
        self._samples: list[FloatArray] = []  # of this spell
        self._poses: Poses = {}
        self._counts: list[tuple[Moment, Codes, int, NDArray[np.bool_]]] = []

    def run_started(self, state: FleetState) -> None:
        """Everybody at rest."""
        self._state = state
        self._range = state.scene.radio_range
        self._graph = cast(GraphName, state.scene.graph)
        self._anew(Moment(0.0, 0, 0))

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """A moment to see who has fallen silent, or is heard again."""
        if (self._on_air != self._state.on_air).any():
            if self._poses:
                self._spell_over(at)
            self._anew(at)

    def departed(self, at: Moment, robot: RobotId) -> None:
        """A new spell."""
        if self._poses:
            self._spell_over(at)
        self._poses[robot] = self._pose(at, robot)
        self._begin(at)

    def moved(self, at: Moment, samples: FloatArray) -> None:
        """Keep the poses until the spell is over."""
        self._latest = at
        self._samples.append(samples[samples[:, 1] > self._start.time])

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """The spell is over, and what holds now is counted."""
        self._spell_over(at)
        del self._poses[trip.robot]
        if (self._on_air != self._state.on_air).any():
            self._anew(at)
        else:
            self._begin(at)
            self._count(at)

    def send(self, sink: Sink) -> None:
        """Links, their number, and the components they form."""
        if self._samples:
            self._spell_over(self._latest)
            self._begin(self._latest)
        if self._courses:
            _send_links(sink, UDG, self._courses, self._disc_spells)
            _send_links(sink, ROUTING, self._courses, self._routing_spells)
        if self._counts:
            when, routing, udg, on_air = zip(*self._counts, strict=True)
            numbers = np.array([udg, [len(codes) for codes in routing]], float).T
            pieces = component_counts(routing, on_air, self._state.n)
            sink.rows(
                LINK_COUNT,
                when,
                column(rr.Scalars.descriptor_scalars(), doubles(numbers.ravel()), [2] * len(when)),
            )
            sink.rows(COMPONENTS, when, column(rr.Scalars.descriptor_scalars(), doubles(pieces)))
        self._courses, self._disc_spells, self._routing_spells, self._counts = [], [], [], []

    def _anew(self, at: Moment) -> None:
        """Work out all links: at the start, and when somebody has fallen silent."""
        self._on_air = self._state.on_air.copy()
        self._begin(at)
        self._courses.append(MoverPath(self._base, [], Index.of([at]), NOBODY))
        self._udg = whole(self._base, self._range, "udg")
        self._routing = whole(self._base, self._range, self._graph)
        self._disc_spells.append(Spell(self._udg, [self._udg[:0]]))
        self._routing_spells.append(Spell(self._routing, [self._routing[:0]]))
        self._count(at)

    def _begin(self, at: Moment) -> None:
        self._start = at
        self._samples = []
        self._base = np.where(self._on_air[:, None], self._state.positions, np.nan)

    def _spell_over(self, at: Moment) -> None:
        """Work out the links since the spell began, until now."""
        course = self._course(at)
        base, robots, _, places = course
        if len(robots) == 1 and self._graph in ("gabriel", "udg"):
            (robot,) = robots
            reach = MoverReach.of(base, robot, places[:, 0], self._range)
            disc = routing = disc_spell(self._udg, robot, reach)
            if self._graph == "gabriel":
                routing = gabriel_spell(self._routing, disc.fixed, base, robot, reach)
        else:
            disc = any_spell(base, robots, places, self._range, "udg")
            routing = any_spell(base, robots, places, self._range, self._graph)
        self._courses.append(course)
        self._disc_spells.append(disc)
        self._routing_spells.append(routing)
        self._udg = np.sort(np.concatenate([disc.fixed, disc.varying[-1]]))
        self._routing = np.sort(np.concatenate([routing.fixed, routing.varying[-1]]))

    def _course(self, at: Moment) -> MoverPath:
        """The spell's moments, from its start to now, :data:`INTERVAL` apart."""
        robots = sorted(self._poses)
        last = [self._pose(at, robot) for robot in robots]
        rows = np.array([[self._poses[robot] for robot in robots], last])
        samples = np.concatenate([np.empty((0, 6)), *self._samples])
        if len(samples):
            when, _, poses = frames(samples, self._poses, at)
            step = np.floor((when.times - self._start.time) / INTERVAL)
            kept = np.flatnonzero(np.diff(step, append=step[-1:]) > 0)
            rows = np.concatenate([rows[:1], poses.reshape(-1, *rows.shape[1:])[kept], rows[1:]])
        self._poses.update(zip(robots, last, strict=True))
        times = rows[:, 0, 1].copy()
        times[0] = self._start.time
        rounds, msgs = np.full(len(rows), at.round), np.full(len(rows), at.msg)
        rounds[0], msgs[0] = self._start.round, self._start.msg
        places = np.where(self._on_air[robots, None], rows[:, :, 2:4], np.nan)
        return MoverPath(self._base, robots, Index(times, rounds, msgs), places)

    def _pose(self, at: Moment, robot: RobotId) -> tuple[float, ...]:
        return (robot, at.time, *self._state.at(robot), 0.0, 0.0)

    def _count(self, at: Moment) -> None:
        self._counts.append((at, self._routing, len(self._udg), self._on_air))


def _send_links(
    sink: Sink, path: str, courses: Sequence[MoverPath], spells: Sequence[Spell]
) -> None:
    """Links in three parts, each rewritten as seldom as it can be.

    Few robots move in a handful of spells, so most links outlast it. They are written once for
    all of it; every spell writes the others that stay, every moment those that vary. With n
    robots about √(n/2) spells together take the least space.
    """
    n = len(courses[0].base)
    size = max(1, round(sqrt(n / 2)))
    bases = np.array([course.base for course in courses], np.float32)  # (s, n, 2)
    starts = np.cumsum([0, *(len(course.places) for course in courses[:-1])])
    when = Index.joined([course.when for course in courses])
    firsts = np.arange(0, len(spells), size)
    lasting = [in_all([spell.fixed for spell in spells[f : f + size]]) for f in firsts.tolist()]
    resting = [without(spell.fixed, lasting[s // size]) for s, spell in enumerate(spells)]
    every = np.arange(len(spells))
    for part, of, codes in (("lasting", firsts, lasting), ("resting", every, resting)):
        counts = [len(some) for some in codes]
        ends = bases[np.repeat(of, counts)[:, None], _ends(codes, n)]
        _send_strips(sink, f"{path}/{part}", when.take(starts[of]), ends, counts)

    varying = [codes for spell in spells for codes in spell.varying]
    counts = [len(codes) for codes in varying]
    pairs = _ends(varying, n)
    moment = np.repeat(np.arange(len(varying)), counts)
    spell = np.searchsorted(starts, moment, side="right") - 1
    ends = bases[spell[:, None], pairs]
    for j in range(max(len(course.robots) for course in courses)):
        mover = np.array([c.robots[j] if j < len(c.robots) else -1 for c in courses])
        places = np.concatenate(
            [c.places[:, j] if j < len(c.robots) else np.zeros((len(c.places), 2)) for c in courses]
        )
        link, end = np.nonzero(pairs == mover[spell][:, None])
        ends[link, end] = places[moment[link]]
    _send_strips(sink, f"{path}/moving", when, ends, counts)


def _ends(codes: Sequence[Codes], n: int) -> NDArray[np.intp]:
    """All links as pairs (m, 2)."""
    return np.stack(np.divmod(np.concatenate(codes), n), axis=1)


def _send_strips(
    sink: Sink, path: str, when: Index, ends: NDArray[np.float32], counts: Sequence[int]
) -> None:
    sink.rows(path, when, column(rr.LineStrips2D.descriptor_strips(), segments(ends), counts))
