"""Real bodies on recorded commands: whether a preset's robot, driven by forces, costs as much."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fleet.logs.grounds import LoggedRun
from fleet.logs.judging import Judgement, folds
from fleet.logs.presets import preset_keys
from fleet.logs.sampling import SHORTEST_TRIP, TERMS
from fleet.power import ExtraPower, PowerModel
from fleet.robot import RobotSpec

Floats = NDArray[np.float64]

MOST = 600.0  # [s] of drives that bodies are sent through
_STEP = 1.0 / 60.0  # [s]


@dataclass(frozen=True, slots=True)
class Redriven:
    """Drives of runs that were left out, from standing to standing, (k,) each."""

    seconds: float  # in all
    measured: Floats  # [J]
    law: Floats  # by forces [J]
    body: Floats  # what the body took [J]
    arrived: NDArray[np.bool_]  # it could follow to the end


def robot_of(judgement: Judgement) -> RobotSpec:
    """The robot of a preset, without computers that the log leaves out."""
    settings = replace(judgement.ground.settings, electronics=0.0)
    bare = replace(judgement, ground=replace(judgement.ground, settings=settings))
    values: dict[str, dict[str, float]] = {"": {}, "power": {}, "extra": {}}
    for key in preset_keys(bare):
        values[key.section][key.key] = key.value
    return RobotSpec(
        **values[""],  # type: ignore[arg-type]  # all keys of a preset are numbers
        power=PowerModel(**values["power"]),
        extra=ExtraPower(**values["extra"]),
    )


def redrive(judgement: Judgement, most: float = MOST) -> Redriven:
    """Send bodies through recorded drives, each made without the run that it drives.

    As many drives of a metre or more, evenly over the log, as take ``most`` [s] in all.
    """
    from fleet.motion.commanded import drive_commanded

    samples, sums = judgement.forces.samples, judgement.forces.sums
    spans = list(_drives(judgement))
    far = np.flatnonzero(np.bincount(samples.drive, samples.metres) >= SHORTEST_TRIP)
    lasts = np.array([high - low for _, low, high in spans])
    if len(far):
        far = far[:: max(1, int(np.ceil(lasts[far].sum() / most)))]
    run_of = dict(zip(samples.drive.tolist(), samples.run.tolist(), strict=True))
    measured = np.bincount(samples.drive, samples.energy)
    rows = []
    for among in folds(judgement.forces):
        law = judgement.forces.law(judgement.preset.terms, among)
        spec = robot_of(replace(judgement, preset=replace(judgement.preset, law=law)))
        out = {sums.runs[k] for k in np.flatnonzero(~among if not among.all() else among)}
        for drive in far:
            if run_of[int(drive)] in out:
                body = drive_commanded(spec, *_commands(*spans[drive]))
                mine = samples.drive == drive
                said = samples.terms[mine].sum(0) @ [law[term] for term in TERMS]
                rows.append((measured[drive], said + samples.rest[mine].sum(), *body))
    table = np.array(rows, float).reshape(-1, 5)
    return Redriven(
        float(lasts[far].sum()), table[:, 0], table[:, 1], table[:, 2], table[:, 4] > 0.0
    )


def _drives(judgement: Judgement) -> Iterator[tuple[LoggedRun, float, float]]:
    """Each drive's run, begin and end [s], in the order of the samples."""
    for reader in judgement.forces.samples.readers:
        edges = np.flatnonzero(np.diff(np.r_[False, reader.driven, False].astype(np.int8)))
        at = reader.run.meter - reader.lag
        for first, after in zip(edges[::2], edges[1::2], strict=True):
            low = at[first] - 0.5 * reader.step[first]
            yield reader.run, float(low), float(at[after - 1] + 0.5 * reader.step[after - 1])


def _commands(run: LoggedRun, low: float, high: float) -> tuple[Floats, Floats]:
    """Speeds and turning rates of a drive, step by step."""
    at = np.arange(low, high, _STEP) + 0.5 * _STEP
    return np.interp(at, run.time, run.v), np.interp(at, run.time, run.omega)


def redriven_sentence(bodies: Redriven) -> str:
    """How near bodies come to what was measured, and to what the law says."""
    if not len(bodies.measured):
        return "No body was driven: the log has no drive of a metre or more."
    error = _percent(float(np.median(np.abs(bodies.body / bodies.measured - 1.0))))
    apart = _percent(float(np.median(np.abs(bodies.body / bodies.law - 1.0))))
    total = 100.0 * float(bodies.body.sum() / bodies.measured.sum() - 1.0)
    lost = int(np.count_nonzero(~bodies.arrived))
    text = (
        f"Such bodies, driven by forces on the recorded speeds of {len(bodies.measured)} drives"
        f" ({bodies.seconds:.0f} s), take what was measured within {error} in half of them, in"
        f" total {total:+.1f} %; half are within {apart} of what the law says"
    )
    return text + (f"; {lost} could not follow to the end." if lost else ".")


def _percent(value: float) -> str:
    return f"{100.0 * value:.1f} %"
