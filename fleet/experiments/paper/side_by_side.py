"""The readings beside one another: which of them fits what the paper says. None are mixed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from fleet.experiments.paper.campaign_runs import Results
from fleet.experiments.paper.claims import Claim, claims
from fleet.experiments.paper.paper_figures import NAMES
from fleet.experiments.paper.printed_tables import Comparison, compare
from fleet.experiments.paper.published import PROTOCOLS, ROWS, TABLES, MeanSd
from fleet.experiments.paper.readings import BIDS, SEARCHES
from fleet.experiments.paper.sample import Sample
from fleet.experiments.paper.verdicts import Verdict

VERDICTS: tuple[Verdict, ...] = ("holds", "does not hold", "cannot tell")
MARKS = {"holds": "✓", "does not hold": "✗", "cannot tell": "?"}
COUNTED = "messages_per_robot"


@dataclass(frozen=True)
class ReadingColumn:
    """What the campaign says under one reading."""

    sample: Sample

    @property
    def name(self) -> str:
        """Of the reading: stop, check, bids."""
        return f"{self.sample.reading}, {self.sample.bids}"

    @cached_property
    def claims(self) -> list[Claim]:
        """The claims that runs bear on, judged."""
        return claims(self.sample)

    @cached_property
    def tables(self) -> dict[str, list[Comparison]]:
        """Tables 2 and 3, by topology."""
        return {world: compare(self.sample, world) for world in TABLES}

    @property
    def cells(self) -> dict[str, int]:
        """How many cells of the tables hold, do not, or cannot be told, of those comparable."""
        counted = [
            cell.judged.verdict
            for cells in self.tables.values()
            for cell in cells
            if cell.judged is not None and not cell.impossible
        ]
        return {verdict: counted.count(verdict) for verdict in VERDICTS}

    @property
    def verdicts(self) -> dict[str, int]:
        """How many claims hold, do not, or cannot be told."""
        counted = [claim.verdict for claim in self.claims]
        return {verdict: counted.count(verdict) for verdict in VERDICTS}

    @property
    def lemma_2(self) -> dict[str, int]:
        """Of the comparisons of 2SR with another radius: how many it wins, loses, cannot tell."""
        counted = [c.verdict for c in self.claims if c.where.startswith("Lemma 2")]
        return {verdict: counted.count(verdict) for verdict in VERDICTS}


def columns(paper: Results) -> list[ReadingColumn]:
    """A column for each reading that was run, the default first, bids as they are relayed."""
    found = []
    for reading in SEARCHES:
        if len(paper.where(reading=str(reading))):
            sample = Sample.of(paper, reading)
            found += [ReadingColumn(sample.counting(bids)) for bids in BIDS]
    return found


def counts(side: Sequence[ReadingColumn]) -> list[list[str]]:
    """A line for each reading: claims, cells of tables, and what of Lemma 2 holds."""
    return [
        [column.name, *(_counted(kind) for kind in (column.verdicts, column.cells, column.lemma_2))]
        for column in side
    ]


def _counted(kind: dict[str, int]) -> str:
    return " / ".join(str(kind[verdict]) for verdict in VERDICTS)


def matrix(side: Sequence[ReadingColumn]) -> list[dict[str, Any]]:
    """A line for each claim: its verdict under each reading, and what was measured."""
    lines = []
    for place, claim in enumerate(side[0].claims):
        each = [column.claims[place] for column in side]
        lines.append(
            {
                "where": claim.where,
                "says": claim.says,
                "marks": [(MARKS[found.verdict], found.verdict, found.measured) for found in each],
            }
        )
    return lines


def fits(side: Sequence[ReadingColumn]) -> list[str]:
    """Which reading fits what, in sentences."""

    def best(of: str) -> str:
        most = max(getattr(column, of)["holds"] for column in side)
        who = [column.name for column in side if getattr(column, of)["holds"] == most]
        named = "; ".join(f"“{name}”" for name in who[:3]) + (
            f" and {len(who) - 3} more" if len(who) > 3 else ""
        )
        return f"{most}, under {named}"

    compared = sum(side[0].lemma_2.values())
    return [
        f"Most claims hold: {best('verdicts')}.",
        f"Most cells of Tables 2 and 3 are met: {best('cells')}.",
        f"2SR wins most of its {compared} comparisons (Lemma 2): {best('lemma_2')}.",
    ]


def table(
    number: int,
    title: str,
    world: str,
    side: Sequence[ReadingColumn],
    physics: Sequence[Sample],
) -> dict[str, Any]:
    """Table 2 or 3 with a column for each reading of the search, and one for physics.

    The messages of RFTA2GE have a line for each way to count bids.
    """
    searches = [column for column in side if column.sample.bids == BIDS[0]]
    others = [ReadingColumn(sample) for sample in physics]
    shown = [*searches, *others]
    heads = [str(column.sample.reading) for column in searches] + ["physics"] * len(others)
    lines: list[list[str]] = []
    rows: list[dict[str, Any]] = []
    notes: list[str] = []
    for place, (row, protocol) in enumerate((row, name) for row in ROWS for name in PROTOCOLS):
        split = row.key == COUNTED and protocol == "rfta2ge"
        for bids in BIDS if split else BIDS[:1]:
            cells = [
                ReadingColumn(column.sample.counting(bids)).tables[world][place] for column in shown
            ]
            first = cells[0]
            unit = f" [{row.unit}]" if row.unit else ""
            name = NAMES[protocol] + (f", bids {bids}" if split else "")
            rows.append(
                {
                    "name": row.name + unit if protocol == PROTOCOLS[0] else "",
                    "protocol": name,
                    "paper": _printed(first.paper) + ("*" if first.impossible else ""),
                    "cells": [_measured(cell) for cell in cells],
                }
            )
            lines.append(
                [row.name, name, _printed(first.paper), *(" ".join(_measured(c)) for c in cells)]
            )
            if first.impossible:
                notes.append(f"* {first.impossible}.")
    return {
        "number": number,
        "title": title,
        "columns": heads,
        "rows": rows,
        "notes": notes,
        "head": ["row", "protocol", "paper", *heads],
        "lines": lines,
    }


def _printed(found: MeanSd) -> str:
    return f"{found.mean:.2f}" + (f" ± {found.sd:.2f}" if found.sd is not None else "")


def _measured(cell: Comparison) -> tuple[str, str]:
    """Mean ± SD, and how far from the paper's: in pooled standard deviations, and the verdict."""
    if cell.judged is None or cell.difference is None:
        return _printed(cell.measured), ""
    found = cell.judged.interval
    apart = f"{cell.difference:+.2f} SD".replace("-", "−")
    mark = "" if cell.impossible else f" {MARKS[cell.judged.verdict]}"
    return _printed(cell.measured), f"[{found.low:.2f}, {found.high:.2f}] {apart}{mark}"
