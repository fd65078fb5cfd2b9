# SPDX-License-Identifier: GPL-3.0-or-later
"""The statements about the runs of a sweep: main effects, response surfaces, Sobol' indices, probabilities (docs/theory.md, section 13)."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from scipy.special import betaincinv, ndtri

from .array import Array
from .plan import LEAST_SALTELLI, Block, Plan
from .samples import Stream

LEVELS, BINS, RUNS_EACH, GOOD_Q2 = 12, 5, 50, 0.8
CELLS, SURFACE_ROWS, OFFSETS = 4096, 20000, 12
INDEX_SHARE, RESAMPLES, TAIL = 0.95, 1000, 0.025


class Effect(NamedTuple):
    """Range of the means of a figure between the values of one factor; `used` of `of` combinations of the other blocks count."""

    low: float = math.nan
    high: float = math.nan
    first: float = math.nan
    last: float = math.nan
    used: int = 0
    of: int = 0


class Index(NamedTuple):
    """Sobol' indices of a factor with their 95 % intervals."""

    first: float = math.nan
    first_low: float = math.nan
    first_high: float = math.nan
    total: float = math.nan
    total_low: float = math.nan
    total_high: float = math.nan


class Chance(NamedTuple):
    """The probability of one combination of what is chosen that a figure stays below its limit."""

    row: int  # of that combination
    share: float
    low: float
    high: float
    below: int
    above: int
    unknown: int
    within: int  # runs whose limit lies within the 95 % scatter of drops


@dataclass
class Surface:
    """A quadratic of the numbers, with constants for the levels of words, by least squares."""

    problem: str = ""
    rows: int = 0
    of: int = 0
    names: list[str] = field(default_factory=list)  # of the terms
    coefficients: Array = field(default_factory=lambda: np.empty(0))
    centre: Array = field(default_factory=lambda: np.empty(0))
    half: Array = field(default_factory=lambda: np.empty(0))
    curved: Array = field(default_factory=lambda: np.empty(0, dtype=bool))
    rms: float = math.nan
    left_out_rms: float = math.nan
    q2: float = math.nan
    simulated: Array = field(default_factory=lambda: np.empty(0))
    left_out: Array = field(default_factory=lambda: np.empty(0))

    def terms(self, x: Array, d: int) -> Array:
        """Returns the terms at the rows x: 1, z, z², z z, constants of words."""
        z = (x[:, :d] - self.centre) / self.half
        pairs = [z[:, i] * z[:, j] for i in range(d) for j in range(i + 1, d)]
        return np.column_stack([np.ones(len(x)), z, z[:, self.curved] ** 2, *pairs, x[:, d:]])


def numbers(plan: Plan) -> list[int]:
    """Returns the factors that are numbers and have more than one value."""
    return [k for k, f in enumerate(plan.factors) if not f.words and np.ptp(f.values) > 0]


def _offsets(plan: Plan) -> list[int]:
    """The factors whose levels have constants of their own; draws of an unknown are scatter."""
    return [k for k, f in enumerate(plan.factors) if f.words and not f.uncertain and f.count <= OFFSETS]


def surface(plan: Plan, y: Array) -> tuple[Surface, Array]:
    """Returns the response surface of the figure y of all rows, NaN where it cannot be used, and the columns of its rows."""
    s, own = Surface(), numbers(plan)
    rows = np.flatnonzero(np.isfinite(y))
    s.of = len(rows)
    if s.of > SURFACE_ROWS:
        rows = np.sort(np.random.default_rng(1).choice(rows, SURFACE_ROWS, replace=False))
    s.rows, d = len(rows), len(own)
    columns = [plan.column(k)[rows] for k in own]
    words = [(k, level) for k in _offsets(plan) for level in range(1, plan.factors[k].count)]
    x: Array = np.column_stack([*columns, *((plan.column(k)[rows] == level).astype(float) for k, level in words)]) if columns or words else np.empty((s.rows, 0))
    s.centre = np.array([(column.min() + column.max()) / 2 for column in columns]) if s.rows else np.zeros(d)
    s.half = np.array([np.ptp(column) / 2 or 1.0 for column in columns]) if s.rows else np.ones(d)
    s.curved = np.array([bool((np.abs(np.abs(column - s.centre[i]) - s.half[i]) > 1e-6 * s.half[i]).any() and np.ptp(column) > 0)
                         for i, column in enumerate(columns)], dtype=bool)
    name = [plan.factors[k].name for k in own]
    s.names = ["1", *name, *(f"{name[i]}²" for i in range(d) if s.rows and s.curved[i]), *(f"{name[i]} × {name[j]}" for i in range(d) for j in range(i + 1, d)),
               *(f"{plan.factors[k].name} = {plan.factors[k].labels[level]}" for k, level in words)]
    count = len(s.names)
    if d == 0 or s.rows < count + 2:
        s.problem = "no factor is a number with more than one value" if d == 0 else f"{count} terms need at least {count + 2} runs, there are {s.rows}"
        s.names = []
        return s, x
    matrix, values = s.terms(x, d), y[rows]
    u, singular, vt = np.linalg.svd(matrix, full_matrices=False)
    if singular[-1] <= 1e-9 * singular[0]:
        s.problem, s.names = "the rows do not determine all terms: two factors vary together, or values are missing", []
        return s, x
    s.coefficients = vt.T @ ((u.T @ values) / singular)
    _judge(s, x, matrix, u, values)
    return s, x


