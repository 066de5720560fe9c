"""What a law of motion is fitted to: rates at the times of the power, windows, trips."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fleet.logs.grounds import LoggedRun, LogGround

Floats = NDArray[np.float64]
Numbers = NDArray[np.intp]

TERMS = ("distance", "time", "angle", "turning", "square")
"""What energy may be linear in: metres driven, seconds of driving, radians turned, seconds of
turning, and v²·s [m²/s]."""

STILL_SPEED, STILL_RATE = 0.02, 0.05  # [m/s], [rad/s] below which a robot stands
STANDING = 1.0  # [s] from which it is standing that ends a trip
WINDOW = 5.0  # [s]
LONGEST_TRIP = 60.0  # [s] from which one is cut
FEWEST = 4  # files; of fewer, stretches stand for runs
STRETCH = 20.0  # [s] of one
MOST_SHARE = 0.5  # of all driving, that one run may hold
SHORTEST_TRIP = 1.0  # [m]
_TOUCHED = 0.01  # of a reading driven: less is how times are rounded


@dataclass(frozen=True, slots=True)
class Samples:
    """All readings of a ground's runs while they drive, one after the other."""

    run: Numbers  # (n,) the run, by file
    drive: Numbers  # (n,) the stretch from standing to standing; ascends
    since: Floats  # (n,) [s] from the drive's begin
    step: Floats  # (n,) [s] that a reading stands for
    metres: Floats  # (n,) driven in that step
    energy: Floats  # (n,) [J] in that step, without what standing takes
    terms: Floats  # (n, 5) in that step: TERMS
    rest: Floats  # (n,) [J] in that step, which no coefficient changes: what inertia takes
    standing: float  # [W] at standstill, NaN: it never stands
    stood: float  # [s]
    shortest: float  # [s] of a run
    period: float  # [s] from reading to reading
    names: tuple[str, ...]  # of the runs
    files: int
    readers: tuple[Reader, ...] = ()
    longest: float = LONGEST_TRIP  # [s] of a trip
    regrouped: str = ""  # what stands for runs, if these do not

    def rated(self, basis: Rates) -> Samples:
        """The same readings with the terms and the rest of another law."""
        parts = [
            reader.sums(np.column_stack(basis(reader.run)))[reader.driven]
            for reader in self.readers
        ]
        both = np.concatenate(parts)
        return replace(self, terms=both[:, :-1], rest=both[:, -1])


@dataclass(frozen=True, slots=True)
class Pieces:
    """Samples added up over windows, or over trips."""

    run: Numbers  # (k,)
    metres: Floats  # (k,) driven
    energy: Floats  # (k,) [J]
    terms: Floats  # (k, 5)
    rest: Floats  # (k,) [J]
    of_sample: Numbers  # (n,) the piece of each sample, -1: of none

    def __len__(self) -> int:
        return len(self.run)

    def rated(self, samples: Samples) -> Pieces:
        """The same pieces of samples that have other terms."""
        return _pieces(samples, self.of_sample)

    def term(self, name: str) -> Floats:
        """One of :data:`TERMS`, (k,)."""
        values: Floats = self.terms[:, TERMS.index(name)]
        return values

    def take(self, mask: NDArray[np.bool_]) -> Pieces:
        """Some of the pieces."""
        return Pieces(
            self.run[mask], self.metres[mask], self.energy[mask], self.terms[mask],
            self.rest[mask], np.full(len(self.of_sample), -1),
        )  # fmt: skip

    def matrix(self, names: Sequence[str]) -> Floats:
        """Some of :data:`TERMS`, (k, names)."""
        return self.terms[:, [TERMS.index(name) for name in names]]


def rates(v: Floats, omega: Floats) -> Floats:
    """The rates of :data:`TERMS` at speeds (n,) [m/s] and turning rates (n,) [rad/s]."""
    speed, turn = np.abs(v), np.abs(omega)
    turns = turn > STILL_RATE
    return np.stack([speed, np.ones_like(v), turn * turns, turns.astype(float), v * v], axis=1)


