"""The conversation in focus as protocol people draw it: robots across, transmissions downwards."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil
from typing import Any, NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from fleet.replay.columns import Moment, colours, column, pairs, segments, texts
from fleet.replay.journal import RecordedLine
from fleet.replay.scheme import (
    CHART_CURSOR,
    CHART_LIFELINES,
    CHART_MESSAGES,
    CHART_ROBOTS,
    LOST_COLOUR,
    PACKET_COLOUR,
    TEXT_COLOUR,
    kind_colour,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import Award, RobotId

WIDTH, HEIGHT = 480.0, 240.0  # of the plane that it is drawn on
STEP = 12.0  # from one transmission to the next, at most
ABOVE = 30.0  # the first transmission, for names
MANY_NAMES = 14  # robots that are named


class Chart(NamedTuple):
    """What is drawn of one conversation, on its plane."""

    robots: list[RobotId]  # from left to right, as they took part
    arrows: NDArray[np.float64]  # (k, 4) from x, y to x, y
    paint: list[int]  # (k,)
    rows: dict[int, float]  # y of each transmission, by its number


class SequenceChart(Layer):
    """Drawn when the conversation is over, to be seen from when it came into focus."""

    def __init__(self) -> None:
        self._charts: list[tuple[Moment, Chart]] = []
        self._cursors: list[tuple[Moment, float | None]] = []
        self._heard: list[tuple[Moment, int]] = []
        self._since: Moment | None = None
        self._lines: list[RecordedLine] = []

    def run_started(self, state: FleetState) -> None:
        """Nothing to draw."""
        self._state = state

    def focused(self, at: Moment) -> None:
        """Another conversation; the chart of one that is over stays until there is."""
        self._complete()
        focus = self._state.in_focus
        if focus is not None:
            self._since, self._lines = at, focus.lines

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """Where the cursor is."""
        if line.event == self._state.focus:
            self._heard.append((at, line.number))

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """It is over."""
        if event == self._state.focus:
            self._complete()

    def broken_off(self, at: Moment, event: int, reason: str) -> None:
        """It is over."""
        if event == self._state.focus:
            self._complete()

    def run_ended(self, at: Moment, summary: Mapping[str, Any] | None) -> None:
        """All is over."""
        self._complete()

    def send(self, sink: Sink) -> None:
        """Charts and cursors."""
        if self._charts:
            when, charts = zip(*self._charts, strict=True)
            self._send_charts(sink, when, charts)
        if self._cursors:
            when, rows = zip(*self._cursors, strict=True)
            lines = np.array([[(0.0, y), (WIDTH, y)] for y in rows])
            sink.rows(
                CHART_CURSOR, when, column(rr.LineStrips2D.descriptor_strips(), segments(lines))
            )
        self._charts, self._cursors = [], []

    def _complete(self) -> None:
        """Draw what is in focus, if that has not been done."""
        if self._since is None:
            return
        chart = lay_out_chart(self._lines)
        self._charts.append((self._since, chart))
        self._cursors += [(at, chart.rows[number]) for at, number in self._heard]
        self._heard, self._since = [], None

    def _send_charts(self, sink: Sink, when: Sequence[Moment], charts: Sequence[Chart]) -> None:
        ends = np.concatenate([chart.arrows for chart in charts])
        counts = [len(chart.arrows) for chart in charts]
        sink.rows(
            CHART_MESSAGES,
            when,
            column(rr.Arrows2D.descriptor_origins(), pairs(ends[:, :2]), counts),
            column(rr.Arrows2D.descriptor_vectors(), pairs(ends[:, 2:] - ends[:, :2]), counts),
            column(
                rr.Arrows2D.descriptor_colors(),
                colours([colour for chart in charts for colour in chart.paint]),
                counts,
            ),
        )
        across = [[(x, -ABOVE) for x in places(len(chart.robots))] for chart in charts]
        counts = [len(row) for row in across]
        flat = np.array([spot for row in across for spot in row]).reshape(-1, 2)
        names = [name for chart in charts for name in _names(chart.robots)]
        sink.rows(
            CHART_ROBOTS,
            when,
            column(rr.Points2D.descriptor_positions(), pairs(flat), counts),
            column(rr.Points2D.descriptor_labels(), texts(names), counts),
        )
        lowest = np.repeat([max(c.rows.values(), default=0.0) + STEP for c in charts], counts)
        lines = np.stack([flat * [1.0, 0.0], np.column_stack([flat[:, 0], lowest])], axis=1)
        sink.rows(
            CHART_LIFELINES,
            when,
            column(rr.LineStrips2D.descriptor_strips(), segments(lines), counts),
        )


def lay_out_chart(lines: Sequence[RecordedLine]) -> Chart:
    """A place for every robot and every transmission."""
    robots = list(
        dict.fromkeys(
            robot
            for line in lines
            for robot in (line.sender, line.receiver, *line.heard)
            if robot is not None
        )
    )
    x = dict(zip(robots, places(len(robots)), strict=True))
    step = min(STEP, HEIGHT / (len(lines) + 1))
    arrows: list[tuple[float, float, float, float]] = []
    paint: list[int] = []
    rows: dict[int, float] = {}
    for k, line in enumerate(lines, 1):
        y = rows[line.number] = k * step
        aims = line.heard or (() if line.receiver is None else (line.receiver,))
        colour = kind_colour(line.kind) if line.heard else LOST_COLOUR
        arrows += [(x[line.sender], y, x[robot], y) for robot in aims]
        paint += [colour] * len(aims)
    return Chart(robots, np.array(arrows, float).reshape(-1, 4), paint, rows)


def places(count: int) -> list[float]:
    """Where robots are from left to right."""
    return [WIDTH * (k + 0.5) / count for k in range(count)]


def _names(robots: Sequence[RobotId]) -> list[str]:
    """Names of as many robots as there is room for."""
    every = max(1, ceil(len(robots) / MANY_NAMES))
    return [f"r{robot}" if k % every == 0 else "" for k, robot in enumerate(robots)]


def describe_chart(sink: Sink) -> None:
    """How wide its lines are."""
    sink.static(
        CHART_LIFELINES, rr.LineStrips2D.from_fields(radii=-0.4, colors=0x93A0B460, draw_order=1.0)
    )
    sink.static(CHART_MESSAGES, rr.Arrows2D.from_fields(radii=-1.2, draw_order=3.0))
    sink.static(
        CHART_CURSOR,
        rr.LineStrips2D.from_fields(radii=-0.7, colors=PACKET_COLOUR & 0xFFFFFF60, draw_order=2.0),
    )
    sink.static(
        CHART_ROBOTS,
        rr.Points2D.from_fields(radii=-1.5, colors=TEXT_COLOUR, draw_order=4.0, show_labels=True),
    )
