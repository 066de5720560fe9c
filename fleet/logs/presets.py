"""A robot for scenarios, made from what a log says: ``fleet run --robot preset.toml``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fleet.logs.forces import Chassis, wheel_forces
from fleet.logs.judging import Judgement
from fleet.logs.sampling import TERMS
from fleet.study.statistics import Interval

Floats = NDArray[np.float64]

_RESERVE = 1.5  # what wheels can push, of the most they pushed in the log
_ROUNDED = 1.0 + 3e-5  # so that what heat takes at standstill is still less, written in six digits
_METRES = 100.0  # that the battery lasts for; no log tells its capacity


@dataclass(frozen=True, slots=True)
class PresetKey:
    """One key of a preset, and what is known of it."""

    section: str  # "" or "power", "extra"
    key: str
    value: float
    unit: str
    interval: Interval | None = None
    note: str = ""


def power_coefficients(chassis: Chassis, parameters: Floats) -> tuple[Floats, Floats]:
    """What a robot of forces ``parameters`` (5,) takes when it drives straight and steadily.

    P(v) = c₂·v² + c₁·v + c₀; returns (c₂, c₁, c₀), and the shares of these that the parameters
    enter with, (3, 5).
    """
    rolling, constant, _, _, viscous = parameters
    heat, gain = chassis.windings, 1.0 / chassis.efficiency
    coefficients = np.array([
        viscous * gain + 0.5 * heat * viscous**2,
        rolling * (gain + heat * viscous),
        constant + 0.5 * heat * rolling**2,
    ])  # fmt: skip
    slopes = np.zeros((3, 5))
    slopes[0, 4] = gain + heat * viscous
    slopes[1, 0], slopes[1, 4] = gain + heat * viscous, heat * rolling
    slopes[2, 1], slopes[2, 0] = 1.0, heat * rolling
    return coefficients, slopes


def preset_keys(judgement: Judgement) -> list[PresetKey]:
    """The keys of ``[robot]`` that the log tells, with 95 % intervals by run."""
    chassis, law = judgement.chassis, judgement.preset.law
    settings, samples = judgement.ground.settings, judgement.forces.samples
    parameters = np.array([law[term] for term in TERMS])
    known = judgement.preset_intervals
    low, high = (
        np.array([getattr(known[t], end) if t in known else law[t] for t in TERMS])
        for end in ("low", "high")
    )
    value = power_coefficients(chassis, parameters)[0]
    bounds = zip(
        *(power_coefficients(chassis, np.maximum(end, 0.0))[0] for end in (low, high)), strict=True
    )
    of_power = [
        Interval(float(x), float(a), float(b)) for x, (a, b) in zip(value, bounds, strict=True)
    ]
    extra = settings.electronics
    constant = Interval(*(x * _ROUNDED + extra for x in of_power[2]))
    told_mass = "" if settings.mass is not None else "not told: --mass KG"
    told_track = "" if settings.track is not None else "not told: --track M"
    standing = max(0.0, samples.standing) if np.isfinite(samples.standing) else 0.0
    speeds = np.concatenate([np.abs(run.v) for run in judgement.ground.runs])
    return [
        PresetKey("", "radius", chassis.half_track, "m", note="half the track; put in the"
                                                              " robot's own"),
        PresetKey("", "mass", chassis.mass, "kg", note=told_mass),
        PresetKey("", "track", 2.0 * chassis.half_track, "m", note=told_track),
        PresetKey("", "inertia", chassis.inertia, "kg·m²", note="a disc's of that track"),
        PresetKey("", "cruise", float(np.quantile(speeds, 0.9)), "m/s", note="9 of 10 samples"
                                                                             " are slower"),
        PresetKey("", "motor", _strongest(judgement, parameters), "N",
                  note=f"{_RESERVE:g} times the most that a wheel pushed"),
        PresetKey("", "efficiency", chassis.efficiency, "",
                  note="motor constants are told: losses are in the others" if settings.motor
                  else "not from the log"),
        PresetKey("", "windings", chassis.windings, "W/N²",
                  note="R/k²" if settings.motor else "not from the log"),
        PresetKey("", "scrub", law["angle"], "N·m", known.get("angle"), _why(judgement, "angle")),
        PresetKey("", "scrub_onset", chassis.scrub_onset, "rad/m",
                  note="told" if settings.scrub_onset is not None else "of 0.4 and 100, what fits"),
        PresetKey("", "turning", law["turning"], "W", known.get("turning"),
                  _why(judgement, "turning")),
        PresetKey("", "capacity", _capacity(judgement), "J",
                  note=f"{_METRES:g} m of such driving; put in the battery's own"),
        PresetKey("power", "quadratic", of_power[0].value, "W·s²/m²", of_power[0],
                  _why(judgement, "square")),
        PresetKey("power", "linear", of_power[1].value, "W·s/m", of_power[1]),
        PresetKey("power", "constant", constant.value, "W", constant, _on_constant(judgement)),
        PresetKey("extra", "idle", standing + extra, "W",
                  note=_on_standing(judgement)),
    ]  # fmt: skip


def _why(judgement: Judgement, term: str) -> str:
    if term in judgement.preset.terms:
        return ""
    return f"not fitted: {judgement.forces.why.get(term, 'cannot be told apart')}"


def _on_constant(judgement: Judgement) -> str:
    samples, ground = judgement.forces.samples, judgement.ground
    if "time" not in judgement.preset.terms:
        return f"not fitted: {judgement.forces.why['time']}"
    if ground.drive_only:
        return electronics_sentence(judgement)
    if not np.isfinite(samples.standing):
        return "never stands: an offset of the current's sensor would be in here"
    if ground.settings.offset is None and abs(samples.standing) > 1e-3:
        return (
            f"{samples.standing:.3g} W is read at standstill too: what standing costs, or the"
            f" sensor's"
            " offset (then --offset A)"
        )
    return ""


def electronics_sentence(judgement: Judgement) -> str:
    """What is said of computers where only a drive's power is logged."""
    extra = judgement.ground.settings.electronics
    if extra:
        return f"with {extra:g} W of computers, as told"
    return "the computers' constant power is not in this log: --electronics W"


