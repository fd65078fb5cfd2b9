# SPDX-License-Identifier: GPL-3.0-or-later
"""The next measurement: what each one is expected to tell about the result of a protocol (docs/protocols.md, "The next drop").

The pad is one of many: each draw of the foam's posterior, by drops of its own, repeated with random errors of the model. A measurement gives
weights to them; what it is worth is the expected fall of the loss, over measurements that the present weights predict.
"""
from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Mapping, Sequence

import numpy as np

from .array import Array
from .errors import InputError

CRITERIA = ("a_max_g", "hic")
REPEATS, TRUTHS, LEAST_DRAWS = 32, 128, 8
MISFIT = -12.0
SAME = 0.01  # of a logarithm: drops of one pad are never told apart by less
TEST_STRAINS = (0.3, 0.5, 0.7)  # at which a compression test tells the stress
FORM = (0.04, 0.08)  # standard deviations of ln(figure) of a foam about the draw that is nearest to it (docs/protocols.md)
LENGTH = 0.3  # of ln(height), over which errors that change with the height do so
LOCKS, EARLIEST, RISE = 0.25, 0.5, (3.0, 12.0)  # share of the pads that lock up before the draws, from which part of the critical height on, and with which power of the height more


@dataclass(frozen=True)
class Drop:
    """A measured drop, the first on its spot: figures by CRITERIA, NaN where there is none."""

    place: str
    height: float
    figures: tuple[float, float]


@dataclass(frozen=True)
class Choice:
    """A measurement that could be next: its cost, the expected loss after it, and the fall of the loss over the cost."""

    name: str
    kind: str  # "drop", "test", or the name of another missile
    cost: float
    loss: float
    gain: float
    place: str = ""  # of a drop
    height: float = math.nan  # m


@dataclass(frozen=True)
class Test:
    """A compression test that could be next: the stress that each draw has in it, the standard deviation of its ln, and its cost."""

    name: str
    stress: Array  # [draws][strains]
    error: float
    cost: float


@dataclass(frozen=True)
class Advice:
    """The state of knowledge, and what to do next.

    `probability` that the pad passes (NaN: nothing is required of its height), critical height with its 95 % interval (m; inf: above the heights
    looked at), `loss` (probability of a wrong decision, or relative length of the interval), `decision` (True, False, or None: go on), and
    the choices from the best one on. `problem`: why nothing can be said. `expected`: the pad is expected to pass, and no drop has shown it; the
    choices are the drops that would.
    """

    probability: float
    height: tuple[float, float, float]
    loss: float
    bound: float
    decision: bool | None
    stop: bool
    choices: list[Choice] = field(default_factory=list)
    problem: str = ""
    expected: bool = False


@dataclass(frozen=True)
class Place:
    """What is known of a condition, a position and a missile: for each draw ln(figure) over ln(height), the errors of the model, the scatter."""

    name: str
    log_height: Array  # [grid]
    value: Array  # [2][draws][grid] ln
    bound: Array  # [draws] m: above it the draw has no drop that can be used, and counts as beyond the limits; inf: there is no such height
    shared: Array  # [2][draws]
    own_sd: Array  # [2][draws]
    scatter: Array  # [2][grid], standard deviation of ln(figure) from drop to drop
    mesh: Array  # [2], standard deviation of ln(figure) by the mesh
    between: Array  # [2], that of the interpolation between the drops of a draw
    notes: tuple[str, ...] = ()  # what is not known of it
    missile: str = ""  # another one than that of the protocol: nothing is judged by its drops
    cost: float = 1.0  # of a drop
    highest: float = math.inf  # m, of a drop that was simulated and can be used

    @property
    def ends(self) -> tuple[float, float]:
        """The heights (m) between which the drops of the draws are known."""
        return math.exp(self.log_height[0]), math.exp(self.log_height[-1])


