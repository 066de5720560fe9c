"""Who hears whom: the graphs of a fleet by their definitions, and the live one.

``graphs`` computes a graph whole. ``live`` keeps one up to date robot by robot; its loops are
compiled: ``cells`` finds who is near, ``relinking`` links a neighbourhood anew. ``witness`` has
the rule that both go by.
"""

from protocols.topology.graphs import (
    Edges,
    GraphName,
    component_count,
    components,
    connected,
    edges,
    unit_disc,
)
from protocols.topology.live import NOWHERE, Topology
from protocols.topology.witness import between

__all__ = [
    "NOWHERE",
    "Edges",
    "GraphName",
    "Topology",
    "between",
    "component_count",
    "components",
    "connected",
    "edges",
    "unit_disc",
]
