"""The times of a log: their unit, and where they jump."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fleet.scenario.errors import bad

Floats = NDArray[np.float64]

_EPOCH = ((1e18, 1e-9, "ns"), (1e15, 1e-6, "µs"), (1e12, 1e-3, "ms"), (1e9, 1.0, "s"))
_STEP = ((5e4, 1e-9, "ns"), (5e3, 1e-6, "µs"), (5.0, 1e-3, "ms"), (0.0, 1.0, "s"))
LONGEST_GAP = 1.0  # [s], or five steps if these are longer
_STEPS = 5.0


def seconds(time: Floats, source: str) -> tuple[Floats, str]:
    """Times in seconds, and a sentence if they were in another unit.

    Times since 1970 (of 2001 to 2065) are told by their size, others by their steps: robots are
    read 1 to 1000 times a second.

    Raises:
        BadInput: there are fewer than three times.
    """
    finite = time[np.isfinite(time)]
    if len(finite) < 3:
        raise bad(
            "--log", f"{source}: holds {len(finite)} samples; expected a drive of at least 20 s,"
                     f" with"
            " some samples a second",
        )  # fmt: skip
    size, step = float(np.median(finite)), float(np.median(np.abs(np.diff(finite))))
    since_1970 = [(f, u) for least, f, u in _EPOCH if least <= size < 3.0 * least]
    by_step = next((f, u) for least, f, u in _STEP if step >= least)
    factor, unit = since_1970[0] if since_1970 else by_step
    if unit == "s":
        return time, ""
    return time * factor, f"times taken as {unit}: {step:g} from sample to sample"


def unfolded(time: Floats) -> Floats:
    """Times of rows that go on, after a gap, where they went backward.

    So that no two rows have one time, and those of a stretch are of no other.
    """
    finite = np.flatnonzero(np.isfinite(time))
    steps = np.diff(time[finite])
    back = steps < 0.0
    if not back.any():
        return time
    typical = float(np.median(np.abs(steps)))
    shift = np.cumsum(np.where(back, 3.0 * max(LONGEST_GAP, _STEPS * typical) - steps, 0.0))
    later = time.copy()
    later[finite[1:]] += shift
    return later


def ascending(time: Floats, source: str) -> tuple[list[NDArray[np.intp]], list[str]]:
    """The samples of each stretch in which time goes on without gaps, and what was found.

    Times are :func:`unfolded`. One that repeats the one before is left out; a stretch ends where
    nothing is logged for more than a second and more than five steps.

    Raises:
        BadInput: all times are the same.
    """
    keep = np.flatnonzero(np.isfinite(time))
    notes = []
    if len(keep) < len(time):
        notes.append(f"{len(time) - len(keep)} rows without a time left out")
    again = np.zeros(len(keep), bool)
    again[1:] = np.diff(time[keep]) == 0.0
    if again.any():
        notes.append(f"{np.count_nonzero(again)} repeated times left out")
    keep = keep[~again]
    steps = np.diff(time[keep])
    forward = steps[steps > 0.0]
    if not len(forward):
        raise bad("--log", f"{source}: its times never go on; expected times that ascend")
    longest = max(LONGEST_GAP, _STEPS * float(np.median(forward)))
    gap = steps > longest
    if gap.any():
        notes.append(
            f"cut at {np.count_nonzero(gap)} places where time goes backward, or nothing is logged"
            f" for more than {longest:.3g} s: nothing is integrated across them"
        )
    return np.split(keep, np.flatnonzero(gap) + 1), notes


_LONGEST_HOLD = 3.0  # [s]
_SHORTEST_HOLD = 5  # samples


def genuine(values: Floats, time: Floats, motion: Floats) -> NDArray[np.intp] | None:
    """The samples at which a value was read anew, if it was held in between; None: it was not.

    Loggers that write a row for each pose repeat the last reading of a slower battery: it changes
    at multiples of a period, while the ``motion`` (n,) goes on changing in between.
    """
    changed = np.diff(values) != 0.0
    changes = np.flatnonzero(changed) + 1
    if len(changes) < 10 or np.count_nonzero((np.diff(motion) != 0.0) & ~changed) < len(changes):
        return None
    gaps = np.diff(changes)
    period = int(np.quantile(gaps, 0.1))  # a reading may also repeat by chance
    step = float(np.median(np.diff(time)))
    if period < _SHORTEST_HOLD or period * step > _LONGEST_HOLD:
        return None
    multiples = np.maximum(1, np.round(gaps / period))
    period = round(float((gaps / multiples).mean()))
    slack = max(1.0, 0.06 * period) if period > 8 else 0.0
    if np.mean(np.abs(gaps - period * multiples) <= slack * multiples) < 0.95:
        return None
    readings = [
        np.linspace(a, b, max(1, round((b - a) / period)), endpoint=False).round().astype(np.intp)
        for a, b in pairwise(changes)
    ]
    return np.concatenate([*readings, changes[-1:]])
