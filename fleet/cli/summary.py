"""A run's summary as a table."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from fleet.results import Summary
from fleet.service import StreamFigures


def print_summary(summary: Summary) -> None:
    """Print the summary to standard output, units beside the figures."""
    s = summary
    kinds = ", ".join(f"{count} {kind}" for kind, count in s.messages_by_kind.items() if count)
    kinds = f": {kinds}" if kinds else ""
    initial = s.energy_initial
    drained_to_predicted = (
        f" = {s.energy_drained / s.energy_predicted:.3f} × Eq. (1)" if s.energy_predicted else ""
    )
    rows = [
        ("lifetime", _lifetime(s)),
        ("events", f"{s.events} raised, {s.served} served, {s.failed} trips failed"),
        ("messages", f"{s.messages} ({s.messages / max(s.events, 1):.1f} an event{kinds})"),
        ("messages per robot", f"{s.messages_per_robot:.2f}"),
        ("hops", f"{s.hops_greedy} greedy, {s.hops_face} face"),
        ("energy predicted", f"{s.energy_predicted:.1f} J by Eq. (1) on straight lines"),
        ("energy drained", f"{s.energy_drained:.1f} J of {initial:.0f} J{drained_to_predicted}"),
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
        ("simulated time", f"{s.simulated_time:.1f} s"),
        ("wall time", f"{s.wall_time:.2f} s"),
    ]
    if s.stream is not None:
        rows[2:2] = _stream_rows(s.stream)
    table = Table(
        title=f"{s.protocol} on {s.world}, {s.motion} motion, seed {s.seed}\n"
        f"{s.robots} robots, range {s.radio_range} m, search radius {s.search_radius} m",
        show_header=False,
        title_justify="left",
    )
    for name, value in rows:
        table.add_row(name, value)
    Console().print(table)


def _lifetime(summary: Summary) -> str:
    if summary.stream is None:
        return f"{summary.lifetime} rounds"
    first, tolerated = summary.stream.lifetime_first, summary.stream.lifetime_tolerated
    if first is None:
        return "to the end: every event was served"
    kept = "to the end" if tolerated is None else f"until {tolerated:.1f} s"
    return (
        f"{summary.lifetime} events in {first:.1f} s, then one that was never served;"
        f" nine of ten were served {kept}"
    )


def _stream_rows(stream: StreamFigures) -> list[tuple[str, str]]:
    """What only streams have."""
    reasons = "; ".join(f"{count} {reason}" for reason, count in stream.lost_by_reason.items())
    each = "none" if stream.messages_per_served is None else f"{stream.messages_per_served:.1f}"
    joules = "none" if stream.energy_per_served is None else f"{stream.energy_per_served:.1f} J"
    return [
        (
            "not served",
            f"{stream.waiting} waiting, {stream.expired} expired, {stream.lost} lost"
            + (f" ({reasons})" if reasons else ""),
        ),
        ("response time", _response(stream)),
        ("backlog", f"{stream.backlog_mean:.2f} events on average, {stream.backlog_most} at most"),
        ("throughput", f"{stream.throughput:.3f} events/s"),
        ("utilisation", f"robots engaged {stream.utilisation:.1%} of the time"),
        ("an event served", f"{each} messages, {joules} by Eq. (1)"),
        ("conversations", f"{stream.conversations}, {stream.broken} of them broken off"),
        ("winners already taken", f"{stream.conflicts}"),
        ("searches begun anew", f"{stream.restarts}"),
        ("frames", f"{stream.repeated} repeated, {stream.unheard} heard by nobody"),
        ("beacons, sensor messages", f"{stream.beacons}, {stream.sensor_messages}"),
        ("breakdowns, relocations", f"{stream.breakdowns}, {stream.relocations}"),
    ]


def _response(stream: StreamFigures) -> str:
    if stream.response_mean is None:
        return "none served"
    return (
        f"{stream.response_mean:.2f} s on average, median {stream.response_median:.2f} s,"
        f" 90 % within {stream.response_p90:.2f} s, 99 % within {stream.response_p99:.2f} s"
    )
