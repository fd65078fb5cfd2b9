# SPDX-License-Identifier: GPL-3.0-or-later
"""The foam that meets the measurements best: least squares on simulated drops, from several starts.

Unknowns are sought as logarithms, HU as ln(HU/(1 - HU)), which keeps it below 1. Residuals are over the stated standard deviations; the priors are residuals, too.
"""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Callable, Sequence

import numpy as np
from scipy.optimize import least_squares
from scipy.special import chdtri, ndtri, stdtrit

from ..array import Array
from ..errors import Error, NumericError
from .drops import COARSE, OWN, SECTION, Bench, Outcome, Wanted
from .input import CHAIN, KINDS, Input, Model
from .work import BENDS

STARTS, SPREAD = 3, 0.7  # searches, and how far they begin from the start values, in standard deviations of the prior
STEP, LEAST_STEP, MOST_STEP = 0.05, 0.01, 0.1  # of differences: part of a standard deviation of the prior, and its bounds
ROUNDS, MOST_CALLS, FINE_CALLS = 6, 25, 10
STILL = 0.03  # standard deviations of the prior: a round that moves the unknowns by less was the last
NEAR = 0.3  # standard deviations of the prior: ratios to the cases' own drops hold as far
GAIN = 0.1  # fall of the objective that is still expected: more is told, and has not converged
DEEP, DEEP_SD = 0.94, 0.003  # indentation over the thickness, from where the missile all but reaches the anvil
TOO_FAR = 10.0  # root of the misfit per degree of freedom
ON_BOUND, ALL_RETURNED = 1e-3, 0.999  # on the axis of the search; an HU that is 1
BEND = 0.03  # ln of the stress, of a difference
START_TRIES = 20  # starts that are tried for one that works
STRETCH = 1.6  # of intervals of drops beyond the measured strains: of the first 61 foams of verify/study_coverage_fit.py, those of 95 % hold a_max of 53 without it, of 58 with it


