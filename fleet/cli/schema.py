"""``fleet schema``: what may stand in a file, for editors."""

from __future__ import annotations

import json

import click


@click.command("schema")
@click.argument("kind", type=click.Choice(["scenario", "study"]), default="scenario")
def command(kind: str) -> None:
    """Print the JSON Schema of scenario files, or of study files.

    Copies are in docs/schema. An editor that knows TOML completes and checks a file that begins
    with a line such as "#:schema docs/schema/scenario.json".
    """
    from fleet.scenario.json_schema import scenario_schema
    from fleet.study.study_schema import study_schema

    made = scenario_schema() if kind == "scenario" else study_schema()
    click.echo(json.dumps(made, indent=2))
