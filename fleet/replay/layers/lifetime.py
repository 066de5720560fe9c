"""The whole life of the fleet at a glance: energy by robot and round, what is left, where to."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray
from PIL import Image

from fleet.motion import SAMPLE_FIELDS
from fleet.replay.colormap import TABLE, energy_colours, levels
from fleet.replay.columns import Moment, column, segments
from fleet.replay.journal import TripEnd
from fleet.replay.scheme import (
    ENDS,
    ENERGY_MAP,
    ENERGY_MAP_CURSOR,
    ENERGY_MAP_SCALES,
    GROUND_PLANE,
    HISTOGRAM,
    PACKET_COLOUR,
    PATHS,
    STARTS,
    TEXT_COLOUR,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer

MAP_WIDTH, MAP_HEIGHT = 200.0, 80.0  # of the plane that the energy map is drawn on
BARS = 20  # of the histogram
CORNERS = 8  # of a driven path, at most
TRIPS = 20_000  # that are drawn, at most


class Lifetime(Layer):
    """Drawn whenever the run has become twice as long, and at its end."""

    def __init__(self) -> None:
        self._levels: list[NDArray[np.uint8]] = []  # (n,) by round
        self._driving: list[NDArray[np.float64]] = []  # poses of trips not over yet
        self._paths: list[NDArray[np.float32]] = []
        self._cursors: list[tuple[Moment, int]] = []
        self._due = 16

    def run_started(self, state: FleetState) -> None:
        """The first row of the map."""
        self._state = state
        self._starts = state.positions.astype(np.float32)
        self._levels.append(levels(state.energies, state.capacity))
        self._cursors.append((Moment(0.0, 0, 0, 0.0), 0))

    def event_raised(self, at: Moment, event: int, source: int) -> None:
        """The rounds before are history."""
        self._cursors.append((at, at.round))

    def moved(self, at: Moment, samples: NDArray[np.float64]) -> None:
        """On the way somewhere."""
        self._driving.append(samples)

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """A path, and what everybody has left."""
        now = levels(self._state.energies, self._state.capacity)
        while len(self._levels) <= at.round:
            self._levels.append(now)
        self._levels[at.round] = now
        if len(self._paths) < TRIPS:
            poses = np.concatenate([np.empty((0, len(SAMPLE_FIELDS))), *self._driving])
            mine = poses[poses[:, 0] == trip.robot, 2:4]
            picked = mine[:: max(1, len(mine) // CORNERS)]
            self._paths.append(np.array([trip.origin, *picked, trip.end], np.float32))
        since = min((way.departed for way in self._state.under_way.values()), default=np.inf)
        self._driving = [samples for samples in self._driving if samples[-1, 1] > since]

    def run_ended(self, at: Moment, summary: Mapping[str, Any] | None) -> None:
        """Draw it all."""
        self._due = 0

    def send(self, sink: Sink) -> None:
        """Everything anew, seldom."""
        if self._cursors:
            self._send_cursor(sink)
        if len(self._levels) < self._due:
            return
        self._due = 2 * len(self._levels)
        state = self._state
        self._send_map(sink)
        if self._paths:
            sink.static(
                PATHS, rr.LineStrips2D(self._paths, radii=0.15 * state.mark, colors=0x56B4E970)
            )
        sink.static(STARTS, rr.Points2D(self._starts, radii=0.3 * state.mark, colors=0x93A0B4FF))
        sink.static(
            ENDS,
            rr.Points2D(
                state.positions.astype(np.float32),
                radii=state.mark,
                colors=energy_colours(state.energies, state.capacity),
                draw_order=20.0,
            ),
        )
        counts, edges = np.histogram(state.energies, BARS, (0.0, state.capacity))
        sink.static(
            HISTOGRAM,
            rr.BarChart(
                counts,
                color=0x56B4E9FF,
                abscissa=0.5 * (edges[1:] + edges[:-1]),
                widths=np.full(BARS, 0.9 * (edges[1] - edges[0])),
            ),
        )

    def _send_map(self, sink: Sink) -> None:
        """A pixel for every robot and round; what lies under the map is measured in pixels."""
        grid = np.array(self._levels).T  # (n, rounds + 1)
        n, rounds = grid.shape
        image = Image.fromarray(grid)
        image.putpalette(TABLE.tobytes())
        png = io.BytesIO()
        image.save(png, "PNG")
        sink.static(
            ENERGY_MAP,
            rr.Transform3D(mat3x3=np.diag([MAP_WIDTH / rounds, MAP_HEIGHT / n, 1.0])),
            rr.EncodedImage(contents=png.getvalue(), media_type="image/png", draw_order=-100.0),
        )
        along, down = ticks(rounds), ticks(n)
        words = [f"{tick}" for tick in along] + [f"r{tick}" for tick in down]
        words[0] = "round 0"
        spots = [(tick + 0.5, 1.03 * n) for tick in along]
        spots += [(-0.02 * rounds, tick + 0.5) for tick in down]
        sink.static(
            ENERGY_MAP_SCALES,
            rr.Points2D(spots, labels=words, colors=TEXT_COLOUR, radii=-0.1, show_labels=True),
        )

    def _send_cursor(self, sink: Sink) -> None:
        when, rounds = zip(*self._cursors, strict=True)
        x = np.array(rounds) + 0.5
        lines = np.zeros((len(x), 2, 2))
        lines[:, :, 0] = x[:, None]
        lines[:, 1, 1] = self._state.n
        sink.rows(
            ENERGY_MAP_CURSOR, when, column(rr.LineStrips2D.descriptor_strips(), segments(lines))
        )
        self._cursors = []


def describe_lifetime(sink: Sink) -> None:
    """Its plane, and the line at the cursor."""
    sink.static(GROUND_PLANE, rr.Transform3D(mat3x3=np.diag([1.0, -1.0, 1.0])))
    sink.static(ENERGY_MAP_CURSOR, rr.LineStrips2D.from_fields(radii=-0.75, colors=PACKET_COLOUR))


def ticks(size: int) -> list[int]:
    """Six or fewer round numbers from 0 to below ``size``."""
    step = next(
        factor * 10**power for power in range(12) for factor in (1, 2, 5)
        if size <= 6 * factor * 10**power
    )  # fmt: skip
    return list(range(0, size, step))
