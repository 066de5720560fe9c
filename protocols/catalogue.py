"""The protocols and bid metrics by name. One line here puts one into scenario files."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from protocols.gfgf import gfgf2a
from protocols.messages import Conversation
from protocols.metrics import Metric, distance, energy_left
from protocols.rfta import rfta2

PAPER = "Stanulovic et al., Sensors 21(18):6149, 2021"


class ProtocolEntry(NamedTuple):
    """A protocol, and where it comes from. Its docstring says what it does."""

    function: Callable[..., Conversation]  # view, event, source; parameters by keyword
    source: str


class MetricEntry(NamedTuple):
    """A bid metric, or a class whose instances are, and where it comes from."""

    function: Metric | type[Metric]
    source: str


PROTOCOLS: dict[str, ProtocolEntry] = {
    "gfgf2a": ProtocolEntry(gfgf2a, f"{PAPER}, section 4.3"),
    "rfta2": ProtocolEntry(rfta2, f"{PAPER}, section 4.2"),
}

METRICS: dict[str, MetricEntry] = {
    "distance": MetricEntry(distance, f"{PAPER}, section 4.1"),
    "energy-left": MetricEntry(energy_left, f"{PAPER}, section 4.2"),
}
