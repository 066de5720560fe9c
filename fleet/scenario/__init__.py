"""Scenarios: what one run is made of, from a TOML file, the command line or Python."""

from fleet.scenario.errors import BadInput
from fleet.scenario.loading import load_scenario, scenario_from
from fleet.scenario.model import Choice, Scenario

__all__ = ["BadInput", "Choice", "Scenario", "load_scenario", "scenario_from"]
