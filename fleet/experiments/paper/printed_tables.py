"""Tables 2 and 3 beside the paper's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fleet.experiments.paper.campaign_runs import Results
from fleet.experiments.paper.published import (
    IMPOSSIBLE,
    PROTOCOLS,
    ROWS,
    TABLES,
    MeanSd,
    PrintedRow,
)

TWO_SR = 2.0  # the tables' search radius [m]


@dataclass(frozen=True, slots=True)
class Comparison:
    """A cell of a table: printed, measured, and how far apart."""

    row: PrintedRow
    protocol: str
    paper: MeanSd
    measured: MeanSd
    difference: float | None  # measured − printed, in pooled standard deviations
    impossible: str  # why the printed value cannot be, or nothing


def compare(results: Results, world: str) -> list[Comparison]:
    """Table 2 (``random``) or Table 3 (``random-hole``), pooled over all ranges, row by row.

    The messages of RFTA2GE are those of the way to count bids that is nearest to the paper's:
    two hops away only those bid that outbid whom they heard the call from.
    """
    compared = []
    for row in ROWS:
        for protocol in PROTOCOLS:
            series = protocol
            if protocol == "rfta2ge" and row.key == "messages_per_robot":
                series = "rfta2ge-outbid"
            runs = results.where(series=series, world=world, search_radius=TWO_SR)
            paper = TABLES[world][protocol][row.key]
            measured = pooled(runs, row)
            compared.append(
                Comparison(
                    row,
                    protocol,
                    paper,
                    measured,
                    difference(paper, measured),
                    IMPOSSIBLE.get((world, protocol, row.key), ""),
                )
            )
    return compared


def pooled(runs: Results, row: PrintedRow) -> MeanSd:
    """Mean and standard deviation over all runs."""
    values = runs.numbers(row.key) * row.scale
    if len(values) < 2:
        return MeanSd(float("nan"), float("nan"))
    return MeanSd(float(np.mean(values)), float(np.std(values, ddof=1)))


def difference(paper: MeanSd, measured: MeanSd) -> float | None:
    """How far the means are apart in pooled standard deviations, where the paper gives one."""
    if paper.sd is None or measured.sd is None:
        return None
    sd = np.sqrt((paper.sd**2 + measured.sd**2) / 2.0)
    return float((measured.mean - paper.mean) / sd)