def stands(time: Floats, v: Floats, omega: Floats) -> NDArray[np.bool_]:
    """Where a robot stands, for a second or longer."""
    still = (np.abs(v) < STILL_SPEED) & (np.abs(omega) < STILL_RATE)
    edges = np.flatnonzero(np.diff(np.r_[False, still, False].astype(np.int8)))
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        if time[min(end, len(time) - 1)] - time[begin] < STANDING:
            still[begin:end] = False
    return still


def to_rest(driven: NDArray[np.bool_], v: Floats, omega: Floats) -> NDArray[np.bool_]:
    """Drives (n,) with their first and last moments, in which the robot is slower than standing.

    Launching takes the most power; it counts as driving from where the speeds begin to rise.
    """
    pace = np.abs(v) / STILL_SPEED + np.abs(omega) / STILL_RATE
    whole = driven.copy()
    edges = np.flatnonzero(driven[1:] != driven[:-1])
    for edge in edges:
        outward = -1 if driven[edge + 1] else 1
        at = edge if outward < 0 else edge + 1
        while 0 < at < len(pace) - 1 and 0.0 < pace[at] < pace[at - outward] and not driven[at]:
            whole[at] = True
            at += outward
    return whole


Rates = Callable[[LoggedRun], tuple[Floats, Floats]]
"""For a run of n samples: what coefficients multiply (n, 5), and what they do not (n,) [W]; at the
samples, or from each to the next (n - 1)."""


def samples_of(ground: LogGround, lag: float = 0.0, over: float = 0.0) -> Samples:
    """The readings of all runs of a ground while they drive, with :data:`TERMS`.

    Where power is read less often than motion, the rates of motion are taken at the readings:
    ``lag`` [s] before them, averaged ``over`` [s].
    """
    files = {file: number for number, file in enumerate(ground.files)}
    readers = tuple(Reader(run, lag, over) for run in ground.runs)
    resting = np.concatenate([reader.run.power[reader.moving == 0.0] for reader in readers])
    standing = float(np.median(resting)) if len(resting) > 5 else float("nan")
    rest = 0.0 if np.isnan(standing) else standing
    columns: list[list[Floats]] = [[] for _ in range(7)]
    drives = 0
    for reader in readers:
        run, step, moving, driven = reader.run, reader.step, reader.moving, reader.driven
        begins = driven & ~np.r_[False, driven[:-1]]
        number = drives + np.cumsum(begins) - 1
        drives += int(begins.sum())
        first = np.maximum.accumulate(np.where(begins, np.arange(len(begins)), 0))
        began = run.meter[first] - 0.5 * step[first]
        found = (
            np.full(len(step), files[run.file]), number, run.meter - began, step,
            reader.sums(np.abs(run.v)[:, None])[:, 0],
            (run.power - rest * (1.0 - moving)) * step,
            reader.sums(rates(run.v, run.omega)),
        )  # fmt: skip
        for column, values in zip(columns, found, strict=True):
            column.append(values[driven])
    run_, drive, since, step, metres, energy, terms = (np.concatenate(each) for each in columns)
    samples = Samples(
        run_.astype(np.intp), drive.astype(np.intp), since, step, metres, energy, terms,
        np.zeros(len(step)), standing,
        sum(float(reader.step[reader.moving == 0.0].sum()) for reader in readers),
        min(run.duration for run in ground.runs),
        float(np.median([np.median(np.diff(run.meter)) for run in ground.runs])),
        tuple(ground.files), len(files), readers,
    )  # fmt: skip
    return _regrouped(samples) if len(samples.step) else samples


