"""Numbers as printed in Tables 2 and 3."""

from __future__ import annotations

from typing import NamedTuple


class Cell(NamedTuple):
    """A mean and a standard deviation, where the paper gives one."""

    mean: float
    sd: float | None = None


class Row(NamedTuple):
    """A line of the tables: its name there, and the figure of a summary that it is."""

    name: str
    unit: str
    key: str
    scale: float = 1.0  # from the summary's unit to the table's


ROWS = (
    Row("Average messages per robot (AMPR)", "messages", "messages_per_robot"),
    Row("Average network lifetime (ANL)", "rounds", "lifetime"),
    Row("Average minimum of remaining robot energy", "%", "energy_left_min"),
    Row("Average remaining robot energy (ARRE)", "%", "energy_left_mean"),
    Row("Average number of robot reactions (ANRR)", "", "reactions_per_robot"),
    Row("Average traveled distance per robot (ATDPR)", "m", "distance_per_robot"),
)
"""A full battery holds 100 J, so that joules left are per cent left."""

PROTOCOLS = ("gfgf2a", "rfta2", "rfta2ge")

TABLES: dict[str, dict[str, dict[str, Cell]]] = {
    "random": {
        "gfgf2a": {
            "messages_per_robot": Cell(14.79, 5.51),
            "lifetime": Cell(225.11, 88.51),
            "energy_left_min": Cell(7.39),
            "energy_left_mean": Cell(79.52, 6.98),
            "reactions_per_robot": Cell(2.13, 0.81),
            "distance_per_robot": Cell(1.06, 0.36),
        },
        "rfta2": {
            "messages_per_robot": Cell(43.32, 12.23),
            "lifetime": Cell(323.14, 122.69),
            "energy_left_min": Cell(11.33),
            "energy_left_mean": Cell(44.81, 20.17),
            "reactions_per_robot": Cell(3.07, 1.14),
            "distance_per_robot": Cell(2.85, 1.04),
        },
        "rfta2ge": {
            "messages_per_robot": Cell(68.64, 15.39),
            "lifetime": Cell(376.35, 96.94),
            "energy_left_min": Cell(5.95),
            "energy_left_mean": Cell(35.04, 13.98),
            "reactions_per_robot": Cell(3.57, 0.84),
            "distance_per_robot": Cell(3.35, 0.72),
        },
    },
    "random-hole": {
        "gfgf2a": {
            "messages_per_robot": Cell(6.45, 3.63),
            "lifetime": Cell(85.60, 57.25),
            "energy_left_min": Cell(11.49),
            "energy_left_mean": Cell(90.56, 5.48),
            "reactions_per_robot": Cell(0.82, 0.56),
            "distance_per_robot": Cell(0.49, 0.28),
        },
        "rfta2": {
            "messages_per_robot": Cell(13.62, 6.29),
            "lifetime": Cell(260.16, 123.88),
            "energy_left_min": Cell(12.00),
            "energy_left_mean": Cell(53.44, 20.76),
            "reactions_per_robot": Cell(2.47, 1.15),
            "distance_per_robot": Cell(2.39, 1.07),
        },
        "rfta2ge": {
            "messages_per_robot": Cell(57.62, 18.13),
            "lifetime": Cell(319.87, 105.66),
            "energy_left_min": Cell(8.03),
            "energy_left_mean": Cell(41.93, 16.88),
            "reactions_per_robot": Cell(3.05, 0.95),
            "distance_per_robot": Cell(2.99, 0.87),
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
