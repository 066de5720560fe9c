"""A run's summary as a table."""

from __future__ import annotations

import json
import sys

import click
from rich.console import Console
from rich.table import Table

from fleet.observer import Observer
from fleet.results import Summary
from fleet.summary_lines import summary_lines, title


class SummaryFirst(Observer):
    """Prints the summary as soon as the run has ended; observers after it may take their time."""

    def __init__(self, *, as_json: bool) -> None:
        self._as_json = as_json
        self._summary: Summary | None = None

    def run_ended(self, summary: Summary) -> None:
        """Keep it until the bar of progress is gone."""
        self._summary = summary

    def closed(self) -> None:
        """Print it, unless the run broke off."""
        if self._summary is None:
            return
        if self._as_json:
            click.echo(json.dumps(self._summary.as_dict()))
        else:
            print_summary(self._summary)
        sys.stdout.flush()


def print_summary(summary: Summary) -> None:
    """Print the summary to standard output, units beside the figures."""
    table = Table(title=title(summary), show_header=False, title_justify="left")
    for name, value in summary_lines(summary):
        table.add_row(name, value)
    Console().print(table)
