"""The report of the energy study: one page that needs no network, and its figures beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fleet.experiments.energy import (
    fleet_exhibits,
    preset_exhibit,
    sensitivity,
    trip_exhibits,
)
from fleet.experiments.energy.accuracy import accuracy
from fleet.experiments.energy.exhibits import Exhibit
from fleet.experiments.energy.findings import details, findings, on_bids, on_closure, verdict
from fleet.experiments.energy.lives import lives
from fleet.experiments.energy.models import CORRECTED, LINE, fit
from fleet.experiments.energy.settings import NO_INERTIA, Subject
from fleet.experiments.energy.trip_table import TripTable
from fleet.study.report.page import write_page
from fleet.study.report.style import in_style, saved
from fleet.study.version import environment

TITLES = {
    "distance": "Against the straight distance",
    "presets": "Linear is not proportional: four robots",
    "parts": "Where the rest goes",
    "models": "Models of what a trip costs",
    "settings": "Other robots, crowds and floors",
    "lifetimes-trips": "The trips that protocols ask for",
    "traffic": "Several at once",
    "lifetimes": "Lifetimes",
    "differences": "What wrong bids cost, and better ones win back",
    "choices": "Whom Eq. (1) would send instead",
    "headlines": "Do comparisons of protocols hang on the robot?",
}


def write_report(
    out: Path,
    single: TripTable,
    streams: TripTable,
    lived: TripTable,
    rows: Sequence[Mapping[str, Any]],
    command: str,
    subject: Subject,
) -> Path:
    """Write ``report.html``, and each figure as PNG, SVG and CSV into ``figures/``.

    Returns the page's path.
    """
    folder = out / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    whole = [row for row in rows if row["part"] == "lifetime"]
    robots = [row for row in rows if row["part"] == "headline"]
    listed = lives(whole)
    found = findings(single, streams, lived, listed, subject)
    paper = single.where(setting=subject.name).arrived()
    with in_style("energy"):
        shown = [
            trip_exhibits.by_distance(paper, fit(LINE, paper), subject),
            *([preset_exhibit.by_preset(single)] if not subject.base else []),
            trip_exhibits.by_part(paper, subject),
            trip_exhibits.by_model(paper),
            trip_exhibits.by_setting(single, subject),
            fleet_exhibits.by_protocol(lived, fit(CORRECTED, paper), subject.places),
            *([fleet_exhibits.in_traffic(streams)] if subject.traffic else []),
            fleet_exhibits.lifetimes(listed),
            fleet_exhibits.differences(listed),
            sensitivity.choices(whole),
            *([sensitivity.headlines(robots)] if subject.headlines else []),
        ]
        figures = {exhibit.name: _saved(exhibit, folder) for exhibit in shown}
    said = {
        "parts": on_closure(found),
        "settings": on_engine(single, subject),
        "differences": on_bids(listed, subject.places[0].name),
        "choices": sensitivity.on_choices(whole),
        "headlines": sensitivity.on_headlines(robots),
    }
    return write_page(
        out / "report.html",
        "energy.html.j2",
        "fleet.experiments.energy",
        lead=verdict(found),
        details=details(found),
        exhibits=[(exhibit, figures[exhibit.name]) for exhibit in shown],
        said={exhibit.name: said.get(exhibit.name, "") for exhibit in shown},
        titles=TITLES,
        subject=subject,
        rate=subject.spec.power.per_metre(subject.spec.cruise),
        command=command,
        made_by=environment(),
    )


def on_engine(single: TripTable, subject: Subject) -> str:
    """How far bodies pushed by forces are from the prediction, and the control."""
    names = (subject.name, subject.engine.name)
    if subject.motion == "physics":
        names = names[::-1]
    foreseen, driven = (single.where(setting=name) for name in names)
    if not len(driven) or len(foreseen) != len(driven):
        return ""
    both = (foreseen["outcome"] == "arrived") & (driven["outcome"] == "arrived")
    if not both.any():
        return ""
    foreseen, driven = foreseen.take(both), driven.take(both)
    gap = abs(driven["drained"] / foreseen["drained"] - 1.0)
    said = (
        f"Pushed by forces in pymunk, robots drain what was foreseen within"
        f" {100.0 * gap.mean():.3f} % on average and {100.0 * gap.max():.2f} % at most, over"
        f" {len(driven):,} trips of the robot in which nothing is varied."
    )
    control = single.where(setting=NO_INERTIA).arrived()
    if not len(control):
        return said
    eq1 = accuracy(control["drained"], control["per_metre"] * control["planned"])
    return (
        f"{said} The control is a robot that pays nothing for its inertia and for turning: on the"
        f" planned path it drains {eq1.ratio:.4f} times what Eq. (1) says."
    )


def _saved(exhibit: Exhibit, folder: Path) -> Any:
    """Write a figure's files; returns it as an element of the page."""
    exhibit.write_csv(folder)
    if exhibit.figure is None:
        return ""
    return saved(exhibit.figure, folder, exhibit.name)
