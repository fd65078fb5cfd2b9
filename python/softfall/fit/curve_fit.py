# SPDX-License-Identifier: GPL-3.0-or-later
"""A form of the loading curve fitted to compression tests by least squares, and the memory of a foam from cycles. The library evaluates every law."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Callable, Iterable, NamedTuple

import numpy as np

from ..array import Array
from ..errors import InputError, NumericError
from ..library import Foam
from .compression import Cycles, Given, Test

Residual = Callable[[Array], Array]

RISES, RISE_END, LEAST_RISE = 400, 0.97, 1e-5  # strains at which the curve must rise, up to this part of its pole, by this part of the largest stress
FALL_WEIGHTS = (100.0, 3e3, 1e5)  # of a fall: of the searches from all starts, and of those that go on from the best
FAR, FAR_CYCLES = 1e3, 10.0  # deviation where there is no stress
RIDGE = 1e-4  # holds what the tests do not determine near its median
AWAY = 1.5  # standard deviations of the prior, of the other starts
POOR, GOOD = 0.1, 0.02  # rms over the largest stress: above it a fit is poor, below it good
LEAST_RATIO = 0.05  # part of the largest W above which the factor of unloading is compared
FINE = 200  # parts of the way between two points, over which a law with terms of the rate is followed
AT_END = 1e-3  # part of a range that counts as its end
UNLOADING = ("HU", "SHAPE", "ALPHA")
MEMORY = ("reload", "drift", "recovery")
UNLOADING_LOW, UNLOADING_HIGH = np.array([1e-4, 0.05, 0.1]), np.array([1.0, 20.05, 5.0])
UNLOADING_STARTS = ((-2, -3, -2), (-3, -4, -3), (-2, -1, -1.5), (-5, -2, -3))  # on the real line
CYCLE_HIGH = np.array([0.999, 20.0, 5.0])
CYCLE_START = (0.4, 0.2, 0.1)  # of the memory


def logistic(x: Any) -> Array:
    return np.asarray(1 / (1 + np.exp(-np.clip(x, -500, 500))))


def is_at_end(part: Any) -> Any:
    return (part < AT_END) | (part > 1 - AT_END)


def search(residual: Residual, starts: Iterable[Any]) -> tuple[float, Array, Array]:
    """Returns the least sum of squares of all starts, its place and the covariance there for a variance of 1; an infinite sum: no search converges."""
    from scipy.optimize import least_squares
    best, place, jacobian = math.inf, np.zeros(0), np.zeros((0, 0))
    for start in starts:
        try:
            found = least_squares(residual, np.asarray(start, dtype=float), method="lm", x_scale="jac", ftol=1e-12, xtol=1e-10, gtol=1e-12, max_nfev=200 * (len(start) + 1))
        except (NumericError, ValueError):  # the start has no value
            continue
        if 2 * found.cost < best:
            best, place, jacobian = 2 * float(found.cost), found.x, found.jac
    return best, place, np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-14, hermitian=True) if len(place) else jacobian


def neighbour_correlation(deviation: Array) -> float:
    square = float(deviation @ deviation)
    return float(deviation[1:] @ deviation[:-1]) / square if square > 0 else 0.0


def rms(deviation: Array) -> float:
    return math.sqrt(float(np.mean(deviation ** 2))) if len(deviation) else math.nan


class Unloading(NamedTuple):
    """HU, SHAPE and ALPHA, and how well they describe the unloading."""

    value: Array
    at_bound: list[str]
    rms: float  # of the stress, over the largest of its test
    factor_rms: float  # of the factor on the loading curve

    def json(self) -> dict[str, Any]:
        return {**{name: number(value) for name, value in zip(UNLOADING, self.value)}, "at_bound": self.at_bound, "rms": number(self.rms), "factor_rms": number(self.factor_rms)}


def number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


@dataclass
class FormFit:
    """A form that was fitted: values in SI, relative standard errors of the unknowns, stresses along the tests."""

    given: Given
    value: Array
    error: Array  # of each unknown, relative; NaN at a bound
    at_bound: list[bool]
    correlation: Array
    loading_rms: float
    foam: Foam | None = None
    one: Unloading | None = None  # with ALPHA = 1
    unloading: Unloading | None = None
    stress: list[Array] = field(default_factory=list)  # of the tests, then of the predicted ones
    memory_error: Array = field(default_factory=lambda: np.full(3, math.nan))
    cycles: list[Array] = field(default_factory=list)  # stress along the records
    set: tuple[float, float, float] = (math.nan, math.nan, math.nan)  # part of the largest strain, its standard error, s

    def at(self, name: str) -> float:
        assert self.given.form
        return float(self.value[self.given.form.index[name]])

    def is_determined(self, k: int) -> bool:
        return bool(self.error[k] < 1)

    def is_below_reference(self, test: Test) -> bool:
        return self.given.rate in ("factor", "both") and test.rate < self.at("rate_reference") * (1 - 1e-9)

    def misfits(self, k: int) -> tuple[float, float]:
        """Returns the rms of loading and unloading of test k, the predicted ones behind the fitted."""
        test = [*self.given.tests, *self.given.predicted][k]
        deviation = test.scaled(self.stress[k])
        return rms(deviation[test.loading]), rms(deviation[test.unloading])

    @property
    def worst(self) -> float:
        return max(float(np.nanmax(self.misfits(k))) for k in range(len(self.given.tests)))

    def cycle_rms(self, n: int, branch: int) -> list[float]:
        """Returns the rms of loading (0) or unloading (1) of each cycle of record n, over the largest stress, without the relaxation at the reversals."""
        r = self.given.cycles[n]
        off = (self.cycles[n] - r.stress) / r.largest
        return [rms(off[a:b + 1][~r.held[a:b + 1]]) for a, b in zip(r.turn[branch::2], r.turn[branch + 1::2])]

    def energies(self, n: int) -> list[tuple[float, float]]:
        """Returns the share of its energy that each cycle of record n returns, measured and by the law."""
        r = self.given.cycles[n]
        return [tuple(-area(r.strain[b:c + 1], s[b:c + 1]) / area(r.strain[a:b + 1], s[a:b + 1]) for s in (r.stress, self.cycles[n]))  # type: ignore[misc]
                for a, b, c in zip(r.turn[::2], r.turn[1::2], r.turn[2::2])]


def area(strain: Array, stress: Array) -> float:
    return float(np.sum(0.5 * (stress[1:] + stress[:-1]) * np.diff(strain)))


def returned(test: Test, stress: Array) -> float:
    """Returns the part of the energy of loading that unloading returns."""
    if not test.unloads:
        return math.nan
    turn = test.data.loading - 1
    return -area(test.data.strain[turn:], stress[turn:]) / area(test.data.strain[:turn + 1], stress[:turn + 1])


class _Problem:
    """Loading of all tests by the unknowns, whose logarithms lie between the bounds of their table."""

    def __init__(self, given: Given) -> None:
        assert given.form
        self.given, self.form, self.fall_weight = given, given.form, FALL_WEIGHTS[0]
        self.index = [self.form.index[name] for name in given.unknown]
        about = [self.form.parameters[k] for k in self.index]
        self.low, self.range = np.log([p.low for p in about]), np.log([p.high / p.low for p in about])
        self.sd, self.middle = np.array([p.prior_sd for p in about]), given.start[self.index]
        self.strain = [np.maximum(0.0, test.data.strain[test.loading]) for test in given.tests]
        self.size = given.tests[0].data.largest_stress

    def values(self, x: Array) -> Array:
        made = self.given.start.copy()
        made[self.index] = np.exp(self.low + self.range * logistic(x))
        return made

    def real(self, value: Array, least: float = 1e-6) -> Array:
        part = np.clip((np.log(value) - self.low) / self.range, least, 1 - least)
        return np.asarray(np.log(part / (1 - part)))

    def starts(self) -> list[Array]:
        """Returns the medians, then each unknown up and down from there."""
        moves = [np.zeros(len(self.index)), *(sign * AWAY * row for row in np.diag(self.sd) for sign in (1.0, -1.0))]
        return [self.real(self.middle * np.exp(move)) for move in moves]

    def _fall(self, values: Array) -> float:
        """Returns by how much the curve falls, over the largest stress: it must rise to its pole."""
        stress = self.form.loading(values, 0.0, np.linspace(0, RISE_END * self.form.pole(values), RISES))
        part = self.fall_weight * float(np.sum(np.maximum(0.0, stress[:-1] + LEAST_RISE * self.size - stress[1:]))) / self.size
        return min(FAR, part) if math.isfinite(part) else FAR

    def deviations(self, values: Array) -> Array:
        made = np.concatenate([test.scaled(self.form.loading(values, test.rate, strain)) for test, strain in zip(self.given.tests, self.strain)])
        return np.clip(np.nan_to_num(made, nan=FAR, posinf=FAR, neginf=FAR), -FAR, FAR)

    def residual(self, x: Array) -> Array:
        values = self.values(x)
        ridge = RIDGE * np.log(values[self.index] / self.middle) / self.sd
        return np.concatenate([self.deviations(values), [self._fall(values)], ridge])


def _fit_loading(given: Given) -> FormFit:
    p = _Problem(given)
    least, x, covariance = search(p.residual, p.starts())
    for p.fall_weight in FALL_WEIGHTS:
        if math.isfinite(least):
            least, x, covariance = search(p.residual, [x])
    if not math.isfinite(least):
        raise NumericError(f'no search for the parameters of curve_form = "{p.form.curve}" converges', 5)
    value = p.values(x)
    deviation = p.deviations(value)
    if not rms(deviation) < 1:
        raise NumericError(f'the best curve of curve_form = "{p.form.curve}" deviates from the tests by more than their largest stress (rms)', 5)
    r = min(0.98, neighbour_correlation(deviation))
    serial = (1 + r) / (1 - r) if r > 2 / math.sqrt(len(deviation)) else 1.0
    return FormFit(given, value, *_errors(p, x, covariance, least / max(1, len(deviation) - len(x)) * serial), loading_rms=rms(deviation))


def _errors(p: _Problem, x: Array, covariance: Array, variance: float) -> tuple[Array, list[bool], Array]:
    """Returns relative standard errors of the form's unknowns, those that stand at a bound, and the correlations."""
    part = logistic(x[:len(p.index)])
    spread = np.sqrt(np.maximum(1e-300, np.diag(covariance)))
    error = p.range * part * (1 - part) * np.sqrt(variance) * spread[:len(part)]
    return np.where(is_at_end(part), math.nan, error), [bool(one) for one in is_at_end(part)], (covariance / np.outer(spread, spread))[:len(part), :len(part)]


