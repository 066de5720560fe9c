"""Adding seeds to a study until what is asked for is known well enough."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from math import ceil, inf, isfinite
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fleet.scenario.errors import bad, shown, unknown
from fleet.study.design import Study
from fleet.study.frame import is_numeric
from fleet.study.ledger import reading
from fleet.study.parquet import runs_table
from fleet.study.report.derived import derived, is_measurable, measurable, possible, uncensored
from fleet.study.report.layout import layout
from fleet.study.report.runs import runs_of
from fleet.study.result import StudyResult
from fleet.study.statistics import mean_interval

FEWEST = 20  # seeds before an interval's width is believed
GROWTH = (1.25, 4.0)  # of the number of seeds from one look to the next
SPARE = 1.05  # more seeds than the widest interval asks for
MOST = 100_000  # seeds
FORM = re.compile(r"^\s*(\w+)\s*(?:±|\+-|\+/-)\s*([0-9.]+)\s*%\s*$")


class Target(NamedTuple):
    """How well a measure is to be known: half its interval over its mean, in every cell."""

    measure: str
    share: float

    def __str__(self) -> str:
        return f"{self.measure} ±{100.0 * self.share:g}%"


def target(text: str) -> Target:
    """What ``lifetime ±2%`` means; ``+-`` will do.

    Raises:
        BadInput: it means nothing.
    """
    found = FORM.match(text)
    share = 0.01 * float(found[2]) if found and found[2].count(".") < 2 and found[2] != "." else 0.0
    if found is None or not 0.0 < share < 1.0:
        raise bad("--until", f"is {shown(text)}; expected a measure and a width, as 'lifetime ±2%'")
    if not is_measurable(found[1]):
        raise bad("--until", unknown("measure", found[1], measurable()))
    return Target(found[1], share)


def seeds_wanted(values: ArrayLike, measure: str, share: float) -> int:
    """How many seeds there should be before the next look; no more than there are: it is enough.

    Looks are few and far between, and none is taken at fewer than :data:`FEWEST` seeds, since the
    interval of a study that stops when it likes what it sees holds the mean less often than said;
    so it does as often as said within a percent.
    """
    sample = np.asarray(values, float)
    sample = sample[np.isfinite(sample)]
    count = len(sample)
    if count < FEWEST:
        return FEWEST
    mean, low, high = mean_interval(sample, possible(measure))
    half = max(high - mean, mean - low)
    if half <= share * abs(mean):
        return count
    width = half / (share * abs(mean)) if mean else inf
    wanted = ceil(SPARE * count * width**2) if isfinite(width) else MOST
    return min(max(wanted, ceil(GROWTH[0] * count)), ceil(GROWTH[1] * count))


def wanted(result: StudyResult, goal: Target) -> tuple[int, float]:
    """How many seeds every cell of a study should have, and the widest interval's half [share].

    Raises:
        BadInput: the runs have no such measure.
    """
    with reading(result.folder) as ledger:
        runs = derived(runs_of(runs_table(ledger.rows()), ledger.labels()))
    if not len(runs):
        return 0, inf
    runs, _ = uncensored(runs, layout(runs, {}))
    if goal.measure not in runs.columns or not is_numeric(runs[goal.measure]):
        numeric = [name for name, column in runs.columns.items() if is_numeric(column)]
        raise bad("--until", unknown("measure", goal.measure, numeric))
    most, widest = 0, 0.0
    for _, group in runs.groups(["cell"]):
        values = group.numbers(goal.measure)
        most = max(most, seeds_wanted(values, goal.measure, goal.share))
        mean, low, high = mean_interval(values[np.isfinite(values)], possible(goal.measure))
        widest = max(widest, max(high - mean, mean - low) / abs(mean) if mean else inf)
    return most, widest


def with_seeds(study: Study, count: int) -> Study:
    """The study with so many seeds: its own, and those that follow the largest of them."""
    more = count - len(study.seeds)
    if more <= 0:
        return study
    first = max(study.seeds) + 1
    return replace(study, seeds=[*study.seeds, *range(first, first + more)])


def seeds_there(meta: dict[str, Any], study: Study) -> int:
    """How many seeds a folder's study has, if it is this one with some added."""
    before: Sequence[int] = meta.get("study", {}).get("seeds", ())
    grown = with_seeds(study, len(before))
    return len(before) if list(before) == list(grown.seeds) else 0
