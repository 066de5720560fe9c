"""What the study says in the end, in numbers and in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, isinf

import numpy as np

from fleet.experiments.energy.accuracy import Accuracy, accuracy, ratio_interval
from fleet.experiments.energy.launching import launch_cost
from fleet.experiments.energy.linearity import TOLERABLE, Linearity, linearity
from fleet.experiments.energy.lives import BASELINE, Life, find
from fleet.experiments.energy.models import CORRECTED, EQ1, fit, held_out
from fleet.experiments.energy.settings import (
    AS_IN_THE_PAPER,
    HUSKIES,
    OPEN,
    PROTOCOLS,
    Subject,
)
from fleet.experiments.energy.trip_table import TripTable, closure
from fleet.study.statistics import Interval

WORLDS = ("pit", "rooms", "warehouse")  # with things to drive around
LONG = 3.5  # [m] of trips that are long
SOURCES = {
    "path": "Eq. (1) on the planned path",
    "corrected": "the corrected model",
    "driven": "the whole drive, foreseen,",
}
CLOSED = 1e-3  # share of its energy that a trip's parts may leave unexplained


@dataclass(frozen=True, slots=True)
class Findings:
    """The study in a few numbers. Ratios are of what was drained to what Eq. (1) says."""

    paper: Linearity  # of single trips of the robot in which nothing is varied
    floor: str  # over which they went, as it is said
    skid: Linearity | None  # of a robot that steers by skidding
    longest: float  # that was driven [m]
    asked: Interval  # ratio over the trips of lifetimes on the open floor
    asked_trips: int
    asked_mean: float  # their straight distance [m]
    by_protocol: Mapping[str, float]  # their ratio
    by_world: Mapping[str, float]  # ratio of long single tasks among obstacles
    launch: Interval  # [J]
    launch_formula: float  # by the drive law [J]
    corrected: Accuracy  # of Eq. (1) on the planned path and a launch, on held-out placements
    eq1: Accuracy  # of Eq. (1), on the same
    asked_corrected: Accuracy  # the two of them, on the trips of lifetimes
    asked_eq1: Accuracy
    overrated: Mapping[str, float]  # lifetime by Eq. (1) alone over that of driving robots
    closure: float  # largest share of a trip's energy that its parts leave unexplained
    trips: int  # over which that was checked


def findings(
    single: TripTable,
    streams: TripTable,
    lived: TripTable,
    listed: Sequence[Life],
    subject: Subject,
) -> Findings:
    """From the trips of single tasks, streams and lifetimes, and the lifetimes themselves."""
    paper = single.where(setting=subject.name).arrived()
    skid = single.where(setting=HUSKIES).arrived()
    asked = lived.where(place=subject.places[0].name).arrived()
    long = single.take(single["straight"] >= LONG).arrived()
    return Findings(
        paper=linearity(paper),
        floor=subject.floor,
        skid=linearity(skid) if len(skid) else None,
        longest=float(paper["straight"].max()),
        asked=ratio_interval(asked["drained"], asked.eq1, asked["seed"]),
        asked_trips=len(asked),
        asked_mean=float(np.mean(asked["straight"])),
        by_protocol=_ratios({name: asked.where(protocol=name) for name in PROTOCOLS}),
        by_world=_ratios({name: long.where(setting=name) for name in WORLDS}),
        launch=fit(CORRECTED, paper).coefficients[0],
        launch_formula=launch_cost(subject.spec),
        corrected=held_out(CORRECTED, paper)[1],
        eq1=held_out(EQ1, paper)[1],
        asked_corrected=accuracy(asked["drained"], fit(CORRECTED, paper).predict(asked)),
        asked_eq1=accuracy(asked["drained"], asked.eq1),
        overrated={
            life.protocol: life.means["lifetime"].value / driven.means["lifetime"].value
            for life in listed
            if life.bids == AS_IN_THE_PAPER
            and (driven := find(listed, life.place, life.protocol, BASELINE))
        },
        closure=max(closure(trips) for trips in (single, streams, lived)),
        trips=len(single) + len(streams) + len(lived),
    )


def verdict(found: Findings) -> str:
    """When the linear assumption may be used and when not, from what was measured."""
    bounds = [bound for bound in found.asked if isfinite(bound)]
    fits = max(abs(1.0 / bound - 1.0) for bound in bounds) <= TOLERABLE
    one = found.paper
    line = f"a line of its own, {one.intercept.value:.1f} J and {one.slope.value:.1f} J a metre,"
    return (
        f"Energy is {_kind(one)}. Eq. (1) has no intercept: over {found.floor}"
        f" {_usable(one.within_10, 'a tenth', found.longest)}, and"
        f" {_usable(one.within_5, 'a twentieth', found.longest)}; {line} is within"
        f" {100.0 * one.line_off:.0f} % at all lengths (R² {one.r2:.3f})."
        f" {_on_skid(found.skid)}"
        f"Eq. (1) may {'' if fits else 'not '}be used for what the protocols ask for: the"
        f" {found.asked_trips:,} trips, {found.asked_mean:.2f} m long on average, by which robots"
        f" arrived in whole lifetimes drained {_more(found.asked.value)} than it says. Eq. (1) on"
        f" the planned path and {found.launch.value:.1f} J a launch has R² ="
        f" {found.corrected.r2:.4f} on tasks that this was not fitted on."
    ).replace("-", "−")


def _kind(one: Linearity) -> str:
    proportional = one.within_10 == 0.0
    if one.linear:
        return "linear in the straight distance" + (
            ", and proportional to it, within a tenth"
            if proportional
            else ", but not proportional to it"
        )
    return "neither linear in the straight distance nor proportional to it"


def _on_skid(skid: Linearity | None) -> str:
    if skid is None:
        return ""
    return (
        f"Of a robot that steers by skidding (husky) it is {_kind(skid)}: the best line is off"
        f" by up to {100.0 * skid.line_off:.0f} % (R² {skid.r2:.2f}), and Eq. (1) has R²"
        f" {skid.eq1_r2:.2f}. "
    )


def details(found: Findings) -> list[str]:
    """What else there is to know, a sentence or two each."""
    by_protocol = (
        f"The trips of lifetimes drained {found.asked.value:.3f} times what it says"
        f" [{found.asked.low:.3f}, {found.asked.high:.3f}]; by protocol:"
        f" {_listed(found.by_protocol)}."
    )
    left_out = (
        f"What Eq. (1) leaves out comes with every launch, not with every metre: turning, speeding"
        f" up and braking cost {found.launch.value:.2f} J"
        f" [{found.launch.low:.2f}, {found.launch.high:.2f}], however short the way"
        f" ({found.launch_formula:.2f} J foreseen for a straight drive)."
    )
    corrected = (
        f"With a launch added, and the planned path for the straight line, it is off by"
        f" {found.corrected.rmse:.2f} J (RMSE; R² {found.corrected.r2:.4f}) on tasks that it was"
        f" not fitted on, and by {found.asked_corrected.rmse:.2f} J"
        f" ({found.asked_corrected.r2:.4f}) on the protocols’ trips. As it stands it is off by"
        f" {found.eq1.rmse:.2f} J ({found.eq1.r2:.3f}) and {found.asked_eq1.rmse:.2f} J"
        f" ({found.asked_eq1.r2:.3f})."
    )
    said = [
        by_protocol,
        left_out,
        corrected,
    ]
    if found.by_world:
        worlds = f"Among obstacles, trips of {LONG:g} m and more drained"
        said.insert(1, f"{worlds}: {_listed(found.by_world)}.")
    if found.overrated:
        ratios = ", ".join(f"{name} {ratio:.2f}" for name, ratio in found.overrated.items())
        said.append(
            f"Networks simulated with Eq. (1) alone live longer than those that drive: {ratios}"
            f" times."
        )
    return [sentence.replace("-", "−") for sentence in said]


def on_bids(listed: Sequence[Life], place: str = OPEN) -> str:
    """What bids by the corrected model are worth in a place."""
    said, changes = [], []
    for protocol in PROTOCOLS:
        base, other = (find(listed, place, protocol, bids) for bids in (BASELINE, "corrected"))
        if base is None or other is None:
            continue
        before, after = base.means, other.means
        said.append(
            f"{protocol} {before['failed'].value:.1f} and {after['failed'].value:.1f} a lifetime,"
            f" {before['unbroken'].value:.0f} and {after['unbroken'].value:.0f} events before the"
            f" first"
        )
        changes.append(_gain(other))
    if not said:
        return ""
    tried = [bids for bids in SOURCES if any(life.bids == bids for life in listed)]
    return (
        "Some robots set out and do not arrive, their battery being empty. If they bid by Eq. (1),"
        f" and if by the corrected model, in the place “{place}”: {'; '.join(said)}. The lifetime,"
        f" up to the first event that nobody takes, changes by {min(changes):+.0f} % to"
        f" {max(changes):+.0f} %. It is no measure of this: if a robot dies on its way another one"
        " is sent, and the event counts as served, so whoever takes a chance lives longer by it."
        f" Over all places and protocols {'; '.join(_changed(listed, bids) for bids in tried)}:"
        " cases whose interval leaves out 0, as that of one in twenty would by chance."
    ).replace("-", "−")


def _changed(listed: Sequence[Life], bids: str) -> str:
    """How often the lifetime is another one than with bids by Eq. (1), and where the most."""
    mine = [life for life in listed if life.bids == bids]
    longer = [life for life in mine if life.differences["lifetime"].low > 0.0]
    shorter = sum(life.differences["lifetime"].high < 0.0 for life in mine)
    best = max(longer, key=_gain, default=None)
    most = (
        "" if best is None else f", at most by {_gain(best):.0f} % ({best.place}, {best.protocol})"
    )
    return (
        f"bids by {SOURCES[bids]} make it longer in {len(longer)} of {len(mine)} cases{most}, and"
        f" shorter in {shorter}"
    )


def _gain(life: Life) -> float:
    """By how much the lifetime is longer than with bids by Eq. (1) [%]."""
    change = life.differences["lifetime"].mean
    return 100.0 * change / (life.means["lifetime"].value - change)


def on_closure(found: Findings) -> str:
    """Whether the parts add up."""
    verdict = "add up to" if found.closure <= CLOSED else "do NOT add up to"
    return (
        f"Over all {found.trips:,} trips the parts {verdict} what the batteries lost: the largest"
        f" gap is {found.closure:.0e} of a trip’s energy, where {CLOSED:g} is tolerated."
    ).replace("e-", "e−")


def _usable(distance: float, tolerance: str, longest: float) -> str:
    if isinf(distance):
        return f"it is nowhere within {tolerance}, up to {longest:.0f} m"
    return f"from {distance:g} m on it is within {tolerance} of what is drained"


def _listed(ratios: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {_more(ratio)}" for name, ratio in ratios.items())


def _ratios(trips: Mapping[str, TripTable]) -> dict[str, float]:
    return {n: accuracy(some["drained"], some.eq1).ratio for n, some in trips.items() if len(some)}


def _more(ratio: float) -> str:
    return f"{100.0 * abs(ratio - 1.0):.0f} % {'more' if ratio >= 1.0 else 'less'}"