def _with(given: Given, value: Array, unloading: Any, memory: Any = ()) -> Array:
    """Returns values with HU, SHAPE, ALPHA and the memory."""
    assert given.form
    made = value.copy()
    for name, one in zip((*UNLOADING, *MEMORY), (*unloading, *memory)):
        made[given.form.index[name]] = one
    return made


def _foam(given: Given, value: Array, unloading: Any, memory: Any = ()) -> Foam:
    assert given.form
    return given.form.foam(_with(given, value, unloading, memory), given.informed)


def _follow(foam: Foam, test: Test, parts: int = 1) -> Array:
    """Returns the stress of the law along a test."""
    return foam.compress(*test.path_of(parts))[parts::parts]


def _fit_unloading(fit: FormFit, is_one: bool) -> Unloading:
    """Fits HU, SHAPE and ALPHA (`is_one`: 1) to all unloading, given the loading."""
    given, form = fit.given, fit.given.form
    assert form
    tests = [test for test in given.tests if test.unloads]

    def values(x: Array) -> Array:
        made = UNLOADING_LOW + (UNLOADING_HIGH - UNLOADING_LOW) * logistic([*x, 0.0][:3])
        return np.array([*made[:2], 1.0]) if is_one else np.asarray(made)

    def deviations(unloading: Array) -> list[Array]:
        foam = _foam(given, fit.value, unloading)
        return [test.scaled(_follow(foam, test))[test.unloading] for test in tests]

    least, x, _ = search(lambda x: np.concatenate(deviations(values(x))), [start[:2 if is_one else 3] for start in UNLOADING_STARTS])
    if not math.isfinite(least):
        raise NumericError("no search for HU, SHAPE and ALPHA converges", 5)
    found, factors = values(x), list[Array]()
    off = deviations(found)
    for test, one in zip(tests, off):
        strain = np.maximum(0.0, test.data.strain[test.unloading])[::-1]
        way = np.linspace(0, test.data.largest_strain, 2001)
        curve = form.loading(fit.value, 0.0, way)
        work = np.concatenate([[0.0], np.cumsum(0.5 * (curve[1:] + curve[:-1]))])
        loading = np.interp(strain, way, curve)[::-1]
        keep = np.interp(strain, way, work)[::-1] >= LEAST_RATIO * work[-1]
        factors.append((one * test.data.largest_stress)[keep] / loading[keep])
    return Unloading(found, [UNLOADING[k] for k in np.flatnonzero(is_at_end(logistic(x)))], math.sqrt(least / sum(map(len, off))), rms(np.concatenate(factors)))


