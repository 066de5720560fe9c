"""``fleet picture``: a moment of a recording as a picture, or a stretch of it as a clip."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from typing import Any

import click

TIMELINES = {
    "round": "round",
    "msg": "msg",
    "message": "msg",
    "time": "sim_time",
    "story": "story",
}
IN_SECONDS = ("sim_time", "story")
THEMES = ("light", "dark")


class MomentType(click.ParamType[dict[str, float]]):
    """A moment on one of the timelines, such as round=12, as ``{"round": 12.0}``."""

    name = "moment"

    def convert(self, value: Any, param: Any, ctx: Any) -> dict[str, float]:
        """Take the text apart."""
        if isinstance(value, dict):
            return value
        timeline, _, number = str(value).partition("=")
        timeline = TIMELINES.get(timeline, timeline)
        try:
            moment = float(number)
        except ValueError:
            moment = float("nan")
        if timeline not in TIMELINES.values() or not isfinite(moment):
            self.fail(f"{value!r} is no moment; expected round=12, msg=345 or sim_time=6.78")
        if timeline not in IN_SECONDS and not moment.is_integer():
            self.fail(f"{value!r} is no moment; expected a whole number")
        return {timeline: moment}


MOMENT = MomentType()


@click.command("picture")
@click.argument("recording", type=click.Path(path_type=Path))
@click.option("--at", type=MOMENT, metavar="MOMENT",
              help="Draw this: round=12, msg=345 or sim_time=6.78 (seconds).")  # fmt: skip
@click.option("--from", "start", type=MOMENT, metavar="MOMENT", help="Make a clip from here")
@click.option("--to", "stop", type=MOMENT, metavar="MOMENT", help="to here, both included.")
@click.option("--chart", type=click.IntRange(min=1), metavar="EVENT",
              help="Draw the sequence chart of what was said about this event.")  # fmt: skip
@click.option("-o", "--out", type=click.Path(path_type=Path), required=True,
              help="A picture: .png, .pdf, .svg ...; a clip: .gif, .webp, or .mp4 with ffmpeg.",
              )  # fmt: skip
@click.option("--theme", type=click.Choice(THEMES), default="light",
              help="The ground: light for paper, dark for screens.  [light]")  # fmt: skip
@click.option(
    "--fps", "frames_per_second", type=float, default=10.0, help="Frames a second of a clip.  [10]"
)
@click.option("--speed", type=float, default=1.0,
              help="Simulated seconds in a second of a clip, while robots drive.  [1]")  # fmt: skip
@click.option("--width", "size", type=click.FloatRange(3.2, 40.0), help="In inches.  [5.2]")
@click.option(
    "--dpi", "dots_per_inch", type=click.IntRange(30, 1200), help="Dots an inch.  [160; clips: 130]"
)
def command(
    recording: Path,
    at: dict[str, float] | None,
    start: dict[str, float] | None,
    stop: dict[str, float] | None,
    chart: int | None,
    out: Path,
    **style: Any,
) -> None:
    """Draw a moment of a recording, or a clip of a stretch of it, without a viewer.

    A clip of rounds shows one transmission after another, then the drive.
    """
    from fleet.scenario.errors import bad

    given = {name: value for name, value in style.items() if value is not None}
    pace = {name: given.pop(name) for name in ("frames_per_second", "speed")}
    wanted = [at is not None, chart is not None, start is not None or stop is not None]
    if sum(wanted) != 1 or (start is None) != (stop is None):
        raise bad(
            "",
            "expected either --at, for a picture, or --from and --to, for a clip, or --chart, for"
            " what was said about an event",
        )
    try:
        out.absolute().parent.mkdir(parents=True, exist_ok=True)
        if at is not None:
            from fleet.replay.still import picture

            picture(recording, at, out, **given)
        elif chart is not None:
            from fleet.replay.chart_figure import chart as draw_chart

            draw_chart(recording, chart, out, **given)
        elif start is not None and stop is not None:
            from fleet.replay.clip import clip

            with progress() as show:
                clip(recording, start, stop, out, progress=show, **pace, **given)
    except OSError as error:
        raise bad("", f"cannot write {out}: {error.strerror or error}") from error
    except ValueError as error:
        raise bad("", str(error)) from error
    click.echo(out)


@contextmanager
def progress() -> Iterator[Callable[[int, int], object]]:
    """A bar of frames, on standard error, for those who watch a terminal."""
    if not sys.stderr.isatty():
        yield lambda _done, _of: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        row = bar.add_task("drawing", total=None)
        yield lambda done, of: bar.update(row, completed=done, total=of)