def _bell(a: Array, b: Array) -> Array:
    return np.asarray(np.exp(-0.5 * ((a[:, None] - b) / LENGTH) ** 2))


class _Smooth:
    """Random functions of ln(height) of variance 1, whose correlation falls over LENGTH as a bell curve."""

    def __init__(self, places: Sequence[Place]) -> None:
        ends = [place.log_height[k] for place in places for k in (0, -1)]
        self.knots = np.arange(min(ends), max(ends) + LENGTH / 3, LENGTH / 3)
        self.root = np.linalg.inv(np.linalg.cholesky(_bell(self.knots, self.knots) + 1e-9 * np.eye(self.knots.size)))

    def draw(self, count: int, random: np.random.Generator) -> Array:
        """Returns the coefficients of functions, two for each of `count` pads."""
        return random.standard_normal((2, count, self.knots.size))

    def at(self, log_height: Array, coefficients: Array) -> Array:
        """Returns values [2][count][heights]."""
        return np.asarray(coefficients @ (_bell(log_height, self.knots) @ self.root.T).T)


class Pads:
    """The pads that may be the real one: the draws, each REPEATS times with errors of the model.

    A pad keeps its errors in all drops of a place. Two of them change with the height: the own errors of the responses, which a fit has for each of its
    drops, and those of a foam that has another form than the draws, of standard deviations `form`, the same at all places of a missile.
    With `limits` a share LOCKS of the pads locks up earlier than their draw: from a part of the height where that reaches a limit, the same part
    at all places, the figures rise with a further power of the height.
    """

    def __init__(self, places: Sequence[Place], seed: int = 1, form: Sequence[float] = FORM, limits: Sequence[float | None] | None = None) -> None:
        self.places = {place.name: place for place in places}
        self.draws = places[0].shared.shape[1]
        if any(place.shared.shape[1] != self.draws for place in places):
            raise InputError("the places of the protocol have different numbers of draws")
        random = np.random.default_rng(seed)
        self.draw = np.repeat(np.arange(self.draws), REPEATS)
        self.log_weight = np.zeros(self.draw.size)
        self.misfit = 0.0  # ln of the likelihood of the worst drop at the pad that fits it best
        self.offset, self.value = {}, {}  # ln [2][pads], and [2][pads][grid] without it
        n, mesh = self.draw.size, random.standard_normal(self.draw.size)  # all places are of one pad, and of one way to compute it
        smooth, forms = _Smooth(places), dict[str, Array]()
        for place in sorted(places, key=lambda place: place.missile != ""):
            forms.setdefault(place.missile, smooth.draw(n, random))
            own = place.own_sd[:, self.draw, None] * smooth.at(place.log_height, smooth.draw(n, random))
            self.value[place.name] = place.value[:, self.draw] + own + np.reshape(form, (2, 1, 1)) * smooth.at(place.log_height, forms[place.missile])
            self.offset[place.name] = place.shared[:, self.draw] + place.mesh[:, None] * mesh + place.between[:, None] * random.standard_normal((2, n))
            if place.missile:  # draws state errors of the missile of their fit
                self.offset[place.name] += np.sqrt((place.shared**2).mean(axis=1, keepdims=True)) * random.standard_normal((2, n))
        part = np.where(random.random(n) < (0 if limits is None else LOCKS), random.uniform(EARLIEST, 1, n), np.inf)
        self.rise, self.lock = random.uniform(*RISE, n), {place.name: np.full(n, np.inf) for place in places}  # m, where a pad locks up
        if limits is not None:
            for place in places:
                self.lock[place.name] = part * np.clip(self.crossing(place.name, limits), *place.ends)

    @property
    def judged(self) -> list[Place]:
        """The places with the missile of the protocol."""
        return [place for place in self.places.values() if not place.missile]

    def predict(self, place: str, height: float) -> Array:
        """Returns ln(figure) [2][pads] at a height (m)."""
        grid, value = self.places[place].log_height, self.value[place]
        at = np.clip(math.log(height), grid[0], grid[-1])
        k = int(np.clip(np.searchsorted(grid, at) - 1, 0, grid.size - 2))
        part = (at - grid[k]) / (grid[k + 1] - grid[k])
        made: Array = (1 - part) * value[..., k] + part * value[..., k + 1] + self.offset[place]
        made += self.rise * np.maximum(0, math.log(height) - np.log(self.lock[place]))
        return made

    def passes(self, place: str, height: float, limits: Sequence[float | None]) -> Array:
        """Returns whether a drop from a height (m) stays below the limits [pads]; one that no draw of the pad has does not."""
        below = self.places[place].bound[self.draw] > height
        for value, limit in zip(self.predict(place, height), limits):
            below &= value < math.log(limit) if limit is not None else True
        return np.asarray(below)

    def locking(self, low: Mapping[str, float], high: float) -> float:
        """Returns the probability that the pad locks up below a height (m) at any place of the protocol's missile, from its own `low` on."""
        locks = [(self.lock[place.name] >= low[place.name]) & (self.lock[place.name] < high) for place in self.judged]
        return float(self.weight @ np.any(locks, axis=0))

    def scatter(self, place: str, height: float) -> Array:
        """Returns the standard deviations of ln(figure) from drop to drop at a height."""
        p = self.places[place]
        return np.array([np.interp(math.log(height), p.log_height, p.scatter[c]) for c in range(2)])

    def crossing(self, place: str, limits: Sequence[float | None]) -> Array:
        """Returns the height (m) [pads] where the first limit is reached; inf: at none of the heights looked at; 0: at all of them."""
        p = self.places[place]
        lowest: Array = p.bound[self.draw]
        grid = np.exp(np.linspace(p.log_height[0], p.log_height[-1], 4 * p.log_height.size))
        values = np.array([self.predict(place, h) for h in grid])  # [grid][2][pads]
        for c, limit in enumerate(limits):
            if limit is None:
                continue
            over = values[:, c] >= math.log(limit)
            first = over.argmax(axis=0)
            before = np.maximum(first - 1, 0)
            low, high = (np.take_along_axis(values[:, c], k[None], axis=0)[0] for k in (before, first))
            with np.errstate(invalid="ignore", divide="ignore"):
                found = grid[before] * (grid[first] / grid[before]) ** np.clip((math.log(limit) - low) / (high - low), 0, 1)
            lowest = np.minimum(lowest, np.where(over[0], 0.0, np.where(over.any(axis=0), found, np.inf)))
        return lowest

    @property
    def weight(self) -> Array:
        """The probabilities of the pads."""
        w = np.exp(self.log_weight - self.log_weight.max())
        share: Array = w / w.sum()
        return share

    @property
    def effective_draws(self) -> float:
        """How many draws of equal weight are worth as much as these."""
        w = np.bincount(self.draw, self.weight, self.draws)
        return float(1 / (w**2).sum())

    @property
    def misfits(self) -> str:
        """Why the foam is none of the draws, after what was measured; "": it may be one."""
        if self.misfit >= MISFIT and self.effective_draws >= LEAST_DRAWS:
            return ""
        return (f"what was measured leaves {self.effective_draws:.1f} of {self.draws} draws, or fits none: a height or a scale in list.csv is wrong, or the foam is "
                "none of them. Then give these drops to softfall fit, and begin anew with its posterior and without them")

    def interval(self, limits: Sequence[float | None]) -> tuple[float, float]:
        """Returns the 95 % interval of the critical height (m); inf: above the heights looked at."""
        height = np.asarray(np.min([self.crossing(place.name, limits) for place in self.judged], axis=0))
        low, _, high = quantiles(np.argsort(height), height, self.weight)
        return float(low), float(high)

    def learn(self, drop: Drop) -> None:
        """Takes a measured drop into the weights."""
        likelihood = _log_likelihood(np.log(np.array(drop.figures)), self.predict(drop.place, drop.height), self.scatter(drop.place, drop.height))
        self.misfit = min(self.misfit, float(likelihood.max()))
        self.log_weight = self.log_weight + likelihood


