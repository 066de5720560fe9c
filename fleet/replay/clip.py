"""Short clips of a recording: conversations message by message, drives at the speed of life."""

from __future__ import annotations

import io
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fleet.replay.colormap import TABLE
from fleet.replay.scheme import (
    EVENT_COLOUR,
    KIND_COLOURS,
    LOG,
    LOST_COLOUR,
    MSG,
    RELOCATION_COLOUR,
    ROUND,
    ROUTING_COLOUR,
    SIM_TIME,
    TRIPS,
)
from fleet.replay.still import check_ending, draw, the_moment

if TYPE_CHECKING:
    from PIL.Image import Image

    from fleet.replay.readback import Recording


ENDINGS = {"gif", "webp", "mp4"}
MEANT = (*KIND_COLOURS.values(), LOST_COLOUR, EVENT_COLOUR, RELOCATION_COLOUR, ROUTING_COLOUR)
SHADES = 64  # of energy
COMMON = 48  # colours that cover the most
COLOURS = 255  # of a GIF
MOST_FRAMES = 3000
LINGER = 1.0  # [s] that the last picture stays
NANO = 1e9

Frame: TypeAlias = tuple[str, float]
"""A timeline, and the moment on it that is drawn."""


def clip(
    recording: Path,
    start: Mapping[str, float],
    stop: Mapping[str, float],
    out: Path,
    *,
    frames_per_second: float = 10.0,
    speed: float = 1.0,
    theme: str = "light",
    size: float = 5.2,
    dots_per_inch: int = 130,
    progress: Callable[[int, int], object] = lambda _done, _of: None,
) -> Path:
    """Draw a stretch of a recording as a GIF, a WebP animation, or with ffmpeg as an MP4.

    Args:
        recording: the .rrd file.
        start: the moment it begins at, on one timeline, as for ``picture``.
        stop: the moment it ends at, on the same one. By "round", it lasts until that round is
            over, and shows each transmission, then the drive; by "msg", a frame for each
            transmission; by "sim_time", what is to be seen then.
        out: the file to write: .gif, .webp or .mp4.
        frames_per_second: of the clip.
        speed: simulated seconds that pass in a second of the clip, while robots drive.
        theme: "light" or "dark".
        size: width of the clip [in].
        dots_per_inch: times size, its width in dots.
        progress: is told how many frames are drawn, of how many.

    Raises:
        ValueError: no such file or moment, nothing between the two, too many frames, or the
            file is not a recording; or ffmpeg is needed and is not installed.
        OSError: the clip cannot be written.
    """
    from PIL import Image

    from fleet.replay.floor_figure import FloorFigure
    from fleet.replay.readback import sound

    for name, value in (("speed", speed), ("frames a second", frames_per_second)):
        if not value > 0.0:
            raise ValueError(f"{name} is {value:g}; expected more than 0")
    check_ending(out, ENDINGS, "clip")
    ffmpeg = shutil.which("ffmpeg")
    if out.suffix.lower() == ".mp4" and ffmpeg is None:
        raise ValueError(f"{out}: an .mp4 takes ffmpeg, which is not installed; a .gif does not")
    loaded = sound(recording)
    moments = frames(loaded, start, stop, speed / frames_per_second)
    floor = FloorFigure(loaded, theme)
    drawn: list[Image.Image] = []
    for timeline, moment in moments:
        figure = draw(floor, timeline, moment, size, dots_per_inch)
        dots = io.BytesIO()
        figure.savefig(dots, format="png", facecolor=figure.get_facecolor())
        drawn.append(Image.open(dots).convert("RGB"))
        progress(len(drawn), len(moments))
    if out.suffix.lower() == ".mp4" and ffmpeg is not None:
        _film(ffmpeg, drawn, out, frames_per_second)
    else:
        _animate(drawn, out, frames_per_second)
    return out


def frames(
    recording: Recording, start: Mapping[str, float], stop: Mapping[str, float], step: float
) -> list[Frame]:
    """What a clip shows, ``step`` [s] of simulated time apart while robots drive.

    Raises:
        ValueError: no such moments, the last before the first, or too many frames.
    """
    (timeline, first), (other, last) = the_moment(start), the_moment(stop)
    if timeline != other:
        raise ValueError(f"the clip runs from a {timeline} to a {other}; expected one timeline")
    for moment in (first, last):
        recording.check_moment(timeline, moment)
    if first > last:
        raise ValueError(f"the clip runs from {first:g} to {last:g}; expected the end last")
    if timeline == MSG:
        found: list[Frame] = [(MSG, float(msg)) for msg in range(int(first), int(last) + 1)]
    elif timeline == SIM_TIME:
        found = [(SIM_TIME, time) for time in [*_between(first, last, step), last]]
    else:
        found = [*_rounds(recording, first, last, step), (ROUND, last)]
    if len(found) > MOST_FRAMES:
        raise ValueError(
            f"the clip would have {len(found)} frames; expected {MOST_FRAMES} or fewer:"
            " choose a shorter stretch, or a higher speed"
        )
    return found


