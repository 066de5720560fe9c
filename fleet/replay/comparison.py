"""Recordings arranged anew: several in one, under one cursor, or one that shows some event."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from string import ascii_lowercase
from typing import Any, NamedTuple

import numpy as np
import rerun as rr

from fleet.replay import scheme
from fleet.replay.blueprint import Span, Stage, blueprint, side_by_side
from fleet.replay.columns import Index, column, doubles
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
        stages = [_stage(r, f"{x}/") for r, x in zip(loaded, ascii_lowercase, strict=False)]
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
        text = rr.TextDocument(difference(*loaded[:2]), media_type=rr.MediaType.MARKDOWN)
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


def difference(one: Recording, other: Recording) -> str:
    """Where two runs part, event by event, and how they differ from there on: Markdown."""
    first = {task["event"]: task for task in one.table(scheme.TASKS).to_pylist()}
    second = {task["event"]: task for task in other.table(scheme.TASKS).to_pylist()}
    names = f"`{one.path.name}` and `{other.path.name}`"
    shared = sorted(first.keys() & second.keys())
    parted = next((e for e in shared if _signature(first[e]) != _signature(second[e])), None)
    if parted is None:
        more = f" {names} have {len(first)} and {len(second)} events." * (len(first) != len(second))
        return f"## They never part\n\nAll {len(shared)} events that both have end alike.{more}"
    rows = [
        "| event | " + " | ".join(f"{run.path.name}" for run in (one, other)) + " |",
        "|---|---|---|",
    ]
    others = [e for e in shared if _signature(first[e]) != _signature(second[e])]
    rows += [f"| {e} | {_told(first[e])} | {_told(second[e])} |" for e in others[:20]]
    spent = [_energy(run, parted) for run in (one, other)]
    return (
        f"## They part at event {parted}\n\n"
        f"{names} are alike before it. From there on their trips take"
        f" **{spent[0]:.1f} J** and **{spent[1]:.1f} J**, a difference of"
        f" {spent[1] - spent[0]:+.1f} J.\n\n" + "\n".join(rows)
    )


def _signature(task: dict[str, Any]) -> tuple[Any, ...]:
    return task["x"], task["y"], task["robot"], task["outcome"], task["offers"]


def _told(task: dict[str, Any]) -> str:
    who = "nobody" if task["robot"] < 0 else f"r{task['robot']}"
    cost = "" if task["cost"] is None else f", bid {task['cost']:.2f}"
    return f"{who}{cost}, {task['outcome']}"


def _energy(recording: Recording, event: int) -> float:
    """What trips to an event and all later ones took [J]."""
    return sum(
        float(trip["energy"])
        for trip in recording.table(scheme.TRIPS).to_pylist()
        if trip["event"] >= event
    )


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


def _stage(recording: Recording, root: str) -> Stage:
    scene = recording.properties["scene"]
    radii = recording.static(scheme.ROBOTS, "Points2D:radii")
    if radii is None or "title" not in scene:
        raise ValueError(f"{recording.path}: recorded by another version; record the run again")
    return Stage(
        scene["width"], scene["height"], float(radii[0]), scene["capacity"],
        scene["title"], root,
    )  # fmt: skip