@dataclass
class Problem:
    """A model of a fit: from a vector of unknowns to residuals."""

    given: Input
    model: Model
    bench: Bench

    def __post_init__(self) -> None:
        given, foam = self.given, self.model.unknown
        self.drops, self.measured = given.drops, given.measured
        self.chain = [k for k in range(3) if given.chain_sd[k] > 0]
        self.speeds = [d for d, drop in enumerate(self.measured) if drop.speed_sd > 0]
        self.names = [u.name for u in foam] + [CHAIN[k] for k in self.chain] + [f"speed of {self.measured[d].name}" for d in self.speeds]
        self.logit = np.array([name == "HU" for name in self.names])
        self.sd = np.array([u.sd for u in foam] + [given.chain_sd[k] for k in self.chain] + [self.measured[d].speed_sd for d in self.speeds])
        self.start = np.array([self.transform(u.name, u.start) for u in foam] + [0.0] * (len(self.chain) + len(self.speeds)))
        self.low = np.array([self.transform(u.name, u.low) for u in foam] + [-1.0] * (len(self.chain) + len(self.speeds)))
        self.high = np.array([self.transform(u.name, min(u.high, 1 - 1e-6) if u.name == "HU" else u.high) for u in foam] + [1.0] * (len(self.chain) + len(self.speeds)))
        self.center = np.array([math.log(u.start) for u in foam] + [0.0] * (len(self.chain) + len(self.speeds)))
        self.start = np.clip(self.start, self.low + 1e-3, self.high - 1e-3)
        self.offset: dict[str, list[Array]] = {}  # of each mesh: ln of the case's own drop over that on this mesh; of samples a difference

    @staticmethod
    def transform(name: str, value: float) -> float:
        """Returns the place of a value on the axis of the search."""
        return math.log(value / (1 - min(value, 1 - 1e-9))) if name == "HU" else math.log(value)

    @staticmethod
    def value(name: str, x: float) -> float:
        """Returns the value at a place on the axis of the search.

        >>> round(Problem.value("HU", Problem.transform("HU", 0.3)), 9)
        0.3
        """
        return 1 / (1 + math.exp(-x)) if name == "HU" else math.exp(x)

    def logarithm(self, x: Array) -> Array:
        """Returns ln of the unknowns [points][unknowns], by which the priors hold."""
        return np.where(self.logit, -np.logaddexp(0.0, -x), x)

    def log_slope(self, x: Array) -> Array:
        """Returns the derivatives of the logarithms by the places."""
        return np.where(self.logit, 1 / (1 + np.exp(np.minimum(x, 700.0))), 1.0)

    def foam_values(self, x: Array) -> Array:
        values = self.model.start.copy()
        for u, place in zip(self.model.unknown, x):
            values[self.model.form.index[u.name]] = self.value(u.name, place)
        return values

    def chain_of(self, x: Array) -> list[float]:
        made, first = list(self.given.chain), len(self.model.unknown)
        for place, k in enumerate(self.chain):
            made[k] *= math.exp(x[first + place])
        made[1] = min(made[1], 0.999)
        return made

    def speed_of(self, x: Array, d: int) -> float:
        """Returns the factor on the speed of a drop."""
        if d not in self.speeds:
            return 1.0
        return math.exp(x[len(self.model.unknown) + len(self.chain) + self.speeds.index(d)])

    def settle(self, x: Array) -> None:
        """Gives drops that cannot be used at x on a cheap mesh a finer one."""
        for mesh in (SECTION, COARSE):
            self.outcomes([(x, range(len(self.drops)))], mesh)  # side by side; below one by one
            for d, drop in enumerate(self.drops):
                cheap = self.bench.overrides(drop, mesh)
                while self.outcomes([(x, [d])], mesh)[0][0].failure:
                    if not self.bench.refine(drop, mesh):  # it fails on every mesh
                        self.bench.set_mesh(drop, mesh, cheap)
                        break

    # ---- responses

    def outcomes(self, points: Sequence[tuple[Array, Sequence[int]]], mesh: str, given_speed: bool = False) -> list[list[Outcome]]:
        """Returns the outcomes of drops, by their numbers, at points."""
        made = iter(self.bench.run([self._wanted(x, d, mesh, given_speed) for x, which in points for d in which]))
        return [[next(made) for _ in which] for _, which in points]

    def _wanted(self, x: Array, d: int, mesh: str, given_speed: bool = False, bend: Sequence[float] = ()) -> Wanted:
        return Wanted(self.drops[d], mesh, self.model, self.foam_values(x), 1.0 if given_speed else self.speed_of(x, d), self.chain_of(x), bend)

    def bend_slopes(self, x: Array) -> list[Array]:
        """Returns of each drop the derivatives of the numbers by ln of the stress at BENDS, [KINDS][BENDS]; 0 where they are not defined."""
        bends, count = BEND * np.eye(len(BENDS)), range(len(self.drops))
        made = self.bench.run([self._wanted(x, d, COARSE, False, bend.tolist()) for d in count for bend in (0 * bends[0], *bends)])
        slopes = []
        for d in count:
            base, *bent = (np.full(len(KINDS), math.nan) if one.failure else one.logs() for one in made[d * (len(BENDS) + 1):(d + 1) * (len(BENDS) + 1)])
            slopes.append(np.nan_to_num((np.array(bent) - base).T / BEND))
        return slopes

    def shifted(self, outcome: Outcome, d: int, mesh: str) -> Array:
        """Returns the response of a drop: ln of the numbers, ln of the indentation over the thickness, samples over their peak; NaN: not defined."""
        curve = self.drops[d].curve
        raw: Array = np.concatenate([outcome.logs(), [math.log(max(outcome.get("strain"), 1e-9))], outcome.samples(len(curve.time)) / curve.peak if curve else []])
        return np.add(raw, self.offset[mesh][d]) if mesh in self.offset else raw

    def tests(self, x: Array) -> Array:
        """Returns residuals of compression tests and cushion curves; inf where the foam fails."""
        if not self.given.compressions and not self.given.cushions:
            return np.empty(0)
        try:
            foam = self.model.form.foam(self.foam_values(x))
            made = [(press(foam, test.rate, test.strain, test.loading, test.turn) - test.stress) / test.sd for test in self.given.compressions]
            for cushion in self.given.cushions:
                peaks = np.array([foam.cushion(s, cushion.thickness, cushion.height) for s in cushion.stress])
                made.append(np.log(peaks / cushion.peak) / cushion.sd)
        except NumericError:
            return np.array([math.inf])
        return np.concatenate(made)

    def residual_of(self, d: int, response: Array) -> Array:
        """Returns the residuals of a measured drop: what was measured, then one that holds the missile off the anvil."""
        drop, count = self.drops[d], len(KINDS)
        made = [(response[k] - math.log(drop.value[kind.key])) / drop.sd[kind.key] for k, kind in enumerate(KINDS) if kind.key in drop.value]
        samples = (response[count + 1:] - drop.curve.value / drop.curve.peak) / drop.curve.sd if drop.curve else np.empty(0)
        return np.concatenate([made, samples, [max(0.0, (response[count] - math.log(DEEP)) / DEEP_SD)]])

    def prior(self, x: Array) -> Array:
        return np.asarray((self.logarithm(x) - self.center) / self.sd)

    def assemble(self, x: Array, responses: Sequence[Array | None]) -> Array:
        """Returns all residuals; inf where a drop fails, which a step does not pass."""
        parts = [np.array([math.inf]) if y is None else self.residual_of(d, y) for d, y in enumerate(responses)]
        made = np.concatenate([*parts, self.tests(x), self.prior(x)])
        return np.asarray(np.where(np.isnan(made), math.inf, made))

    def responses(self, x: Array, mesh: str) -> list[Array | None]:
        """Returns the responses of the measured drops; None: it failed."""
        made = self.outcomes([(x, range(len(self.measured)))], mesh)[0]
        return [None if one.failure else self.shifted(one, d, mesh) for d, one in enumerate(made)]

    def residual(self, x: Array, mesh: str) -> Array:
        try:
            self.model.form.foam(self.foam_values(x))
        except Error:
            return np.array([math.inf])  # of any length: the step is shortened
        return self.assemble(x, self.responses(x, mesh))

    def steps(self, x: Array) -> Array:
        """Returns steps of differences, away from the nearer bound."""
        size = np.clip(STEP * self.sd, LEAST_STEP, MOST_STEP)
        size = np.where(self.sd < 0.05, np.minimum(size, 1.0 * self.sd), size)  # of speeds
        return np.where(x + size < self.high, size, -size)

    def jacobian(self, x: Array, mesh: str, also: Sequence[int] = (), side: float = 1.0) -> tuple[Array, dict[int, Array]]:
        """Returns derivatives of the residuals, and of the responses of drops (also of those to predict, whose numbers are given), by differences."""
        step, n, measured = side * self.steps(x), len(x), range(len(self.measured))
        first_speed = len(self.model.unknown) + len(self.chain)
        which = [[self.speeds[k - first_speed]] if k >= first_speed else [*measured, *also] for k in range(n)]
        points = [(x + step[k] * np.eye(n)[k], which[k]) for k in range(n)]
        base_drops = [*measured, *also]
        good = [self.makes_foam(point) for point, _ in points]
        for k in range(n):
            if not good[k]:  # the foam ends on this side
                step[k] = -step[k]
                points[k] = (x + step[k] * np.eye(n)[k], which[k])
        base, *moved = self.outcomes([(x, base_drops), *points], mesh)
        base_y = {d: self.shifted(one, d, mesh) for d, one in zip(base_drops, base)}
        slope = {d: np.zeros((len(base_y[d]), n)) for d in base_drops}
        for k, outcomes in enumerate(moved):
            for d, one in zip(which[k], outcomes):
                if one.failure:  # by the other side
                    one = self.outcomes([(x - step[k] * np.eye(n)[k], [d])], mesh)[0][0]
                    slope[d][:, k] = 0.0 if one.failure else (base_y[d] - self.shifted(one, d, mesh)) / step[k]
                else:
                    slope[d][:, k] = (self.shifted(one, d, mesh) - base_y[d]) / step[k]
        rows = [self._drop_rows(d, base_y[d], slope[d]) for d in measured]
        tests = self.tests(x)
        if len(tests):
            rows.append(np.stack([(self.tests(point) - tests) / step[k] for k, (point, _) in enumerate(points)], axis=1) if np.isfinite(tests).all() else np.zeros((len(tests), n)))
        rows.append(np.diag(self.log_slope(x) / self.sd))
        return np.nan_to_num(np.concatenate(rows), nan=0.0, posinf=0.0, neginf=0.0), slope

    def makes_foam(self, x: Array) -> bool:
        try:
            self.model.form.foam(self.foam_values(x))
        except Error:
            return False
        return True

    def _drop_rows(self, d: int, y: Array, slope: Array) -> Array:
        drop, count = self.drops[d], len(KINDS)
        rows = [slope[k] / drop.sd[kind.key] for k, kind in enumerate(KINDS) if kind.key in drop.value]
        rows += [row / drop.curve.sd for row in slope[count + 1:]] if drop.curve else []
        rows.append(slope[count] / DEEP_SD if y[count] > math.log(DEEP) else np.zeros(slope.shape[1]))
        return np.array(rows)