def run(given: Given) -> FormFit:
    """Fits the form, its unloading and its memory. NumericError: no search converges, or its curve is none."""
    fit = _fit_loading(given)
    try:
        fit.foam = _foam(given, fit.value, (1.0, 1.0, 1.0))
    except NumericError as error:
        raise NumericError(f'the tests lead to no foam of curve_form = "{given.form.curve if given.form else ""}": {error}', 5) from None
    if sum(len(test.data.strain[test.unloading]) for test in given.tests) > 3:
        fit.one, fit.unloading = _fit_unloading(fit, True), _fit_unloading(fit, False)
        fit.value = _with(given, fit.value, fit.unloading.value)
        fit.foam = _foam(given, fit.value, fit.unloading.value)
    if given.cycles:
        _fit_cycles(fit)
    assert fit.foam
    for test in (*given.tests, *given.predicted):
        stress = _follow(fit.foam, test, FINE if given.rate != "none" else 1)
        fit.stress.append(stress if fit.unloading else np.where(np.arange(len(stress)) < test.data.loading, stress, math.nan))
    return fit


# ---- memory

def _fit_cycles(fit: FormFit) -> None:
    """Refines the form's unknowns, HU, SHAPE and ALPHA with reload, drift and, with pauses, recovery by the fitted cycles of all records."""
    given, form = fit.given, fit.given.form
    assert form
    if not fit.unloading:
        raise InputError(f"{given.cycles[0].path}: a test without unloading has no memory")
    p = _Problem(given)
    told = max(1 if r.fitted < 3 else 3 if np.any(r.pause[:r.turn[2 * r.fitted] + 1]) else 2 for r in given.cycles)
    about = [form.parameters[form.index[name]] for name in MEMORY[:told]]
    low, high = (np.log(np.concatenate([a, b])) for a, b in ((UNLOADING_LOW, [q.low for q in about]), (CYCLE_HIGH, [q.high for q in about])))
    n, records = len(p.index), [(r, r.turn[2 * r.fitted] + 1) for r in given.cycles]

    def take(x: Array) -> tuple[Array, Array]:
        made = given.start.copy()
        made[p.index] = np.exp(p.low + p.range * logistic(x[:n]))
        return made, np.exp(low + (high - low) * logistic(x[n:]))

    def residual(x: Array) -> Array:
        try:
            value, own = take(x)
            foam = _foam(given, value, own[:3], own[3:])
            off = np.concatenate([((foam.cycles(r.time[:end], r.strain[:end], r.pause[:end]) - r.stress[:end]) / r.largest)[~r.held[:end]] for r, end in records])
            return np.asarray(np.clip(np.nan_to_num(off, nan=FAR_CYCLES, posinf=FAR_CYCLES, neginf=FAR_CYCLES), -FAR_CYCLES, FAR_CYCLES))
        except NumericError:
            return np.full(sum(int(np.sum(~r.held[:end])) for r, end in records), FAR_CYCLES)

    first = (np.log([*fit.unloading.value, *CYCLE_START[:told]]) - low) / (high - low)
    first = np.clip(first, 1e-3, 1 - 1e-3)
    least, x, covariance = search(residual, [np.concatenate([p.real(fit.value[p.index], 1e-3), np.log(first / (1 - first))])])
    if not math.isfinite(least):
        raise NumericError(f"no search for the memory in {given.cycles[0].path} converges", 5)
    value, own = take(x)
    deviation, part = residual(x), logistic(x[n:])
    r1 = min(0.98, max(0.0, neighbour_correlation(deviation)))
    variance = least / (len(deviation) - len(x)) * (1 + r1) / (1 - r1)
    fit.error, fit.at_bound, fit.correlation = _errors(p, x, covariance, variance)
    error = own * (high - low) * part * (1 - part) * np.sqrt(variance * np.maximum(0.0, np.diag(covariance)[n:]))
    fit.memory_error[:told] = np.where(is_at_end(part), math.nan, error)[3:]
    memory = [*own[3:], *[0.0] * (3 - told)]
    fit.value = _with(given, value, own[:3], memory)
    fit.foam = _foam(given, value, own[:3], memory)
    fit.cycles = [fit.foam.cycles(r.time, r.strain, r.pause) for r in given.cycles]
    squares = [sum(fit.cycle_rms(k, branch)[0] ** 2 for k in range(len(given.cycles))) / len(given.cycles) for branch in (0, 1)]
    fit.loading_rms = math.sqrt(squares[0])
    fit.unloading = Unloading(own[:3], [UNLOADING[k] for k in np.flatnonzero(is_at_end(part[:3]))], math.sqrt(squares[1]), math.nan)
    fit.set = _set(fit)