def _judge(s: Surface, x: Array, matrix: Array, u: Array, values: Array) -> None:
    """The error at each row by the surface without all rows of its place."""
    residual: Array = values - matrix @ s.coefficients
    _, site, number = np.unique(x, axis=0, return_inverse=True, return_counts=True)
    site = np.asarray(site).ravel()
    leverage = (u ** 2).sum(axis=1)
    total = np.bincount(site, residual)
    rest = 1 - number[site] * leverage
    error = np.where(rest > 1e-9, residual + leverage * total[site] / np.where(rest > 1e-9, rest, 1), np.nan)
    s.simulated, s.left_out = values, values - error
    s.rms = math.sqrt((residual ** 2).sum() / (len(values) - len(s.coefficients)))
    s.left_out_rms = math.sqrt((error ** 2).mean()) if np.isfinite(error).all() else math.nan
    if math.isnan(s.left_out_rms):
        s.problem = "without one place in the factors the terms are not determined: its error at runs left out is not known"
    spread = ((values - values.mean()) ** 2).sum()
    s.q2 = 1 - (error ** 2).sum() / spread if spread > 0 else math.nan


def _is_mixed(plan: Plan, k: int) -> bool:
    return plan.block_of[k].kind == "sample" and plan.block_of[k].count > 1


def is_by_surface(plan: Plan, k: int) -> bool:
    """True of a number that a sample mixes with other factors."""
    return _is_mixed(plan, k) and not plan.factors[k].words


def is_scatter(plan: Plan, k: int) -> bool:
    """True if the range of the means is mostly scatter of the other factors: draws, or many words, that a sample mixes with few runs each."""
    f = plan.factors[k]
    return _is_mixed(plan, k) and f.words and (f.posterior or f.count > LEVELS) and plan.block_of[k].rows < RUNS_EACH * f.count


def _groups(plan: Plan, k: int) -> tuple[Array, int]:
    """The group of each row of the block: levels; of more than LEVELS numbers BINS parts with equally many rows."""
    f = plan.factors[k]
    if f.words:
        return f.values.astype(int), f.count
    distinct, level = np.unique(f.values, return_inverse=True)
    if len(distinct) <= LEVELS:
        return np.asarray(level).ravel(), len(distinct)
    rank = np.empty(len(f.values), dtype=int)
    rank[np.argsort(f.values, kind="stable")] = np.arange(len(f.values))
    return rank * BINS // len(f.values), BINS


def effect(plan: Plan, k: int, y: Array, s: Surface, x: Array) -> Effect:
    """Returns the main effect of a factor on a figure."""
    if is_scatter(plan, k):
        return Effect()
    if is_by_surface(plan, k):
        return _effect_of_surface(plan, k, s, x)
    block, f = plan.block_of[k], plan.factors[k]
    cube = y.reshape(-1, block.rows, block.stride).transpose(0, 2, 1).reshape(-1, block.rows)  # a line for each combination of the other blocks
    whole = np.isfinite(cube).all(axis=1)
    counts = (int(whole.sum()), len(cube)) if len(cube) > 1 else (0, 0)
    chosen = cube[whole] if len(cube) > 1 else cube
    group, number = _groups(plan, k)
    parts = [chosen[:, group == level] for level in range(number)]
    means = np.array([part[np.isfinite(part)].mean() if np.isfinite(part).any() else math.nan for part in parts])
    there = means[np.isfinite(means)]
    draws = f.words and f.uncertain
    low, high = (math.nan, math.nan) if len(there) < 2 else np.quantile(there, (0.05, 0.95)) if draws else (there.min(), there.max())
    first, last = (math.nan, math.nan) if f.words else (means[0], means[-1])
    return Effect(float(low), float(high), float(first), float(last), *counts)


def _effect_of_surface(plan: Plan, k: int, s: Surface, x: Array) -> Effect:
    """The effect between least and greatest value, averaged over the rows that the surface was fitted to."""
    own = numbers(plan)
    if k not in own or s.problem or not s.names or not s.q2 >= GOOD_Q2:
        return Effect()
    i = own.index(k)

    def mean(value: float) -> float:
        moved = x.copy()
        moved[:, i] = value
        return float((s.terms(moved, len(own)) @ s.coefficients).mean())

    first, middle, last = (mean(s.centre[i] + part * s.half[i]) for part in (-1, 0, 1))
    slope, bend = (last - first) / 2, (last + first) / 2 - middle
    ends = [first, last]
    if abs(slope) < 2 * abs(bend):  # the top of the parabola is between them
        ends.append(middle - slope * slope / (4 * bend))
    return Effect(min(ends), max(ends), first, last)