def press(foam: object, rate: float, strain: Array, loading: int, turn: float) -> Array:
    """Returns the stress (Pa) of a test at a constant rate: up to `turn` through the first strains, and back."""
    stops = np.concatenate([[0.0], strain[:loading], [turn], strain[loading:]])
    path, marks = [np.zeros(1)], []
    for a, b in zip(stops, stops[1:]):
        count = max(1, math.ceil(abs(b - a) / 0.01))
        path.append(a + (b - a) * np.arange(1, count + 1) / count if b != a else np.empty(0))
        marks.append(sum(len(part) for part in path) - 1)
    whole = np.ascontiguousarray(np.concatenate(path))
    time = np.concatenate([[0.0], np.cumsum(np.maximum(np.abs(np.diff(whole)), 1e-6))]) / rate
    stress = foam.compress(time, whole)  # type: ignore[attr-defined]
    marks = marks[:loading] + marks[loading + 1:]
    return np.asarray(stress[marks])


@dataclass
class Found:
    """What a search has found: the unknowns, how sure they are by linearised errors, and the drops of that foam."""

    problem: Problem
    x: Array
    residual: Array
    jacobian: Array
    slope: dict[int, Array]
    covariance: Array
    gain: float
    misfit: float
    freedom: float
    scale: float
    converged: bool
    reason: str
    on_bounds: list[str]
    starts: list[tuple[float, str]]  # objective of each search, and how it ended
    own: list[Outcome] = field(default_factory=list)  # of all drops, at their given speeds
    fitted: list[Outcome] = field(default_factory=list)  # of the measured ones, at the fitted speeds
    response: list[Array | None] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=dict)

    @property
    def half_width(self) -> float:
        """Returns the standard errors on each side of a 95 % interval."""
        return float(stdtrit(max(1.0, self.freedom), 0.975) if self.scale > 1 else ndtri(0.975))

    def sd_of_log(self) -> Array:
        return np.asarray(np.sqrt(np.diag(self.covariance)) * self.problem.log_slope(self.x))

    def interval(self, k: int) -> tuple[float, float, float]:
        """Returns the value of an unknown (SI) and its 95 % interval."""
        name, width = self.problem.names[k], self.half_width * math.sqrt(self.covariance[k, k])
        low, high = max(self.x[k] - width, self.problem.low[k]), min(self.x[k] + width, self.problem.high[k])
        return Problem.value(name, self.x[k]), Problem.value(name, low), Problem.value(name, high)

    @property
    def deepest(self) -> float:
        """Returns the largest strain of the measured drops, as simulated, and of the tests."""
        drops = [one.get("max_local_strain") for one in self.fitted if not one.failure]
        return max([0.0, *drops, *(test.turn for test in self.problem.given.compressions)])

    def is_beyond(self, d: int) -> bool:
        """Does a drop strain the foam more than what was measured? One that fails does."""
        return self.problem.drops[d].predicted and not self.own[d].get("max_local_strain") <= self.deepest

    def response_sd(self, d: int) -> Array:
        """Returns the standard errors of the responses of a drop by the parameters."""
        rows = self.slope.get(d)
        return np.full(len(KINDS), math.nan) if rows is None else np.asarray(np.sqrt(np.einsum("ij,jk,ik->i", rows, self.covariance, rows))[:len(KINDS)])

    def without(self, d: int) -> Array | None:
        """Returns the response of a measured drop by a fit to all others, linearised; None: there are no others."""
        if len(self.problem.measured) < 2 and not self.problem.given.compressions and not self.problem.given.cushions:
            return None
        sizes = [len(self.problem.residual_of(k, y)) for k, y in enumerate(self.response) if y is not None]
        first = sum(sizes[:d])
        keep = np.r_[0:first, first + sizes[d]:len(self.residual)]
        jacobian, residual = self.jacobian[keep], self.residual[keep]
        move = -np.linalg.lstsq(jacobian, residual, rcond=None)[0]
        base = self.response[d]
        return None if base is None else base + self.slope[d] @ move


