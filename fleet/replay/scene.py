"""What does not change: the floor and what stands on it, how everything looks, how to read it."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import rerun as rr
from PIL import Image, ImageDraw

from fleet.replay import scheme
from fleet.replay.colormap import TABLE
from fleet.replay.guide import guide
from fleet.replay.journal import Scene
from fleet.replay.layers.curves import describe_counts
from fleet.replay.layers.label_placement import HANG
from fleet.replay.layers.lifetime import describe_lifetime
from fleet.replay.layers.sequence_chart import describe_chart
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState
from protocols.messages import Point

RING = 1.75  # radius of the ring around a robot, in its radii
PIXELS = 1200  # of the longer side of the picture of the floor

FLOOR = (16, 21, 29)
GRID = (24, 31, 42)
EMPTY = scheme.GROUND_COLOUR
HATCH = (38, 45, 57)
BLOCK = (52, 60, 74)


def describe(sink: Sink, scene: Scene, key: str, properties: Mapping[str, Any]) -> None:
    """Say what this is a recording of."""
    sink.name(f"{scene.title} · {key}")
    sink.properties("run", {"key": key, **properties})
    sink.properties(
        "scene",
        {
            "width": scene.width,
            "height": scene.height,
            "robots": len(scene.positions),
            "robot_radius": scene.radius,
            "capacity": max(scene.capacities),
            "radio_range": scene.radio_range,
            "search_radius": scene.search_radius,
            "graph": scene.graph,
            "title": scene.title,
            "protocol": scene.protocol,
            "motion": scene.motion,
            "world": scene.world,
            "seed": scene.seed,
            "metric": scene.metric,
            "unit": scene.unit,
            "belief": scene.belief,
        },
    )


def draw_scene(sink: Sink, state: FleetState) -> None:
    """The floor, and for everything that comes and goes its size, colour and place in the stack."""
    scene, mark = state.scene, state.mark
    sink.static(scheme.WORLD, rr.Transform3D(mat3x3=np.diag([1.0, -1.0, 1.0])))  # y points up
    _draw_floor(sink, scene)
    line = 0.1 * mark
    for part in scheme.LINK_PARTS:
        _style_lines(sink, f"{scheme.UDG}/{part}", 0.8 * line, scheme.UDG_COLOUR, 1.0)
        _style_lines(sink, f"{scheme.ROUTING}/{part}", 1.4 * line, scheme.ROUTING_COLOUR, 2.0)
    _style_lines(sink, scheme.STRAIGHT, 1.6 * line, scheme.WINNER_COLOUR, 9.0)
    _style_lines(sink, scheme.RELOCATION, 1.6 * line, scheme.RELOCATION_COLOUR, 9.0)
    _style_lines(sink, scheme.PLANNED, 0.9 * line, scheme.PLANNED_COLOUR, 9.2)
    _style_lines(sink, scheme.DRIVEN, 3.2 * line, scheme.WINNER_COLOUR, 9.5)
    sink.static(scheme.MARKS, rr.LineStrips2D.from_fields(radii=2.0 * line, draw_order=23.0))
    _style_lines(sink, scheme.LEADERS, 0.6 * line, scheme.LEADER_COLOUR, 39.0)
    _style_lines(sink, scheme.TRUE_SITE, 1.0 * line, scheme.TRUE_COLOUR, 26.5)
    sink.static(
        scheme.TRUE_SITE,
        rr.Points2D.from_fields(radii=0.7 * mark, colors=scheme.TRUE_COLOUR, draw_order=26.6),
    )
    sink.static(
        scheme.OPEN_EVENTS,
        rr.Points2D.from_fields(
            radii=0.6 * mark, colors=scheme.OPEN_COLOUR, draw_order=26.0, show_labels=False
        ),
    )
    sink.static(
        scheme.SILENT,
        rr.Ellipses2D.from_fields(
            line_radii=1.5 * line, colors=scheme.SILENT_COLOUR, draw_order=4.0, show_labels=False
        ),
    )
    if scene.sensors:
        sink.static(
            scheme.SENSORS,
            rr.Points2D(
                np.array(scene.sensors, np.float32), radii=0.25 * mark,
                colors=scheme.SENSOR_COLOUR, draw_order=-40.0,
            ),
        )  # fmt: skip
    for order, kind in enumerate(scheme.KIND_COLOURS):
        width = 1.6 if kind in ("call", "bid") else 2.8
        _style_arrows(sink, scheme.messages(kind), width * line, scheme.kind_colour(kind), order)
    _style_arrows(sink, scheme.LOST, 1.6 * line, scheme.LOST_COLOUR, 7)
    sink.static(
        scheme.PACKET,
        rr.Arrows2D.from_fields(radii=3.6 * line, colors=scheme.PACKET_COLOUR, draw_order=18.0),
    )
    sink.static(scheme.RINGS, rr.Points2D.from_fields(radii=RING * mark, draw_order=19.0))
    sink.static(
        scheme.ROBOTS,
        rr.Points2D.from_fields(radii=mark, draw_order=21.0, show_labels=False),
    )
    sink.static(  # over those at rest that have a part, and looking alike: to be pointed at
        scheme.PARTS, rr.Points2D.from_fields(radii=mark, draw_order=22.0, show_labels=False)
    )
    sink.static(
        scheme.MOVERS,
        rr.Points2D.from_fields(radii=mark, draw_order=25.0, show_labels=True),
        rr.Arrows2D.from_fields(radii=2.2 * line, colors=scheme.WINNER_COLOUR),
    )
    sink.static(
        scheme.EVENT,
        rr.Points2D.from_fields(
            radii=0.45 * mark, colors=scheme.EVENT_COLOUR, draw_order=27.0, show_labels=False
        ),
        rr.Ellipses2D.from_fields(
            line_radii=2.2 * line,
            colors=scheme.EVENT_COLOUR,
            show_labels=False,
        ),
    )
    if scene.search_radius > 0.0:
        sink.static(
            scheme.SEARCH,
            rr.Ellipses2D.from_fields(
                line_radii=1.2 * line,
                colors=scheme.SEARCH_COLOUR,
                draw_order=3.0,
                show_labels=False,
            ),
        )
    sink.static(
        scheme.NAMES, rr.Points2D.from_fields(radii=0.001, draw_order=40.0, show_labels=True)
    )
    sink.static(scheme.CARD, rr.TextDocument.from_fields(media_type=rr.MediaType.MARKDOWN))
    describe_chart(sink)
    describe_counts(sink)
    describe_lifetime(sink)
    sink.static(scheme.GUIDE, rr.TextDocument(guide(state), media_type=rr.MediaType.MARKDOWN))


def _style_lines(sink: Sink, path: str, radius: float, colour: int, order: float) -> None:
    sink.static(path, rr.LineStrips2D.from_fields(radii=radius, colors=colour, draw_order=order))


def _style_arrows(sink: Sink, path: str, radius: float, colour: int, order: int) -> None:
    sink.static(path, rr.Arrows2D.from_fields(radii=radius, colors=colour, draw_order=10.0 + order))


def _draw_floor(sink: Sink, scene: Scene) -> None:
    scale = PIXELS / max(scene.width, scene.height)
    sink.static(
        scheme.GROUND,
        rr.Transform3D(
            translation=[0.0, scene.height, 0.0], mat3x3=np.diag([1 / scale, -1 / scale, 1.0])
        ),
        rr.EncodedImage(contents=_ground(scene, scale), media_type="image/png", draw_order=-100.0),
    )
    side = max(scene.width, scene.height)
    _outline(
        sink,
        scheme.WALLS,
        [[(0, 0), (scene.width, 0), (scene.width, scene.height), (0, scene.height)]],
        scheme.WALL_COLOUR,
        0.002 * side,
    )
    if scene.hole is not None:
        _outline(sink, scheme.HOLE, [scene.hole], scheme.HOLE_COLOUR, 0.0015 * side)
    _outline(sink, scheme.OBSTACLES, scene.obstacles, scheme.OBSTACLE_COLOUR, 0.002 * side)
    _draw_scales(sink, scene)


def _outline(
    sink: Sink, path: str, outlines: list[list[Point]], colour: int, radius: float
) -> None:
    """Closed lines around shapes."""
    if outlines:
        closed = [np.array([*outline, outline[0]], np.float32) for outline in outlines]
        sink.static(
            path,
            rr.LineStrips2D(closed, colors=colour, radii=radius, draw_order=-50.0),
        )


def _draw_scales(sink: Sink, scene: Scene) -> None:
    """Metres along two walls, and what colour means how much energy."""
    side = max(scene.width, scene.height)
    step = next(s for s in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1e9) if side / s <= 6.0)
    hang = HANG * side
    across = np.arange(0.0, scene.width + 1e-9, step).tolist()
    marks = [(x, -0.012 * side, f"{x:g}") for x in across[:-1]]
    marks.append((across[-1], -0.012 * side, f"{across[-1]:g} m"))
    up = np.arange(step, scene.height + 1e-9, step).tolist()
    marks += [(-0.03 * side, y + hang, f"{y:g}") for y in up]
    capacity = max(scene.capacities)
    left, width = scene.width + 0.035 * side, 0.02 * side
    low, high = 0.25 * scene.height, 0.75 * scene.height
    for share, unit in ((0.0, ""), (0.5, ""), (1.0, " J")):
        y = low + share * (high - low) + hang
        marks.append((left + width + 0.05 * side, y, f"{share * capacity:g}{unit}"))
    sink.static(
        scheme.SCALES,
        rr.Points2D(
            [(x, y) for x, y, _ in marks],
            labels=[text for _, _, text in marks],
            colors=scheme.TEXT_COLOUR,
            radii=0.001,
            show_labels=True,
        ),
    )
    sink.static(
        scheme.ENERGY_SCALE,
        rr.Transform3D(
            translation=[left, low, 0.0], mat3x3=np.diag([width, (high - low) / 256, 1.0])
        ),
        rr.Image(TABLE[:, None, :], draw_order=-90.0),
    )


def _ground(scene: Scene, scale: float) -> bytes:
    """The floor from above as a PNG, a metre being ``scale`` pixels."""
    size = max(1, round(scale * scene.width)), max(1, round(scale * scene.height))
    image = Image.new("P", size, 0)
    image.putpalette([part for colour in (FLOOR, GRID, EMPTY, HATCH, BLOCK) for part in colour])
    grid_line, empty, hatch, block = 1, 2, 3, 4
    draw = ImageDraw.Draw(image)

    def pixels(points: list[Point]) -> list[Point]:
        return [(scale * x, size[1] - scale * y) for x, y in points]

    grid = 1.0 if max(scene.width, scene.height) <= 20.0 else 5.0
    for x in np.arange(grid, scene.width, grid).tolist():
        draw.line(pixels([(x, 0.0), (x, scene.height)]), fill=grid_line)
    for y in np.arange(grid, scene.height, grid).tolist():
        draw.line(pixels([(0.0, y), (scene.width, y)]), fill=grid_line)
    if scene.hole is not None:
        mask = Image.new("1", size, 0)
        ImageDraw.Draw(mask).polygon(pixels(scene.hole), fill=1)
        hatched = Image.new("P", size, empty)
        lines = ImageDraw.Draw(hatched)
        for start in range(-size[1], size[0], 26):
            lines.line([(start, 0), (start + size[1], size[1])], fill=hatch, width=3)
        image.paste(hatched, mask=mask)
    for obstacle in scene.obstacles:
        draw.polygon(pixels(obstacle), fill=block)
    buffer = io.BytesIO()
    image.save(buffer, "PNG")
    return buffer.getvalue()
