"""Units that columns of logs come in, and their factors to SI."""

from __future__ import annotations

import re
from math import pi

_RPM = pi / 30.0

UNITS: dict[str, dict[str, float]] = {
    "s": {"s": 1.0, "sec": 1.0, "secs": 1.0, "seconds": 1.0, "ms": 1e-3, "msec": 1e-3,
          "us": 1e-6, "µs": 1e-6, "usec": 1e-6, "ns": 1e-9, "nsec": 1e-9, "min": 60.0},
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3},
    "rad": {"rad": 1.0, "deg": pi / 180.0, "°": pi / 180.0, "degrees": pi / 180.0},
    "m/s": {"m/s": 1.0, "m_s": 1.0, "mps": 1.0, "cm/s": 1e-2, "cm_s": 1e-2, "mm/s": 1e-3,
            "mm_s": 1e-3, "km/h": 1.0 / 3.6, "kmh": 1.0 / 3.6, "km_h": 1.0 / 3.6, "kph": 1.0 / 3.6},
    "rad/s": {"rad/s": 1.0, "rad_s": 1.0, "radps": 1.0, "deg/s": pi / 180.0, "°/s": pi / 180.0,
              "deg_s": pi / 180.0, "dps": pi / 180.0, "rpm": _RPM, "1/min": _RPM},
    "W": {"w": 1.0, "watt": 1.0, "watts": 1.0, "mw": 1e-3, "kw": 1e3},
    "V": {"v": 1.0, "volt": 1.0, "volts": 1.0, "mv": 1e-3},
    "A": {"a": 1.0, "amp": 1.0, "amps": 1.0, "ampere": 1.0, "ma": 1e-3},
    "J": {"j": 1.0, "joule": 1.0, "joules": 1.0, "kj": 1e3, "wh": 3600.0, "mwh": 3.6, "kwh": 3.6e6},
}  # fmt: skip
"""For each SI unit, what is written for it, in lower case, and multiples of it."""

_BRACKETS = re.compile(r"[\[(<{]\s*([^\])>}]*?)\s*[\])>}]")


def factor_of(written: str, unit: str) -> float | None:
    """What turns values in the unit that is ``written`` into ``unit``; None: it is no such unit."""
    tidy = written.strip().lower().replace("μ", "µ").replace("·", "").replace(" ", "")
    tidy = tidy.removesuffix("^1").replace("s^-1", "/s").replace("s-1", "/s").replace("//", "/")
    return UNITS[unit].get(tidy)


def split_name(name: str) -> tuple[str, str]:
    """A column's name as words joined by ``_`` in lower case, and the unit in brackets after it.

    ``"Left Speed [mm/s]"`` is ``("left_speed", "mm/s")``, ``curL`` is ``("cur_l", "")``.
    """
    bracketed = _BRACKETS.search(name)
    bare = _BRACKETS.sub(" ", name) if bracketed else name
    bare = re.sub(r"[_ ](mV|mA|[mk]Wh?|kJ|Wh)$", lambda unit: unit[0].lower(), bare.strip())
    bare = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", bare)
    words = re.sub(r"[^0-9A-Za-zµθωφψ]+", "_", bare).strip("_")
    return words.lower(), bracketed[1] if bracketed else ""


def split_suffix(words: str, unit: str) -> tuple[str, str]:
    """A name as :func:`split_name` gives it, and the unit at its end, if it ends in one."""
    for written in sorted(UNITS[unit], key=len, reverse=True):
        stem = words.removesuffix("_" + written.replace("/", "_"))
        if stem != words and stem:
            return stem, written
    return words, ""
