"""The radios by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fleet.radio.csma import CsmaSpec
from fleet.radio.hearsay import RadioParameters
from fleet.radio.lossy import RadioSpec
from fleet.radio.trace import TraceSpec


class Entry(NamedTuple):
    """What a radio's parameters make of it (None: ideal), and where it comes from."""

    function: Callable[..., RadioParameters | None]
    source: str


def ideal() -> None:
    """Every transmission arrives at once; neighbours' positions are always known."""


RADIOS: dict[str, Entry] = {
    "ideal": Entry(ideal, "Stanulovic et al., Sensors 21(18):6149, 2021, section 3"),
    "lossy": Entry(RadioSpec, "beacons as GPSR, Karp and Kung, MobiCom 2000"),
    "csma": Entry(CsmaSpec, "IEEE 802.15.4-2020, unslotted CSMA/CA; or IEEE 802.11-2020, DCF"),
    "trace": Entry(TraceSpec, "delivery ratios from measurements, in a table"),
}