def _log_likelihood(measured: Array, predicted: Array, sd: Array) -> Array:
    """Returns ln of the likelihood [pads] of the logarithms of two figures, of which at least one is known; a NaN is no figure.

    What scatters from drop to drop, speed and thickness, moves all figures of a drop together: two tell no more than one, so their mean counts.
    """
    there = ~np.isnan(measured)
    each = -0.5 * ((measured[there, None] - predicted[there]) / sd[there, None]) ** 2
    mean: Array = each.mean(axis=0)
    return mean


@dataclass(frozen=True)
class Question:
    """What a protocol asks: limits of CRITERIA at given heights of each place, or a critical height, with one that is required (NaN: none).

    `bound`: of the loss, where measuring stops: a probability of a wrong decision, or a relative length of the interval.
    """

    limits: tuple[float | None, float | None]
    heights: tuple[float, ...] = ()
    required: float = math.nan
    bound: float = 0.05

    @property
    def decides(self) -> bool:
        """True if the answer is yes or no."""
        return bool(self.heights) or not math.isnan(self.required)

    @property
    def asked(self) -> tuple[float, ...]:
        """The heights that are asked for (m)."""
        return (*self.heights, *([] if math.isnan(self.required) else [self.required]))


def _heights_of(pads: Pads, q: Question) -> Array:
    lowest: Array = np.min([pads.crossing(place.name, q.limits) for place in pads.judged], axis=0)
    return lowest