def indices(block: Block, y: Array) -> tuple[list[Index], int]:
    """Returns Sobol' indices by Saltelli's estimator of 2010 and Jansen's, with intervals of the bootstrap, and the samples that are whole."""
    d, blocks = block.count, y.reshape(block.count + 2, block.samples)
    blocks = blocks[:, np.isfinite(blocks).all(axis=0)]
    used = blocks.shape[1]
    if used < LEAST_SALTELLI or used < INDEX_SHARE * block.samples:
        return [Index()] * d, used

    def estimate(chosen: Array) -> Any:
        """[2 d, ...] of samples along the last axis."""
        centred = chosen - chosen[:2].mean(axis=(0, -1), keepdims=True)
        a, b, mixed = centred[0], centred[1], centred[2:]
        variance = (a ** 2 + b ** 2).sum(axis=-1) / 2
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.concatenate([(b * (mixed - a)).sum(axis=-1), ((mixed - a) ** 2).sum(axis=-1) / 2]) / variance

    best = estimate(blocks)
    if not np.isfinite(best).all():
        return [Index()] * d, used
    resamples = 200 if used * d > 200000 else RESAMPLES
    pick = Stream(block.seed).whole(used, resamples * used).reshape(resamples, used)
    low, high = np.nanquantile(np.array([estimate(blocks[:, line]) for line in pick]), (TAIL, 1 - TAIL), axis=0)
    return [Index(*(float(value) for i in (k, d + k) for value in (best[i], low[i], high[i]))) for k in range(d)], used


def _independent(plan: Plan) -> float:
    """Rows of a cell that share no draw: of crossed blocks those of the smallest, of saltelli its first two blocks, and never more than a posterior has draws."""
    least = math.inf
    for block in plan.blocks:
        rows = block.rows * 2 / (block.count + 2) if block.method == "saltelli" else float(block.rows)
        rows = min([rows, *(f.count for f in plan.factors[block.first:block.first + block.count] if f.posterior)])
        least = least if plan.is_chosen(block) else min(least, rows)
    return least


def interval(below: int, unknown: int, total: int, independent: float) -> tuple[float, float]:
    """Returns the 95 % interval of Clopper and Pearson, of which unknown runs count as above at the low end, as below at the high one.

    >>> [round(end, 2) for end in interval(20, 0, 20, 20)]
    [0.83, 1.0]
    """
    part = independent / total if total > independent else 1.0
    n, certain, possible = part * total, part * below, part * (below + unknown)
    low = float(betaincinv(certain, n - certain + 1, TAIL)) if certain > 0 else 0.0
    return low, float(betaincinv(possible + 1, n - possible, 1 - TAIL)) if possible < n else 1.0


def cells(plan: Plan) -> Array | None:
    """Returns the combination of what is chosen of each row; None if nothing is uncertain or there are too many."""
    rows, cell, count = np.arange(plan.rows), np.zeros(plan.rows, dtype=int), 1
    for block in plan.blocks:
        if plan.is_chosen(block):
            count *= block.rows
            cell = cell * block.rows + rows // block.stride % block.rows
    return cell if count <= CELLS and not all(map(plan.is_chosen, plan.blocks)) else None


def chances(plan: Plan, limit: float, y: Array, anvil: Array, is_open: Array, scatter: Array) -> list[Chance]:
    """Returns the probabilities of staying below the limit; `anvil`: runs that ended there are above. Other runs without a value are unknown."""
    cell = cells(plan)
    if cell is None or math.isnan(limit):
        return []
    with np.errstate(invalid="ignore", divide="ignore"):
        below, above = (y < limit) & ~anvil, (y >= limit) | anvil
        within = np.abs(np.log(limit / y)) < -ndtri(TAIL) * np.nan_to_num(scatter)
    unknown = np.isnan(y) & ~anvil & ~is_open
    number = int(cell.max()) + 1
    counts = [np.bincount(cell[chosen], minlength=number) for chosen in (below, above & ~is_open, unknown, within)]
    independent, found = _independent(plan), []
    first = np.full(number, plan.rows)
    np.minimum.at(first, cell, np.arange(plan.rows))
    for k in range(number):
        b, a, u, w = (int(part[k]) for part in counts)
        total = a + b + u
        low, high = interval(b, u, total, independent) if total else (0.0, 1.0)
        found.append(Chance(int(first[k]), b / total if total else math.nan, low, high, b, a, u, w))
    return found


@dataclass
class Statements:
    """What there is to say of one figure."""

    effects: list[Effect]
    surface: Surface
    indices: list[Index]
    samples: int
    chances: list[Chance]


def statements(plan: Plan, limit: float, y: Array, **states: Any) -> Statements:
    """Returns all statements about the figure y."""
    fit, x = surface(plan, y)
    found, samples = indices(plan.saltelli, y) if plan.saltelli else ([], 0)
    return Statements([effect(plan, k, y, fit, x) for k in range(len(plan.factors))], fit, found, samples, chances(plan, limit, y, **states))