def _regrouped(samples: Samples) -> Samples:
    """Samples whose runs can be left out one by one.

    Of fewer than four files, stretches of 20 s stand for runs; a run of more than half of all
    driving is cut so that no part is more than a third: without it too little is left to fit.
    """
    total = float(samples.step.sum())
    if samples.files < FEWEST:
        samples = replace(
            samples, longest=STRETCH, shortest=STRETCH,
            regrouped=f"{samples.files} file{'s' * (samples.files > 1)}: stretches of {STRETCH:g} s"
            " stand for runs; they say nothing of how the robot differs from day to day",
        )  # fmt: skip
        parts = dict.fromkeys(range(samples.files), STRETCH)
    else:
        held = np.bincount(samples.run, samples.step) / total
        parts = {int(run): total / 3.0 for run in np.flatnonzero(held > MOST_SHARE)}
        if parts:
            samples = replace(
                samples, regrouped=f"one run holds {100.0 * held.max():.0f} % of all driving:"
                                   f" cut in"
                " parts, each left out by itself",
            )  # fmt: skip
    piece = _cut(samples, samples.longest, round_up=True)
    begins = np.r_[True, np.diff(piece) != 0]
    label = samples.run.astype(float)
    for whole, length in parts.items():
        mine = samples.run == whole
        lasted = np.cumsum(samples.step * mine)
        count = max(1, round(lasted[-1] / length))
        at = np.where(begins & mine, np.floor(lasted / lasted[-1] * count * (1.0 - 1e-9)), 0.0)
        label[mine] += np.maximum.accumulate(at)[mine] / (count + 1.0)
    labels, run = np.unique(label, return_inverse=True)
    names = tuple(
        f"{samples.names[int(part)]}, part" if int(part) in parts else samples.names[int(part)]
        for part in labels
    )
    return replace(samples, run=run, names=_numbered(names))


def _numbered(names: Sequence[str]) -> tuple[str, ...]:
    """Names with what tells them apart counted: of parts of a run."""
    count: dict[str, int] = {}
    found = []
    for name in names:
        stem, comma, _ = name.partition(", ")
        count[stem] = count.get(stem, 0) + 1
        found.append(f"{stem}, part {count[stem]}" if comma else stem)
    return tuple(found)


class Reader:
    """The readings of a run's power, and what its motion was while each was taken."""

    def __init__(self, run: LoggedRun, lag: float, over: float) -> None:
        self.run, self.lag = run, lag if run.slow else 0.0
        edges = np.r_[run.meter[0], 0.5 * (run.meter[1:] + run.meter[:-1]), run.meter[-1]]
        self.step: Floats = np.diff(edges)  # (k,) [s] that each stands for
        driven = ~stands(run.time, run.v, run.omega)
        self._spans: Spans | None = None
        if np.array_equal(run.meter, run.time):
            self._moves = driven.astype(float)
            self.moving: Floats = self._moves  # (k,) the share of each that it drives
        else:
            if run.slow:
                half = 0.5 * max(over, float(np.median(np.diff(run.time))))
                low, high = run.meter - lag - half, run.meter - lag + half
            else:
                low, high = edges[:-1], edges[1:]
            self._spans = Spans(run.time, low, high)
            driven = to_rest(driven, run.v, run.omega)
            self._moves = (driven[1:] | driven[:-1]).astype(float)
            self.moving = self._spans.means(self._moves[:, None])[:, 0]
            self.moving[self.moving < _TOUCHED] = 0.0
        self.driven: NDArray[np.bool_] = self.moving > 0.0  # (k,)

    def sums(self, values: Floats) -> Floats:
        """Values at the samples (n, p), or between them (n - 1, p), over each reading (k, p)."""
        if self._spans is None:
            values = _at_instants(self.run.time, values) * self._moves[:, None]
        else:
            values = between_instants(values, len(self.run.time)) * self._moves[:, None]
            values = self._spans.means(values)
        sums: Floats = values * (self.step * self.driven)[:, None]
        return sums


def _at_instants(time: Floats, values: Floats) -> Floats:
    """Values (n, p) at ``time`` (n,), if they are those between the instants (n - 1, p)."""
    if len(values) == len(time):
        return values
    weight = np.diff(time)
    share = (weight[:-1] / (weight[1:] + weight[:-1]))[:, None]
    inside = values[1:] + share * (values[:-1] - values[1:])
    return np.concatenate([values[:1], inside, values[-1:]])


