"""All that a scenario can name, and the one way to look it up."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fleet.modes import Rounds, Stream
from fleet.motion.motions import MOTIONS
from fleet.radio.csma import CsmaSpec
from fleet.radio.ideal import ideal
from fleet.radio.lossy import RadioSpec
from fleet.radio.trace import TraceSpec
from fleet.robot import PRESETS
from fleet.scenario.errors import bad, unknown
from protocols.catalogue import METRICS, PROTOCOLS
from worlds.catalogue import EVENTS, WORLDS


class Entry(NamedTuple):
    """What takes the parameters of something, and where it comes from."""

    function: Callable[..., Any]
    source: str


PAPER = "Stanulovic et al., Sensors 21(18):6149, 2021"

TIMES: dict[str, Entry] = {
    "rounds": Entry(Rounds, f"{PAPER}, section 5"),
    "stream": Entry(Stream, "Poisson by default; see the events"),
}

RADIOS: dict[str, Entry] = {
    "ideal": Entry(ideal, f"{PAPER}, section 3"),
    "lossy": Entry(RadioSpec, "beacons as GPSR, Karp and Kung, MobiCom 2000"),
    "csma": Entry(CsmaSpec, "IEEE 802.15.4-2020, unslotted CSMA/CA; or IEEE 802.11-2020, DCF"),
    "trace": Entry(TraceSpec, "delivery ratios from measurements, in a table"),
}

CATALOGUES: dict[str, Mapping[str, Any]] = {
    "protocol": PROTOCOLS,
    "metric": METRICS,
    "world": WORLDS,
    "motion": MOTIONS,
    "time": TIMES,
    "events": EVENTS,
    "radio": RADIOS,
    "preset": PRESETS,
}
"""By kind: what there is, by name."""


def known_name(kind: str, name: str) -> str | None:
    """The name as the catalogue of this ``kind`` spells it, upper or lower case; None: unknown."""
    catalogue = CATALOGUES[kind]
    if name in catalogue:
        return name
    folded = name.casefold()
    return next((known for known in catalogue if known.casefold() == folded), None)


def look_up(kind: str, name: str, key: str) -> Any:
    """The entry of that name, upper or lower case.

    Raises:
        BadInput: there is none; ``key`` is where it was named. Near matches are suggested.
    """
    known = known_name(kind, name)
    if known is None:
        raise bad(key, unknown(kind, name, CATALOGUES[kind]))
    return CATALOGUES[kind][known]


def takers(kind: str) -> dict[str, Callable[..., Any]]:
    """By name, what takes the parameters of each of this ``kind``."""
    return {name: parameters_of(entry) for name, entry in CATALOGUES[kind].items()}


def parameters_of(entry: Any) -> Callable[..., Any]:
    """What takes an entry's parameters: its function, or the options of a motion."""
    taker: Callable[..., Any] = getattr(entry, "options", entry.function)
    return taker
