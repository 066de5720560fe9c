"""The links of the run, following the bodies, and how well they hold the fleet together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt
from typing import NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from fleet.replay.columns import Index, Moment, column, doubles, segments
from fleet.replay.journal import TripEnd
from fleet.replay.known_links import Changes
from fleet.replay.layers.network import (
    Codes,
    component_counts,
    in_all,
    in_reach,
    of_movers,
    touching,
    without,
)
from fleet.replay.scheme import COMPONENTS, LINK_COUNT, ROUTING, UDG
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import Point, RobotId

FloatArray = NDArray[np.float64]
NONE: Codes = np.empty(0, np.intp)


class MoverPaths(NamedTuple):
    """Where everybody was, as far as links go, from one departure or arrival to the next."""

    base: FloatArray  # (n, 2) of all at the start [m]; NaN: off the air
    robots: list[RobotId]  # (j,) those who moved
    when: Index  # (k,)
    places: FloatArray  # (k, j, 2) of those who moved [m]


class Spell(NamedTuple):
    """The links over some moments."""

    fixed: Codes  # among robots at rest, and there at every moment
    varying: list[Codes]  # the others of each moment


class Relinking(NamedTuple):
    """What the run told of its links."""

    at: Moment
    places: Mapping[RobotId, Point]
    linked: tuple[Codes, Codes]  # of the routing graph: new ones, and those that are gone
    heard: tuple[Codes, Codes]  # likewise, who hears whom


class Links(Layer):
    """Both graphs, spell by spell: a spell lasts until somebody sets off or arrives.

    Links of the routing graph are the run's, and so is who hears whom; but where all within range
    do, that follows from the places that the run linked robots at.
    """

    def __init__(self) -> None:
        self._paths: list[MoverPaths] = []
        self._hearing: list[Spell] = []
        self._routed: list[Spell] = []
        self._changes: list[Relinking] = []  # of this spell, the first at its start
        self._counts: list[tuple[Moment, Codes, int, NDArray[np.bool_]]] = []
        self._counted = True

    def run_started(self, state: FleetState) -> None:
        """Nobody is linked, until the run tells."""
        self._state = state
        self._disc, self._range = state.scene.disc, state.scene.radio_range
        self._base = state.positions.copy()
        self._routing = self._udg = NONE
        if self._disc:
            self._udg = in_reach(self._base, self._range)
        self._count_soon()

    def air_changed(self, at: Moment) -> None:
        """Who is off the air has no links."""
        self._spell_over()
        state = self._state
        places = state.positions.copy()
        known = ~np.isnan(self._base[:, 0])
        places[known] = self._base[known]
        self._base = np.where(state.on_air[:, None], places, np.nan)
        off = np.flatnonzero(~state.on_air).tolist()
        self._routing = self._routing[~touching(self._routing, state.n, off)]
        self._udg = self._udg[~touching(self._udg, state.n, off)]
        if self._disc:
            self._udg = in_reach(self._base, self._range)
        self._changes.append(_nothing(at))

    def departed(self, at: Moment, robot: RobotId) -> None:
        """A new spell."""
        self._spell_over()
        self._changes.append(_nothing(at))

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """A new spell; what holds now is counted."""
        self._spell_over()
        self._changes.append(_nothing(at))
        self._count_soon()

    def relinked(
        self, at: Moment, places: Mapping[RobotId, Point], linked: Changes, heard: Changes
    ) -> None:
        """Links as the run has them now."""
        on_air = self._state.on_air
        moved = {
            robot: place
            for robot, place in places.items()
            if on_air[robot] and place != tuple(self._base[robot].tolist())
        }
        self._changes.append(Relinking(at, moved, _sorted(linked), _sorted(heard)))
        if not self._counted:
            self._spell_over()
            self._changes.append(_nothing(at))
            self._counts.append((at, self._routing, len(self._udg), on_air.copy()))
            self._counted = True

    def send(self, sink: Sink) -> None:
        """Links, their number, and the components they form."""
        if len(self._changes) > 1:
            latest = self._changes[-1].at
            self._spell_over()
            self._changes.append(_nothing(latest))
        if self._paths:
            _send_links(sink, UDG, self._paths, self._hearing)
            _send_links(sink, ROUTING, self._paths, self._routed)
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
        self._paths, self._hearing, self._routed, self._counts = [], [], [], []

    def _count_soon(self) -> None:
        """Once the run has told what links there are."""
        self._counted = False

    def _spell_over(self) -> None:
        """Work out the links of each moment since the spell began."""
        changes, self._changes = self._changes, []
        if not changes:
            return
        n, base = self._state.n, self._base
        robots = sorted({robot for change in changes for robot in change.places})
        places = np.empty((len(changes), len(robots), 2))
        now, row = base[robots], {robot: j for j, robot in enumerate(robots)}
        for k, change in enumerate(changes):
            for robot, place in change.places.items():
                now[row[robot]] = place
            places[k] = now
        if self._disc:
            fixed = self._udg[~touching(self._udg, n, robots)]
            hearing = Spell(fixed, of_movers(base, robots, places, self._range))
        else:
            hearing = self._follow(self._udg, [change.heard for change in changes], robots)
        routed = self._follow(self._routing, [change.linked for change in changes], robots)
        self._base = base.copy()
        self._base[robots] = now
        self._udg = np.sort(np.concatenate([hearing.fixed, hearing.varying[-1]]))
        self._routing = np.sort(np.concatenate([routed.fixed, routed.varying[-1]]))
        self._paths.append(MoverPaths(base, robots, Index.of([c.at for c in changes]), places))
        self._hearing.append(hearing)
        self._routed.append(routed if self._disc else both(routed, hearing))

    def _follow(
        self, before: Codes, changes: Sequence[tuple[Codes, Codes]], robots: Sequence[RobotId]
    ) -> Spell:
        """Links that the run tells of: those that nothing is told of stay as they are."""
        touched = np.unique(np.concatenate([codes for change in changes for codes in change]))
        fixed = without(before, touched)
        if robots:
            fixed = fixed[~touching(fixed, self._state.n, robots)]
        now = set(without(before, fixed).tolist())
        varying = []
        for new, gone in changes:
            now.difference_update(gone.tolist())
            now.update(new.tolist())
            varying.append(np.array(sorted(now), np.intp))
        return Spell(fixed, varying)


def both(one: Spell, other: Spell) -> Spell:
    """The links that are in both."""
    whole = [np.union1d(other.fixed, codes) for codes in other.varying]
    fixed = in_all([one.fixed, other.fixed])
    rest = without(one.fixed, fixed)
    return Spell(
        fixed,
        [
            in_all([np.union1d(rest, codes), there])
            for codes, there in zip(one.varying, whole, strict=True)
        ],
    )


def _nothing(at: Moment) -> Relinking:
    return Relinking(at, {}, (NONE, NONE), (NONE, NONE))


def _sorted(changes: Changes) -> tuple[Codes, Codes]:
    new, gone = (np.sort(np.array(part, np.intp)) if part else NONE for part in changes)
    return new, gone


def _send_links(
    sink: Sink, path: str, paths: Sequence[MoverPaths], spells: Sequence[Spell]
) -> None:
    """Links in three parts, each rewritten as seldom as it can be.

    Few robots move in a handful of spells, so most links outlast it. They are written once for
    all of it; every spell writes the others that stay, every moment those that vary. With n
    robots about 1.2 √n spells together take the least space, as files are compressed.
    """
    n = len(paths[0].base)
    size = max(1, round(1.2 * sqrt(n)))
    bases = np.array([spell_.base for spell_ in paths], np.float32)  # (s, n, 2)
    starts = np.cumsum([0, *(len(spell_.places) for spell_ in paths[:-1])])
    when = Index.joined([spell_.when for spell_ in paths])
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
    for j in range(max(len(spell_.robots) for spell_ in paths)):
        mover = np.array([c.robots[j] if j < len(c.robots) else -1 for c in paths])
        places = np.concatenate(
            [c.places[:, j] if j < len(c.robots) else np.zeros((len(c.places), 2)) for c in paths]
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
