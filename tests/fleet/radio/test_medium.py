"""The shared air against closed forms: slots, hidden terminals, Bianchi's saturation throughput."""

from __future__ import annotations

from heapq import heappop, heappush
from itertools import count
from math import inf

import numpy as np
import pytest
from scipy.optimize import brentq

from fleet.radio.access import Timing
from fleet.radio.stations import Standard, Stations

US = 1000  # [ns]


class Clock:
    """A schedule of its own, in whole nanoseconds."""

    def __init__(self):
        self.heap, self.order, self.now = [], count(), 0

    def at(self, time, action):
        assert time >= self.now
        heappush(self.heap, (time, next(self.order), action))

    def run(self, until=inf):
        while self.heap and self.heap[0][0] <= until:
            self.now, _, action = heappop(self.heap)
            action()


def timing(**changed):
    plain = {
        "slot": 320 * US, "sense": 0, "turnaround": 0, "acknowledgement": 352 * US,
        "patience": 864 * US, "preamble": 0, "least": 8, "most": 32, "looks": 4,
    }  # fmt: skip
    return Timing(**(plain | changed))


def stations(power, clock, seed, *, survives=lambda *_: True, **changed):
    """Stations whose frames arrive at one another with ``power`` (n, n)."""
    defaults = {
        "timing": timing(), "bit": 1000, "distributed": True, "retries": 0, "capture": 2.0,
        "sensing": 1.0,
    }  # fmt: skip
    rng = np.random.default_rng(seed)
    n = len(power)
    heard = [[(w, power[u][w]) for w in range(n) if w != u and power[u][w] > 0] for u in range(n)]
    return Stations(
        n,
        heard.__getitem__,
        survives,
        Standard(**(defaults | changed)),
        clock.at,
        lambda _robot, most: int(rng.integers(most)),
    )


def everybody(n):
    return np.ones((n, n)) - np.eye(n)


def test_in_slots_a_frame_gets_through_if_nobody_else_chose_its_slot():
    n, slots, rounds = 8, 16, 1500
    slotted = timing(slot=1_000_000, least=slots, most=slots)
    through = []
    for seed in range(rounds):
        clock = Clock()
        air = stations(everybody(n), clock, seed, timing=slotted, sensing=inf)
        for sender in range(n):
            air.send(sender, None, 1000, lambda d: through.append(len(d.heard) == n - 1), 0)
        clock.run()
    expected = (1 - 1 / slots) ** (n - 1)
    error = 3 * np.sqrt(expected * (1 - expected) / (rounds * n)) * 2  # frames of a round depend
    assert np.mean(through) == pytest.approx(expected, abs=error)


@pytest.mark.parametrize("hidden", [True, False])
def test_hidden_terminals_collide_wherever_they_overlap_others_only_in_the_same_slot(hidden):
    """0 and 2 send to 1. Of W² pairs of slots those collide that are closer than the frame."""
    window, slot, airtime, rounds = 64, 100_000, 1_000_000, 3000
    power = np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]], float)
    if not hidden:
        power[0, 2] = power[2, 0] = 1.0
    got = []
    for seed in range(rounds):
        clock = Clock()
        air = stations(power, clock, seed, timing=timing(slot=slot, least=window, most=window))
        for sender in (0, 2):
            air.send(sender, None, airtime // 1000, lambda d: got.append(1 in d.heard), 0)
        clock.run()
    apart = np.abs(np.subtract.outer(np.arange(window), np.arange(window))) * slot
    collide = (apart < (airtime if hidden else slot)).mean()
    assert np.mean(got) == pytest.approx(1 - collide, abs=4 * np.sqrt(collide / rounds))


def bianchi(n, least, stages, slot, success, collision, payload):
    """Saturation throughput of the DCF (Bianchi, IEEE JSAC 18(3), 2000, eqs 7, 9, 13)."""

    def tau(p):
        return 2 * (1 - 2 * p) / ((1 - 2 * p) * (least + 1) + p * least * (1 - (2 * p) ** stages))

    p = brentq(lambda p: p - (1 - (1 - tau(p)) ** (n - 1)), 1e-9, 0.499999)
    some = 1 - (1 - tau(p)) ** n
    one = n * tau(p) * (1 - tau(p)) ** (n - 1) / some
    idle = (1 - some) * slot
    return some * one * payload / (idle + some * one * success + some * (1 - one) * collision)


@pytest.mark.parametrize("n", [5, pytest.param(10, marks=pytest.mark.slow), 20])
def test_saturation_throughput_is_bianchis(n):
    """His example: 1 Mbit/s, payload 8184 bits, headers 400 bits, window 32, five doublings."""
    slot, sifs, difs, ack = 50 * US, 28 * US, 128 * US, 240 * US
    clock = Clock()
    wifi = timing(
        slot=slot, sense=difs, turnaround=sifs, acknowledgement=ack, patience=sifs + ack + 1,
        least=32, most=32 * 2**5,
    )  # fmt: skip
    air = stations(everybody(n), clock, 1, timing=wifi, retries=60)
    carried = []

    def refill(sender):
        def done(delivery):
            carried.extend(delivery.heard)
            air.send(sender, (sender + 1) % n, 8184 + 400, done, delivery.end)

        return done

    for sender in range(n):
        air.send(sender, (sender + 1) % n, 8184 + 400, refill(sender), 0)
    seconds = 30
    clock.run(seconds * 10**9)
    success = (8584 * US + sifs + ack + difs) / 1e9
    collision = (8584 * US + difs) / 1e9
    expected = bianchi(n, 32, 5, slot / 1e9, success, collision, 8184 / 1e6)
    assert len(carried) * 8184e-6 / seconds == pytest.approx(expected, rel=0.05)
