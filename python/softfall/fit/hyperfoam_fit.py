# SPDX-License-Identifier: GPL-3.0-or-later
"""A hyperfoam fitted to one compression test with free sides: its terms from stress and lateral strain of loading, HU, SHAPE and ALPHA from unloading.

Terms have mu > 0 and 0 <= nu < 0.45, so that the law is stable at any strain."""
from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..array import Array
from ..errors import NumericError
from ..library import Hyperfoam
from .compression import Given
from .curve_fit import POOR, UNLOADING, UNLOADING_HIGH, UNLOADING_LOW, UNLOADING_STARTS, is_at_end, logistic, rms, search

STARTS = (40.0, 14.0, 4.0, -1.0, -3.0, -8.0)  # of alpha: from yield to densification
MOST_NU, MOST_ALPHA, LEAST_ALPHA = 0.45, 49.0, 0.02


@dataclass
class HyperfoamFit:
    """Terms (mu in Pa, alpha, nu) with their standard errors (of mu relative; NaN: not fitted, or at a bound), and what the fit leaves."""

    given: Given
    terms: Array
    error: Array
    at_bound: Array
    correlation: Array
    foam: Hyperfoam
    stress: Array  # Pa, along the test
    lateral: Array  # along the measured lateral strain
    poisson: tuple[float, float]  # at 1 % strain and at the largest
    unloading: Array
    unloading_at_bound: list[str]
    unloading_rms: float
    stress_rms: float = math.nan
    lateral_rms: float = math.nan

    @property
    def misfits(self) -> dict[str, float]:
        """Returns what the fit leaves, over the largest value."""
        found = {"stress while loading": self.stress_rms, "lateral strain": self.lateral_rms, "stress of unloading": self.unloading_rms}
        return {name: value for name, value in found.items() if math.isfinite(value)}

    @property
    def is_good(self) -> bool:
        return not max(self.misfits.values()) > POOR


class _Problem:
    """Stress and lateral strain of loading, each over its largest value and with the same weight in all."""

    def __init__(self, given: Given) -> None:
        self.given, self.test, self.each = given, given.tests[0], 3 if given.lateral else 2
        self.strain = self.test.data.strain[self.test.loading]
        self.weight = 1 / math.sqrt(len(self.strain))
        self.size = max(0.01, float(np.max(np.abs(given.lateral[1])))) if given.lateral else math.nan  # a foam may have no lateral strain

    def foam(self, terms: Any, unloading: Any = (1.0, 1.0, 1.0)) -> Hyperfoam:
        return Hyperfoam(self.given.density, self.given.damp, [tuple(term) for term in terms], list(unloading), self.given.informed)

    def terms(self, x: Array) -> Array:
        """Returns the terms: ln mu, alpha and nu are bounded smoothly."""
        row = np.reshape(x, (-1, self.each))
        alpha = MOST_ALPHA * np.tanh(row[:, 1] / MOST_ALPHA)
        alpha = np.where(np.abs(alpha) < LEAST_ALPHA, np.copysign(LEAST_ALPHA, alpha), alpha)
        nu = MOST_NU * logistic(row[:, 2]) if self.each == 3 else np.full(len(row), self.given.nu)
        return np.column_stack([np.exp(np.minimum(30, row[:, 0])), alpha, nu])

    def residual(self, x: Array) -> Array:
        foam = self.foam(self.terms(x))
        parts: list[Array] = [self.weight * self.test.scaled(foam.loading(self.strain)[0])]
        if self.given.lateral:
            at, measured = self.given.lateral
            parts.append((foam.loading(at)[1] - measured) / (self.size * math.sqrt(len(at))))
        made = np.concatenate(parts)
        if not np.all(np.isfinite(made)):
            raise NumericError("the terms have no stress", 5)
        return made

    def starts(self) -> list[list[float]]:
        """Returns all choices of different alphas, each term with its part of the stress in the middle of the test."""
        middle = self.test.data.loading // 2
        modulus = {}
        for alpha in STARTS:
            alone = float(self.foam([(1.0, alpha, self.given.nu)]).loading(self.strain[middle:middle + 1])[0][0])
            modulus[alpha] = math.log(max(1.0, float(self.test.data.stress[middle])) / (self.given.terms * max(alone, 1e-6)))
        return [[value for alpha in choice for value in (modulus[alpha], MOST_ALPHA * math.atanh(alpha / MOST_ALPHA), -1.0)[:self.each]]
                for choice in itertools.combinations(STARTS, self.given.terms)]


