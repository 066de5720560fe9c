"""When a claim is said to hold: equivalence tests, their tolerances fixed before anything was run.

A figure holds if its whole interval is within the tolerance of what the paper says, does not hold
if all of it is outside, and otherwise the campaign cannot tell: Schuirmann, J. Pharmacokinet.
Biopharm. 15(6):657, 1987; Wellek, Testing Statistical Hypotheses of Equivalence and Noninferiority,
2nd ed., 2010.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite, nextafter, sqrt
from typing import Literal, NamedTuple

from fleet.experiments.paper.published import MeanSd
from fleet.experiments.paper.resampling import Resampled
from fleet.study.statistics import Interval, wilson_interval

Verdict = Literal["holds", "does not hold", "cannot tell"]

TIMES = 0.25  # of a number that the text gives
SHARE = 0.05  # of all, for a share
CELL = 0.5  # pooled standard deviations, for a cell of a table

TOLERANCES = (
    ("a number of the text: k times, around k rounds or messages", "within 25 % of it"),
    ("a share", "within 5 points of it"),
    ("a cell of Tables 2 and 3", "within 0.5 pooled standard deviations of it"),
    ("more, longer, best: an order", "the quotient of the two is above 1"),
    ("never, at most: a bound", "not exceeded once; the interval is of how often it is"),
)
"""What is compared, and how near it has to be."""


class Band(NamedTuple):
    """What a figure must lie between for a claim to hold."""

    low: float
    high: float
    rule: str
    possible: tuple[float, float] = (-inf, inf)


def times(number: float, unit: str = "") -> Band:
    """A number that the text gives."""
    low, high = (1.0 - TIMES) * number, (1.0 + TIMES) * number
    return Band(low, high, f"{_plain(low)} to {_plain(high)}{unit and ' '}{unit}")


def share(low: float, high: float | None = None) -> Band:
    """A share, or from one share to another."""
    least, most = max(0.0, low - SHARE), min(1.0, (low if high is None else high) + SHARE)
    return Band(least, most, f"{least:.0%} to {most:.0%}", (0.0, 1.0))


def same_share() -> Band:
    """A difference of two shares that are almost the same."""
    return Band(-SHARE, SHARE, f"less than {100.0 * SHARE:.0f} points apart")


def above(least: float) -> Band:
    """An order: a quotient above 1, or another least."""
    return Band(nextafter(least, inf), inf, f"above {_plain(least)}")


def cell(paper: MeanSd, measured_sd: float) -> Band | None:
    """A cell of a table; None: the paper prints no standard deviation there."""
    if paper.sd is None or not isfinite(measured_sd):
        return None
    within = CELL * sqrt((paper.sd**2 + measured_sd**2) / 2.0)
    return Band(paper.mean - within, paper.mean + within, f"{paper.mean:g} ± {within:.2f}")


@dataclass(frozen=True, slots=True)
class Judged:
    """A figure with its 95 % interval, and whether it is where the claim has it."""

    name: str
    interval: Interval
    rule: str
    verdict: Verdict
    percent: bool = False
    unit: str = ""

    def __str__(self) -> str:
        value, low, high = (100.0 * x if self.percent else x for x in self.interval)
        before = f"{self.name}{self.name and ': '}"
        if not isfinite(value):
            return f"{before}not run"
        bounds = f"{_plain(low)}, {_plain(high)}" if isfinite(low) else "too few networks"
        unit = " %" if self.percent else f" {self.unit}" if self.unit else ""
        return f"{before}{_plain(value)} [{bounds}]{unit}"


def judge(
    figure: Resampled, band: Band, name: str = "", unit: str = "", *, percent: bool = False
) -> Judged:
    """Whether a figure of the campaign is within a band."""
    verdict = within(_cut(figure.interval(figure.decisive), band), band)
    return Judged(name, _cut(figure.interval(), band), band.rule, verdict, percent, unit)


def judge_interval(
    found: Interval, band: Band, name: str = "", unit: str = "", *, percent: bool = False
) -> Judged:
    """Whether a figure with an interval of its own is within a band."""
    return Judged(name, found, band.rule, within(found, band), percent, unit)


def never(exceeded: int, tried: int, name: str) -> Judged:
    """Whether a bound that is said to hold always was kept each time; how often it was not."""
    verdict: Verdict = "does not hold" if exceeded else "holds" if tried else "cannot tell"
    found = wilson_interval(exceeded, tried)
    return Judged(f"{name}, of {tried:,}", found, "never", verdict, percent=True)


def within(found: Interval, band: Band) -> Verdict:
    """Holds, if all of the interval is inside; does not hold, if all of it is outside."""
    if not (isfinite(found.low) and isfinite(found.high)):
        return "cannot tell"
    if band.low <= found.low and found.high <= band.high:
        return "holds"
    return "does not hold" if found.high < band.low or found.low > band.high else "cannot tell"


def all_of(parts: Sequence[Judged]) -> Verdict:
    """Of a claim with several parts: it fails with one of them, and holds with all."""
    verdicts = {part.verdict for part in parts} or {"cannot tell"}
    if "does not hold" in verdicts:
        return "does not hold"
    return "cannot tell" if "cannot tell" in verdicts else "holds"


def _cut(found: Interval, band: Band) -> Interval:
    """The part of an interval that is possible."""
    least, most = band.possible
    return Interval(found.value, max(found.low, least), min(found.high, most))


def _plain(number: float) -> str:
    """Three digits that count."""
    text = f"{number:.0f}" if abs(number) >= 100 else f"{number:.3g}"
    return text.replace("-", "−")
