"""Pictures of a recording for papers and slides, without a viewer."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from fleet.replay.scheme import TIMELINES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fleet.replay.floor_figure import FloorFigure


def picture(
    recording: Path,
    at: Mapping[str, float],
    out: Path,
    *,
    theme: str = "light",
    size: float = 5.2,
    dots_per_inch: int = 160,
) -> Path:
    """Draw the state of a recording at one moment.

    Args:
        recording: the .rrd file.
        at: the moment on one timeline: ``{"round": 12}``, ``{"msg": 345}`` or
            ``{"sim_time": 12.3}`` [s].
        out: the file to write; its ending says what kind (.png, .pdf, .svg ...).
        theme: "light" or "dark".
        size: width of the picture [in].
        dots_per_inch: of formats that are made of dots.

    Raises:
        ValueError: no such file, moment or kind of picture, or the file is not a recording or
            damaged.
        OSError: the picture cannot be written.
    """
    from matplotlib.figure import Figure

    from fleet.replay.floor_figure import FloorFigure
    from fleet.replay.readback import sound

    kinds = Figure().canvas.get_supported_filetypes()
    check_ending(out, set(kinds), "picture")
    moment = the_moment(at)
    floor = FloorFigure(sound(recording), theme)
    figure = draw(floor, *moment, size, dots_per_inch)
    figure.savefig(out, facecolor=figure.get_facecolor())
    return out


def draw(
    floor: FloorFigure, timeline: str, moment: float, size: float, dots_per_inch: int
) -> Figure:
    """A figure of the floor at a moment, ``size`` [in] wide."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(size, floor.height(size)), dpi=dots_per_inch)
    axes, bar = (figure.add_axes(box) for box in floor.boxes(size))
    floor.draw(axes, timeline, moment)
    floor.colour_bar(bar)
    figure.set_facecolor(axes.get_facecolor())
    axes.set_title(
        floor.caption(),
        color=axes.xaxis.label.get_color(),
        size=8.5 * floor.scale(size),
        loc="left",
    )
    return figure


def the_moment(at: Mapping[str, float]) -> tuple[str, float]:
    """The timeline and the moment on it, of which there must be one."""
    if len(at) != 1:
        raise ValueError(f"the moment is {dict(at)}; expected one of {', '.join(TIMELINES)}")
    ((timeline, moment),) = at.items()
    return timeline, moment


def check_ending(out: Path, known: set[str], what: str) -> None:
    """Raises ValueError unless the file's ending is one of those ``known``."""
    if out.suffix.removeprefix(".").lower() not in known:
        endings = ", ".join(f".{ending}" for ending in sorted(known))
        raise ValueError(f"{out}: no such kind of {what}; expected one of {endings}")