def _on_standing(judgement: Judgement) -> str:
    samples = judgement.forces.samples
    if not np.isfinite(samples.standing):
        return "never stands"
    return f"median over {samples.stood:.0f} s of standing"


def _strongest(judgement: Judgement, parameters: Floats) -> float:
    most = [
        np.quantile(np.abs(force), 0.999)
        for run in judgement.ground.runs
        for force in wheel_forces(judgement.chassis, run.time, run.v, run.omega, parameters)
    ]
    return max(1.0, _RESERVE * float(max(most)))


def _capacity(judgement: Judgement) -> float:
    trips = judgement.trips
    return float(_METRES * trips.energy.sum() / trips.metres.sum())


def preset_text(judgement: Judgement, head: Sequence[str]) -> str:
    """The preset as TOML; intervals and what is known of each key are comments."""
    lines = [f"# {line}" for line in head]
    section = ""
    for key in preset_keys(judgement):
        if key.section != section:
            section = key.section
            lines += ["", f"[{section}]"]
        comment = f"  # {key.unit}" if key.unit else "  #"
        if key.interval is not None:
            comment += f" [{_short(key.interval.low)}, {_short(key.interval.high)}]"
        comment += f" {key.note}" if key.note else ""
        lines.append(f"{key.key} = {_number(key.value)}{comment if comment.strip() != '#' else ''}")
    return "\n".join(lines) + "\n"


def _short(value: float) -> str:
    return f"{value:.4g}" if np.isfinite(value) else "?"


def _number(value: float) -> str:
    """A float of six digits, as TOML has it."""
    text = f"{value:.6g}"
    return text if any(mark in text for mark in ".en") else f"{text}.0"
