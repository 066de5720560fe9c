"""Numbers as people read them: no more digits than their intervals warrant."""

from __future__ import annotations

from math import floor, isfinite, log10
from typing import Any

from fleet.study.statistics import Difference, Interval

FEWEST_PAIRS = 6  # of which all on one side are as rare as 3 in 100


def estimate(interval: Interval) -> str:
    """A mean with half the width of its interval: ``391.2 ± 8.7``; lopsided ones as bounds."""
    value, low, high = interval
    if not isfinite(value):
        return "–"
    half = 0.5 * (high - low)
    if not isfinite(half) or half == 0.0:
        return plain(value)
    digits = _digits(half)
    if abs(high + low - 2.0 * value) > 0.02 * half:
        return f"{value:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]".replace("-", "−")
    return f"{value:.{digits}f} ± {half:.{digits}f}".replace("-", "−")


def difference(found: Difference) -> str:
    """A mean difference: ``+12.1``."""
    return f"{found.mean:+.{_digits_of(found)}f}".replace("-", "−").replace("+nan", "–")


def bounds(found: Difference) -> str:
    """The interval of a difference: ``[3.4, 20.2]``; nothing if there is none."""
    if not (isfinite(found.low) and isfinite(found.high)):
        return ""
    digits = _digits_of(found)
    return f"[{found.low:.{digits}f}, {found.high:.{digits}f}]".replace("-", "−")


def effect(found: Difference) -> str:
    """Cohen's d in two digits."""
    return f"{found.effect:+.2f}".replace("-", "−").replace("inf", "∞").replace("nan", "–")


def plain(value: Any) -> str:
    """A number without needless digits; anything else as text."""
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def stands_out(found: Difference, chance: float) -> bool:
    """Whether there is a difference, by its p for all comparisons; few pairs cannot say so."""
    return found.pairs >= FEWEST_PAIRS and chance < 0.05


def _digits_of(found: Difference) -> int:
    width = 0.5 * (found.high - found.low)
    return _digits(width if isfinite(width) and width > 0.0 else abs(found.mean) or 1.0)


def _digits(width: float) -> int:
    """Decimals that show two figures of ``width``."""
    return max(0, 1 - floor(log10(width)))
