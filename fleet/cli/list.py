"""``fleet list``: what there is to choose from."""

from __future__ import annotations

import inspect

import click


@click.command("list")
def command() -> None:
    """All that a scenario can name, with one line and the source of each."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from fleet.catalogue import CATALOGUES

    console = Console()
    for kind, catalogue in CATALOGUES.items():
        if kind == "preset":
            continue  # a robot has no docstring
        table = Table(kind, "what it does", "source", title_justify="left", expand=True)
        table.columns[0].no_wrap = True
        for name, entry in sorted(catalogue.items()):
            table.add_row(name, escape(first_sentence(entry.function)), escape(entry.source))
        console.print(table)


def first_sentence(function: object) -> str:
    """The first paragraph of a docstring, on one line."""
    paragraph = (inspect.getdoc(function) or "").partition("\n\n")[0]
    return " ".join(paragraph.split())
