"""What a judgement leaves behind: a report, a preset, and tables of trips and windows."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fleet.logs.judging import NEEDED, Judgement, LeftOut
from fleet.logs.presets import preset_text
from fleet.logs.redriving import Redriven, redriven_sentence
from fleet.logs.sampling import TERMS, Pieces
from fleet.logs.sentences import (
    FORCES,
    LEADS,
    NAMES,
    UNITS,
    outcome_sentences,
    summary_sentence,
    verdict_sentence,
)  # fmt: skip
from fleet.scenario.errors import bad

PRESET, REPORT, TRIPS, WINDOWS = "preset.toml", "report.html", "trips.csv", "windows.csv"


def write(
    judgement: Judgement, out: Path, command: str = "", bodies: Redriven | None = None
) -> Path:
    """Write ``report.html``, ``preset.toml``, ``trips.csv`` and ``windows.csv`` into a folder.

    ``bodies``: what bodies took that were driven on held-out trips, if any were.

    Returns the report's path.

    Raises:
        BadInput: the folder cannot be written to.
    """
    preset = preset_text(judgement, preset_head(judgement))
    try:
        out.mkdir(parents=True, exist_ok=True)
        (out / PRESET).write_text(preset, "utf-8")
        _write_trips(judgement, out / TRIPS)
        _write_windows(judgement, out / WINDOWS)
        _write_page(judgement, out / REPORT, preset, command, bodies)
    except OSError as error:
        raise bad("--out", f"{str(out)!r} cannot be written to: {error.strerror}") from error
    return out / REPORT


def preset_head(judgement: Judgement) -> list[str]:
    """The first lines of a preset: what it was made from, and how well it does."""
    left_out = judgement.preset.left_out
    lines = [
        f"A robot as logged on {judgement.ground.name}: {summary_sentence(judgement)}.",
        (
            f"Held-out trips: {_percent(left_out.within(judgement.band))} within"
            f" {100.0 * judgement.band:g} %, half within {_percent(left_out.median)}, total"
            f" {_signed(left_out.total)}; distance alone: half within"
            f" {_percent(judgement.linear.median)}."
        ),
        "In brackets: 95 % intervals, by drawing whole runs again.",
    ]
    if judgement.outcome == "no law is":
        lines.append(outcome_sentences(judgement)[0])
    return lines


def _write_trips(judgement: Judgement, path: Path) -> None:
    trips, best, preset = judgement.trips, judgement.best.left_out, judgement.preset.left_out
    _write(path, trips, judgement, {
        "linear [J]": judgement.linear.predicted,
        "fitted [J]": best.predicted,
        "preset [J]": preset.predicted,
        "error of linear": judgement.linear.errors,
        "error of fitted": best.errors,
        "error of preset": preset.errors,
    })  # fmt: skip


def _write_windows(judgement: Judgement, path: Path) -> None:
    windows = judgement.motion.windows
    law = [judged for judged in judgement.nested if judged.family == "motion"][-1].law
    _write(path, windows, judgement, {"law of motion [J]": law.predict(windows)})


_HEADS = ("distance [m]", "time [s]", "turned [rad]", "time turning [s]", "v² [m²/s]")


def _write(path: Path, pieces: Pieces, judgement: Judgement, more: dict[str, Any]) -> None:
    samples = judgement.motion.samples
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["run", *_HEADS, "energy [J]", *more])
        for row in range(len(pieces)):
            values = [pieces.terms[row, TERMS.index(term)] for term in TERMS]
            values += [pieces.energy[row], *(column[row] for column in more.values())]
            name = samples.names[pieces.run[row]]
            writer.writerow([name, *(f"{value:.6g}" for value in values)])


def _write_page(
    judgement: Judgement, path: Path, preset: str, command: str, bodies: Redriven | None
) -> None:
    from fleet.logs.drawings import FIGURES
    from fleet.study.report.page import write_page
    from fleet.study.report.style import in_style, inline, svg_of
    from fleet.study.version import environment

    figures = []
    for name, title, draw, caption in FIGURES:
        with in_style(f"log-{name}"):
            svg = inline(svg_of(draw(judgement)))
        figures.append({"name": name, "title": title, "caption": caption, "svg": svg})
    write_page(
        path, "log_report.html.j2", "fleet.logs",
        title=f"Is energy linear in distance? {judgement.ground.name}",
        name=judgement.ground.name,
        summary=summary_sentence(judgement),
        answer=LEADS[judgement.outcome],
        lead=verdict_sentence(judgement),
        details=outcome_sentences(judgement),
        figures=figures,
        laws=_laws(judgement),
        forces=True,
        coefficients=_coefficients(judgement),
        closing=closing_sentence(judgement),
        preset=preset,
        notes=judgement.ground.notes,
        band=f"{100.0 * judgement.band:g}",
        need=f"{100.0 * NEEDED:g}",
        longest=f"{judgement.motion.samples.longest:g}",
        command=command,
        made_by=environment(),
        bodies=redriven_sentence(bodies) if bodies else "",
    )  # fmt: skip


def closing_sentence(judgement: Judgement) -> str:
    """How well the preset's robot does on the speeds of runs that it was not made from."""
    left_out = judgement.preset.left_out
    runs = _by_run(left_out)
    return (
        "A simulated robot of these keys, made without a run and sent through that run’s speeds and"
        f" turning rates, takes what was measured within {_percent(left_out.median)} in half of all"
        f" trips, and within {_percent(float(np.median(np.abs(runs))))} in half of all runs; in"
        f" total"
        f" {_signed(left_out.total)}. Try it: fleet run --robot preset.toml"
    )


def _by_run(left_out: LeftOut) -> Any:
    """The relative errors of runs, all trips of each together."""
    _, index = np.unique(left_out.run, return_inverse=True)
    return np.bincount(index, left_out.predicted) / np.bincount(index, left_out.energy) - 1.0


def _laws(judgement: Judgement) -> list[dict[str, Any]]:
    rows = []
    for judged in judgement.nested:
        names = NAMES if judged.family == "motion" else FORCES
        what = ", ".join(names[term] for term in judged.terms)
        rows.append(
            {
                "name": what if judged.family == "motion" else f"by forces: {what}",
                "chosen": judged.family == "motion" and judged.terms == judgement.best.terms,
                "within": f"{100.0 * judged.left_out.within(judgement.band):.0f}",
                "median": f"{100.0 * judged.left_out.median:.1f}",
                "total": f"{100.0 * judged.left_out.total:+.1f}".replace("-", "−"),
            }
        )
    return rows


def _coefficients(judgement: Judgement) -> list[dict[str, str]]:
    return [
        {
            "name": NAMES[term],
            "value": f"{judgement.intervals[term].value:.4g}",
            "interval": _bounds(judgement.intervals[term]),
            "unit": UNITS[term],
        }
        for term in judgement.best.terms
    ]


def _bounds(interval: Sequence[float]) -> str:
    _, low, high = interval
    return f"[{low:.3g}, {high:.3g}]" if np.isfinite(high) else "not known from one run"


def _percent(value: float) -> str:
    return f"{100.0 * value:.1f} %" if abs(value) < 0.095 else f"{100.0 * value:.0f} %"


def _signed(value: float) -> str:
    return re.sub("-", "−", f"{100.0 * value:+.1f} %")