def quantiles(order: Array, value: Array, weight: Array) -> Array:
    """Returns 2.5, 50 and 97.5 % of `value`, whose order is given, for weights [...][pads]."""
    total = np.cumsum(weight[..., order], axis=-1)
    places = np.stack([(total < part * total[..., -1:]).sum(axis=-1) for part in (0.025, 0.5, 0.975)], axis=-1)
    quantiles: Array = value[order][np.minimum(places, value.size - 1)]
    return quantiles


class _Loss:
    """The loss of a question for weights [...][pads]: the probability of a wrong decision, or the relative length of the 95 % interval."""

    def __init__(self, pads: Pads, q: Question) -> None:
        self.q, self.height = q, _heights_of(pads, q)
        self.order = np.argsort(self.height)
        if q.heights:
            self.passes = np.ones(self.height.size, bool)
            for place in pads.judged:
                for h in q.heights:
                    self.passes &= pads.passes(place.name, h, q.limits)
        else:
            self.passes = self.height >= q.required

    def probability(self, weight: Array) -> Array:
        """Returns the probability of passing."""
        share: Array = weight @ self.passes / weight.sum(axis=-1)
        return share

    def __call__(self, weight: Array) -> Array:
        if self.q.decides:
            share = self.probability(weight)
            return np.minimum(share, 1 - share)
        low, median, high = np.moveaxis(quantiles(self.order, self.height, weight), -1, 0)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(np.isfinite(high) & (low > 0), (high - low) / median, 1.0)


def _expected(loss: _Loss, weight: Array, log_likelihood: Array) -> float:
    """Returns the mean loss after measurements whose ln of the likelihood is [truths][pads]."""
    with np.errstate(under="ignore"):
        after = weight * np.exp(log_likelihood - log_likelihood.max(axis=1, keepdims=True))
    return float(np.mean(loss(after / after.sum(axis=1, keepdims=True))))


def _truths(weight: Array) -> Array:
    """Returns TRUTHS pads, as probable as their weights, evenly drawn."""
    return np.minimum(np.searchsorted(np.cumsum(weight), (np.arange(TRUTHS) + 0.5) / TRUTHS), weight.size - 1)


