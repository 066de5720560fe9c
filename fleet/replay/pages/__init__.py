"""Everything that is drawn of a run."""

from __future__ import annotations

from collections.abc import Sequence

from fleet.replay.pages.bodies import Bodies
from fleet.replay.pages.cards import Cards
from fleet.replay.pages.counts import Counts
from fleet.replay.pages.lifetime import Lifetime
from fleet.replay.pages.links import Links
from fleet.replay.pages.roles import Roles
from fleet.replay.pages.talk import Talk
from fleet.replay.pages.tree import Tree
from fleet.replay.pages.trips import Trips
from fleet.replay.pages.words import Words
from fleet.replay.story import Page


def pages() -> Sequence[Page]:
    """One of each."""
    return (
        Bodies(), Links(), Trips(), Talk(), Roles(), Words(), Cards(), Tree(), Counts(), Lifetime()
    )  # fmt: skip
