"""The protocols by name. One line here puts a protocol into scenario files."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from protocols.gfgf import gfgf2a
from protocols.messages import Conversation
from protocols.rfta import rfta2

PAPER = "Stanulovic et al., Sensors 21(18):6149, 2021"


class Entry(NamedTuple):
    """A protocol function, and where it comes from. Its docstring says what it does."""

    function: Callable[..., Conversation]
    source: str


PROTOCOLS: dict[str, Entry] = {
    "gfgf2a": Entry(gfgf2a, f"{PAPER}, section 4.3"),
    "rfta2": Entry(rfta2, f"{PAPER}, section 4.2"),
}
