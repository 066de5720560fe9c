"""Tables 2 and 3 beside the paper's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fleet.experiments.paper.published import (
    IMPOSSIBLE,
    PROTOCOLS,
    ROWS,
    TABLES,
    MeanSd,
    PrintedRow,
)
from fleet.experiments.paper.readings import ge_series
from fleet.experiments.paper.sample import TWO_SR, Sample
from fleet.experiments.paper.verdicts import Judged, cell, judge


@dataclass(frozen=True, slots=True)
class Comparison:
    """A cell of a table: printed, measured, and whether they are the same."""

    row: PrintedRow
    protocol: str
    paper: MeanSd
    measured: MeanSd
    difference: float | None  # measured − printed, in pooled standard deviations
    judged: Judged | None  # None: the paper prints no standard deviation
    impossible: str  # why the printed value cannot be, or nothing


def compare(sample: Sample, world: str) -> list[Comparison]:
    """Table 2 (``random``) or Table 3 (``random-hole``), pooled over all ranges, row by row.

    The messages of RFTA2GE are those of the sample's way to count bids.
    """
    compared = []
    for row in ROWS:
        for protocol in PROTOCOLS:
            paper = TABLES[world][protocol][row.key]
            measured, judged = _cell(sample, row, protocol, world, paper)
            compared.append(
                Comparison(
                    row,
                    protocol,
                    paper,
                    measured,
                    difference(paper, measured),
                    judged,
                    IMPOSSIBLE.get((world, protocol, row.key), ""),
                )
            )
    return compared


def _cell(
    sample: Sample, row: PrintedRow, protocol: str, world: str, paper: MeanSd
) -> tuple[MeanSd, Judged | None]:
    """Mean and standard deviation over all runs, and the verdict on the mean."""
    counted = protocol == "rfta2ge" and row.key == "messages_per_robot"
    series = ge_series(sample.bids) if counted else protocol
    runs = sample.runs.where(series=series, world=world, search_radius=TWO_SR)
    values = runs.numbers(row.key) * row.scale
    if len(values) < 2:
        return MeanSd(float("nan"), float("nan")), None
    measured = MeanSd(float(np.mean(values)), float(np.std(values, ddof=1)))
    band = cell(paper, measured.sd or 0.0)
    if band is None:
        return measured, None
    name = f"{row.name}, {protocol}"
    return measured, judge(sample.networks.mean(runs, values), band, name, row.unit)


def difference(paper: MeanSd, measured: MeanSd) -> float | None:
    """How far the means are apart in pooled standard deviations, where the paper gives one."""
    if paper.sd is None or measured.sd is None:
        return None
    sd = np.sqrt((paper.sd**2 + measured.sd**2) / 2.0)
    return float((measured.mean - paper.mean) / sd)
