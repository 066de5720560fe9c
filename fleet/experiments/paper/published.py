"""Numbers as printed in Tables 2 and 3."""

from __future__ import annotations

from typing import NamedTuple


class MeanSd(NamedTuple):
    """A mean and a standard deviation, where the paper gives one."""

    mean: float
    sd: float | None = None


class PrintedRow(NamedTuple):
    """A line of the tables: its name there, and the figure of a summary that it is."""

    name: str
    unit: str
    key: str
    scale: float = 1.0  # from the summary's unit to the table's


ROWS = (
    PrintedRow("Average messages per robot (AMPR)", "messages", "messages_per_robot"),
    PrintedRow("Average network lifetime (ANL)", "rounds", "lifetime"),
    PrintedRow("Average minimum of remaining robot energy", "%", "energy_left_min"),
    PrintedRow("Average remaining robot energy (ARRE)", "%", "energy_left_mean"),
    PrintedRow("Average number of robot reactions (ANRR)", "", "reactions_per_robot"),
    PrintedRow("Average traveled distance per robot (ATDPR)", "m", "distance_per_robot"),
)
"""A full battery holds 100 J, so that joules left are per cent left."""

PROTOCOLS = ("gfgf2a", "rfta2", "rfta2ge")

TABLES: dict[str, dict[str, dict[str, MeanSd]]] = {
    "random": {
        "gfgf2a": {
            "messages_per_robot": MeanSd(14.79, 5.51),
            "lifetime": MeanSd(225.11, 88.51),
            "energy_left_min": MeanSd(7.39),
            "energy_left_mean": MeanSd(79.52, 6.98),
            "reactions_per_robot": MeanSd(2.13, 0.81),
            "distance_per_robot": MeanSd(1.06, 0.36),
        },
        "rfta2": {
            "messages_per_robot": MeanSd(43.32, 12.23),
            "lifetime": MeanSd(323.14, 122.69),
            "energy_left_min": MeanSd(11.33),
            "energy_left_mean": MeanSd(44.81, 20.17),
            "reactions_per_robot": MeanSd(3.07, 1.14),
            "distance_per_robot": MeanSd(2.85, 1.04),
        },
        "rfta2ge": {
            "messages_per_robot": MeanSd(68.64, 15.39),
            "lifetime": MeanSd(376.35, 96.94),
            "energy_left_min": MeanSd(5.95),
            "energy_left_mean": MeanSd(35.04, 13.98),
            "reactions_per_robot": MeanSd(3.57, 0.84),
            "distance_per_robot": MeanSd(3.35, 0.72),
        },
    },
    "random-hole": {
        "gfgf2a": {
            "messages_per_robot": MeanSd(6.45, 3.63),
            "lifetime": MeanSd(85.60, 57.25),
            "energy_left_min": MeanSd(11.49),
            "energy_left_mean": MeanSd(90.56, 5.48),
            "reactions_per_robot": MeanSd(0.82, 0.56),
            "distance_per_robot": MeanSd(0.49, 0.28),
        },
        "rfta2": {
            "messages_per_robot": MeanSd(13.62, 6.29),
            "lifetime": MeanSd(260.16, 123.88),
            "energy_left_min": MeanSd(12.00),
            "energy_left_mean": MeanSd(53.44, 20.76),
            "reactions_per_robot": MeanSd(2.47, 1.15),
            "distance_per_robot": MeanSd(2.39, 1.07),
        },
        "rfta2ge": {
            "messages_per_robot": MeanSd(57.62, 18.13),
            "lifetime": MeanSd(319.87, 105.66),
            "energy_left_min": MeanSd(8.03),
            "energy_left_mean": MeanSd(41.93, 16.88),
            "reactions_per_robot": MeanSd(3.05, 0.95),
            "distance_per_robot": MeanSd(2.99, 0.87),
        },
    },
}

IMPOSSIBLE = {
    ("random-hole", "rfta2", "messages_per_robot"): (
        "13.62 messages a robot over 260 rounds are 5.2 a round, fewer than the same table's"
        " GFGF2A spends (7.5), whose route RFTA2 takes before it calls and hears bids"
    ),
}
"""Cells that cannot be as printed, and why."""

FIGURES: dict[int, dict[tuple[str, str], str]] = {
    7: {(w, "rfta1"): "around 25 % more than GFGF2" for w in ("random", "random-hole")},
    8: {(w, "gfgf2"): "55 to 90 %" for w in ("random", "random-hole")},
    9: {
        ("random", "7-saap"): "7-SAAP up to 10 times RFTA2, 3 times RFTA2GE (messages)",
        ("random", "bfs-7"): "BFS almost 30 times RFTA2",
        ("random", "bfs-10"): "BFS-10 twice BFS-7",
    },
    10: {
        ("random", "7-saap"): "a seventh of RFTA2 and RFTA2GE (lifetime)",
        ("random", "bfs-7"): "BFS-7 much as 7-SAAP",
        ("random", "bfs-10"): "BFS-10 twice BFS-7, a sixth of RFTA2",
    },
    11: {("random", "rfta2"): "around 350 rounds at the longest, constant for r > 0.2"},
    13: {
        ("random", "rfta2ge"): "up to almost 400 rounds",
        ("random-hole", "rfta2ge"): "a little lower with the hole",
    },
    14: {(w, "rfta2ge"): "around 40 messages" for w in ("random", "random-hole")},
    15: {(w, "rfta2ge"): "RFTA2GE around four times the others" for w in ("random", "random-hole")},
    16: {
        ("random", "gfgf2a"): "RFTA2 and RFTA2GE almost twice GFGF2A",
        ("random-hole", "gfgf2a"): "almost four times with the hole, where GFGF2A is a fourth",
    },
}
"""What the text says of the figures, by topology and series; their points are not printed."""