class _Slopes:
    """Derivatives of the residuals along a search: by differences at its start, and then every other time Broyden's update of the last ones."""

    def __init__(self, problem: Problem, mesh: str) -> None:
        self.problem, self.mesh = problem, mesh
        self.last: tuple[Array, Array, Array] | None = None  # place, residuals and their derivatives by differences

    def __call__(self, x: Array) -> Array:
        if self.last is None:
            made = self.problem.jacobian(x, self.mesh)[0]
            self.last = x.copy(), self.problem.residual(x, self.mesh), made  # known from the step
            return made
        place, residual, slopes = self.last
        self.last = None
        move = (x - place) / self.problem.sd
        wrong = self.problem.residual(x, self.mesh) - residual - slopes @ (x - place)
        return np.asarray(slopes + np.outer(wrong, move / self.problem.sd) / float(move @ move))


def _search(problem: Problem, x: Array, mesh: str, calls: int) -> tuple[Array, float, str]:
    """Returns the best place of one search by scipy's trust-region reflective algorithm, its objective, and how it ended."""
    start = np.clip(x, problem.low + 1e-9, problem.high - 1e-9)
    try:
        made = least_squares(lambda p: problem.residual(p, mesh), start, _Slopes(problem, mesh), (problem.low, problem.high), "trf",
                             ftol=1e-3, xtol=1e-3, gtol=1e-4, x_scale=problem.sd, max_nfev=calls)
    except ValueError as error:
        if "not finite" in str(error):  # of the start
            return start, math.inf, "the drops of its start fail"
        raise
    return made.x, 2 * float(made.cost), {0: f"{calls} steps"}.get(made.status, "no step gains more")


