"""A study at a glance: its means as a table of HTML, or as a figure."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Any

from fleet.notebook_figure import NotebookFigure
from fleet.scenario.errors import bad
from fleet.study.ledger import reading
from fleet.study.parquet import runs_table
from fleet.study.report import estimates
from fleet.study.report.derived import derived, uncensored
from fleet.study.report.estimate_figures import draw_means
from fleet.study.report.estimate_tables import TableCell, means_table
from fleet.study.report.layout import Layout, layout
from fleet.study.report.quantities import measures, short_name
from fleet.study.report.runs import runs_of
from fleet.study.report.style import in_style
from fleet.study.report.text import plain


def figure(folder: Path, names: tuple[str, ...]) -> NotebookFigure:
    """The means with their 95 % intervals, a panel a measure; as the report's first figure.

    Raises:
        BadInput: no run is done, or a measure is not there.
    """
    means, plan = _means(folder, names)
    if not means:
        raise bad(str(folder), "has no finished run to draw")
    with in_style("plot"):
        facet = means[0].cell.facet
        drawn = draw_means([mean for mean in means if mean.cell.facet == facet], plan)
        if plan.facets:
            named = zip(plan.facets, facet, strict=True)
            drawn.suptitle(", ".join(f"{short_name(name)} {plain(said)}" for name, said in named))
        return drawn


def table(folder: Path) -> str:
    """The means with their 95 % intervals, a row a combination, as HTML; empty without runs."""
    means, plan = _means(folder, ())
    if not means:
        return ""
    shown = means_table(means, plan)
    heads = "".join(
        f"<th>{escape(name)}{f'<br>[{escape(unit)}]' if unit else ''}</th>"
        for name, unit in shown.head
    )
    rows = "".join(f"<tr>{''.join(map(_cell, row.entries))}</tr>" for row in shown.rows)
    more = f"<p>{shown.left_out} more rows.</p>" if shown.left_out else ""
    return f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>{more}"


def _cell(entry: TableCell) -> str:
    return f"<td>{escape(entry.text)}</td>"


def _means(folder: Path, names: tuple[str, ...]) -> tuple[list[estimates.Mean], Layout]:
    with reading(folder) as ledger:
        study: dict[str, Any] = ledger.meta().get("study", {})
        runs = derived(runs_of(runs_table(ledger.rows()), ledger.labels()))
    if not len(runs):
        return [], Layout(None, None, (), None, ())
    asked = study.get("report", {})
    plan = layout(runs, asked)
    seen, _ = uncensored(runs, plan)
    return estimates.means(seen, plan, measures(seen, names or asked.get("measures"))), plan
