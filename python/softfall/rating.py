# SPDX-License-Identifier: GPL-3.0-or-later
"""How well a curve agrees with a measured one: the objective rating of ISO/TS 18571.

The text of the standard could not be read. The definitions and constants are those that several public implementations of it agree
on (corridor 0.05 and 0.5 of the peak with exponent 2; shifts up to a fifth of the length; magnitude 0.5 after dynamic time warping in
a window of a tenth; slope 2.0 over means of nine points; weights 0.4, 0.2, 0.2, 0.2), and unconfirmed.
"""
from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .array import Array
from .errors import InputError

RATE = 1e4  # Hz, of both curves
INNER, OUTER, EXPONENT = 0.05, 0.5, 2
MOST_SHIFT, WINDOW = 0.2, 0.1  # of the length
MAGNITUDE, SLOPE, SMOOTHED = 0.5, 2.0, 9
WEIGHTS = (0.4, 0.2, 0.2, 0.2)


class Rating(NamedTuple):
    """Scores from 0 to 1; `overall` is their weighted mean."""

    corridor: float
    phase: float
    magnitude: float
    slope: float
    overall: float

    @property
    def word(self) -> str:
        """The grade in words: excellent above 0.94, good above 0.80, fair above 0.58, else poor."""
        return next(word for bound, word in ((0.94, "excellent"), (0.8, "good"), (0.58, "fair"), (-1, "poor")) if self.overall > bound)


def _corridor(reference: Array, curve: Array) -> float:
    peak = np.abs(reference).max()
    score = (OUTER * peak - np.abs(curve - reference)) / ((OUTER - INNER) * peak)
    return float(np.mean(np.clip(score, 0, 1) ** EXPONENT))


def _shift(reference: Array, curve: Array) -> int:
    """Returns the samples by which the curve is later (negative: earlier) where the two correlate best; of equals the least."""
    count = reference.size
    most, best = int(MOST_SHIFT * count), (-np.inf, 0)
    for shift in sorted(range(-most, most + 1), key=abs):
        p, q = _overlap(reference, curve, shift)
        p, q = p - p.mean(), q - q.mean()
        norm = np.sqrt((p @ p) * (q @ q))
        value = p @ q / norm if norm > 0 else -np.inf
        if value > best[0] + 1e-12:
            best = (value, shift)
    return best[1]


def _overlap(reference: Array, curve: Array, shift: int) -> tuple[Array, Array]:
    if shift >= 0:
        return reference[: reference.size - shift], curve[shift:]
    return reference[-shift:], curve[: curve.size + shift]


def _warp(reference: Array, curve: Array) -> float:
    """Returns the sum of the magnitudes of the differences, over that of the reference, along the cheapest path of dynamic time warping
    (squared differences as cost, steps right, up and diagonal)."""
    count, window = reference.size, max(1, int(np.ceil(WINDOW * reference.size)))
    cost = np.full((count + 1, count + 1), np.inf)
    cost[0, 0] = 0
    for i in range(1, count + 1):
        for j in range(max(1, i - window), min(count, i + window) + 1):
            cost[i, j] = (curve[i - 1] - reference[j - 1]) ** 2 + min(cost[i - 1, j - 1], cost[i - 1, j], cost[i, j - 1])
    i, j, difference, size = count, count, 0.0, 0.0
    while i > 0 and j > 0:
        difference += abs(curve[i - 1] - reference[j - 1])
        size += abs(reference[j - 1])
        i, j = min(((i - 1, j - 1), (i - 1, j), (i, j - 1)), key=lambda at: float(cost[at]))
    return difference / size


def _slopes(values: Array) -> Array:
    """Returns the derivative per sample, smoothed by means of nine points, of fewer at the ends."""
    slope = np.gradient(values)
    half = SMOOTHED // 2
    return np.array([slope[max(0, k - half): k + half + 1].mean() for k in range(slope.size)])


def rate(reference_time: Any, reference: Any, time: Any, values: Any, interval: tuple[float, float] | None = None) -> Rating:
    """Rates a curve against a measured reference over `interval` (s; by default all that both have), at 10 kHz.

    >>> t = np.arange(0, 0.04, 1e-4)
    >>> a = np.where(t < 0.02, np.sin(np.pi * t / 0.02), 0)
    >>> rate(t, a, t, a).overall, rate(t, a, t, a).word
    (1.0, 'excellent')
    >>> round(rate(t, a, t, 1.2 * a).slope, 6)
    0.9
    """
    begin, end = interval or (max(reference_time[0], time[0]), min(reference_time[-1], time[-1]))
    grid = begin + np.arange(int(round((end - begin) * RATE)) + 1) / RATE
    if grid.size < 2 * SMOOTHED:
        raise InputError(f"the two curves share {max(0.0, end - begin):g} s: too little to rate")
    p, q = np.interp(grid, reference_time, reference), np.interp(grid, time, values)
    if not np.abs(p).max() > 0:
        raise InputError("the reference is zero all along: it cannot be rated against")
    shift = _shift(p, q)
    near, moved = _overlap(p, q, shift)
    scores = [_corridor(p, q), max(0.0, 1 - abs(shift) / (MOST_SHIFT * p.size)), max(0.0, 1 - _warp(near, moved) / MAGNITUDE)]
    slope, other = _slopes(near), _slopes(moved)
    scores.append(max(0.0, 1 - np.abs(other - slope).sum() / np.abs(slope).sum() / SLOPE))
    corridor, phase, magnitude, steepness = (float(score) for score in scores)
    return Rating(corridor, phase, magnitude, steepness, float(np.dot(WEIGHTS, scores)))