def _first_failure(problem: Problem, x: Array) -> str:
    try:
        problem.model.form.foam(problem.foam_values(x))
    except Error as error:
        return str(error)
    for drop, one in zip(problem.measured, problem.outcomes([(x, range(len(problem.measured)))], COARSE)[0]):
        missing = next((kind.key for k, kind in enumerate(KINDS) if kind.key in drop.value and math.isnan(one.logs()[k])), None)
        if one.failure:
            return f"the drop {drop.name}: {one.failure}"
        if missing:
            return f"{missing} of the drop {drop.name} was measured, but its simulation does not give it within its time: raise solver.end_time of its case"
    return "its tests cannot be evaluated"


def _starts(problem: Problem, random: np.random.Generator, tell: Callable[[str], None]) -> tuple[Array, list[tuple[float, str]]]:
    """Returns the best place of several searches on the coarse mesh, and how each ended."""
    made: list[tuple[float, str, Array]] = []
    count = STARTS if len(problem.model.unknown) > 1 else 1
    first = problem.start
    problem.settle(first)
    if not np.isfinite(problem.residual(first, COARSE)).all():
        made.append((math.inf, _first_failure(problem, first), first))
    for k in range(count):
        x = first
        if k or made:
            for _ in range(START_TRIES):
                x = np.clip(problem.start + SPREAD * np.clip(random.standard_normal(len(first)), -2, 2) * problem.sd, problem.low + 1e-6, problem.high - 1e-6)
                if np.isfinite(problem.residual(x, COARSE)).all():
                    break
            else:
                break
        place, objective, how = _search(problem, x, COARSE, MOST_CALLS)
        made.append((objective, how, place))
        tell(f"  start {len(made)}: objective {objective:.3f}, {how}")
    best = min(made, key=lambda one: one[0])
    if not math.isfinite(best[0]):
        raise NumericError(f"no start of the model {problem.model.label} can be used: {made[0][1]}; give start values nearer to the foam", 5)
    return best[2], [(objective, how) for objective, how, _ in made]


