"""Seeds are added until a measure is known well enough, and then it is as well known as said."""

from __future__ import annotations

import numpy as np
import pytest

from fleet.scenario.errors import BadInput
from fleet.study.statistics import mean_interval
from fleet.study.sweeping import sweep
from fleet.study.until import FEWEST, Target, seeds_wanted, target

DRAWS = {
    "normal": lambda rng, n: rng.normal(1.0, 0.25, n),
    "uniform": lambda rng, n: rng.uniform(0.5, 1.5, n),
    "skewed": lambda rng, n: rng.gamma(9.0, 1.0 / 9.0, n),
}
"""Synthetic studies of mean 1."""


@pytest.mark.parametrize("text", ["lifetime ±2%", "lifetime +-2 %", " lifetime+/-2.0% "])
def test_a_target_is_read_as_people_write_it(text):
    assert target(text) == Target("lifetime", pytest.approx(0.02))


@pytest.mark.parametrize(
    "text", ["lifetime", "lifetime 2%", "lifetime ±0%", "lifetime ±120%", "±2%", "lifetime ±.%"]
)
def test_what_is_no_target_is_refused(text):
    with pytest.raises(BadInput, match="expected a measure and a width, as 'lifetime ±2%'"):
        target(text)


def test_a_measure_that_there_is_not_is_refused_before_any_run(tmp_path):
    with pytest.raises(BadInput, match="unknown measure 'lifetim'; did you mean 'lifetime'"):
        sweep({}, tmp_path / "out", until="lifetim ±2%")
    assert not (tmp_path / "out").exists()


def test_few_seeds_are_never_enough_and_growth_is_bounded():
    assert seeds_wanted([1.0] * 5, "lifetime", 0.1) == FEWEST
    assert seeds_wanted([1.0] * 20, "lifetime", 0.1) == 20
    rng = np.random.default_rng(0)
    wide = rng.normal(1.0, 5.0, 20)
    assert seeds_wanted(wide, "lifetime", 0.001) == 80
    just = rng.normal(1.0, 0.1, 20)
    half = mean_interval(just).high - just.mean()
    assert seeds_wanted(just, "lifetime", 1.001 * half / just.mean()) == 20
    assert seeds_wanted(just, "lifetime", 0.999 * half / just.mean()) == 25


def stopped(draw, rng, share):
    sample = draw(rng, FEWEST)
    while (more := seeds_wanted(sample, "lifetime", share)) > len(sample):
        sample = np.concatenate([sample, draw(rng, more - len(sample))])
    return mean_interval(sample)


@pytest.mark.slow
@pytest.mark.parametrize("kind", DRAWS)
def test_the_interval_of_a_study_that_was_stopped_holds_the_mean_as_often_as_said(kind):
    """4000 synthetic studies: at least 94 % of intervals, and all of them narrow enough."""
    rng = np.random.default_rng(11)
    held = 0
    for number in range(4000):
        share = (0.03, 0.05, 0.08, 0.12)[number % 4]
        found = stopped(DRAWS[kind], rng, share)
        assert max(found.high - found.value, found.value - found.low) <= share * found.value + 1e-12
        held += found.low <= 1.0 <= found.high
    assert held / 4000 >= 0.94


def test_a_sweep_adds_seeds_until_it_is_enough_and_goes_on_from_there(tmp_path):
    study = {
        "scenario": {"motion": "straight", "robots": 40, "range": 3.0, "rounds": 15},
        "axes": {"protocol": ["rfta2", "gfgf2a"]},
        "seeds": 2,
    }
    said: list[str] = []
    result = sweep(study, tmp_path, workers=1, until="messages_per_event ±20%", say=said.append)
    rows = list(result.rows())
    seeds = sorted({row["seed"] for row in rows})
    assert seeds == list(range(len(seeds)))
    assert len(seeds) >= FEWEST
    assert len(rows) == 2 * len(seeds)
    for protocol in ("rfta2", "gfgf2a"):
        each = [r["messages"] / r["events"] for r in rows if r["protocol"] == protocol]
        mean, _, high = mean_interval(each)
        assert high - mean <= 0.2 * mean
    assert said[-1].endswith(f"with {len(seeds)} seeds")
    again: list[str] = []
    sweep(study, tmp_path, workers=1, until="messages_per_event ±20%", say=again.append)
    assert again == said[-1:]
