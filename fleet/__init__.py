"""Robot fleets that drive, talk and run out of energy.

>>> import fleet
>>> fleet.run(fleet.Scenario.of(protocol="rfta2", motion="straight", seed=1)).lifetime
"""

from __future__ import annotations

TYPE_CHECKING = False  # typing's, which takes its time to import
if TYPE_CHECKING:
    from typing import Any

    from fleet.assembly import run
    from fleet.observer import Observer
    from fleet.playthrough import Playthrough, play
    from fleet.results import Summary
    from fleet.scenario.model import Scenario
    from fleet.study.design import Study
    from fleet.study.result import StudyResult
    from fleet.study.sweeping import sweep

__all__ = [
    "Observer",
    "Playthrough",
    "Scenario",
    "Study",
    "StudyResult",
    "Summary",
    "__version__",
    "play",
    "run",
    "sweep",
]

__version__ = "0.1.0"

_HOMES = {
    "Playthrough": "fleet.playthrough",
    "play": "fleet.playthrough",
    "Observer": "fleet.observer",
    "Scenario": "fleet.scenario.model",
    "Study": "fleet.study.design",
    "StudyResult": "fleet.study.result",
    "Summary": "fleet.results",
    "run": "fleet.assembly",
    "sweep": "fleet.study.sweeping",
}


def __getattr__(name: str) -> Any:
    """Load what is asked for when it is asked for: ``fleet --help`` needs none of it."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)