def shift_of(problem: Problem, x: Array, mesh: str, to: str) -> list[Array]:
    """Returns by how much the responses on one mesh exceed those on another, at x; 0 where one of them is not defined."""
    count, saved = range(len(problem.drops)), problem.offset
    problem.offset = {}
    cheap, dear = (problem.outcomes([(x, count)], which)[0] for which in (mesh, to))
    made = [np.nan_to_num(problem.shifted(b, d, to) - problem.shifted(a, d, mesh)) if not a.failure and not b.failure else
            np.zeros(len(KINDS) + 1 + (len(problem.drops[d].curve.time) if problem.drops[d].curve else 0)) for d, (a, b) in enumerate(zip(cheap, dear))]  # type: ignore[union-attr]
    problem.offset = saved
    return made


def find(problem: Problem, tell: Callable[[str], None]) -> Found:
    """Finds the foam of a model: several searches on the coarse mesh, then the best one with the ratios to the section's and the cases' own drops."""
    x, starts = _starts(problem, np.random.default_rng(problem.given.seed), tell)
    own_shift, at = shift_of(problem, x, SECTION, OWN), x  # it hardly changes; the end of the search finds it anew
    for turn in range(ROUNDS):
        section = shift_of(problem, x, COARSE, SECTION)
        problem.offset = {COARSE: [a + b for a, b in zip(section, own_shift)], SECTION: own_shift}
        before = x
        x, objective, _ = _search(problem, x, COARSE, MOST_CALLS)
        moved = float(np.max(np.abs(x - before) / problem.sd)) if len(x) else 0.0
        tell(f"  round {turn + 1}: objective {objective:.3f}")
        if moved < STILL:
            break
    return _judge(problem, x, at, starts, tell)


