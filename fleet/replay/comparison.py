"""Recordings arranged anew: several in one, under one cursor, or one that shows some event."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from string import ascii_lowercase
from typing import NamedTuple

import numpy as np
import rerun as rr

from fleet.replay import scheme
from fleet.replay.blueprint import Span, Stage, blueprint, side_by_side
from fleet.replay.columns import Index, column, doubles
from fleet.replay.parting import Parting, differing, parting
from fleet.replay.readback import NANO, Recording, sound
from fleet.replay.scheme import APPLICATION, COMPARISON, ROUND, STORY

MOST = 6  # recordings side by side
LINE_COLOURS = (0x56B4E9FF, 0xE69F00FF, 0x1FBF8FFF, 0xF0E442FF, 0xCC79A7FF, 0xD55E00FF)
CURVES = {  # of each recording in one plot: what is plotted, and which of its figures
    scheme.COMPARED_ENERGY: (scheme.FLEET_ENERGY, slice(0, 1)),
    scheme.COMPARED_TOTAL: (scheme.TOTAL_ENERGY, slice(1, 2)),
    scheme.COMPARED_MESSAGES: (scheme.FLEET_MESSAGES, slice(None)),
    scheme.COMPARED_ON_AIR: (scheme.ON_AIR, slice(None)),
}
DIFFERENCES = {  # of a recording to the first, so far
    scheme.DIFFERENCE_ENERGY: (scheme.TOTAL_ENERGY, slice(1, 2)),
    scheme.DIFFERENCE_MESSAGES: (scheme.FLEET_MESSAGES, slice(None)),
}
MOST_SETTINGS = 3  # that a recording is named by


class Aim(NamedTuple):
    """What of a recording is looked at."""

    event: int | None = None  # as it is shown, from 1
    robot: int | None = None


def arrange(
    recordings: Sequence[Path], out: Path, timeline: str | None = None, aim: Aim | None = None
) -> None:
    """Write recordings into one, side by side; or a single one, to be scrubbed by ``timeline``, or
    framed to show what is aimed at.

    Raises:
        ValueError: there are none or too many, or one of them cannot be read, or what is aimed at
            is not in it.
    """
    if not 1 <= len(recordings) <= MOST:
        raise ValueError(f"{len(recordings)} recordings to compare; expected 1 to {MOST}")
    loaded = [sound(path) for path in recordings]
    single, aim = len(loaded) == 1, aim or Aim()
    if single:
        stage, span = framed(loaded[0], aim)
        stages, layout = [stage], blueprint(stage, timeline or STORY, span)
    elif aim != Aim():
        raise ValueError("an event or a robot is looked at in one recording; expected one")
    else:
        stages = [
            _stage(recording, f"{letter}/")._replace(name=name)
            for recording, letter, name in zip(loaded, ascii_lowercase, names(loaded), strict=False)
        ]
        layout = side_by_side(stages, timeline or ROUND)
    key = "+".join(recording.key for recording in loaded)
    sink = rr.RecordingStream(
        APPLICATION if single else COMPARISON, recording_id=key, send_properties=False
    )
    sink.save(out, default_blueprint=layout)
    sink.send_recording_name(" | ".join(stage.name for stage in stages))
    for recording, stage in zip(loaded, stages, strict=True):
        sink.send_chunks(
            [
                chunk.with_entity_path(stage(chunk.entity_path.removeprefix("/")))
                for chunk in recording.chunks
                if not chunk.entity_path.startswith("/__properties")
            ]
        )
    if not single:
        for k, (recording, stage) in enumerate(zip(loaded, stages, strict=True)):
            _send_curves(sink, recording, stage, LINE_COLOURS[k])
        for recording, letter in zip(loaded[1:], ascii_lowercase[1:], strict=False):
            _send_differences(sink, loaded[0], recording, letter)
        words = "\n\n".join(parting(loaded[0], recording).markdown() for recording in loaded[1:])
        text = rr.TextDocument(words, media_type=rr.MediaType.MARKDOWN)
        sink.log(scheme.DIFFERENCE, text, static=True)
    sink.flush()
    sink.disconnect()


def framed(recording: Recording, aim: Aim) -> tuple[Stage, Span | None]:
    """The stage with the view around what is aimed at, and when on the story that is."""
    stage = _stage(recording, "")
    if aim.robot is not None and not 0 <= aim.robot < recording.properties["scene"]["robots"]:
        last = recording.properties["scene"]["robots"] - 1
        raise ValueError(f"{recording.path}: there is no robot {aim.robot}; expected 0 to {last}")
    if aim == Aim():
        return stage, None
    lines = recording.table(scheme.TRANSCRIPT).to_pylist()
    trips = recording.table(scheme.TRIPS).to_pylist()
    event = aim.event
    if event is None:
        event = next((trip["event"] for trip in trips if trip["robot"] == aim.robot), None)
        if event is None:
            raise ValueError(f"{recording.path}: robot {aim.robot} never drove")
    tasks = {task["event"]: task for task in recording.table(scheme.TASKS).to_pylist()}
    if event not in tasks:
        raise ValueError(
            f"{recording.path}: there is no event {event}; expected 1 to {max(tasks, default=0)}"
        )
    robots = {
        r for line in lines if line["event"] == event for r in (line["sender"], *line["heard"])
    }
    span = _span(recording, event)
    places = recording.at(scheme.ROBOTS, "Points2D:positions", STORY, span.start)
    spots = np.array(
        [(tasks[event]["told_x"], tasks[event]["told_y"])]
        + [place for place in np.asarray(places)[sorted(robots)].tolist() if place[0] == place[0]]
    )
    margin = 0.06 * max(stage.width, stage.height)
    low, high = spots.min(axis=0) - margin, spots.max(axis=0) + margin
    return stage._replace(frame=(*low.tolist(), *high.tolist())), span


def _span(recording: Recording, event: int) -> Span:
    """From when an event is told to a robot to when it is over, on the story."""
    rows = recording.rows(scheme.LOG, "TextLog:text")
    mine = [
        moment / NANO
        for text, moment in zip(rows.values, rows.moments[STORY].tolist(), strict=True)
        if str(text[0]).startswith(f"event {event}: ")
    ]
    if not mine:
        raise ValueError(f"{recording.path}: no robot was told of event {event}")
    return Span(mine[0], mine[-1] + scheme.PAUSE)


def comparison(one: Path, other: Path) -> Parting:
    """Where two recordings part, and how they differ from there on.

    Raises:
        ValueError: one of them cannot be read.
    """
    return parting(sound(one), sound(other))


def _send_curves(sink: rr.RecordingStream, recording: Recording, stage: Stage, colour: int) -> None:
    """One figure of a recording under a path of its own, named as the recording is."""
    for path, (source, figures) in CURVES.items():
        rows = recording.rows(source, "Scalars:scalars")
        values = [float(np.sum(np.asarray(row)[figures])) for row in rows.values]
        moments = rows.moments
        when = Index(
            moments[scheme.SIM_TIME] / NANO, moments[ROUND], moments[scheme.MSG],
            moments[STORY] / NANO,
        )  # fmt: skip
        style = rr.SeriesLines.from_fields(names=[stage.name], colors=[colour], widths=[2.0])
        sink.log(stage(path), style, static=True)
        scalars = column(rr.Scalars.descriptor_scalars(), doubles(values))
        sink.send_columns(stage(path), when.columns(), [scalars])


def _send_differences(
    sink: rr.RecordingStream, first: Recording, other: Recording, letter: str
) -> None:
    """How much more than the first run another has taken so far, round by round."""
    for path, (source, figures) in DIFFERENCES.items():
        totals = [_so_far(run, source, figures) for run in (first, other)]
        shared = [k for k in totals[0] if k in totals[1]]
        if not shared:
            continue
        rows = [totals[0][k][0] for k in shared]
        values = [totals[1][k][1] - totals[0][k][1] for k in shared]
        times, msgs, stories = (np.array(part) for part in zip(*rows, strict=True))
        when = Index(times / NANO, np.array(shared), msgs, stories / NANO)
        style = rr.SeriesLines.from_fields(
            names=[f"{letter} − a"], colors=[LINE_COLOURS[ord(letter) - ord("a")]], widths=[2.0]
        )
        sink.log(f"{path}/{letter}", style, static=True)
        scalars = column(rr.Scalars.descriptor_scalars(), doubles(values))
        sink.send_columns(f"{path}/{letter}", when.columns(), [scalars])


def _so_far(
    run: Recording, source: str, figures: slice
) -> dict[int, tuple[tuple[int, int, int], float]]:
    """By round: its last moment, and what has been counted until then."""
    rows = run.rows(source, "Scalars:scalars")
    values = [float(np.sum(np.asarray(row)[figures])) for row in rows.values]
    if source == scheme.FLEET_MESSAGES:  # counted for each event, not for all
        values = np.cumsum(values).tolist()
    moments = rows.moments
    three = (moments[name].tolist() for name in (scheme.SIM_TIME, scheme.MSG, STORY))
    when = list(zip(*three, strict=True))
    return dict(zip(moments[ROUND].tolist(), zip(when, values, strict=True), strict=True))


def names(recordings: Sequence[Recording]) -> list[str]:
    """What tells recordings apart: their titles, and if those do not, what of their scenarios
    does, or their files.
    """
    titles = [recording.properties["scene"].get("title", "") for recording in recordings]
    if len(set(titles)) == len(titles):
        return titles
    unlike = sorted({name for other in recordings[1:] for name in differing(recordings[0], other)})
    tails = [
        " · ".join(f"{n} {recording.properties['run'].get(n)}" for n in unlike[:MOST_SETTINGS])
        for recording in recordings
    ]
    if len(set(zip(titles, tails, strict=True))) < len(titles):
        tails = [recording.path.stem for recording in recordings]
    return [f"{title} · {tail}" for title, tail in zip(titles, tails, strict=True)]


def _stage(recording: Recording, root: str) -> Stage:
    scene = recording.properties["scene"]
    radii = recording.static(scheme.ROBOTS, "Points2D:radii")
    if radii is None or "title" not in scene:
        raise ValueError(f"{recording.path}: recorded by another version; record the run again")
    return Stage(
        scene["width"], scene["height"], float(radii[0]), scene["capacity"],
        scene["title"], root,
    )  # fmt: skip
