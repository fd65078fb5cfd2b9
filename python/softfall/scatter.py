# SPDX-License-Identifier: GPL-3.0-or-later
"""Repeated drops: how much they scatter, and which interval that leaves to a mean and to a height read off between measured heights."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Iterable, Sequence

import numpy as np
from scipy.special import stdtrit

from .array import Array

LEAST = 0.01  # of a standard deviation: drops of one pad are never told apart by less, as in the advice
ENOUGH = 3  # degrees of freedom from which on repeats alone give the interval
GRID = 400  # points between two heights


@dataclass(frozen=True)
class Scatter:
    """The standard deviation of ln(figure) from drop to drop on one spot, and its degrees of freedom; 0: no spot has two drops."""

    sd: float
    freedom: int

    def half(self, count: float | Array) -> Array:
        """Returns half of the 95 % interval of the mean ln(figure) of `count` drops, by Student's t."""
        width: Array = np.asarray(stdtrit(self.freedom, 0.975) * self.sd / np.sqrt(count))
        return width


def of_repeats(spots: Iterable[Sequence[float]]) -> Scatter:
    """Returns the scatter within spots, all alike, of the figures of the drops on each.

    >>> of_repeats([[100.0, 100.0 * math.exp(0.2)]]).freedom, round(of_repeats([[100.0, 100.0 * math.exp(0.2)]]).sd, 6)
    (1, 0.141421)
    """
    squares, freedom = 0.0, 0
    for values in spots:
        log = np.log(np.array([value for value in values if value > 0]))
        if log.size > 1:
            squares, freedom = squares + float(((log - log.mean()) ** 2).sum()), freedom + log.size - 1
    return Scatter(max(LEAST, math.sqrt(squares / freedom)) if freedom else math.nan, freedom)


def of_mean(value: float, count: int, scatter: Scatter | None) -> tuple[float, float]:
    """Returns the 95 % interval of a mean of `count` drops; NaN: there are no repeats."""
    if scatter is None or not scatter.freedom or not value > 0:
        return math.nan, math.nan
    half = float(scatter.half(count))
    return value * math.exp(-half), value * math.exp(half)


def of_crossing(heights: Sequence[float], values: Sequence[float], counts: Sequence[int], limit: float, scatter: Scatter) -> tuple[float, float]:
    """Returns the 95 % interval of the height (m) where means of `counts` drops first reach a limit on straight lines in logarithms.

    It holds the heights at which the interval of the line holds the limit (Fieller's, of a straight line). 0: the lowest height does not bound it
    from below; inf: the highest does not from above.
    """
    x, y, n = np.log(np.array(heights)), np.log(np.array(values)), np.array(counts, float)
    at = np.arange(GRID * (x.size - 1) + 1) / GRID
    k = np.minimum(at.astype(int), max(x.size - 2, 0))
    after = np.minimum(k + 1, x.size - 1)
    part = at - k
    line, height = y[k] + part * (y[after] - y[k]), np.exp(x[k] + part * (x[after] - x[k]))
    half = scatter.half(1 / ((1 - part) ** 2 / n[k] + part**2 / n[after]))
    return _first(height, line + half - math.log(limit), 0.0), _first(height, line - half - math.log(limit), math.inf)


def _first(height: Array, excess: Array, outside: float) -> float:
    """Returns the height where the excess first reaches 0; inf: nowhere; at the lowest one `outside` if that is 0."""
    if not (excess >= 0).any():
        return math.inf
    k = int(np.argmax(excess >= 0))
    if k == 0:
        return 0.0 if outside == 0 else float(height[0])
    part = -excess[k - 1] / (excess[k] - excess[k - 1])
    return float(height[k - 1] * (height[k] / height[k - 1]) ** part)
