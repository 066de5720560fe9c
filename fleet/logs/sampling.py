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
    longest: float = LONGEST_TRIP  # [s] of a trip
    regrouped: str = ""  # what stands for runs, if these do not


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


Rates = Callable[[LoggedRun], tuple[Floats, Floats]]
"""For a run of n samples: what coefficients multiply (n, 5), and what they do not (n,) [W]; at the
samples, or from each to the next (n - 1)."""


def plain_rates(run: LoggedRun) -> tuple[Floats, Floats]:
    """:func:`rates`, and no rest: the laws that are linear in what the robot did."""
    return rates(run.v, run.omega), np.zeros(len(run.time))


def samples_of(
    ground: LogGround, basis: Rates = plain_rates, lag: float = 0.0, over: float = 0.0
) -> Samples:
    """The readings of all runs of a ground while they drive.

    Where power is read less often than motion, the rates of motion are taken at the readings:
    ``lag`` [s] before them, averaged ``over`` [s].
    """
    files = {file: number for number, file in enumerate(ground.files)}
    parts, standing_power, stood = [], [], 0.0
    for run in ground.runs:
        moving, terms, step = _at_meter(run, basis(run), lag, over)
        parts.append((run, moving, terms, step))
        rests = moving == 0.0
        standing_power.append(run.power[rests])
        stood += float(step[rests].sum())
    resting = np.concatenate(standing_power)
    standing = float(np.median(resting)) if len(resting) > 5 else float("nan")
    columns: list[list[Floats]] = [[] for _ in range(7)]
    drives = 0
    for run, moving, terms, step in parts:
        drives_here = moving > 0.0
        begins = drives_here & ~np.r_[False, drives_here[:-1]]
        number = drives + np.cumsum(begins) - 1
        drives += int(begins.sum())
        rest = 0.0 if np.isnan(standing) else standing
        energy = (run.power - rest * (1.0 - moving)) * step
        first = np.maximum.accumulate(np.where(begins, np.arange(len(begins)), 0))
        began = run.meter[first] - 0.5 * step[first]
        found = (
            np.full(len(step), files[run.file]), number, run.meter - began, step, terms[:, 6],
            energy, terms[:, :6],
        )  # fmt: skip
        for column, values in zip(columns, found, strict=True):
            column.append(values[drives_here])
    run_, drive, since, step, metres, energy, both = (np.concatenate(column) for column in columns)
    samples = Samples(
        run_.astype(np.intp), drive.astype(np.intp), since, step, metres, energy, both[:, :5],
        both[:, 5], standing, stood,
        min(run.duration for run in ground.runs),
        float(np.median([np.median(np.diff(run.meter)) for run in ground.runs])),
        tuple(ground.files), len(files),
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


def _at_meter(
    run: LoggedRun, rated: tuple[Floats, Floats], lag: float, over: float
) -> tuple[Floats, Floats, Floats]:
    """For each reading: the share of it driven, terms, rest and metres (k, 7), its length."""
    edges = np.r_[run.meter[0], 0.5 * (run.meter[1:] + run.meter[:-1]), run.meter[-1]]
    step: Floats = np.diff(edges)
    driven = ~stands(run.time, run.v, run.omega)
    columns = np.column_stack([*rated, np.abs(run.v[: len(rated[1])])])
    if len(rated[1]) < len(run.v):
        columns[:, -1] = 0.5 * np.abs(run.v[1:] + run.v[:-1])
    if np.array_equal(run.meter, run.time):
        moving: Floats = driven.astype(float)
        terms = _at_instants(run.time, columns) * moving[:, None]
        return moving, terms * step[:, None], step
    moves = (driven[1:] | driven[:-1]).astype(float)
    columns = _between_instants(run.time, columns) * moves[:, None]
    averages = Averages(run.time, np.column_stack([moves, columns]))
    if run.slow:
        half = 0.5 * max(over, float(np.median(np.diff(run.time))))
        averaged = averages.between(run.meter - lag - half, run.meter - lag + half)
    else:
        averaged = averages.between(edges[:-1], edges[1:])
    averaged[averaged[:, 0] < _TOUCHED] = 0.0
    return averaged[:, 0], averaged[:, 1:] * step[:, None], step


def _at_instants(time: Floats, values: Floats) -> Floats:
    """Values (n, p) at ``time`` (n,), if they are those between the instants (n - 1, p)."""
    if len(values) == len(time):
        return values
    weight = np.diff(time)[:, None]
    none = np.zeros((1, 1))
    before, after = np.vstack([none, weight]), np.vstack([weight, none])
    first, last = np.vstack([values[:1], values]), np.vstack([values, values[-1:]])
    mean: Floats = (before * first + after * last) / (before + after)
    return mean


def _between_instants(time: Floats, values: Floats) -> Floats:
    """Values (n - 1, p) between instants, the means of their ends if they are at ``time`` (n,)."""
    return 0.5 * (values[1:] + values[:-1]) if len(values) == len(time) else values


class Averages:
    """Means of signals, at instants (n, p) or between these (n - 1, p), over spans of time."""

    def __init__(self, time: Floats, values: Floats) -> None:
        grown = _between_instants(time, values) * np.diff(time)[:, None]
        self._time = time
        self._so_far = np.vstack([np.zeros(values.shape[1]), np.cumsum(grown, axis=0)])

    def between(self, low: Floats, high: Floats) -> Floats:
        """The means (k, p) from ``low`` to ``high`` (k,) [s], held to the span of the signals."""
        begin, end = self._time[0], self._time[-1]
        low, high = np.clip(low, begin, end - 1e-3), np.clip(high, begin + 1e-3, end)
        return (self._at(high) - self._at(low)) / (high - low)[:, None]

    def _at(self, time: Floats) -> Floats:
        """What signals add up to until ``time`` (k,), (k, p)."""
        place = np.clip(np.searchsorted(self._time, time, "right") - 1, 0, len(self._time) - 2)
        begin = self._time[place]
        share = ((time - begin) / (self._time[place + 1] - begin))[:, None]
        so_far: Floats = self._so_far[place] * (1.0 - share) + self._so_far[place + 1] * share
        return so_far


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
