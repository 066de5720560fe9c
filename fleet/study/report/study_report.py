"""The report of a study: one page that needs no network, and CSV and SVG files beside it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from matplotlib.figure import Figure

from fleet.scenario.errors import BadInput, bad
from fleet.study.atomic import write_text
from fleet.study.endings import BrokenOff
from fleet.study.frame import is_numeric
from fleet.study.ledger import Counts, Ledger, reading
from fleet.study.lock import sole
from fleet.study.parquet import runs_table, side_table
from fleet.study.report import estimate_figures as figures
from fleet.study.report import estimate_tables as tables
from fleet.study.report import estimates
from fleet.study.report.conditions import conditions
from fleet.study.report.derived import PER_SERVED, accounts, derived, uncensored, with_deaths
from fleet.study.report.layout import Layout, layout
from fleet.study.report.page import write_page
from fleet.study.report.quantities import measures, name_of, short_name
from fleet.study.report.runs import Runs, runs_of
from fleet.study.report.style import in_style, inline, svg_of
from fleet.study.report.text import FEWEST_PAIRS, plain
from fleet.study.result import StudyResult

T = TypeVar("T", estimates.Mean, estimates.Contrast, estimates.Curve, estimates.Energies)

MOST_FACETS = 6  # figures of one kind
OF_INTEREST = 0.05  # a difference of interest, of the baseline's mean


@dataclass(frozen=True, slots=True)
class Shown:
    """A figure of the page."""

    number: int
    caption: str
    svg: str
    csv: str


@dataclass(frozen=True, slots=True)
class Section:
    """A heading with its figures and its table."""

    title: str
    text: str
    figures: list[Shown]
    table: tables.Table | None
    csv: str


def write_report(folder: Path, out: Path | None = None) -> Path:
    """Write ``report.html`` into the folder of a study, or ``out``, and its data into ``report/``.

    It tells what there is, also while the study goes on.

    Raises:
        BadInput: the folder holds no study, or the study's ``[report]`` asks for what is not
            there, or the page cannot be written.
    """
    page = (out or folder) / "report.html"
    try:
        return _write(folder, page)
    except OSError as error:
        said = f"{str(error.filename or page)!r} cannot be written: {error.strerror or error}"
        raise bad("", f"{said}; --out names another folder") from error
    except BrokenOff as error:
        raise bad("", str(error)) from error


def has_report_of_its_own(folder: Path) -> bool:
    """Whether what ran there was no study, but an experiment that has written its own page.

    Raises:
        BadInput: the folder holds no study.
    """
    with reading(folder) as ledger:
        return "study" not in ledger.meta() and (folder / "report.html").is_file()


def _write(folder: Path, path: Path) -> Path:
    with reading(folder) as ledger:
        meta, counts, failures = ledger.meta(), ledger.counts(), ledger.failures()
        runs = derived(runs_of(runs_table(ledger.rows()), ledger.labels()))
        robots, rounds = _side(ledger, "robots"), _side(ledger, "rounds")
    if rounds is not None:
        runs = with_deaths(runs, rounds)
    _bring_up_to_date(folder)
    beside = path.parent / "report"
    beside.mkdir(parents=True, exist_ok=True)
    study = meta.get("study", {})
    sections = list(_sections(runs, robots, study.get("report", {}), beside)) if len(runs) else []
    return write_page(
        path,
        "study.html.j2",
        title=study.get("title") or f"Study in {folder.resolve().name}",
        counts=counts,
        sections=sections,
        failures=failures,
        design=_design(runs),
        fixed=_fixed(runs),
        conditions=conditions(runs),
        seeds=_seeds(runs),
        summary=_summary(runs, counts),
        source=meta.get("source") or json.dumps(study, indent=2),
        command=meta.get("command", ""),
        until=meta.get("until", ""),
        made_by=meta.get("made_by", {}),
    )


def _bring_up_to_date(folder: Path) -> None:
    """Write the tables, unless a sweep is at work, which will, or nothing can be written here."""
    with suppress(BadInput, OSError), sole(folder):
        StudyResult(folder).write()


def _sections(
    runs: Runs, robots: Runs | None, asked: dict[str, Any], beside: Path
) -> Iterator[Section]:
    plan = layout(runs, asked)
    seen = runs
    runs, cut_off = uncensored(runs, plan)
    chosen = measures(runs, asked.get("measures"))
    number = _Numbers()
    found = estimates.means(runs, plan, chosen)
    if found:
        most = max(mean.runs for mean in found)
        tables.write_means(beside / "means.csv", found, plan)
        yield Section(
            "Means",
            "Whiskers and ± are 95 % confidence intervals of the mean, after Student; in brackets"
            f" where part of one would be impossible. {_of_served(chosen)}{cut_off}",
            list(_drawn(
                "means", found, plan, figures.draw_means, f"Means over {most} runs each", beside,
                number,
            )),
            tables.means_table(found, plan), "report/means.csv",
        )  # fmt: skip
    against = estimates.contrasts(runs, plan, chosen)
    if against:
        tables.write_contrasts(beside / "differences.csv", against, plan)
        named = isinstance(plan.baseline, str)
        baseline = f"{'' if named else f'{short_name(str(plan.series))} '}{plain(plan.baseline)}"
        yield Section(
            f"Differences from {baseline}",
            f"{_pairs(plan)} Intervals are 95 % BCa bootstrap intervals of the mean difference; d"
            f" is Cohen’s for pairs. In bold: a difference by Student’s paired test, corrected for"
            f" all {len(against)} comparisons after Holm (5 %), if there are {FEWEST_PAIRS} pairs"
            f" or more. {_needed(against, found, plan)}",
            list(_drawn(
                "differences", against, plan, figures.draw_contrasts,
                f"Paired differences from {baseline}", beside, number,
            )),
            tables.contrasts_table(against, plan), "report/differences.csv",
        )  # fmt: skip
    if robots is not None and len(robots):
        left = estimates.energies(robots, plan)
        tables.write_energies(beside / "energy.csv", left, plan)
        yield Section(
            "Energy balance",
            "How the energy that is left is spread over the robots of all runs: the steeper, the"
            " more alike they are.",
            list(_drawn(
                "energy", left, plan, figures.draw_energies,
                "Energy left in the robots at the end of a run", beside, number,
            )),
            None, "report/energy.csv",
        )  # fmt: skip
    yield from _tallies(runs, plan, beside)
    lives = estimates.curves(seen, plan)
    if lives:
        tables.write_curves(beside / "survival.csv", lives, plan)
        yield Section(
            "Lifetimes",
            "The share of networks that outlive each round, after Kaplan and Meier, with 95 %"
            " intervals after Greenwood. Runs that were cut off at their limit of rounds count as"
            " long as they were seen.",
            list(_drawn(
                "survival", lives, plan, figures.draw_curves, "Survival of the network", beside,
                number,
            )),
            tables.curves_table(lives, plan), "report/survival.csv",
        )  # fmt: skip


def _tallies(runs: Runs, plan: Layout, beside: Path) -> Iterator[Section]:
    """Tables of what became of events, and of what energy went into."""
    counted = [n for n in ("events", "served", "waiting", "expired", "lost") if n in runs.columns]
    reasons = [n for n in runs.columns if n.startswith("lost_by_reason_")]
    if "stream_within_deadline" in runs.columns:
        shown = [*counted, *reasons, "stream_within_deadline", "stream_response_mean"]
        found = estimates.means(runs, plan, [n for n in shown if is_numeric(runs[n])])
        tables.write_means(beside / "events.csv", found, plan)
        yield Section(
            "What became of events",
            "Raised = served + still open + expired + lost, in the mean of all runs. The share that"
            " was reached by the deadline is of all events; response times are of those served.",
            [], tables.means_table(found, plan), "report/events.csv",
        )  # fmt: skip
    spent = [f"{name}{PER_SERVED}" for name in accounts(runs)]
    if spent and "drained_per_served" in runs.columns:
        shown = ["predicted_per_served", "drained_per_served", *spent]
        found = estimates.means(runs, plan, shown)
        tables.write_means(beside / "accounts.csv", found, plan)
        yield Section(
            "What an event took",
            "Eq. (1) on the straight lines of all trips, what the batteries lost, and what that"
            " went into, over the events served.",
            [], tables.means_table(found, plan), "report/accounts.csv",
        )  # fmt: skip


def _of_served(chosen: Sequence[str]) -> str:
    if any("response" in name for name in chosen):
        return "Response times are of events served only. "
    return ""


def _needed(
    against: Sequence[estimates.Contrast], base: Sequence[estimates.Mean], plan: Layout
) -> str:
    """How many more seeds a difference of interest would need, measure by measure."""
    needed = estimates.pairs_for(against, base, plan.baseline, OF_INTEREST)
    there = min(contrast.difference.pairs for contrast in against)
    said = [
        f"{short_name(name)} {pairs:.0f}"
        + (f" ({pairs - there:.0f} more)" if pairs > there else " (there are enough)")
        for name, pairs in needed.items()
    ]
    if not said:
        return ""
    return (
        f"To show a difference of {OF_INTEREST:.0%} of the baseline’s mean, four times out of five"
        f" and looked at alone, takes so many seeds: {', '.join(said)}."
    )


def _pairs(plan: Layout) -> str:
    """What runs of one seed have in common; the network depends on no more than the world does."""
    if str(plan.series).startswith(("protocol", "search_radius")):
        return (
            "Runs of one seed have the same network and the same events, and are compared as pairs."
        )
    return "Runs of one seed are compared as pairs."


class _Numbers:
    """Counts the figures of the page."""

    def __init__(self) -> None:
        self.last = 0

    def next(self) -> int:
        self.last += 1
        return self.last


def _drawn(
    kind: str,
    items: Sequence[T],
    plan: Layout,
    draw: Callable[[Sequence[T], Layout], Figure],
    caption: str,
    beside: Path,
    number: _Numbers,
) -> Iterator[Shown]:
    """A figure for each combination of the facets, as far as there is room."""
    facets = list(dict.fromkeys(item.cell.facet for item in items))
    for place, facet in enumerate(facets[:MOST_FACETS]):
        where = ", ".join(
            f"{short_name(name)} {plain(value)}"
            for name, value in zip(plan.facets, facet, strict=True)
        )
        name = f"{kind}-{place + 1}" if len(facets) > 1 else kind
        with in_style(name):
            svg = svg_of(draw([item for item in items if item.cell.facet == facet], plan))
        write_text(beside / f"{name}.svg", svg)
        rest = len(facets) - MOST_FACETS
        more = f" {rest} more combinations are in the CSV file." if rest > 0 else ""
        said = f"{caption}: {where}." if where else f"{caption}."
        yield Shown(number.next(), said + more, inline(svg), f"report/{name}.svg")


def _side(ledger: Ledger, name: str) -> Runs | None:
    """A table beside the runs with the axes of the study, if there is one."""
    if name not in ledger.table_names():
        return None
    return runs_of(side_table(ledger, name), ledger.labels())


def _design(runs: Runs) -> list[tuple[str, str]]:
    """The axes with their values."""
    return [(name_of(axis), ", ".join(map(plain, runs.values(axis)))) for axis in runs.axes]


def _fixed(runs: Runs) -> list[tuple[str, str]]:
    """What all runs have in common, of what their summary says."""
    names = ("protocol", "world", "motion", "robots", "radio_range", "search_radius")
    return [
        (short_name(name), plain(runs.values(name)[0]))
        for name in names
        if name in runs.columns and name not in runs.axes and len(runs.values(name)) == 1
    ]


def _seeds(runs: Runs) -> str:
    if "seed" not in runs.columns or not len(runs):
        return ""
    seeds = sorted(runs.values("seed"))
    if len(seeds) > 2 and seeds == list(range(seeds[0], seeds[-1] + 1)):
        return f"{seeds[0]} to {seeds[-1]}"
    return ", ".join(map(str, seeds[:20])) + (" …" if len(seeds) > 20 else "")


def _summary(runs: Runs, counts: Counts) -> str:
    cells = len(list(runs.groups(runs.axes))) if len(runs) else 0
    parts = [f"{counts.done} of {counts.total} runs"]
    if cells > 1:
        parts.append(f"{cells} combinations")
    return ", ".join(parts)
