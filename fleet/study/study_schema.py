"""The JSON Schema of study files."""

from __future__ import annotations

from fleet.scenario.json_schema import DIALECT, Schema, scenario_schema, table_schema
from fleet.study.side_tables import TABLES


def study_schema() -> Schema:
    """The schema of a study file: a scenario, what varies in it, and seeds."""
    base = table_schema({**scenario_schema()["properties"], "file": {"type": "string"}})
    seed: Schema = {"type": "integer", "minimum": 0}
    axes: Schema = {"type": "object", "additionalProperties": {"type": ["array", "object"]}}
    text: Schema = {"type": "string"}
    keys: dict[str, Schema] = {
        "title": text,
        "scenario": {"anyOf": [{"type": "string", "description": "a scenario file"}, base]},
        "axes": axes,
        "paired": _listed(axes),
        "cases": _listed({"type": "object"}),
        "seeds": {"anyOf": [seed, _listed(seed), table_schema({"first": seed, "count": seed})]},
        "tables": _listed({"enum": sorted(TABLES)}),
        "report": table_schema(
            {"x": text, "series": text, "baseline": {}, "measures": _listed(text)}
        ),
    }
    return {"$schema": DIALECT, "title": "A study of talking-fleet", **table_schema(keys)}


def _listed(items: Schema) -> Schema:
    return {"type": "array", "items": items}
