"""What the author of a study may not have meant: said before anything runs, once for all cells."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from fleet.assembly import ground_for, remarks
from fleet.scenario.choices import make_world
from fleet.scenario.loading import scenario_from
from worlds.arena import ImpossibleWorld

if TYPE_CHECKING:
    from fleet.study.design import Study
    from worlds.catalogue import World


def study_remarks(study: Study) -> Iterator[str]:
    """The sentences that ``fleet run`` would say of its scenarios, and of how many of them."""
    cells = study.resolved
    worlds: dict[str, World] = {}
    found: dict[str, list[str]] = {}
    for cell in cells:
        for said in _of(cell.scenario | {"seed": study.seeds[0]}, worlds):
            found.setdefault(said, []).append(cell.name)
    for said, names in found.items():
        some = f" ({len(names)} of {len(cells)} combinations, such as {names[0]})"
        yield said if len(names) == len(cells) else said + some


def _of(tables: dict[str, Any], worlds: dict[str, World]) -> list[str]:
    scenario = scenario_from(tables)
    name = repr(scenario.world)
    world = worlds.get(name) or worlds.setdefault(name, make_world(scenario.world))
    try:
        return list(remarks(scenario, world, ground_for(scenario, world)))
    except ImpossibleWorld:
        return []  # the runs themselves say so, and are counted as failed
