"""The protocols and bid metrics by name. One line here puts one into scenario files."""

from __future__ import annotations

from collections.abc import Callable
from inspect import isclass, signature
from typing import NamedTuple

from protocols import central, flooding, gfgf, metrics, rfta
from protocols.adaptive import aap
from protocols.connectivity import mia_ta
from protocols.messages import Conversation, ProtocolFunction
from protocols.metrics import Metric
from protocols.rfta3 import rfta3

PAPER = "Stanulovic et al., Sensors 21(18):6149, 2021"
MEZEI = "Mezei et al., IEEE Robotics & Automation Magazine 17(4), 2010"
BOSE = "Bose et al., Wireless Networks 7(6), 2001"


class ProtocolEntry(NamedTuple):
    """A protocol, or a class whose instances are, and where it comes from."""

    function: Callable[..., Conversation] | type[ProtocolFunction]
    source: str
    local: bool = True  # False: it asks robots that nobody has talked to
    searches: bool = True  # hop by hop for the robot that decides


class MetricEntry(NamedTuple):
    """A bid metric, or a class whose instances are, and where it comes from."""

    function: Metric | type[Metric]
    source: str
    unit: str = ""  # of a bid's cost, if it has one


PROTOCOLS: dict[str, ProtocolEntry] = {
    "aap": ProtocolEntry(
        aap,
        "after AAP, doi:10.1177/1550147720932751: the area from the first bids, not from its fit",
    ),
    "assignment": ProtocolEntry(
        central.Assignment,
        "Jonker and Volgenant, Computing 38(4), 1987; all are known",
        local=False,
        searches=False,
    ),
    "bfs": ProtocolEntry(
        flooding.bfs, f"after RODAA as in {PAPER}, section 5: one task at a time", searches=False
    ),
    "face": ProtocolEntry(gfgf.face, BOSE),
    "gfg": ProtocolEntry(central.gfg, f"{BOSE}; the destination from a location service", False),
    "gfgf1": ProtocolEntry(gfgf.gfgf1, f"{PAPER}, section 2.5"),
    "gfgf2": ProtocolEntry(gfgf.gfgf2a, f"{PAPER}, section 2.5"),
    "gfgf2a": ProtocolEntry(gfgf.gfgf2a, f"{PAPER}, section 4.3"),
    "greedy": ProtocolEntry(gfgf.greedy_only, "Finn, ISI/RR-87-180, 1987"),
    "k-saap": ProtocolEntry(flooding.k_saap, MEZEI, searches=False),
    "k-sap": ProtocolEntry(flooding.k_sap, MEZEI, searches=False),
    "mia-ta": ProtocolEntry(
        mia_ta, f"after MIA-TA as in {PAPER}, Table 1: who cuts off no neighbour bids"
    ),
    "optimum": ProtocolEntry(
        central.optimum, "a yardstick: all robots are known", local=False, searches=False
    ),
    "rfta1": ProtocolEntry(rfta.rfta1, f"{PAPER}, section 4.1"),
    "rfta2": ProtocolEntry(rfta.rfta2, f"{PAPER}, section 4.2"),
    "rfta2-iterated": ProtocolEntry(
        rfta.rfta2_iterated, "Mezei et al., Ad Hoc & Sensor Wireless Networks 17(1-2), 2013"
    ),
    "rfta2ge": ProtocolEntry(rfta.rfta2ge, f"{PAPER}, section 4.4"),
    "rfta3": ProtocolEntry(rfta3, "beyond the paper: docs/rfta3.md"),
}

METRICS: dict[str, MetricEntry] = {
    "company-share": MetricEntry(metrics.CompanyShare, "m·d/E_R^b, with company: docs/rfta3.md"),
    "cost-over-left": MetricEntry(
        metrics.cost_over_left, f"{PAPER}, section 6, read as a quotient"
    ),
    "cost-share": MetricEntry(metrics.cost_share, f"{PAPER}, section 6: m·d/E_R"),
    "cost-times-left": MetricEntry(
        metrics.cost_times_left, f"{PAPER}, section 6: m·d(E_R − m·d), lowest", "J²"
    ),
    "distance": MetricEntry(metrics.distance, f"{PAPER}, section 4.1", "m"),
    "energy-left": MetricEntry(metrics.energy_left, f"{PAPER}, section 4.2", "J"),
    "energy-left-minus-cost": MetricEntry(
        metrics.EnergyLeftMinusCost, "energy-left with a weight on the trip", "J"
    ),
    "most-cost-times-left": MetricEntry(
        metrics.most_cost_times_left, f"{PAPER}, section 6: m·d(E_R − m·d), highest", "J²"
    ),
}


def metric_of(protocol: Callable[..., object]) -> tuple[str, str]:
    """The name and the unit of what a protocol's bids are worth; "" of what is not known."""
    bound = getattr(protocol, "keywords", {}).get("metric") or getattr(protocol, "metric", None)
    if bound is None:
        function = getattr(protocol, "func", protocol)
        default = signature(function).parameters.get("metric")
        bound = None if default is None else default.default
    for name, entry in METRICS.items():
        if bound is entry.function or (
            isclass(entry.function) and isinstance(bound, entry.function)
        ):
            return name, entry.unit
    return "" if bound is None else getattr(bound, "__name__", type(bound).__name__), ""
