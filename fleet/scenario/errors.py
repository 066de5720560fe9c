"""Bad input, said in one sentence: the key, the value, and what was expected."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import date, time
from difflib import get_close_matches
from typing import Any

MOST_SHOWN = 60  # characters of a value that is echoed
MOST_SAID = 300  # characters of one sentence
MOST_LISTED = 12  # names that are listed where none is near


class BadInput(ValueError):
    """Something the user gave cannot be used. ``problems`` are (key, sentence) pairs."""

    def __init__(self, problems: Iterable[tuple[str, str]]) -> None:
        self.problems = tuple(problems)
        super().__init__(
            "\n".join(f"{key}: {text}" if key else text for key, text in self.problems)
        )


def bad(key: str, text: str) -> BadInput:
    """One problem with one key."""
    return BadInput([(key, text)])


def shown(value: Any, most: int = MOST_SHOWN) -> str:
    """``value`` as it is echoed to whoever gave it: on one line, shortened in its middle."""
    if isinstance(value, int) and abs(value) >= 10**most:
        return f"a whole number of {value.bit_length() * 0.30103:.0f} digits"
    if isinstance(value, list | tuple | dict) and len(value) > most:  # half of it will do
        value = list(value)[:most]
    try:
        text = str(value) if isinstance(value, date | time) else repr(value)
    except (RecursionError, ValueError):  # nested too deeply, or with numbers too long to write
        return f"a {type(value).__name__}"
    return shortened(text, most)


def shortened(text: str, most: int) -> str:
    """``text`` on one line, without its middle if it is longer than ``most`` characters."""
    text = "".join(c if c.isprintable() else "·" for c in " ".join(text.split()))
    if len(text) <= most:
        return text
    half = (most - 1) // 2
    return f"{text[:half]}…{text[-half:]}"


def unknown(what: str, name: str, known: Iterable[str]) -> str:
    """``name`` is not among the ``known`` ones; the near matches, or all if they are few."""
    names = sorted(known)
    folded = {n.casefold(): n for n in reversed(names)}
    near = get_close_matches(name.casefold()[:MOST_SHOWN], folded, 3, 0.6)
    said = f"unknown {what} {shown(name)}"
    if near:
        return f"{said}; did you mean {or_list(folded[n] for n in near)}?"
    if len(names) > MOST_LISTED:
        return f"{said}; expected one of {len(names)}, such as {or_list(names[:3])}"
    return f"{said}; expected {or_list(names)}"


def or_list(names: Iterable[str]) -> str:
    """'a', 'b' or 'c'."""
    quoted = [repr(name) for name in names]
    return " or ".join([", ".join(quoted[:-1]), quoted[-1]] if len(quoted) > 1 else quoted)


EXPECTED = {
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "string_type": "text in quotes",
    "bool_type": "true or false",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "a table",
    "dataclass_type": "a table",
    "none_required": "nothing",
}


def sentence(kind: str, value: Any, context: dict[str, Any], message: str) -> str:
    """What pydantic found, in the project's words."""
    if kind == "value_error":
        return str(context["error"])
    if kind == "missing":
        return "is missing; it is required"
    if kind == "literal_error":
        return f"is {shown(value)}; expected {context['expected']}"
    expected = EXPECTED.get(kind)
    if expected is None:
        return f"is {shown(value)}; {message[0].lower()}{message[1:]}"
    return f"is {shown(value)}; expected {expected}"
