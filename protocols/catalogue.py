"""The protocols and bid metrics by name. One line here puts one into scenario files."""

from __future__ import annotations

from collections.abc import Callable
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


class MetricEntry(NamedTuple):
    """A bid metric, or a class whose instances are, and where it comes from."""

    function: Metric | type[Metric]
    source: str


PROTOCOLS: dict[str, ProtocolEntry] = {
    "aap": ProtocolEntry(
        aap,
        "after AAP, doi:10.1177/1550147720932751: the area from the first bids, not from its fit",
    ),
    "assignment": ProtocolEntry(
        central.Assignment, "Jonker and Volgenant, Computing 38(4), 1987; all are known", False
    ),
    "bfs": ProtocolEntry(flooding.bfs, f"after RODAA as in {PAPER}, section 5: one task at a time"),
    "face": ProtocolEntry(gfgf.face, BOSE),
    "gfg": ProtocolEntry(central.gfg, f"{BOSE}; the destination from a location service", False),
    "gfgf1": ProtocolEntry(gfgf.gfgf1, f"{PAPER}, section 2.5"),
    "gfgf2": ProtocolEntry(gfgf.gfgf2a, f"{PAPER}, section 2.5"),
    "gfgf2a": ProtocolEntry(gfgf.gfgf2a, f"{PAPER}, section 4.3"),
    "greedy": ProtocolEntry(gfgf.greedy_only, "Finn, ISI/RR-87-180, 1987"),
    "k-saap": ProtocolEntry(flooding.k_saap, MEZEI),
    "k-sap": ProtocolEntry(flooding.k_sap, MEZEI),
    "mia-ta": ProtocolEntry(
        mia_ta, f"after MIA-TA as in {PAPER}, Table 1: who cuts off no neighbour bids"
    ),
    "optimum": ProtocolEntry(central.optimum, "a yardstick: all robots are known", False),
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
        metrics.cost_times_left, f"{PAPER}, section 6: m·d(E_R − m·d), lowest"
    ),
    "distance": MetricEntry(metrics.distance, f"{PAPER}, section 4.1"),
    "energy-left": MetricEntry(metrics.energy_left, f"{PAPER}, section 4.2"),
    "energy-left-minus-cost": MetricEntry(
        metrics.EnergyLeftMinusCost, "energy-left with a weight on the trip"
    ),
    "most-cost-times-left": MetricEntry(
        metrics.most_cost_times_left, f"{PAPER}, section 6: m·d(E_R − m·d), highest"
    ),
}
