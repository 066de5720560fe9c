"""The report of the reproduction: tables, claims and figures in one page, readable offline."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fleet import __version__
from fleet.assembly import prepare
from fleet.experiments.paper import beyond
from fleet.experiments.paper.campaign_runs import Results
from fleet.experiments.paper.claims import Claim, claims
from fleet.experiments.paper.paper_figures import NAMES, Numbered, draw_all
from fleet.experiments.paper.printed_tables import Comparison, compare
from fleet.experiments.paper.published import MeanSd
from fleet.experiments.paper.theory import theory_claims
from fleet.scenario.model import Scenario
from fleet.study.atomic import write_text
from fleet.study.report.csv_files import write_csv
from fleet.study.report.page import write_page

TITLES = {
    "random": "Table 2: after the final round, random topology",
    "random-hole": "Table 3: after the final round, random topology with hole",
}


def write_report(out: Path, results: Results, command: str) -> Path:
    """Figures (PNG, SVG), tables and claims (CSV), and ``report.html`` with all of them.

    ``results`` holds the runs of one or both motions; the straight ones are the paper's.
    Returns the page's path.
    """
    motions = [m for m in ("straight", "physics") if len(results.where(motion=m))]
    figures = out / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    drawn: list[dict[str, Any]] = []
    further: list[dict[str, Any]] = []
    for motion in motions:
        label = "" if motion == "straight" else " Physics motion."
        runs = results.where(motion=motion)
        numbered = draw_all(runs, energies_left(motion))
        drawn.extend(_saved(figure, figures, motion, label) for figure in numbered)
        further.extend(
            _saved(figure, figures, motion, label) for figure in beyond.draw_beyond(runs)
        )
    paper = results.where(motion=motions[0])
    listed = [*theory_claims(), *claims(paper)]
    tables = [_table(results, world, motions) for world in TITLES]
    said = [[c.where, c.says, c.measured, c.verdict, c.rule] for c in listed]
    write_csv(out / "claims.csv", ["where", "says", "measured", "verdict", "holds if"], said)
    for number, table in zip((2, 3), tables, strict=True):
        lines = [[r["name"], r["protocol"], r["paper"], *r["cells"]] for r in table["rows"]]
        write_csv(out / f"table-{number}.csv", ["row", "protocol", "paper", *motions], lines)
    reached = _beyond(results, motions)
    for table in reached:
        write_csv(out / f"{table['stem']}.csv", beyond.HEADER, table["lines"])
    return write_page(
        out / "report.html",
        "paper.html.j2",
        "fleet.experiments.paper",
        lead=_lead(listed, paper),
        provenance=_provenance(results, motions),
        command=command,
        version=__version__,
        tables=tables,
        claims=listed,
        figures=drawn,
        beyond=reached,
        further=further,
    )


def energies_left(motion: str) -> dict[str, NDArray[np.float64]]:
    """Figure 17: what each robot holds [J] after RFTA2 and RFTA2GE on one network (100,)."""
    left = {}
    for protocol in ("rfta2", "rfta2ge"):
        simulation = prepare(Scenario.of(protocol=protocol, motion=motion, range=2.5, seed=17))
        simulation.run()
        left[protocol] = np.array([robot.energy for robot in simulation.fleet.robots])
    return left


def _saved(numbered: Numbered, folder: Path, motion: str, label: str) -> dict[str, Any]:
    stem = f"figure-{numbered.number:02d}" + ("" if motion == "straight" else f"-{motion}")
    numbered.figure.savefig(folder / f"{stem}.png", dpi=200)
    text = io.StringIO()
    numbered.figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    write_text(folder / f"{stem}.svg", svg)
    return {
        "number": numbered.number,
        "caption": numbered.caption,
        "motion": label,
        "svg": svg[svg.index("<svg") :],
    }


def _table(results: Results, world: str, motions: Sequence[str]) -> dict[str, Any]:
    compared = [compare(results.where(motion=motion), world) for motion in motions]
    rows, notes = [], []
    last = ""
    for cells in zip(*compared, strict=True):
        first = cells[0]
        unit = f" [{first.row.unit}]" if first.row.unit else ""
        name = first.row.name + unit
        rows.append(
            {
                "name": "" if name == last else name,
                "protocol": NAMES[first.protocol],
                "paper": _printed(first.paper) + ("*" if first.impossible else ""),
                "cells": [_measured(cell) for cell in cells],
            }
        )
        last = name
        if first.impossible:
            notes.append(f"* {first.impossible}.")
    notes += [_ge_note(results.where(motion=motion, world=world), motion) for motion in motions]
    return {"title": TITLES[world], "columns": list(motions), "rows": rows, "notes": notes}


def _beyond(results: Results, motions: Sequence[str]) -> list[dict[str, Any]]:
    """The tables of what RFTA3 comes to, one for each topology and motion."""
    limits = {world: beyond.typical_bounds(world) for world in beyond.TITLES}
    return [
        {
            "title": f"{title}, {motion} motion",
            "stem": f"beyond-{world}-{motion}",
            "header": beyond.HEADER,
            "lines": beyond.lines(
                list(beyond.reaches(results.where(motion=motion, world=world), limits[world]))
            ),
            "limits": limits[world],
        }
        for motion in motions
        for world, title in beyond.TITLES.items()
    ]


def _ge_note(runs: Results, motion: str) -> str:
    """The messages of RFTA2GE by the other ways to count its bids."""
    relayed, aggregated = (
        runs.where(series=series, search_radius=2.0).numbers("messages_per_robot").mean()
        for series in ("rfta2ge", "rfta2ge-aggregated")
    )
    return (
        "The paper does not say how RFTA2GE counts bids from two hops away. The table has the count"
        " nearest to it: those two hops away bid only if they outbid whom they heard the call from,"
        f" and each neighbour passes on the best. If all bid it is {aggregated:.1f} messages a"
        f" robot, and {relayed:.1f} if every bid is relayed by itself ({motion} motion)."
    )


def _printed(cell: MeanSd) -> str:
    return f"{cell.mean:.2f}" + (f" ± {cell.sd:.2f}" if cell.sd is not None else "")


def _measured(cell: Comparison) -> str:
    apart = f" ({cell.difference:+.2f})".replace("-", "−") if cell.difference is not None else ""
    return _printed(cell.measured) + apart


def _lead(listed: Sequence[Claim], results: Results) -> str:
    holding = sum(claim.verdict == "holds" for claim in listed)
    failing = sum(claim.verdict == "does not hold" for claim in listed)
    cells = [cell for world in TITLES for cell in compare(results, world)]
    counted = [c for c in cells if c.difference is not None and not c.impossible]
    near = sum(abs(c.difference or 0.0) <= 0.5 for c in counted)
    return (
        f"Of the paper’s claims {holding} hold and {failing} do not;"
        f" {len(listed) - holding - failing} times the paper contradicts itself."
        f" {near} of the {len(counted)} values of its tables that can be compared are met within"
        f" half a standard deviation."
    )


def _provenance(results: Results, motions: Sequence[str]) -> str:
    lifetimes = [results.where(motion=m) for m in motions]
    counts = " and ".join(
        f"{len(runs):,} runs in {motion} motion"
        for runs, motion in zip(lifetimes, motions, strict=True)
    )
    networks = len(results.where(series="rfta2", radio_range=2.5).values("seed"))
    return f"{counts}; networks drawn for each range and topology: {networks}."
