"""A conversation as a sequence chart: robots across, transmissions downwards, kinds by colour."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fleet.replay import scheme

if TYPE_CHECKING:
    from fleet.replay.readback import Recording

ROW = 0.16  # [in] from one transmission to the next
MOST_HIGH = 40.0  # [in]


def chart(
    recording: Path, event: int, out: Path, *, theme: str = "light", size: float = 5.2,
    dots_per_inch: int = 160,
) -> Path:  # fmt: skip
    """Draw all that was said about an event.

    Args:
        recording: the .rrd file.
        event: as it is numbered in the picture, from 1.
        out: the file to write; its ending says what kind (.png, .pdf, .svg ...).
        theme: "light" or "dark".
        size: width of the picture [in].
        dots_per_inch: of formats that are made of dots.

    Raises:
        ValueError: no such file, event or kind of picture, or the file is not a recording.
        OSError: the picture cannot be written.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from fleet.replay.floor_figure import THEMES, FloorFigure, rgb
    from fleet.replay.readback import sound
    from fleet.replay.still import check_ending

    check_ending(out, set(Figure().canvas.get_supported_filetypes()), "picture")
    loaded = sound(recording)
    style, scale = THEMES[theme], FloorFigure.scale(size)
    lines = [row for row in loaded.table(scheme.TRANSCRIPT).to_pylist() if row["event"] == event]
    if not lines:
        raise ValueError(f"{recording}: nothing was said about an event {event}")
    robots = list(dict.fromkeys(r for row in lines for r in _involved(row)))
    across = {robot: k for k, robot in enumerate(robots)}
    height = min(1.5 * scale + ROW * scale * len(lines), MOST_HIGH)
    figure = Figure(figsize=(size, height), dpi=dots_per_inch, facecolor=style.ground)
    margin = 0.5 * scale / height
    axes = figure.add_axes((0.06, margin, 0.9, 1.0 - 2.2 * margin), facecolor=style.ground)
    axes.set(xlim=(-0.16 * len(robots) - 0.1, len(robots) - 0.3), ylim=(len(lines) + 0.8, 0.2))
    axes.vlines(range(len(robots)), 0.2, len(lines) + 0.6, colors=style.ink, lw=0.5, alpha=0.35)
    used: dict[str, str] = {}
    for y, row in enumerate(lines, 1):
        kind = row["kind"] if row["heard"] else "lost"
        colour = rgb(style.kinds.get(kind, scheme.arrow_colour(scheme.messages(kind))))
        used[scheme.KIND_LABELS.get(kind, kind)] = colour
        start = across[row["sender"]]
        for robot in row["heard"] or [r for r in (row["receiver"],) if r >= 0]:
            axes.annotate(
                "", (across[robot], y), (start, y),
                arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.2 * scale,
                            "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7 * scale},
            )  # fmt: skip
        axes.plot(start, y, "o", color=colour, ms=2.4 * scale)
        again = f" ×{row['attempts']}" if row["attempts"] > 1 else ""
        bid = "" if row["cost"] is None else f" {row['cost']:.1f}"
        axes.text(
            -0.15 * len(robots) - 0.1,
            y,
            f"{row['number']}{bid}{again}",
            size=5.5 * scale,
            color=style.ink,
            va="center",
        )
    axes.set_xticks(range(len(robots)), [f"r{robot}" for robot in robots])
    axes.xaxis.tick_top()
    turn = 90 if len(robots) > 14 else 0
    axes.tick_params(colors=style.ink, labelsize=6.5 * scale, length=0, labelrotation=turn)
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)
    handles = [Line2D([], [], color=colour, lw=2.0) for colour in used.values()]
    figure.legend(
        handles, list(used), ncols=min(len(used), 6), loc="lower center", frameon=False,
        fontsize=6.5 * scale, labelcolor=style.ink,
    )  # fmt: skip
    title = f"{loaded.properties['scene']['title']}\n{outcome(loaded, event)}"
    figure.suptitle(title, color=style.ink, size=8.5 * scale, x=0.03, ha="left")
    figure.savefig(out, facecolor=style.ground)
    return out


def outcome(recording: Recording, event: int) -> str:
    """What came of an event, in a line."""
    for task in recording.table(scheme.TASKS).to_pylist():
        if task["event"] == event:
            who = "nobody went" if task["robot"] < 0 else f"r{task['robot']} went"
            return f"event {event}: {who}, {task['outcome']}"
    return f"event {event}"


def _involved(row: dict[str, object]) -> list[int]:
    receiver, heard = row["receiver"], row["heard"]
    assert isinstance(heard, list)
    addressed = [receiver] if isinstance(receiver, int) and receiver >= 0 else []
    return [row["sender"], *addressed, *heard]
