"""Figures that a report works out from those of a run's summary, and what is possible of each."""

from __future__ import annotations

from dataclasses import fields, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from fleet.results import Summary
from fleet.service import StreamFigures
from fleet.study.report.layout import Layout
from fleet.study.report.quantities import MEASURES
from fleet.study.report.runs import Runs, ended
from fleet.study.statistics import restricted

TABLES = ("messages_by_kind", "energy_by_account", "lost_by_reason", "stream")
"""What is a table in a summary; in a row its entries are columns."""

ACCOUNT = "energy_by_account_"
PER_SERVED = "_per_served"


def derived(runs: Runs) -> Runs:
    """The runs with what an event took: messages of each raised, energy of each served."""
    there = runs.columns
    if not {"messages", "events", "served", "energy_drained"} <= there.keys() or not len(runs):
        return runs
    events, served = runs.numbers("events"), runs.numbers("served")
    new = {
        "messages_per_event": _each(runs.numbers("messages"), events),
        "drained_per_served": _each(runs.numbers("energy_drained"), served),
        "predicted_per_served": _each(runs.numbers("energy_predicted"), served),
        "served_share": _each(served, events),
    }
    for name in accounts(runs):
        spent = np.nan_to_num(runs.numbers(name))  # an account that a run does not have is empty
        new[f"{name}{PER_SERVED}"] = _each(spent, served)
    return replace(runs, columns={**new, **there})


def with_deaths(runs: Runs, rounds: Runs) -> Runs:
    """The runs with how many events were served before the first robot died on its way.

    ``rounds`` is the study's table of that name. Where none died it is all that were served.
    """
    if not len(runs) or not {"key", "outcome"} <= rounds.columns.keys():
        return runs
    served: dict[str, float] = dict.fromkeys(runs["key"].tolist(), 0.0)
    dead: set[str] = set()
    for key, outcome in zip(rounds["key"].tolist(), rounds["outcome"].tolist(), strict=True):
        if outcome == "battery empty":
            dead.add(key)
        elif outcome == "arrived" and key not in dead:
            served[key] = served.get(key, 0.0) + 1.0
    before = np.array([served[key] for key in runs["key"].tolist()])
    return replace(runs, columns={**runs.columns, "before_death": before})


def measurable() -> list[str]:
    """The columns that runs of scenarios may have, but for those that name a kind or a reason."""
    own = [f.name for f in fields(Summary) if f.name not in TABLES]
    streams = [f"stream_{f.name}" for f in fields(StreamFigures)]
    return [*own, *streams, "before_death", "messages_per_event", "served_share",
            "drained_per_served", "predicted_per_served"]  # fmt: skip


def is_measurable(name: str) -> bool:
    """Whether runs of scenarios may have such a column of numbers."""
    return name in measurable() or name.startswith(tuple(f"{table}_" for table in TABLES))


def accounts(runs: Runs) -> list[str]:
    """The accounts that energy went into, the largest first; those into which none did are left."""
    found = {n: np.nansum(runs.numbers(n)) for n in runs.columns if n.startswith(ACCOUNT)}
    found = {n: total for n, total in found.items() if not n.endswith(PER_SERVED) and total}
    return sorted(found, key=lambda name: -found[name])


def possible(measure: str) -> tuple[float, float]:
    """The least and the most that a measure can be."""
    if measure.endswith(("share", "within_deadline")) or "[share]" in MEASURES.get(measure, ""):
        return 0.0, 1.0
    known = measure in MEASURES or measure.endswith(PER_SERVED)
    return (0.0, inf) if known else (-inf, inf)


def uncensored(runs: Runs, plan: Layout) -> tuple[Runs, str]:
    """The runs with lifetimes whose mean is right though some were cut off, and what to say of it.

    Where none was cut off, nothing changes. Else lifetimes count up to the longest time that
    some run of every cell was seen for: see :func:`fleet.study.statistics.restricted`.
    """
    if not {"lifetime", "censored"} <= runs.columns.keys() or not len(runs):
        return runs, ""
    over, life = ended(runs), runs.numbers("lifetime")
    if over.all():
        return runs, ""
    names = [*plan.facets, *(name for name in (plan.series, plan.x) if name is not None)]
    numbered = replace(runs, columns={**runs.columns, "_row": np.arange(len(runs))})
    cells = [group["_row"] for _, group in numbered.groups(names)]
    horizon = min(float(life[cell].max()) for cell in cells)
    values = life.copy()
    for cell in cells:
        values[cell] = restricted(life[cell], over[cell], horizon)
    cut = int(np.count_nonzero(~over))
    said = (
        f"{cut} of {len(runs)} runs were cut off before their network came to its end; their"
        f" lifetime is longer than was seen. Means and differences are of lifetimes up to"
        f" {horizon:g}, by pseudo-observations after Andersen, Hansen and Klein (2004)."
    )
    return replace(runs, columns={**runs.columns, "lifetime": values}), said


def _each(total: NDArray[np.float64], count: NDArray[np.float64]) -> NDArray[np.float64]:
    found: NDArray[np.float64] = np.full(len(total), np.nan)
    np.divide(total, count, out=found, where=count > 0)
    return found
