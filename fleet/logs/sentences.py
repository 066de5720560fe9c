"""What the logs of one ground say, in words."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import Literal

import numpy as np

from fleet.logs.judging import NEEDED, Judgement, trips_needed
from fleet.logs.presets import electronics_sentence
from fleet.study.statistics import Interval

LEADS = {
    "accurate": "Accurate, and enough: distance alone tells what a trip costs.",
    "a law is": "Distance is not enough; a law of speed and turning is better.",
    "no law is": "Distance is not enough, and no law of motion is better.",
    "cannot tell": "These logs cannot tell.",
}
_ANSWERS = {"holds": "holds", "fails": "does not hold", "cannot tell": "cannot be told"}

NAMES = {
    "distance": "distance", "time": "time", "angle": "turning, by angle",
    "turning": "turning, by time", "square": "speed squared",
}  # fmt: skip
UNITS = {"distance": "J/m", "time": "W", "angle": "J/rad", "turning": "W", "square": "W·s²/m²"}
FORCES = {
    "distance": "rolling resistance", "time": "constant power", "angle": "scrub",
    "turning": "power while turning", "square": "viscous resistance",
}  # fmt: skip


def verdict_sentence(judgement: Judgement) -> str:
    """The verdict on energy linear in distance, as a person understands it."""
    linear, share, total = judgement.linear, judgement.share, judgement.total
    best = judgement.best.left_out
    band = 100.0 * judgement.band
    answer = _ANSWERS[judgement.by_trip]
    trips = "it cannot be told" if answer == "cannot be told" else f"it {answer}"
    totals = _ANSWERS[judgement.by_total]
    text = (
        f"Energy linear in distance: trip by trip {trips} ({_percent(share)} of"
        f" {len(linear.energy)}"
        f" held-out trips within {band:g} %, half of them within {100.0 * linear.median:.0f} %);"
        f" for"
        f" totals it {totals} ({_signed(total)})."
    )
    text += (
        f" The fitted law: {100.0 * best.within(judgement.band):.0f} % within {band:g} %, half"
        f" within"
        f" {100.0 * best.median:.0f} %, total {100.0 * best.total:+.1f} %."
    )
    return minus(text + _missing(judgement))


def _missing(judgement: Judgement) -> str:
    """What the linear law leaves out most."""
    if judgement.outcome != "a law is":
        return ""
    parts = shares(judgement)
    turning = parts.get("angle", 0.0) + parts.get("turning", 0.0)
    others = {"turning": turning, "time": parts.get("time", 0.0), "speed": parts.get("square", 0.0)}
    what = max(others, key=lambda name: _gain(judgement, name))
    return f" What is missing is {what}: {100.0 * others[what]:.0f} % of the energy."


def _gain(judgement: Judgement, name: str) -> float:
    """By how much a term of that name brings the nested laws nearer, in mean error."""
    mine = {"turning": ("angle", "turning"), "time": ("time",), "speed": ("square",)}[name]
    laws = [judged for judged in judgement.nested if judged.family == "motion"]
    gain = 0.0
    for before, after in pairwise(laws):
        if after.terms[-1] in mine:
            gain += float(
                np.abs(before.left_out.errors).mean() - np.abs(after.left_out.errors).mean()
            )
    return gain


def shares(judgement: Judgement) -> dict[str, float]:
    """The share of all energy that each term of the law by motion explains."""
    laws = [judged for judged in judgement.nested if judged.family == "motion"]
    law, windows = laws[-1].law, judgement.motion.windows
    whole = float(windows.energy.sum())
    return {
        term: value * float(windows.term(term).sum()) / whole
        for term, value in zip(law.terms, law.coefficients, strict=True)
    }


def outcome_sentences(judgement: Judgement) -> list[str]:
    """What follows from the outcome, and what would settle what is open."""
    found = []
    if judgement.outcome == "no law is":
        low, middle, high = np.quantile(per_metre_by_run(judgement), [0.1, 0.5, 0.9])
        found.append(
            "What varies is the ground, or the robot, from run to run: runs take"
            f" {low:.0f} to {high:.0f} J/m (8 of 10), half of them less than {middle:.0f}; use no"
            " preset without that spread."
        )
    if judgement.by_trip == "cannot tell":
        found.append(_how_many(judgement))
    better = judgement.better
    found.append(
        f"The chosen law is nearer by {_points(better)} points of error a trip"
        " than distance alone (95 % by run)."
    )
    found += [f"Not fitted: {NAMES[term]}: {why}." for term, why in judgement.motion.why.items()]
    if judgement.motion.samples.regrouped:
        found.append(f"{_capital(judgement.motion.samples.regrouped)}.")
    if judgement.reading:
        found.append(f"{_capital(judgement.reading)}.")
    if judgement.ground.drive_only:
        found.append(f"{_capital(electronics_sentence(judgement))}.")
    return [minus(text) for text in found]


def _how_many(judgement: Judgement) -> str:
    share = judgement.linear.within(judgement.band)
    have = len(judgement.linear.energy)
    least = trips_needed(1.0, "holds")
    answer: Literal["holds", "fails"] = "holds" if share >= NEEDED else "fails"
    needed = trips_needed(share, answer)
    text = (
        f"Without a miss it takes {least} independent trips to say that it holds; there are {have}."
    )
    if needed is not None and needed > have:
        text += (
            f" At {100.0 * share:.0f} % within {100.0 * judgement.band:g} % it takes about"
            f" {needed} to"
            f" say that it {_ANSWERS[answer]}; log more runs, on more days."
        )
    else:
        text += " Log them in more runs, on more days: trips of one run are no independent ones."
    return text


def per_metre_by_run(judgement: Judgement) -> np.ndarray:
    """What each run takes a metre [J/m], over its trips."""
    trips = judgement.trips
    runs, index = np.unique(trips.run, return_inverse=True)
    return np.bincount(index, trips.energy, len(runs)) / np.bincount(index, trips.metres, len(runs))


def summary_sentence(judgement: Judgement) -> str:
    """How much was logged."""
    windows, runs = judgement.motion.windows, judgement.ground.runs
    seconds = sum(run.duration for run in runs)
    metres, energy = float(windows.metres.sum()), float(windows.energy.sum())
    driven = float(judgement.motion.samples.step.sum())
    angle = float(windows.term("angle").sum())
    files = len(judgement.ground.files)
    text = (
        f"{files} {'run' if files == 1 else 'runs'}, {seconds:.0f} s, {driven:.0f} s of them"
        f" driving,"
        f" {metres:.0f} m, {energy:.0f} J: {energy / driven:.3g} W, {energy / metres:.3g} J/m,"
        f" {angle / metres:.2f} rad/m"
    )
    standing = judgement.motion.samples.standing
    if np.isfinite(standing):
        text += f"; {standing:.3g} W while standing ({judgement.motion.samples.stood:.0f} s)"
    return text


def minus(text: str) -> str:
    """Text with minus signs for the hyphens before numbers."""
    return re.sub(r"(?<![\w])-(?=\d)", "−", text)


def _percent(interval: Interval) -> str:
    value, low, high = (100.0 * part for part in interval)
    return f"{value:.0f} % [{low:.0f}, {high:.0f}]"


def _signed(interval: Interval) -> str:
    value, low, high = (100.0 * part for part in interval)
    return f"{value:+.1f} % [{low:+.1f}, {high:+.1f}]"


def _points(interval: Interval) -> str:
    value, low, high = (100.0 * part for part in interval)
    return f"{value:.0f} [{low:.0f}, {high:.0f}]"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
