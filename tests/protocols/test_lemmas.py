"""Lemmas 1, 3 and 4 of the paper, as far as they hold."""

from __future__ import annotations

import numpy as np
import pytest
from hand_drawn import converse, network, random_connected, random_points

from fleet.experiments.paper.theory import lemma_1_bound
from protocols.rfta import rfta2, rfta2ge


@pytest.mark.parametrize(("radius", "bound"), [(1.0, 0.54), (2.0, 0.96), (3.0, 1.0), (4.0, 1.0)])
def test_lemma_1_bounds_the_chance_of_a_robot_near_the_event(radius, bound):
    """P(R) ≥ 1 − (1 − πR²/4)^(N−1) for N = 100 in the unit square, here 10 m wide."""
    formula = lemma_1_bound(radius)
    assert formula == pytest.approx(bound, abs=0.005)
    rng = np.random.default_rng(1)
    hits = 0
    for _ in range(1000):
        robots = np.array(random_points(100, 10.0, rng))
        event = np.array(random_points(1, 10.0, rng)[0])
        hits += bool((np.hypot(*(robots - event).T) <= radius).any())
    assert hits / 1000 >= formula - 0.02


@pytest.mark.parametrize("protocol", [rfta2, rfta2ge])
def test_lemmas_3_and_4_bound_steps_and_messages(protocol):
    """Steps ≤ n·c, and for one hop M ≤ (F + 1)·deg + 2 with F = c − n + 1 inner faces.

    The messages of Lemma 4 are counted with deg the largest degree, the auctioneer's being
    what it stands for; a route longer than the faces it walks would break the bound.
    """
    rng = np.random.default_rng(2)
    for _ in range(60):
        view = network(random_connected(60, 10.0, 2.0, rng), 2.0)
        n, c = len(view), sum(len(robot.neighbours) for robot in view) // 2
        assert n - 1 <= c < 3 * n
        talk = converse(protocol, view, random_points(1, 10.0, rng)[0], int(rng.integers(n)))
        assert len(talk.route) <= n * c
        if protocol is rfta2:
            deg = max(len(robot.neighbours) for robot in view)
            assert len(talk.transcript) <= (c - n + 2) * deg + 2
