"""What the author of a scenario may want to know, on standard error."""

from __future__ import annotations

import click

from fleet.observer import Observer


class Notices(Observer):
    """Says it, a line each."""

    def noticed(self, said: str) -> None:
        """A sentence."""
        click.echo(f"fleet: {said}", err=True)
