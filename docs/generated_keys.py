"""The table of all scenario keys, with types and defaults as the models have them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fleet.scenario.json_schema import scenario_schema

HEAD = """# Every key, its type and default

Made from the models when these pages are built; [scenarios](../scenarios.md) says what each one
means and in which unit. A dot leads into a table; after a name that is picked (`world = rooms`)
come the parameters of that choice.

| key | type | default |
|---|---|---|
"""


def write(path: Path) -> None:
    """Write the page."""
    rows = (f"| `{key}` | {kind} | {default} |" for key, kind, default in keys(scenario_schema()))
    path.write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")


def keys(schema: dict[str, Any], before: str = "") -> Iterator[tuple[str, str, str]]:
    """Each key below a schema: its path, its type in words, its default as TOML would have it."""
    needed = schema.get("required", ())
    for name, inner in schema.get("properties", {}).items():
        path = f"{before}{name}"
        if "const" in inner:
            continue
        default = json.dumps(inner["default"]) if "default" in inner else ""
        yield path, kind(inner), f"`{default}`" if default else "required" * (name in needed)
        yield from keys(inner, f"{path}.")
        for table in inner.get("anyOf", ()):
            picked = table.get("properties", {})
            if "const" in picked.get("name", {}):
                yield from keys(table, f"{path} = {picked['name']['const']}: ")
            elif "name" not in picked and path == "robot":
                yield from keys(table, "robot.")


def kind(schema: dict[str, Any]) -> str:
    """A type in words."""
    if "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema["enum"])
    if "anyOf" in schema:
        kinds = list(dict.fromkeys(kind(part) for part in schema["anyOf"]))
        return " or ".join(kinds)
    said = schema.get("type", "anything")
    return " or ".join(said) if isinstance(said, list) else {"object": "table"}.get(said, said)
