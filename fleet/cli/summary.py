"""A run's summary as a table."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from fleet.results import Summary


def print_summary(summary: Summary) -> None:
    """Print the summary to standard output, units beside the figures."""
    s = summary
    kinds = ", ".join(f"{count} {kind}" for kind, count in s.messages_by_kind.items() if count)
    initial = s.energy_initial
    drained_to_predicted = (
        f" = {s.energy_drained / s.energy_predicted:.3f} × Eq. (1)" if s.energy_predicted else ""
    )
    rows = [
        ("lifetime", f"{s.lifetime} rounds"),
        ("events", f"{s.events} raised, {s.served} served, {s.failed} trips failed"),
        ("messages", f"{s.messages} ({s.messages / max(s.events, 1):.1f} an event: {kinds})"),
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
    table = Table(
        title=f"{s.protocol} on {s.world}, {s.motion} motion, seed {s.seed}\n"
        f"{s.robots} robots, range {s.radio_range} m, search radius {s.search_radius} m",
        show_header=False,
        title_justify="left",
    )
    for name, value in rows:
        table.add_row(name, value)
    Console().print(table)