def _errors(p: _Problem, x: Array, terms: Array, covariance: Array, variance: float) -> tuple[Array, Array, Array]:
    row = np.reshape(x, (-1, p.each))
    error, bound = np.full((len(row), 3), math.nan), np.zeros((len(row), 3), dtype=bool)
    bound[:, 1] = (np.abs(terms[:, 1]) <= LEAST_ALPHA) | (np.abs(terms[:, 1]) > (1 - 1e-3) * MOST_ALPHA)
    scale = np.ones((len(row), p.each))
    scale[:, 1] = 1 - (terms[:, 1] / MOST_ALPHA) ** 2
    if p.each == 3:
        part = logistic(row[:, 2])
        bound[:, 2], scale[:, 2] = is_at_end(part), MOST_NU * part * (1 - part)
    spread = np.sqrt(np.maximum(1e-300, np.diag(covariance)))
    error[:, :p.each] = np.where(bound[:, :p.each], math.nan, scale * math.sqrt(variance) * np.reshape(spread, (-1, p.each)))
    return error, bound, covariance / np.outer(spread, spread)


def run(given: Given) -> HyperfoamFit:
    """Fits the terms, then HU, SHAPE and ALPHA; nu is that of every term if no lateral strain was measured."""
    p, test = _Problem(given), given.tests[0]
    least, x, _ = search(p.residual, p.starts())
    if math.isfinite(least):
        least, x, covariance = search(p.residual, [x])
    if not math.isfinite(least):
        raise NumericError(f"no search for {given.terms} terms of the hyperfoam converges", 5)
    terms = p.terms(x)
    count = test.data.loading + (len(given.lateral[0]) if given.lateral else 0)
    error, bound, correlation = _errors(p, x, terms, covariance, least / max(1, count - len(x)))
    unloading, at_bound, left = np.ones(3), [], math.nan
    if len(test.data.strain) - test.data.loading > 3:
        def values(y: Array) -> Array:
            return np.asarray(UNLOADING_LOW + (UNLOADING_HIGH - UNLOADING_LOW) * logistic(y))

        def deviation(y: Array) -> Array:
            return test.scaled(p.foam(terms, values(y)).compress(*test.path_of(), free_sides=True)[1:])[test.unloading]

        left, y, _ = search(deviation, [UNLOADING_STARTS[0]])
        if not math.isfinite(left):
            raise NumericError("no search for HU, SHAPE and ALPHA converges", 5)
        unloading, at_bound, left = values(y), [UNLOADING[k] for k in np.flatnonzero(is_at_end(logistic(y)))], rms(deviation(y))
    foam = p.foam(terms, unloading)
    stress = foam.compress(*test.path_of(), free_sides=True)[1:]
    ends = np.array([0.01, test.data.largest_strain])
    poisson = -np.log1p(foam.loading(ends)[1]) / np.log1p(-ends)
    lateral = foam.loading(given.lateral[0])[1] if given.lateral else np.zeros(0)
    return HyperfoamFit(given, terms, error, bound, correlation, foam, stress, lateral, (float(poisson[0]), float(poisson[1])), unloading, at_bound, left,
                        rms(test.scaled(foam.loading(p.strain)[0])), rms((lateral - given.lateral[1]) / p.size) if given.lateral else math.nan)
