"""How a recording is laid out in the viewer: what happens in one tab, the lifetime in the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.components import AbsoluteTimeRange
from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping

from fleet.replay import scheme
from fleet.replay.layers.event_log import DECIDED, FAILED
from fleet.replay.layers.lifetime import MAP_HEIGHT, MAP_WIDTH
from fleet.replay.layers.sequence_chart import HEIGHT, WIDTH

RIM = 1.3  # radius of the dark rim around a robot, in its radii
UNPICKABLE = rrb.EntityBehavior(interactive=False)  # robots are what is asked for
DARK = list(scheme.GROUND_COLOUR)


class Span(NamedTuple):
    """A stretch of the timeline that is scrubbed by [s]."""

    start: float
    end: float

    def range(self) -> AbsoluteTimeRange:
        """As Rerun has it, in ns."""
        return AbsoluteTimeRange(
            rr.encodings.TimeInt(seconds=self.start), rr.encodings.TimeInt(seconds=self.end)
        )


class Stage(NamedTuple):
    """One recording to be shown, and what its layout depends on."""

    width: float  # of the floor [m]
    height: float  # [m]
    mark: float  # radius that robots are drawn with [m]
    capacity: float  # of the largest battery [J]
    name: str  # which run it is
    root: str = ""  # before all paths, with a slash after it
    frame: tuple[float, float, float, float] | None = None  # x, y to x, y [m]; None: all of it

    def __call__(self, path: str) -> str:
        """Where something is in the recording."""
        return f"/{self.root}{path}"


def blueprint(
    stage: Stage, timeline: str = scheme.STORY, span: Span | None = None
) -> rrb.Blueprint:
    """Three tabs, with ``timeline`` to scrub by; a ``span`` of it is selected, and played."""
    tabs = rrb.Tabs(_replay(stage), _lifetime(stage), _tables(stage), active_tab=0)
    return _whole(tabs, timeline, span)


def side_by_side(stages: Sequence[Stage], timeline: str = scheme.ROUND) -> rrb.Blueprint:
    """Several recordings under one cursor: a column each, and their curves in one plot."""
    now = rrb.Horizontal(
        *(rrb.Vertical(_world(stage), _card(stage), row_shares=[8, 5]) for stage in stages),
        name="Replay",
    )
    curves = rrb.Grid(
        *(_shared(stages, name, path, span) for name, path, span in _compared(stages)),
        _curves(scheme.DIFFERENCE_ENERGY, "More energy for trips than the first, so far [J]"),
        _curves(scheme.DIFFERENCE_MESSAGES, "More messages than the first, so far"),
        grid_columns=2,
        name="Lifetime",
    )
    difference = rrb.TextDocumentView(origin=scheme.DIFFERENCE, name="Where they part")
    return _whole(rrb.Tabs(now, curves, difference, active_tab=0), timeline)


def _compared(stages: Sequence[Stage]) -> list[tuple[str, str, tuple[float, float] | None]]:
    """What is plotted of all recordings in one: names, paths and ranges."""
    most = max(stage.capacity for stage in stages)
    return [
        ("Energy of a robot, mean [J]", scheme.COMPARED_ENERGY, (0.0, most)),
        ("Energy of all trips so far [J]", scheme.COMPARED_TOTAL, None),
        ("Messages an event", scheme.COMPARED_MESSAGES, None),
        ("Robots on the air", scheme.COMPARED_ON_AIR, None),
    ]


def _shared(
    stages: Sequence[Stage], name: str, path: str, span: tuple[float, float] | None
) -> rrb.View:
    return _curves("/", name, "RightTop", span, [f"+ {stage(path)}" for stage in stages])


def _whole(content: rrb.Container, timeline: str, span: Span | None = None) -> rrb.Blueprint:
    return rrb.Blueprint(
        content,
        rrb.TopPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(
            state="collapsed",
            timeline=timeline,
            play_state="paused" if span is None else "playing",
            time_selection=None if span is None else span.range(),
            loop_mode=None if span is None else "selection",
        ),
        auto_views=False,
        auto_layout=False,
    )


def _replay(stage: Stage) -> rrb.Container:
    guide = rrb.TextDocumentView(origin=stage(scheme.GUIDE), name="How to read")
    trip = _curves(stage(scheme.TRIP_ENERGY), "Trip [J]")
    return rrb.Horizontal(
        rrb.Vertical(_world(stage), _lanes(stage), row_shares=[75, 25]),
        rrb.Vertical(
            rrb.Tabs(_card(stage), guide, active_tab=0),
            rrb.Tabs(_log(stage, decisions=True), _log(stage, decisions=False), active_tab=0),
            rrb.Tabs(_chart(stage), _messages(stage), trip, active_tab=0),
            row_shares=[15, 8, 13],
        ),
        column_shares=[57, 43],
        name="Replay",
    )


def _tables(stage: Stage) -> rrb.Container:
    """What can be asked."""
    return rrb.Tabs(
        _table(stage, scheme.TASKS, "Tasks"),
        _table(stage, scheme.TRIPS, "Trips"),
        _table(stage, scheme.TRANSCRIPT, "Transcript"),
        name="Tables",
        active_tab=0,
    )


def _lifetime(stage: Stage) -> rrb.Container:
    return rrb.Vertical(
        rrb.Horizontal(
            _energy_map(stage),
            rrb.Spatial2DView(
                origin="/",
                contents=[f"+ {stage('world/floor')}/**", f"+ {stage(scheme.GROUND_PLANE)}/**"],
                name="Where robots went",
                background=DARK,
                visual_bounds=_bounds(stage),
            ),
            rrb.BarChartView(
                origin=stage(scheme.HISTOGRAM),
                name="Robots by energy left [J]",
                plot_legend=rrb.PlotLegend(visible=False),
                background=rrb.archetypes.PlotBackground(color=DARK, show_grid=True),
            ),
            column_shares=[5, 3, 3],
        ),
        rrb.Horizontal(_energy(stage), _total_energy(stage), _messages(stage)),
        rrb.Horizontal(
            _curves(stage(scheme.LINK_COUNT), "Links", "RightTop"),
            _curves(stage(scheme.COMPONENTS), "Connected components"),
            _curves(stage(scheme.ON_AIR), "Robots on the air"),
        ),
        row_shares=[6, 4, 3],
        name="Lifetime",
    )


def _world(stage: Stage) -> rrb.View:
    nose = rr.Arrows2D.from_fields().visualizer(  # from the body's middle
        mappings=[
            VisualizerComponentMapping(
                target="Arrows2D:origins",
                source_kind=ComponentSourceKind.SourceComponent,
                source_component="Points2D:positions",
            )
        ]
    )
    names = rr.Points2D.from_fields(  # in a colour that can be read, however low the battery
        radii=0.001, colors=scheme.WINNER_TEXT, draw_order=26.0, show_labels=True
    ).visualizer()
    return rrb.Spatial2DView(
        origin="/",
        name=stage.name,
        contents=[f"+ {stage(scheme.WORLD)}/**"],
        background=DARK,
        visual_bounds=_bounds(stage),
        overrides={
            **{stage(path): UNPICKABLE for path in (scheme.FLOOR, scheme.LINKS)},
            stage(scheme.ROBOTS): _with_rim(stage.mark, 20.0),
            stage(scheme.MOVERS): [*_with_rim(stage.mark, 24.0), nose, names],
        },
    )


def _bounds(stage: Stage) -> rrb.VisualBounds2D:
    side = max(stage.width, stage.height)
    if stage.frame is not None:
        left, low, right, high = stage.frame
        return rrb.VisualBounds2D(x_range=[left, right], y_range=[-high, -low])
    return rrb.VisualBounds2D(
        x_range=[-0.06 * side, stage.width + 0.15 * side],
        y_range=[-stage.height - 0.03 * side, 0.085 * side],
    )


def _with_rim(radius: float, order: float) -> list[rrb.Visualizer]:
    """Points drawn twice: once larger and dark, so that they stand out from what lies below."""
    return [
        rr.Points2D.from_fields(
            radii=RIM * radius, colors=scheme.RIM_COLOUR, draw_order=order, show_labels=False
        ).visualizer(),
        rr.Points2D.from_fields(draw_order=order + 1.0, show_labels=False).visualizer(),
    ]


def _lanes(stage: Stage) -> rrb.Container:
    """What is going on around the cursor, about each open event and with those who have a part."""
    around = rrb.TimeRangeBoundary.cursor_relative
    by_time = rr.TimeRange(start=around(seconds=-8.0), end=around(seconds=4.0))
    by_msg = rr.TimeRange(start=around(seq=-40), end=around(seq=20))
    return rrb.Tabs(
        *(
            rrb.StateTimelineView(
                origin=stage(scheme.LANES), name=name, time_view=rrb.TimeAxis(view_range=span)
            )
            for name, span in (("What is going on", by_time), ("by message or round", by_msg))
        ),
        active_tab=0,
    )


def _card(stage: Stage) -> rrb.View:
    return rrb.TextDocumentView(origin=stage(scheme.CARD), name="Event")


def _log(stage: Stage, *, decisions: bool) -> rrb.View:
    hidden = [
        rrb.encodings.TimelineColumn(timeline, visible=False) for timeline in scheme.TIMELINES
    ]
    return rrb.TextLogView(
        origin=stage(scheme.LOG),
        name="Decisions" if decisions else "Transmissions",
        columns=rrb.TextLogColumns(timeline_columns=hidden, text_log_columns=["body"]),
        rows=rrb.TextLogRows(filter_by_log_level=[DECIDED, FAILED]) if decisions else None,
        format_options=rrb.TextLogFormat(monospace_body=not decisions),
    )


def _chart(stage: Stage) -> rrb.View:
    return rrb.Spatial2DView(
        origin=stage(scheme.CHART),
        name="Sequence chart",
        background=DARK,
        visual_bounds=rrb.VisualBounds2D(
            x_range=[-0.02 * WIDTH, 1.02 * WIDTH], y_range=[-0.22 * HEIGHT, 1.05 * HEIGHT]
        ),
    )


def _table(stage: Stage, path: str, name: str) -> rrb.View:
    """A table that can be sorted, filtered and scrolled through."""
    return rrb.DataframeView(
        origin=stage(path),
        name=name,
        query=rrb.archetypes.DataframeQuery(timeline=scheme.STORY, auto_scroll=True),
    )


def _energy_map(stage: Stage) -> rrb.View:
    return rrb.Spatial2DView(
        origin="/",
        contents=[f"+ {stage(scheme.ENERGY_MAP)}/**"],
        name="Energy of each robot, round by round",
        background=DARK,
        visual_bounds=rrb.VisualBounds2D(
            x_range=[-0.06 * MAP_WIDTH, 1.02 * MAP_WIDTH],
            y_range=[-0.03 * MAP_HEIGHT, 1.16 * MAP_HEIGHT],
        ),
    )


def _energy(stage: Stage) -> rrb.View:
    name = "Energy of a robot [J]"
    return _curves(stage(scheme.FLEET_ENERGY), name, "RightTop", (0.0, stage.capacity))


def _total_energy(stage: Stage) -> rrb.View:
    return _curves(stage(scheme.TOTAL_ENERGY), "Energy of all trips so far [J]")


def _messages(stage: Stage) -> rrb.View:
    return _curves(stage(scheme.FLEET_MESSAGES), "Messages an event", "RightTop")


def _curves(
    path: str,
    name: str,
    legend: str = "LeftTop",
    span: tuple[float, float] | None = None,
    contents: Sequence[str] = ("$origin/**",),
) -> rrb.View:
    """Curves over the whole lifetime, whatever the cursor is at."""
    ever = rr.TimeRange(
        start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.infinite()
    )
    return rrb.TimeSeriesView(
        origin=path,
        contents=contents,
        name=name,
        background=rrb.archetypes.PlotBackground(color=DARK, show_grid=True),
        plot_legend=rrb.PlotLegend(rrb.Corner2D.auto(legend)),
        axis_x=rrb.TimeAxis(view_range=ever),
        axis_y=None if span is None else rrb.ScalarAxis(range=span),
    )