def _drop_choice(pads: Pads, loss: _Loss, weight: Array, now: float, place: str, height: float) -> Choice:
    truths, sd, predicted = _truths(weight), pads.scatter(place, height), pads.predict(place, height)
    measured = predicted[:, truths] + sd[:, None] * np.random.default_rng(2).standard_normal(TRUTHS)
    likelihood = np.stack([_log_likelihood(measured[:, m], predicted, sd) for m in range(TRUTHS)])
    after, cost = _expected(loss, weight, likelihood), pads.places[place].cost
    return Choice(f"a drop from {height:.4g} m, {place}", pads.places[place].missile or "drop", cost, after, (now - after) / cost, place, height)


def _test_choice(pads: Pads, loss: _Loss, weight: Array, now: float, test: Test) -> Choice:
    """What scatters from specimen to specimen moves the stress at all strains together: three tell no more than one, so their mean counts."""
    truths, of = _truths(weight), np.log(test.stress[pads.draw])
    measured = of[truths] + test.error * np.random.default_rng(3).standard_normal((TRUTHS, 1))
    likelihood = -0.5 * (((measured[:, None] - of) / test.error) ** 2).mean(axis=2)
    after = _expected(loss, weight, likelihood)
    return Choice(test.name, "test", test.cost, after, (now - after) / test.cost)


def candidate_heights(place: Place, q: Question, median: float) -> list[float]:
    """Returns heights (m) that may be measured at a place: those of the protocol, and nine about the critical height, of two digits."""
    low, high = place.ends
    middle = min(max(median, low), high / 1.2)
    about = {float(f"{middle * part:.2g}") for part in np.linspace(0.6, 1.2, 9)}
    asked = set() if place.missile else set(q.asked)
    return sorted(h for h in about | asked if low <= h <= high)


def _median_height(pads: Pads, q: Question, place: Place, weight: Array, judged: float) -> float:
    """Returns the height about which drops at a place are tried: `judged`, the critical one, or that of another missile."""
    if not place.missile:
        return judged
    height = pads.crossing(place.name, q.limits)
    return min(float(quantiles(np.argsort(height), height, weight)[1]), place.highest / 1.2)


def advise(pads: Pads, q: Question, tests: Sequence[Test] = (), unshown: Sequence[tuple[str, float]] = ()) -> Advice:
    """Returns the state of knowledge and the choices, among them compression tests.

    `unshown`: places and heights (m) where a passing pad lacks a measured drop that meets the limits; while there are any, it has not passed.
    """
    for place in pads.judged:
        low, high = place.ends
        for h in q.asked:
            if not low <= h <= high:
                raise InputError(f"{place.name}: {h:g} m lies outside of the heights looked at, {low:.3g} to {high:.3g} m, "
                                 "which reach from below to above the critical height of the draws")
    weight, loss = pads.weight, _Loss(pads, q)
    height = tuple(float(v) for v in quantiles(loss.order, loss.height, weight))
    share, now = float(loss.probability(weight)) if q.decides else math.nan, float(loss(weight))
    known = Advice(share, (height[0], height[1], height[2]), now, q.bound, None, False)
    if pads.misfits:
        return replace(known, height=(math.nan,) * 3, loss=math.nan, probability=math.nan, problem=pads.misfits)
    if now <= q.bound and q.decides and share > 0.5 and unshown:
        return replace(known, expected=True, choices=[_drop_choice(pads, loss, weight, now, *at) for at in unshown if at[0] in pads.places])
    if now <= q.bound:
        return replace(known, decision=share > 0.5 if q.decides else None, stop=True)
    choices = [_drop_choice(pads, loss, weight, now, name, h) for name, place in pads.places.items()
               for h in candidate_heights(place, q, _median_height(pads, q, place, weight, height[1]))]
    choices += [_test_choice(pads, loss, weight, now, test) for test in tests]
    return replace(known, choices=sorted(choices, key=lambda c: -float(c.gain)))