def _taken_up(r: Cycles, stress: Array, first: int, end: int) -> float:
    """Returns the strain at which the stress reaches 1 % of the record's largest."""
    least = 0.01 * r.largest
    i = next((k for k in range(first, end) if not stress[k] < least), end)
    return float(r.strain[i] if i == first else np.interp(least, stress[[i - 1, i]], r.strain[[i - 1, i]]))


def _set(fit: FormFit) -> tuple[float, float, float]:
    """Returns by how much later than the law, which has no set in a test, reloads take up stress, over the largest strain before; its standard error; the mean time without load."""
    parts, times = list[float](), list[float]()
    for r, law in zip(fit.given.cycles, fit.cycles):
        for c in range(1, r.whole):
            begin, end, top = r.turn[2 * c], r.turn[2 * c + 1], r.turn[2 * c - 1]
            left = begin
            while left > top and r.stress[left] < 0.01 * r.largest:
                left -= 1
            parts.append((_taken_up(r, r.stress, begin, end) - _taken_up(r, law, begin, end)) / float(r.strain[top]))
            times.append(float(r.time[begin] - r.time[left]))
    if len(parts) < 2:
        return math.nan, math.nan, math.nan
    return float(np.mean(parts)), float(np.std(parts, ddof=1)) / math.sqrt(len(parts)), float(np.mean(times))
