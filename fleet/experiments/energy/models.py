"""Models of what a trip costs: Eq. (1), and Eq. (1) with a few fitted terms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import nan

import numpy as np

from fleet.experiments.energy.accuracy import Accuracy, accuracy, expanded, resampled
from fleet.experiments.energy.trip_table import FloatArray, TripTable
from fleet.study.statistics import Interval

Term = Callable[[TripTable], FloatArray]


@dataclass(frozen=True, slots=True)
class Model:
    """What is known, and terms whose coefficients are fitted, each with its unit."""

    name: str
    known: Term
    terms: tuple[tuple[str, str, Term], ...] = ()


@dataclass(frozen=True, slots=True)
class Fit:
    """A model with the coefficients of its terms, and their intervals."""

    model: Model
    coefficients: tuple[Interval, ...]

    def predict(self, trips: TripTable) -> FloatArray:
        """What the model says of each trip (n,) [J]."""
        said = self.model.known(trips)
        for (_, _, term), coefficient in zip(self.model.terms, self.coefficients, strict=True):
            said = said + coefficient.value * term(trips)
        return np.asarray(said)


def _nothing(trips: TripTable) -> FloatArray:
    return np.zeros(len(trips))


def _once(trips: TripTable) -> FloatArray:
    return np.ones(len(trips))


def _straight(trips: TripTable) -> FloatArray:
    return np.asarray(trips["straight"], float)


def _eq1(trips: TripTable) -> FloatArray:
    return trips.eq1


def _eq1_planned(trips: TripTable) -> FloatArray:
    return np.asarray(trips["per_metre"] * trips["planned"])


def _root_turn(trips: TripTable) -> FloatArray:
    """A pivot from rest to rest takes 2·√(angle/acceleration)."""
    return np.asarray(np.sqrt(trips["turn"]))


LAUNCH = ("a launch", "J", _once)

EQ1 = Model("Eq. (1)", _eq1)
LINE = Model("any line in the straight distance", _nothing, (LAUNCH, ("a metre", "J", _straight)))
STRAIGHT_LAUNCH = Model("Eq. (1) + launch", _eq1, (LAUNCH,))
PLANNED = Model("Eq. (1) on the planned path", _eq1_planned)
CORRECTED = Model("Eq. (1) on the planned path + launch", _eq1_planned, (LAUNCH,))
TURNED = Model("the same + turn", _eq1_planned, (LAUNCH, ("a √rad turned", "J", _root_turn)))
MODELS = (EQ1, LINE, STRAIGHT_LAUNCH, PLANNED, CORRECTED, TURNED)


def fit(model: Model, trips: TripTable, seed: int = 0) -> Fit:
    """Least squares; intervals by a percentile bootstrap over placements."""
    if not model.terms:
        return Fit(model, ())
    matrix = np.column_stack([term(trips) for _, _, term in model.terms])
    rest = trips["drained"] - model.known(trips)
    _, which = np.unique(trips["placement"], return_inverse=True)
    groups, terms = int(which.max()) + 1, matrix.shape[1]
    products = np.zeros((groups, terms, terms))
    sums = np.zeros((groups, terms))
    np.add.at(products, which, matrix[:, :, None] * matrix[:, None, :])
    np.add.at(sums, which, matrix * rest[:, None])
    best = np.linalg.solve(products.sum(axis=0), sums.sum(axis=0))
    low, high = np.full(terms, nan), np.full(terms, nan)
    if groups > 1:
        weights = resampled(groups, seed)
        drawn = np.linalg.solve(np.tensordot(weights, products, 1), (weights @ sums)[:, :, None])[
            :, :, 0
        ]
        low, high = np.quantile(drawn, expanded(groups), axis=0)
    return Fit(model, tuple(map(Interval, best.tolist(), low.tolist(), high.tolist())))


def halves(trips: TripTable) -> tuple[TripTable, TripTable]:
    """Trips to fit on and trips to test on: every other placement, so that none is in both."""
    order = np.unique(trips["placement"])
    chosen = np.isin(trips["placement"], order[::2])
    return trips.take(chosen), trips.take(~chosen)


def held_out(model: Model, trips: TripTable) -> tuple[Fit, Accuracy]:
    """The model fitted on one half of the placements, and how it does on the other."""
    mine, others = halves(trips)
    fitted = fit(model, mine)
    return fitted, accuracy(others["drained"], fitted.predict(others))