def _rounds(recording: Recording, first: float, last: float, step: float) -> Iterator[Frame]:
    """Each transmission of some rounds, and the drives between them."""
    lines = recording.rows(LOG, "TextLog:level")
    rounds, times = lines.moments[ROUND], lines.moments[SIM_TIME] / NANO
    inside = (rounds >= first) & (rounds <= last)
    later = times[rounds > last]
    end = float(later.min()) if len(later) else recording.span(SIM_TIME)[1]
    now = float(times[inside].min()) if inside.any() else end
    messages = inside & np.array([level == ["TRACE"] for level in lines.values], bool)
    numbers, at = lines.moments[MSG][messages], times[messages]
    order = np.argsort(numbers)
    trips = recording.table(TRIPS)
    departed, ended = (np.round(trips[name].to_numpy(), 9) for name in ("departed", "ended"))
    for number, time in zip(numbers[order].tolist(), at[order].tolist(), strict=True):
        for moment in _between(now + step, time, step):
            yield SIM_TIME, moment
            now = moment
        yield MSG, float(number)
        if not (
            (departed < time) & (round(time, 9) < ended)
        ).any():  # else the drive goes on as it did
            now = max(now, time)
    yield from ((SIM_TIME, moment) for moment in _between(now + step, end, step))


def _between(start: float, stop: float, step: float) -> list[float]:
    """Moments from ``start`` up to, and without, ``stop``."""
    if (stop - start) / step > MOST_FRAMES:
        stop = start + (MOST_FRAMES + 1) * step  # too many in any case: frames() says so
    moments: list[float] = np.arange(start, stop, step).tolist()
    return moments


def _animate(drawn: list[Image], out: Path, frames_per_second: float) -> None:
    from PIL import Image

    frame = round(1000.0 / frames_per_second)
    durations = [frame] * (len(drawn) - 1) + [frame + round(1000.0 * LINGER)]
    if out.suffix.lower() == ".gif":
        palette = _palette(drawn)
        drawn = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in drawn]
    drawn[0].save(out, save_all=True, append_images=drawn[1:], duration=durations, loop=0)


def _palette(drawn: list[Image]) -> Image:
    """An image with the colours that all frames share.

    A colour says what an arrow is and what a battery holds, but arrows are thin and robots small:
    those colours are there as they are. So are the commonest, such as the ground. The others share
    what is left of the palette.
    """
    from PIL import Image

    digits = np.array([1 << 16, 1 << 8, 1], np.uint32)
    packed, counts = np.unique(
        np.concatenate([(np.asarray(image, np.uint32) @ digits).ravel() for image in drawn]),
        return_counts=True,
    )
    colours = np.stack([packed >> 16, packed >> 8 & 255, packed & 255], axis=-1).astype(np.uint8)
    meant = np.array([(c >> 24, c >> 16 & 255, c >> 8 & 255) for c in MEANT], np.uint8)
    common = colours[np.argsort(-counts, kind="stable")[:COMMON]]
    kept = np.concatenate([meant, TABLE[:: len(TABLE) // SHADES], common])
    left = COLOURS - len(kept)
    rest = Image.fromarray(colours[None]).quantize(left, dither=Image.Dither.NONE).getpalette()
    shared = Image.new("P", (1, 1))
    shared.putpalette([*kept.ravel().tolist(), *(rest or ())[: 3 * left]])
    return shared


def _film(ffmpeg: str, drawn: list[Image], out: Path, frames_per_second: float) -> None:
    """An MP4 that any player takes: H.264 of an even number of dots."""
    with tempfile.TemporaryDirectory() as folder:
        still = [drawn[-1]] * round(LINGER * frames_per_second)
        for k, image in enumerate([*drawn, *still]):
            image.save(Path(folder) / f"{k:05}.png", compress_level=1)
        made = subprocess.run(  # noqa: S603 - the encoder that was asked for
            [
                ffmpeg, "-y", "-loglevel", "error", "-framerate", f"{frames_per_second:g}",
                "-i", f"{folder}/%05d.png", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                "-pix_fmt", "yuv420p", "-movflags", "+faststart", str(out.absolute()),
            ],
            capture_output=True, text=True, check=False,
        )  # fmt: skip
    if made.returncode != 0:
        reason = made.stderr.strip().splitlines()[-1:] or [f"exit code {made.returncode}"]
        raise OSError(f"{out}: ffmpeg could not write it: {reason[0]}")
