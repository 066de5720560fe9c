"""A run's summary in words and units: on the terminal, and in a notebook."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fleet.results import Summary
    from fleet.service import StreamFigures


def title(summary: Summary) -> str:
    """What was run, on two lines."""
    s = summary
    return (
        f"{s.protocol} on {s.world}, {s.motion} motion, seed {s.seed}\n"
        f"{s.robots} robots, range {s.radio_range} m, search radius {s.search_radius} m"
    )


def summary_lines(summary: Summary) -> list[tuple[str, str]]:
    """What came of it: names, and figures with their units."""
    s = summary
    kinds = ", ".join(f"{count} {kind}" for kind, count in s.messages_by_kind.items() if count)
    kinds = f": {kinds}" if kinds else ""
    initial = s.energy_initial
    drained_to_predicted = (
        f" = {s.energy_drained / s.energy_predicted:.3f} × Eq. (1)" if s.energy_predicted else ""
    )
    return [
        ("lifetime", _lifetime(s)),
        ("the run ended", s.ended),
        ("events", f"{s.events} raised, {s.served} served, {s.failed} trips failed"),
        ("not served", _not_served(s)),
        ("messages", f"{s.messages} ({s.messages / max(s.events, 1):.1f} an event{kinds})"),
        ("messages per robot", f"{s.messages_per_robot:.2f}"),
        ("hops", f"{s.hops_greedy} greedy, {s.hops_face} face"),
        ("energy predicted", f"{s.energy_predicted:.1f} J by Eq. (1) on straight lines"),
        ("energy drained", f"{s.energy_drained:.1f} J of {initial:.0f} J{drained_to_predicted}"),
        ("of that", _accounts(s)),
        (
            "energy left per robot",
            f"{s.energy_left_mean:.1f} ± {s.energy_left_sd:.1f} J, least {s.energy_left_min:.1f} J",
        ),
        ("reactions per robot", f"{s.reactions_per_robot:.2f}"),
        (
            "distance per robot",
            f"{s.distance_per_robot:.2f} m straight, {s.path_per_robot:.2f} m driven",
        ),
        ("closest robot found", f"{s.closest_found:.1%} of the events"),
        *(_stream_rows(s.stream) if s.stream is not None else ()),
        *_air_rows(s),
        ("simulated time", f"{s.simulated_time:.1f} s"),
        ("wall time", f"{s.wall_time:.2f} s"),
    ]


def as_html(summary: Summary) -> str:
    """The same as a table for a notebook."""
    rows = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th>"
        f"<td style='text-align:left'>{escape(said)}</td></tr>"
        for name, said in summary_lines(summary)
    )
    caption = escape(title(summary)).replace("\n", "<br>")
    return f"<table><caption style='text-align:left'>{caption}</caption>{rows}</table>"


def _lifetime(summary: Summary) -> str:
    stream = summary.stream
    if stream is None:
        cut_off = ", or more: cut off before an event was not served"
        return f"{summary.lifetime} rounds{cut_off if summary.censored else ''}"
    first, tolerated = stream.lifetime_first, stream.lifetime_tolerated
    if first is None:
        return f"{summary.lifetime} events, to the end: every event was served"
    kept = "to the end" if tolerated is None else f"until {tolerated:.1f} s"
    return (
        f"{summary.lifetime} events in {first:.1f} s, then one that was never served;"
        f" nine of ten were served {kept}"
    )


def _not_served(summary: Summary) -> str:
    reasons = "; ".join(f"{count} {reason}" for reason, count in summary.lost_by_reason.items())
    waiting, expired, lost = summary.waiting, summary.expired, summary.lost
    each = f"{waiting} waiting, {expired} expired, {lost} lost"
    return f"{each} ({reasons})" if reasons else each


def _accounts(summary: Summary) -> str:
    """What the energy went into, the largest part first; what is written as nothing is left out."""
    parts = sorted(summary.energy_by_account.items(), key=lambda part: -abs(part[1]))
    written = ((name, f"{energy:.1f}") for name, energy in parts)
    return ", ".join(f"{n} {e} J" for n, e in written if float(e) != 0.0) or "nothing"


def _stream_rows(stream: StreamFigures) -> list[tuple[str, str]]:
    """What only streams have."""
    within = "none" if stream.within_deadline is None else f"{stream.within_deadline:.1%} of all"
    return [
        ("reached by the deadline", within),
        ("response, if served", _response(stream)),
        ("backlog", f"{stream.backlog_mean:.2f} events on average, {stream.backlog_most} at most"),
        ("throughput", f"{stream.throughput:.3f} events/s"),
        ("utilisation", f"robots engaged {stream.utilisation:.1%} of the time"),
        ("an event served", _each(stream)),
    ]


def _each(stream: StreamFigures) -> str:
    if stream.messages_per_served is None:
        return "none"
    return (
        f"{stream.messages_per_served:.1f} messages, {stream.energy_drained_per_served:.1f} J"
        f" drained, {stream.energy_predicted_per_served:.1f} J by Eq. (1)"
    )


def _air_rows(s: Summary) -> list[tuple[str, str]]:
    """What the radio, faults and sensors did, where they did anything."""
    rows = [
        ("conversations", f"{s.conversations}, {s.broken} broken off", s.broken),
        ("winners already taken", f"{s.conflicts}", s.conflicts),
        ("searches begun anew", f"{s.restarts}", s.restarts),
        (
            "frames",
            f"{s.repeated} repeated, {s.unheard} heard by nobody, {s.beacons} beacons",
            s.repeated + s.unheard + s.beacons,
        ),
        (
            "on the air",
            f"{s.frames_on_air} frames, {s.frames_drowned} drowned, {s.doubts} left in doubt",
            s.frames_on_air,
        ),
        ("sensor messages", f"{s.sensor_messages}", s.sensor_messages),
        (
            "breakdowns, relocations",
            f"{s.breakdowns}, {s.relocations}",
            s.breakdowns + s.relocations,
        ),
    ]
    streamed = s.stream is not None
    return [(name, said) for name, said, count in rows if count or streamed]


def _response(stream: StreamFigures) -> str:
    if stream.response_mean is None:
        return "none served"
    return (
        f"{stream.response_mean:.2f} s on average, median {stream.response_median:.2f} s,"
        f" 90 % within {stream.response_p90:.2f} s, 99 % within {stream.response_p99:.2f} s"
    )
