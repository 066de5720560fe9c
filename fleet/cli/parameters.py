"""What options take, where click's own types would say it in other words than we do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click


class Value(click.ParamType[Any]):
    """A scenario value as it stands in TOML; the scenario says whether it is of the right type."""

    def __init__(self, name: str) -> None:
        self.name = name

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """Read it; what is no TOML is text."""
        from fleet.scenario.toml import parse_value

        try:
            return parse_value(value) if isinstance(value, str) else value
        except ValueError as error:
            self.fail(str(error), param, ctx)


class RecordingFile(click.ParamType[Path]):
    """Where a recording is to be written: a file of Rerun's, by its ending."""

    name = "path"

    def convert(self, value: Any, param: Any, ctx: Any) -> Path:
        """Look at its ending before anything runs."""
        path = Path(value)
        if path.suffix != ".rrd":
            hint = "; `fleet picture` makes clips of a recording" if path.suffix else ""
            self.fail(f"is {str(value)!r}; expected a file that ends in .rrd{hint}", param, ctx)
        return path
