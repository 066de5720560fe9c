"""The report of the reproduction: tables, claims and figures in one page, readable offline."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fleet import __version__
from fleet.assembly import prepare
from fleet.experiments.paper import beyond
from fleet.experiments.paper.campaign_runs import Results
from fleet.experiments.paper.claims import Claim, claims
from fleet.experiments.paper.complexity import Growth, growths
from fleet.experiments.paper.paper_figures import Numbered, draw_all, draw_further
from fleet.experiments.paper.readings import ANY, CHECKS, COUNTS, DEFAULT, STOPS
from fleet.experiments.paper.resampling import GUARDED
from fleet.experiments.paper.sample import Sample
from fleet.experiments.paper.side_by_side import ReadingColumn, columns, counts, fits, matrix, table
from fleet.experiments.paper.theory import theory_claims
from fleet.experiments.paper.verdicts import TOLERANCES
from fleet.scenario.model import Scenario
from fleet.study.report.csv_files import write_csv
from fleet.study.report.page import write_page
from fleet.study.report.style import in_style, saved
from fleet.study.statistics import Interval

TABLES = {
    "random": (2, "Table 2: after the final round, random topology"),
    "random-hole": (3, "Table 3: after the final round, random topology with hole"),
}


def write_report(out: Path, results: Results, command: str) -> Path:
    """Figures (PNG, SVG, CSV), tables and claims (CSV), and ``report.html`` with all of them.

    ``results`` holds the runs of one or both motions; the straight ones are the paper's.
    Returns the page's path.
    """
    out.mkdir(parents=True, exist_ok=True)
    motions = [m for m in ("straight", "physics") if len(results.where(motion=m))]
    paper = results.where(motion=motions[0])
    side = columns(paper)
    physics = [Sample.of(results.where(motion=m)) for m in motions[1:]]
    listed = [*theory_claims(), *claims(side[0].sample)]
    grown = growths(paper)
    tables = [
        table(number, title, world, side, physics) for world, (number, title) in TABLES.items()
    ]
    reached = _beyond(results, motions)
    _write_tables(out, listed, side, tables, grown, reached)
    drawn, further = _draw(out / "figures", results, motions)
    return write_page(
        out / "report.html",
        "paper.html.j2",
        "fleet.experiments.paper",
        lead=_lead(listed, side[0]),
        provenance=_provenance(results, motions, side),
        command=command,
        version=__version__,
        tables=tables,
        tolerances=TOLERANCES,
        guarded=f"{100.0 * GUARDED:g} %",
        claims=listed,
        side=side,
        stops=STOPS,
        checks=CHECKS,
        ways=COUNTS,
        counts=counts(side),
        matrix=matrix(side),
        fits=fits(side),
        growths=[_growth_cells(growth) for growth in grown],
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


def _draw(
    folder: Path, results: Results, motions: Sequence[str]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """The figures of the paper, and those that go beyond it, as the page has them."""
    folder.mkdir(parents=True, exist_ok=True)
    drawn: list[dict[str, Any]] = []
    further: list[dict[str, Any]] = []
    with in_style("paper"):
        for motion in motions:
            runs = results.where(motion=motion)
            drawn += [_shown(f, folder, motion) for f in draw_all(runs, energies_left(motion))]
            further += [_shown(f, folder, motion) for f in beyond.draw_beyond(_default(runs))]
            if motion == "straight":
                drawn += [_shown(figure, folder, motion) for figure in draw_further(runs)]
    return drawn, further


def _shown(numbered: Numbered, folder: Path, motion: str) -> dict[str, Any]:
    """Write the files of a figure; what the page says of it."""
    stem = f"figure-{numbered.number:02d}" + ("" if motion == "straight" else f"-{motion}")
    write_csv(folder / f"{stem}.csv", numbered.head, numbered.rows)
    return {
        "number": numbered.number,
        "caption": numbered.caption,
        "motion": "" if motion == "straight" else " Physics motion.",
        "printed": numbered.printed,
        "stem": f"figures/{stem}",
        "svg": saved(numbered.figure, folder, stem),
    }


def _default(runs: Results) -> Results:
    return runs.where(reading=str(DEFAULT)).with_rows_of(runs.where(reading=ANY))


def _write_tables(
    out: Path,
    listed: Sequence[Claim],
    side: Sequence[ReadingColumn],
    tables: Sequence[dict[str, Any]],
    grown: Sequence[Growth],
    reached: Sequence[dict[str, Any]],
) -> None:
    """What the page says, as CSV files beside it."""
    write_csv(
        out / "claims.csv",
        ["reading", "where", "says", "part", "value", "low", "high", "holds if", "part's verdict",
         "verdict", "elsewhere"],
        _claim_rows(listed, side),
    )  # fmt: skip
    for found in tables:
        write_csv(out / f"table-{found['number']}.csv", found["head"], found["lines"])
    write_csv(
        out / "table-1.csv",
        ["protocol", "printed", "n grows", "messages, exponent", "low", "high", "steps, exponent",
         "low", "high", "networks"],
        [[g.name, g.printed, g.way, *g.messages, *g.steps, g.networks] for g in grown],
    )  # fmt: skip
    for found in reached:
        write_csv(out / f"{found['stem']}.csv", beyond.HEADER, found["lines"])


def _claim_rows(listed: Sequence[Claim], side: Sequence[ReadingColumn]) -> Iterator[list[Any]]:
    others = [(column.name, column.claims) for column in side[1:]]
    for reading, found in [(side[0].name, listed), *others]:
        for claim in found:
            for part in claim.parts:
                yield [
                    reading, claim.where, claim.says, part.name, *part.interval, part.rule,
                    part.verdict, claim.verdict, claim.odds,
                ]  # fmt: skip


def _beyond(results: Results, motions: Sequence[str]) -> list[dict[str, Any]]:
    """The tables of what RFTA3 comes to, one for each topology and motion."""
    limits = {world: beyond.typical_bounds(world) for world in beyond.TITLES}
    runs = {motion: _default(results.where(motion=motion)) for motion in motions}
    return [
        {
            "title": f"{title}, {motion} motion",
            "stem": f"beyond-{world}-{motion}",
            "header": beyond.HEADER,
            "lines": beyond.lines(
                list(beyond.reaches(runs[motion].where(world=world), limits[world]))
            ),
            "limits": limits[world],
        }
        for motion in motions
        for world, title in beyond.TITLES.items()
    ]


def _growth_cells(growth: Growth) -> list[str]:
    return [
        growth.name, growth.printed, growth.way, _exponent(growth.messages),
        _exponent(growth.steps), str(growth.networks),
    ]  # fmt: skip


def _exponent(found: Interval) -> str:
    if not np.isfinite(found.value):
        return "–"
    return "{:.2f} [{:.2f}, {:.2f}]".format(*found).replace("-", "−")


def _lead(listed: Sequence[Claim], first: ReadingColumn) -> str:
    said = {
        verdict: sum(claim.verdict == verdict for claim in listed)
        for verdict in ("holds", "does not hold", "cannot tell")
    }
    near = first.cells["holds"]
    return (
        f"Of {len(listed)} claims of the paper {said['holds']} hold, {said['does not hold']} do"
        f" not, and of {said['cannot tell']} this campaign cannot tell, under the reading"
        f" “{first.name}”. {near} of the {sum(first.cells.values())} values of its tables that can"
        f" be compared are met within half a standard deviation."
    )


def _provenance(results: Results, motions: Sequence[str], side: Sequence[ReadingColumn]) -> str:
    total = " and ".join(
        f"{len(results.where(motion=motion)):,} runs in {motion} motion" for motion in motions
    )
    first = side[0].sample.networks
    others = side[-1].sample.networks.each
    return (
        f"{total}. Networks drawn for each range and topology: {first.each}, of {first.complete} in"
        f" the full campaign; under the other readings of the search {others}."
    )