def _judge(problem: Problem, x: Array, at: Array, starts: list[tuple[float, str]], tell: Callable[[str], None]) -> Found:
    """Ends a search on the section's drops: steps until no gain is expected, with the ratios to the cases' own drops near that place, at first those at `at`."""
    predicted = [d for d, drop in enumerate(problem.drops) if drop.predicted]
    for turn in range(ROUNDS):
        if np.max(np.abs(x - at) / problem.sd) > NEAR:
            problem.offset[SECTION], at = shift_of(problem, x, SECTION, OWN), x
        residual = problem.residual(x, SECTION)
        if not np.isfinite(residual).all():
            raise NumericError(f"the model {problem.model.label}: {_first_failure(problem, x)}", 5)
        jacobian, slope = problem.jacobian(x, SECTION, predicted)
        gain = _gain(problem, x, residual, jacobian)
        if gain <= GAIN or turn == ROUNDS - 1:
            break
        place, objective, _ = _search(problem, x, SECTION, FINE_CALLS)
        if objective > float(residual @ residual) - 0.1 * GAIN:  # no step helps: are the differences to one side misleading?
            other, slopes = problem.jacobian(x, SECTION, predicted, -1.0)
            jacobian, slope = 0.5 * (jacobian + other), {d: 0.5 * (slope[d] + slopes[d]) for d in slope}
            gain = _gain(problem, x, residual, jacobian)
            break
        x = place
    return _found(problem, x, residual, jacobian, slope, gain, starts, tell)


def _gain(problem: Problem, x: Array, residual: Array, jacobian: Array) -> float:
    """Returns by how much the objective is expected to fall with a linear step, of unknowns that no bound holds."""
    pull = jacobian.T @ residual
    free = ~(((x - problem.low < ON_BOUND) & (pull > 0)) | ((problem.high - x < ON_BOUND) & (pull < 0)))
    move = -np.linalg.lstsq(jacobian[:, free], residual, rcond=None)[0]
    return float(-(pull[free] @ move))


def _found(problem: Problem, x: Array, residual: Array, jacobian: Array, slope: dict[int, Array], gain: float, starts: list[tuple[float, str]],
           tell: Callable[[str], None]) -> Found:
    n, data = len(x), jacobian[:-len(x)]
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    misfit = float(residual[:-n] @ residual[:-n])
    rows = int(np.count_nonzero(np.any(data != 0, axis=1)))
    freedom = max(1e-6, rows - float(np.trace(data @ covariance @ data.T)))
    scale = math.sqrt(misfit / freedom) if misfit > chdtri(freedom, 0.05) else 1.0
    lower = [v - low < ON_BOUND for v, low in zip(x, problem.low)]
    upper = [high - v < ON_BOUND or (name == "HU" and Problem.value(name, v) > ALL_RETURNED) for name, v, high in zip(problem.names, x, problem.high)]
    bounds = [f"{name} stands at its {'lower' if at_low else 'upper'} bound" for name, at_low, at_high in zip(problem.names, lower, upper) if at_low or at_high]
    far = math.sqrt(misfit / max(1.0, freedom))
    reason = f"the objective is expected to fall by {gain:.2g} more, but no step found it" if gain > GAIN else \
        f"the data are missed by {far:.1f} times their standard deviations" if far > TOO_FAR else ""
    made = Found(problem, x, residual, jacobian, slope, covariance * scale**2, gain, misfit, freedom, scale, not reason, reason, bounds, starts)
    made.own = problem.outcomes([(x, range(len(problem.drops)))], OWN, given_speed=True)[0]
    made.fitted = problem.outcomes([(x, range(len(problem.measured)))], OWN)[0] if problem.speeds else made.own[:len(problem.measured)]
    made.response = [None if one.failure else problem.shifted(one, d, OWN) for d, one in enumerate(made.fitted)]
    deep = next((problem.drops[d].name for d, one in enumerate(made.fitted) if one.get("strain") > DEEP), None)
    if deep and not made.reason:
        made.converged, made.reason = False, f"the drop {deep} stands at {DEEP:g} of its thickness, where the missile all but reaches the anvil"
    tell(f"  {'converged' if made.converged else 'NOT converged: ' + made.reason}; misfit {misfit:.2f} with {freedom:.1f} degrees of freedom"
         + "".join(f"; {text}" for text in bounds))
    return made
