"""Bad input, said in one sentence: the key, the value, and what was expected."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any


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


def unknown(what: str, name: str, known: Iterable[str]) -> str:
    """``name`` is not among the ``known`` ones; the near matches, or all."""
    names = sorted(known)
    near = get_close_matches(name, names, 3, 0.6)
    if near:
        return f"unknown {what} {name!r}; did you mean {or_list(near)}?"
    return f"unknown {what} {name!r}; expected {or_list(names)}"


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
        return f"is {value!r}; expected {context['expected']}"
    expected = EXPECTED.get(kind)
    if expected is None:
        return f"is {value!r}; {message[0].lower()}{message[1:]}"
    return f"is {value!r}; expected {expected}"
