"""A moment of a recording, drawn with matplotlib: what the viewer shows of the floor."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from typing import Literal, NamedTuple, TypeAlias, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon
from numpy.typing import NDArray

from fleet.replay import scheme
from fleet.replay.colormap import TABLE
from fleet.replay.readback import Recording, Values

FloatArray = NDArray[np.float64]


class Theme(NamedTuple):
    """Colours that depend on the ground."""

    ground: str
    ink: str
    grid: str
    rim: str
    text: float  # how much of a colour's light is left when it is a text
    links: tuple[float, float]  # opacity of all links in range, and of those of the routing graph
    kinds: Mapping[str, int]  # colours of arrows
    winner: int


THEMES = {
    "light": Theme(
        "#ffffff", "#1b222c", "#eceff3", "#ffffff", 0.62, (0.28, 0.8),
        scheme.KINDS_ON_WHITE, scheme.WINNER_ON_WHITE,
    ),
    "dark": Theme(
        "#10151d", "#dfe5ee", "#1a2230", "#0b0e14", 1.0, (0.4, 0.8),
        scheme.KIND_COLOURS, scheme.WINNER_COLOUR,
    ),
}  # fmt: skip


BESIDE, BEYOND = 0.44, 0.82  # the floor, for the axis and for the scale of energies [in]
BELOW, ABOVE = 0.5, 0.5  # the floor, for the axis and for the caption [in]
ROW, COLUMN = 0.14, 1.25  # of the legend [in]
USUAL = 5.2  # width [in] that sizes of letters and lines are for
LINES: tuple[tuple[str, str, int | None, Literal["-", "--"], float], ...] = (  # of the legend
    (scheme.DRIVEN, "way driven", None, "-", 2.2),
    (scheme.PLANNED, "way planned", None, "-", 0.8),
    (scheme.STRAIGHT, "straight, Eq. (1)", None, "--", 1.4),
    (scheme.RELOCATION, "relocation", scheme.RELOCATION_COLOUR, "--", 1.4),
    (scheme.ROUTING, "link", scheme.ROUTING_COLOUR, "-", 1.4),
)  # None: the winner's colour
Box: TypeAlias = tuple[float, float, float, float]
"""Left, bottom, width and height, in shares of a figure."""


def columns(width: float, scale: float = 1.0) -> int:
    """How many columns a legend has room for in a figure of that ``width`` [in]."""
    return max(1, min(4, int((width - 0.2) / (COLUMN * scale))))


class FloorFigure:
    """Draws a recording at one moment after another.

    Raises:
        ValueError: there is no theme of that name.
    """

    def __init__(self, recording: Recording, theme: str = "light") -> None:
        if theme not in THEMES:
            raise ValueError(f"theme {theme!r}; expected one of {', '.join(THEMES)}")
        self._recording = recording
        self._theme = THEMES[theme]
        scene = recording.properties["scene"]
        self._title = str(scene["title"])
        self._size = float(scene["width"]), float(scene["height"])
        self._capacity = float(scene["capacity"])
        self._search = float(scene["search_radius"])
        self._mark = float(
            cast(NDArray[np.float32], recording.static(scheme.ROBOTS, "Points2D:radii"))[0]
        )

    def draw(self, axes: Axes, timeline: str, moment: float) -> None:
        """Draw the state at ``moment`` of a timeline (s, or a number) into empty ``axes``.

        Raises:
            ValueError: the recording has no such timeline or moment.
        """
        self._recording.check_moment(timeline, moment)
        self._when = timeline, moment
        self._axes = axes
        self._bold = self.scale(axes.figure.bbox.width / axes.figure.dpi)
        self._floor()
        faint, clear = self._theme.links
        for path, width, colour, alpha in (
            (scheme.UDG, 0.35, scheme.UDG_COLOUR, faint),
            (scheme.ROUTING, 0.9, scheme.ROUTING_COLOUR, clear),
        ):
            for part in scheme.LINK_PARTS:
                self._lines(f"{path}/{part}", width, colour, alpha=alpha)
        self._regions()
        self._event()
        winner = self._theme.winner
        self._lines(scheme.STRAIGHT, 0.9, winner, order=2.0)
        self._lines(scheme.RELOCATION, 0.9, scheme.RELOCATION_COLOUR, order=2.0)
        self._lines(scheme.PLANNED, 0.6, winner, order=2.1)
        self._lines(scheme.DRIVEN, 1.8, winner, order=2.2)
        self._arrows()
        self._discs(scheme.RINGS, 1.75, 4.0, rim=1.35)
        self._discs(scheme.ROBOTS, 1.0, 5.0)
        self._marks()
        self._discs(scheme.MOVERS, 1.0, 6.0)
        self._noses()
        self._labels()
        self._legend()

    def height(self, width: float) -> float:
        """How high a figure of that width is, all in inches."""
        return self._below(width) + self._floor_height(width) + ABOVE * self.scale(width)

    def boxes(self, width: float) -> tuple[Box, Box]:
        """Where in a figure of that width the floor is, and the scale of energies."""
        height, floor, below = self.height(width), self._floor_height(width), self._below(width)
        left, across = BESIDE / width, 1.0 - (BESIDE + BEYOND) / width
        return (
            (left, below / height, across, floor / height),
            (
                left + across + 0.14 / width, (below + 0.2 * floor) / height, 0.12 / width,
                0.6 * floor / height,
            ),
        )  # fmt: skip

    def _below(self, width: float) -> float:
        """Room for the axis and the legend [in]."""
        scale = self.scale(width)
        return BELOW * scale + ROW * scale * ceil(len(self._entries()) / columns(width, scale))

    def _floor_height(self, width: float) -> float:
        across, up = (side + 0.02 * max(self._size) for side in self._size)
        return (width - BESIDE - BEYOND) * min(up / across, 2.0)

    def colour_bar(self, axes: Axes) -> None:
        """What colour means how much energy, into axes of its own."""
        scale = ScalarMappable(Normalize(0.0, self._capacity), ListedColormap(TABLE / 255.0))
        figure = axes.get_figure()
        assert figure is not None
        bar = figure.colorbar(scale, cax=axes, label="battery [J]")
        ink = self._theme.ink
        bar.ax.tick_params(colors=ink, labelsize=7 * self._bold)
        bar.ax.yaxis.label.set(color=ink, size=8 * self._bold)
        cast(Line2D, bar.outline).set_visible(False)

    def caption(self) -> str:
        """The run, what has come of the event in sight, and the moment."""
        timeline, moment = self._when
        time, _, message = self._recording.moment_at(timeline, moment)
        if timeline == scheme.SIM_TIME:
            time = moment
        card = self._get(scheme.CARD, "TextDocument:text")
        outcome = str(card[0]).partition("\n")[0].removeprefix("## ") if len(card) else ""
        return f"{self._title}\n{outcome}  ·  message {message}  ·  {time:.2f} s"

    @staticmethod
    def scale(width: float) -> float:
        """How much larger than usual letters and lines are in a figure of that ``width`` [in]."""
        return min(max(width / USUAL, 0.85), 1.7)

    def _get(self, entity: str, component: str) -> Values:
        found = self._recording.at(entity, component, *self._when)
        return np.empty(0) if found is None else found

    def _points(self, entity: str, component: str) -> FloatArray:
        return np.asarray(self._get(entity, component), float).reshape(-1, 2)

    def _floor(self) -> None:
        axes, theme, (width, height) = self._axes, self._theme, self._size
        side = max(self._size)
        axes.set(
            aspect="equal", xlim=(-0.01 * side, width + 0.01 * side),
            ylim=(-0.01 * side, height + 0.01 * side), xlabel="x [m]", ylabel="y [m]",
            facecolor=theme.ground,
        )  # fmt: skip
        axes.grid(visible=True, color=theme.grid, linewidth=0.6)
        axes.set_axisbelow(True)
        axes.tick_params(colors=theme.ink, labelsize=7 * self._bold, length=0)
        for label in (axes.xaxis.label, axes.yaxis.label):
            label.set(color=theme.ink, size=8 * self._bold)
        for spine in axes.spines.values():
            spine.set(color=theme.ink, linewidth=0.8, alpha=0.6)
        hole = self._recording.static(scheme.HOLE, "LineStrips2D:strips")
        for outline in hole or ():
            axes.add_patch(
                Polygon(
                    np.asarray(outline), fill=False, hatch="////", edgecolor=theme.ink, alpha=0.18
                )
            )
        for outline in self._recording.static(scheme.OBSTACLES, "LineStrips2D:strips") or ():
            axes.add_patch(Polygon(np.asarray(outline), facecolor=theme.ink, alpha=0.35))

    def _lines(
        self, path: str, width: float, colour: int, *, order: float = 1.0, alpha: float = 1.0
    ) -> None:
        strips = self._get(path, "LineStrips2D:strips")
        if len(strips):
            lines = [np.asarray(strip) for strip in strips]
            self._axes.add_collection(
                LineCollection(
                    lines, colors=rgb(colour), linewidths=width * self._bold, zorder=order,
                    alpha=alpha,
                )
            )  # fmt: skip

    def _marks(self) -> None:
        """What has befallen robots; white strokes are in ink on white."""
        strips = self._get(scheme.MARKS, "LineStrips2D:strips")
        paint = np.asarray(self._get(scheme.MARKS, "LineStrips2D:colors"), np.uint32).tolist()
        broken = scheme.MARK_COLOURS["broken"]
        for strip, colour in zip(strips, paint, strict=True):
            ink = self._theme.ink if colour == broken else rgb(colour)
            self._axes.plot(*np.asarray(strip).T, color=ink, lw=1.2 * self._bold, zorder=5.5)

    def _regions(self) -> None:
        """Where the radio is silent."""
        centres = self._points(scheme.SILENT, "Ellipses2D:centers").tolist()
        radii = self._points(scheme.SILENT, "Ellipses2D:half_sizes")[:, 0].tolist()
        for centre, radius in zip(centres, radii, strict=True):
            self._axes.add_patch(
                Circle(centre, radius, facecolor=self._theme.ink, alpha=0.12, zorder=0.5)
            )
        for site in self._points(scheme.OPEN_EVENTS, "Points2D:positions"):
            self._axes.add_patch(
                Circle(site, 0.6 * self._mark, color=rgb(scheme.EVENT_COLOUR), alpha=0.6)
            )
        self._lines(scheme.TRUE_SITE, 0.8, scheme.TRUE_COLOUR, order=6.4)

    def _event(self) -> None:
        sites = self._points(scheme.EVENT, "Points2D:positions")
        colour = rgb(scheme.EVENT_COLOUR)
        for site in sites:
            if self._search > 0.0:
                self._axes.add_patch(
                    Circle(site, self._search, fill=False, color=colour, alpha=0.5, linewidth=0.8)
                )
            self._axes.add_patch(
                Circle(site, 2.3 * self._mark, fill=False, color=colour, linewidth=1.6, zorder=6.5)
            )
            self._axes.add_patch(Circle(site, 0.45 * self._mark, color=colour, zorder=6.5))

    def _kinds(self) -> list[str]:
        """Kinds of transmissions in the recording, in the order in which they are drawn."""
        prefix = f"{scheme.MESSAGES}/"
        found = [p.removeprefix(prefix) for p in self._recording.temporal if p.startswith(prefix)]
        order = [*scheme.KIND_COLOURS, *sorted(set(found) - {*scheme.KIND_COLOURS, "lost"}), "lost"]
        return [kind for kind in order if kind in found]

    def _kind_colour(self, kind: str) -> str:
        return rgb(self._theme.kinds.get(kind, scheme.arrow_colour(scheme.messages(kind))))

    def _arrows(self) -> None:
        """The conversation so far, in the viewer's order."""
        for order, kind in enumerate(self._kinds()):
            path = scheme.messages(kind)
            self._quiver(path, self._kind_colour(kind), 0.0046, 3.0 + 0.05 * order)
        self._quiver(scheme.PACKET, self._theme.ink, 0.0062, 3.9)

    def _quiver(self, path: str, colour: str, width: float, order: float) -> None:
        origins = self._points(path, "Arrows2D:origins")
        if len(origins):
            vectors = self._points(path, "Arrows2D:vectors")
            self._axes.quiver(
                *origins.T, *vectors.T, angles="xy", scale_units="xy", scale=1.0, width=width,
                color=colour, headwidth=3.4, headlength=3.8, headaxislength=3.4, zorder=order,
            )  # fmt: skip

    def _discs(self, path: str, radius: float, order: float, rim: float = 0.0) -> None:
        places = self._points(path, "Points2D:positions")
        shown = ~np.isnan(places).any(axis=1)
        if not shown.any():
            return
        paint = np.asarray(self._get(path, "Points2D:colors"), np.uint32)[shown]
        for scale, colour in (
            (radius, [rgb(c) for c in paint.tolist()]),
            (rim, self._theme.ground),
        ):
            size = np.full(int(shown.sum()), 2.0 * scale * self._mark)
            if scale:
                self._axes.add_collection(
                    EllipseCollection(
                        size, size, np.zeros_like(size), units="xy", offsets=places[shown],
                        transOffset=self._axes.transData, facecolors=colour,
                        edgecolors=self._theme.rim, linewidths=0.4, zorder=order,
                    )
                )  # fmt: skip

    def _noses(self) -> None:
        origins = self._points(scheme.MOVERS, "Points2D:positions")
        ends = origins + self._points(scheme.MOVERS, "Arrows2D:vectors")
        for robot, nose in zip(origins, ends, strict=True):
            self._axes.plot(
                *zip(robot, nose, strict=True), color=self._theme.ink, lw=1.2, zorder=6.2
            )

    def _labels(self) -> None:
        hang = 0.02 * max(self._size)  # of the viewer's labels; here they hang on their middle
        self._lines(scheme.LEADERS, 0.6, scheme.LEADER_COLOUR, order=7.9, alpha=0.8)
        words = self._get(scheme.NAMES, "Points2D:labels")
        places = self._points(scheme.NAMES, "Points2D:positions") - [0.0, hang]
        paint = np.asarray(self._get(scheme.NAMES, "Points2D:colors"), np.uint32).tolist()
        for word, (x, y), colour in zip(words, places.tolist(), paint, strict=True):
            self._text(x, y, str(word), rgb(colour, self._theme.text))
        movers = self._points(scheme.MOVERS, "Points2D:positions").tolist()
        names = self._get(scheme.MOVERS, "Points2D:labels")
        for name, (x, y) in zip(names, movers, strict=False):
            self._text(x, y - 2.0 * hang, str(name), self._theme.ink)

    def _text(self, x: float, y: float, text: str, colour: str) -> None:
        self._axes.text(
            x, y, text, color=colour, size=7 * self._bold, ha="center", va="center", zorder=8.0,
            clip_on=True,
            bbox={"boxstyle": "round,pad=.2", "fc": self._theme.ground, "ec": "none", "alpha": 0.8},
        )  # fmt: skip

    def _entries(self) -> list[tuple[str, Line2D]]:
        """The legend: the same at every moment, of all that is in the recording."""
        entries = [
            (
                scheme.KIND_LABELS.get(kind, kind),
                Line2D([], [], color=self._kind_colour(kind), lw=2),
            )
            for kind in self._kinds()
        ]
        present = self._recording.temporal
        for path, word, colour, style, width in LINES:
            if path in present or f"{path}/lasting" in present:
                paint = rgb(self._theme.winner if colour is None else colour)
                entries.append((word, Line2D([], [], color=paint, linestyle=style, lw=width)))
        befallen = {
            colour
            for row in self._recording.rows(scheme.MARKS, "LineStrips2D:colors").values
            for colour in np.asarray(row, np.uint32).tolist()
        }
        for why, colour in scheme.MARK_COLOURS.items():
            if colour in befallen:
                paint = self._theme.ink if why == "broken" else rgb(colour)
                mark = Line2D([], [], marker="_" if why == "motor" else "x", color=paint, lw=0.0)
                entries.append((scheme.MARK_LABELS[why], mark))
        ring = Line2D([], [], marker="o", markersize=6, markerfacecolor="none", linewidth=0.0)
        ring.set_color(rgb(scheme.EVENT_COLOUR))
        entries.append(("event, search radius" if self._search > 0.0 else "event", ring))
        return entries

    def _legend(self) -> None:
        words, handles = zip(*self._entries(), strict=True)
        width = self._axes.figure.bbox.width / self._axes.figure.dpi
        drop = -0.34 * self._bold / self._axes.bbox.height * self._axes.figure.dpi
        self._axes.legend(
            handles, words, ncols=columns(width, self._bold), loc="upper center",
            bbox_to_anchor=(0.5, drop), bbox_transform=self._axes.transAxes, frameon=False,
            fontsize=6.5 * self._bold, labelcolor=self._theme.ink, handlelength=1.6,
            columnspacing=1.4,
        )  # fmt: skip


def rgb(colour: int, light: float = 1.0) -> str:
    """A colour 0xRRGGBBAA as matplotlib writes it, without its opacity."""
    parts = [round(light * (colour >> shift & 255)) for shift in (24, 16, 8)]
    return "#{:02x}{:02x}{:02x}".format(*parts)