def between_instants(values: Floats, count: int) -> Floats:
    """Values (n - 1, p) between instants, the means of their ends if there are ``count``."""
    return 0.5 * (values[1:] + values[:-1]) if len(values) == count else values


class Spans:
    """Spans of time, from ``low`` to ``high`` (k,) [s], over which signals are averaged."""

    def __init__(self, time: Floats, low: Floats, high: Floats) -> None:
        begin, end = time[0], time[-1]
        self._time = time
        low, high = np.clip(low, begin, end - 1e-3), np.clip(high, begin + 1e-3, end)
        self._length = (high - low)[:, None]
        self._low, self._high = self._place(low), self._place(high)

    def means(self, values: Floats) -> Floats:
        """The means (k, p) of signals at instants (n, p), or between these (n - 1, p)."""
        time = self._time
        grown = between_instants(values, len(time)) * np.diff(time)[:, None]
        so_far = np.zeros((len(time), values.shape[1]))
        np.cumsum(grown, axis=0, out=so_far[1:])
        low, high = (
            so_far[place] + share * (so_far[place + 1] - so_far[place])
            for place, share in (self._low, self._high)
        )
        means: Floats = (high - low) / self._length
        return means

    def _place(self, at: Floats) -> tuple[Numbers, Floats]:
        """Between which instants times (k,) are, and how far on."""
        place = np.clip(np.searchsorted(self._time, at, "right") - 1, 0, len(self._time) - 2)
        begin = self._time[place]
        return place, ((at - begin) / (self._time[place + 1] - begin))[:, None]


def windows(samples: Samples, length: float | None = None) -> Pieces:
    """Samples added up over windows of about ``length`` [s]; every drive is cut evenly.

    By default 5 s, or ten readings if these take longer, and at most a third of the shortest run.
    """
    if length is None:
        length = max(1.0, min(max(WINDOW, 10.0 * samples.period), samples.shortest / 3.0))
    return _pieces(samples, _cut(samples, length, round_up=False))


def trips(samples: Samples) -> Pieces:
    """Samples added up from standing to standing; a drive of more than a minute is cut evenly.

    Of a metre or more: those that never leave their place are no trips.
    """
    pieces = _pieces(samples, _cut(samples, samples.longest, round_up=True))
    far = pieces.metres >= SHORTEST_TRIP
    number = np.where(far, np.cumsum(far) - 1, -1)
    return replace(pieces.take(far), of_sample=number[pieces.of_sample])


def _cut(samples: Samples, length: float, *, round_up: bool) -> Numbers:
    """The piece of each sample; ascends."""
    last = np.r_[samples.drive[1:] != samples.drive[:-1], True]
    duration = (samples.since + 0.5 * samples.step)[last]
    raw = duration / length
    count = np.maximum(1, np.ceil(raw - 1e-9) if round_up else np.round(raw))
    index = np.cumsum(np.r_[True, last[:-1]]) - 1
    share = samples.since / np.maximum(duration[index], 1e-9)
    piece = np.minimum(np.floor(share * count[index]), count[index] - 1)
    key = np.r_[0.0, np.cumsum(count)[:-1]][index] + piece
    numbers: Numbers = np.cumsum(np.r_[0, np.diff(key) != 0.0]).astype(np.intp)
    return numbers


def _pieces(samples: Samples, piece: Numbers) -> Pieces:
    if not len(piece):
        nothing = np.empty(0)
        return Pieces(piece, nothing, nothing, np.empty((0, len(TERMS))), nothing, piece)
    begins = np.flatnonzero(np.r_[True, np.diff(piece) != 0])
    return Pieces(
        samples.run[begins],
        np.add.reduceat(samples.metres, begins),
        np.add.reduceat(samples.energy, begins),
        np.add.reduceat(samples.terms, begins, axis=0),
        np.add.reduceat(samples.rest, begins),
        piece,
    )
