"""Pictures and short clips of a recording for papers and slides, without a viewer."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fleet.replay.scheme import SIM_TIME, TIMELINES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fleet.replay.sketch import Sketch

COLOURS = 96  # of a clip


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
        ValueError: no such file or moment, or the file is not a recording or damaged.
    """
    from fleet.replay.readback import Recording
    from fleet.replay.sketch import Sketch

    timeline, moment = _moment(at)
    sketch = Sketch(Recording(recording), theme)
    figure = _figure(sketch, timeline, moment, size, dots_per_inch)
    figure.savefig(out, facecolor=figure.get_facecolor())
    return out


def clip(
    recording: Path,
    out: Path,
    *,
    timeline: str = "msg",
    start: float,
    stop: float,
    step: float = 1.0,
    frames_per_second: float = 8.0,
    theme: str = "light",
    size: float = 4.4,
    dots_per_inch: int = 110,
) -> Path:
    """Draw a stretch of a recording as an animated GIF: a frame every ``step`` of a timeline.

    Raises:
        ValueError: no such file or moment, no step forward, or the file is not a recording.
    """
    from PIL import Image

    from fleet.replay.readback import Recording
    from fleet.replay.sketch import Sketch

    if not step > 0.0 or not frames_per_second > 0.0:
        raise ValueError(f"step is {step}, frames a second {frames_per_second}; expected both > 0")
    if not start <= stop:
        raise ValueError(f"the clip runs from {start:g} to {stop:g}; expected the end last")
    sketch = Sketch(Recording(recording), theme)
    frames = []
    for moment in np.arange(start, stop + 1e-9, step).tolist():
        figure = _figure(sketch, timeline, moment, size, dots_per_inch)
        dots = io.BytesIO()
        figure.savefig(dots, format="png", facecolor=figure.get_facecolor())
        frames.append(Image.open(dots).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE))
    frames[0].save(
        out, save_all=True, append_images=frames[1:], duration=round(1000.0 / frames_per_second),
        loop=0,
    )  # fmt: skip
    return out


def _figure(
    sketch: Sketch, timeline: str, moment: float, size: float, dots_per_inch: int
) -> Figure:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(size, 0.97 * size), dpi=dots_per_inch)
    axes = figure.add_axes((0.085, 0.12, 0.78, 0.82))
    sketch.draw(axes, timeline, moment)
    sketch.colour_bar(figure.add_axes((0.89, 0.3, 0.022, 0.46)))
    figure.set_facecolor(axes.get_facecolor())
    axes.set_title(sketch.caption(), color=axes.xaxis.label.get_color(), size=9, loc="left")
    return figure


def _moment(at: Mapping[str, float]) -> tuple[str, float]:
    if len(at) != 1:
        raise ValueError(f"the moment is {dict(at)}; expected one of {', '.join(TIMELINES)}")
    ((timeline, moment),) = at.items()
    return timeline, float(moment) if timeline == SIM_TIME else moment
