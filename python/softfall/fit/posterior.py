# SPDX-License-Identifier: GPL-3.0-or-later
"""What else agrees with the measurements: the posterior of a model by an emulator of drops, a chain on it, and draws that are simulated and weighed.

An emulator (a quadratic with a Gaussian process on what it leaves) learns the drops of an inflated Laplace approximation, then of draws of a first and of a second chain;
its error is one of the numbers' errors. The last chain gives draws, each of which is simulated; their importance weights take away what the emulator still has wrong. Beside the unknowns the chain
has tau, the size of what the true loading curve has beyond the form: a Gaussian process on the logarithm of the stress with a correlation length of 0.12 strain, which acts on the numbers
by their derivatives; and kappa, the size of the model's other errors: of each number one that all drops share and one of a drop's own, each with a standard deviation of
kappa model_sd/sqrt 2. The mesh is an unknown, too: a factor on the step from the coarse drop to that of the case.
"""
from __future__ import annotations

import functools
import logging
import math
import warnings
from dataclasses import dataclass, field
from typing import Any, Callable, NamedTuple, Sequence

import emcee
import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

from ..array import Array
from ..errors import NumericError
from ..memory import nine_digits
from .drops import COARSE, OWN
from .input import CHAIN, KINDS
from .search import STRETCH, Found, Problem, shift_of
from .work import BENDS

INFLATE = 1.6  # of the Laplace approximation, in standard deviations
ENSEMBLES = 2  # of a chain
KAPPA, TAU = 1.0, 0.1  # scales of the half-normal priors
LENGTH = 0.12  # strain, over which the curve's bend is alike
MESH_PART = 1 / 3  # of the step to the case's mesh: its error, of order 2
DEEP_ENOUGH, LEAST_POINTS = 20.0, 6  # ln of the density below the best, beyond one for each unknown, to which an emulator learns; points for each unknown that it has at least
RIDGE, NEAR = 1e-4, 3  # of the quadratic; neighbours that tell whether a drop fails
RHAT, EFFECTIVE, PARETO = 1.02, 400.0, 0.7
LEAVE_DRAWS, OUTPUT_DRAWS, ERRORS = 1500, 200, 16  # of a chain for leave-one-out; files of draws; errors of the responses for each draw
TAIL = (0.025, 0.05, 0.5, 0.95, 0.975)
COLLAPSED = math.inf
logging.getLogger("emcee").setLevel(logging.ERROR)  # the effective size is told by us


@functools.lru_cache(maxsize=None)
def _pairs(n: int) -> tuple[Array, Array]:
    return np.triu_indices(n)


def _basis(z: Array) -> Array:
    first, second = _pairs(z.shape[1])
    return np.concatenate([np.ones((len(z), 1)), z, z[:, first] * z[:, second]], axis=1)


class _Surfaces:
    """Outputs over the unknowns: of each a quadratic, and a Gaussian process on what it leaves, whose length and size follow from the points by their likelihood."""

    def __init__(self, points: Array) -> None:
        self.points, self.basis = points, _basis(points)
        self.weights, self.alpha = np.empty((self.basis.shape[1], 0)), np.empty((len(points), 0))
        self.nearness = np.empty((points.shape[1], 0))  # 1/2 over the square of the length; 0: the output has nothing of this unknown
        self.rms: list[float] = []  # of what is left, by leave-one-out

    def add(self, y: Array, good: Array, columns: Array) -> None:
        """Fits one more output, a function of some unknowns, to the points that have it."""
        first, second = _pairs(len(columns))
        known = np.concatenate([[True], columns, columns[first] & columns[second]])
        basis, z = self.basis[good][:, known], self.points[good][:, columns]
        penalty = RIDGE * len(z) * np.eye(basis.shape[1])
        penalty[:1 + z.shape[1]] = 0.0
        weights, alpha, nearness = np.zeros(len(known)), np.zeros(len(good)), np.zeros(len(columns))
        weights[known] = np.linalg.solve(basis.T @ basis + penalty + 1e-10 * np.eye(basis.shape[1]), basis.T @ y[good])
        left: Array = y[good] - basis @ weights[known]
        scale = rms = float(np.std(left))
        if scale >= 1e-5:
            kernel = ConstantKernel(1.0, (1e-2, 1e2)) * RBF(2.0, (0.5, 20.0)) + WhiteKernel(0.1, (1e-4, 1.0))
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ConvergenceWarning)
                gp = GaussianProcessRegressor(kernel, random_state=0).fit(z, left / scale)
            alpha[good] = scale * float(gp.kernel_.k1.k1.constant_value) * np.asarray(gp.alpha_)
            nearness[columns] = 0.5 / float(gp.kernel_.k1.k2.length_scale) ** 2
            rms = float(scale * np.sqrt(np.mean((np.asarray(gp.alpha_) / np.diag(np.linalg.inv(gp.L_ @ gp.L_.T))) ** 2)))
        self.weights, self.alpha, self.nearness = (np.column_stack(pair) for pair in ((self.weights, weights), (self.alpha, alpha), (self.nearness, nearness)))
        self.rms.append(rms)

    def __call__(self, z: Array) -> Array:
        apart = (z[:, None, :] - self.points[None]) ** 2
        return np.asarray(_basis(z) @ self.weights + np.einsum("spk,pk->sk", np.exp(-apart @ self.nearness), self.alpha))


def pareto(log_weights: Array) -> tuple[Array, float]:
    """Returns normalised importance weights whose largest ones are smoothed by a generalised Pareto distribution, and its shape k (Vehtari and others 2024).

    >>> weights, k = pareto(np.zeros(100))
    >>> bool(np.allclose(weights, 0.01)), k
    (True, 0.0)
    """
    w = np.exp(log_weights - log_weights.max())
    count = int(min(0.2 * len(w), 3 * math.sqrt(len(w))))
    order = np.argsort(w)
    tail, cut = order[-count:], w[order[-count - 1]] if count < len(w) else 0.0
    over = np.sort(w[tail] - cut)
    if count < 5 or over[-1] <= 1e-12 * w.max() or over[0] < 0:
        return w / w.sum(), 0.0
    quarter = max(over[max(int(count / 4 + 0.5) - 1, 0)], 1e-300)
    grid = 30 + int(math.sqrt(count))
    theta = 1 / over[-1] + (1 - np.sqrt(grid / (np.arange(1, grid + 1) - 0.5))) / (3 * quarter)
    shape = np.array([-np.mean(np.log1p(-t * over)) for t in theta])
    score = np.array([count * (math.log(t / k) + k - 1) if t / k > 0 else -math.inf for t, k in zip(theta, shape)])
    part = np.exp(score - score.max())
    best = float((theta * part).sum() / part.sum())
    k = float(np.mean(np.log1p(-best * over)))
    sigma, k = -k / best, (k * count + 5) / (count + 10)
    p = (np.arange(1, count + 1) - 0.5) / count
    smooth = sigma * np.expm1(-k * np.log1p(-p)) / k if abs(k) > 1e-9 else -sigma * np.log1p(-p)
    w[tail[np.argsort(w[tail])]] = np.minimum(cut + smooth, w.max())
    return w / w.sum(), k


def normal_density(off: Array, cover: Array) -> Array:
    """Returns ln of the normal density of residuals [points][rows] with covariances [points][rows][rows]."""
    square = np.einsum("si,si->s", off, np.linalg.solve(cover, off[..., None])[..., 0])
    return np.asarray(-0.5 * (square + np.linalg.slogdet(cover)[1] + off.shape[1] * math.log(2 * math.pi)))


def quantiles(values: Array, weights: Array, shares: Sequence[float] = TAIL) -> Array:
    """Returns weighted quantiles; values may be infinite.

    >>> quantiles(np.array([1.0, 2.0, 3.0]), np.array([1.0, 1.0, 1.0]), [0.5]).tolist()
    [2.0]
    """
    order = np.argsort(values)
    places = np.cumsum(weights[order]) / weights.sum()
    return np.asarray(values[order][np.minimum(np.searchsorted(places, np.asarray(shares) - 1e-12), len(values) - 1)])


def stretched(q: Array) -> Array:
    """Returns quantiles TAIL whose logarithms are STRETCH times as far from the median; all stay where that is infinite.

    >>> stretched(np.exp([-0.2, -0.1, 0.0, 0.1, 0.2])).round(3).tolist()
    [0.726, 0.852, 1.0, 1.174, 1.377]
    """
    middle = q[2]
    return np.asarray(middle * (q / middle) ** STRETCH) if math.isfinite(middle) else q


class Simulated(NamedTuple):
    """Points with all drops, on the case's mesh."""

    x: Array  # [points][unknowns, ln(kappa), ln(tau)]
    response: Array  # [drops][points][KINDS], ln of the numbers; NaN: not defined
    failed: Array  # [drops][points]
    rest: Array  # [points], sum of squares of samples and tests
    by_chain: Array  # [drops][points][KINDS], ln of a number over that without the accelerometer's chain

    def and_these(self, other: Simulated) -> Simulated:
        """Returns both together."""
        points = (0, 1, 1, 0, 1)  # the axis
        return Simulated(*(np.concatenate(pair, axis=axis) for *pair, axis in zip(self, other, points)))

    def only(self, keep: Array) -> Simulated:
        """Returns some of the points."""
        return Simulated(self.x[keep], self.response[:, keep], self.failed[:, keep], self.rest[keep], self.by_chain[:, keep])


@dataclass
class Posterior:
    """The posterior of a model: simulated draws with their weights."""

    found: Found
    drawn: Simulated | None = None  # the draws
    weights: Array = field(default_factory=lambda: np.empty(0))
    rhat: float = math.nan
    effective: float = 0.0
    pareto_k: float = math.nan
    rms: float = math.nan
    left_out: list[tuple[float, float]] = field(default_factory=list)  # log predictive density of each measured drop by the others, and Pareto k

    @property
    def draws(self) -> Simulated:
        assert self.drawn is not None
        return self.drawn

    def __post_init__(self) -> None:
        p = self.problem = self.found.problem
        self.rows = [(d, k) for d, drop in enumerate(p.measured) for k, kind in enumerate(KINDS) if kind.key in drop.value]
        self.data = np.array([math.log(p.measured[d].value[KINDS[k].key]) for d, k in self.rows])
        self.noise = np.diag([p.measured[d].sd[KINDS[k].key] ** 2 for d, k in self.rows])
        self.targets = [(d, k) for d, drop in enumerate(p.drops) if drop.predicted for k in range(len(KINDS))]
        step = shift_of(p, self.found.x, COARSE, OWN)
        self.offset = [one[:len(KINDS)] for one in step]
        places = [*self.rows, *self.targets]
        sd = np.array([KINDS[k].model_sd for _, k in places])
        kinds, drops = np.array([k for _, k in places]), np.array([d for d, _ in places])
        share = (kinds[:, None] == kinds[None]) * (0.5 + 0.5 * (drops[:, None] == drops[None]))
        mesh = MESH_PART * np.array([self.offset[d][k] for d, k in places])
        self.model_error, self.mesh_error = share * np.outer(sd, sd), np.outer(mesh, mesh)
        slopes = p.bend_slopes(self.found.x)
        self.slopes = np.array([slopes[d][k] for d, k in places]).reshape(len(places), len(BENDS))
        self.alike = np.exp(-0.5 * (np.subtract.outer(BENDS, BENDS) / LENGTH) ** 2)
        self.curve_error = self.slopes @ self.alike @ self.slopes.T

    def error(self, kappa: float, tau: float) -> Array:
        """Returns the covariance of the errors of the model, of measured numbers and of those to predict."""
        return np.asarray(kappa**2 * self.model_error + tau**2 * self.curve_error + self.mesh_error)

    def cover(self, sizes: Array, rows: Array | slice = slice(None)) -> Array:
        """Returns the covariances of the residuals of measured numbers, [points][rows][rows], by ln(kappa) and ln(tau) [points][2]."""
        n = len(self.rows)
        parts = [one[:n, :n][rows][:, rows] for one in (self.noise + self.mesh_error[:n, :n], self.model_error, self.curve_error)]
        square = np.exp(2 * sizes)[:, :, None, None]
        return np.asarray(parts[0] + square[:, 0] * parts[1] + square[:, 1] * parts[2])

    # ---- densities

    def prior(self, x: Array) -> Array:
        """Returns ln of the prior density on the axes of the search, and of kappa and tau."""
        p, foam, sizes = self.problem, x[:, :-2], x[:, -2:]
        made = -0.5 * (((p.logarithm(foam) - p.center) / p.sd) ** 2).sum(axis=1) + np.log(np.maximum(p.log_slope(foam), 1e-300)).sum(axis=1)
        made += (sizes - 0.5 * (np.exp(np.minimum(sizes, 5.0)) / (KAPPA, TAU)) ** 2).sum(axis=1)
        inside = np.all((foam > p.low) & (foam < p.high), axis=1) & np.all(sizes > (-7, -9), axis=1)
        return np.asarray(np.where(inside, made, -math.inf))

    def likelihood(self, y: Array, rest: Array, sizes: Array, error: Array | float = 0.0) -> Array:
        """Returns ln of the likelihood of ln(numbers) [points][rows] with errors of their own, with half the sum of squares of all other residuals."""
        made = -0.5 * rest
        if self.rows:
            made = made + normal_density(self.data - y, self.cover(sizes) + np.diag(np.broadcast_to(np.square(error), len(self.rows))))
        return np.asarray(np.where(np.isfinite(made), made, -math.inf))

    # ---- simulated foams

    def simulate(self, x: Array, which: int) -> Simulated:
        """Simulates the first drops at points; the others count as failed."""
        p, count = self.problem, len(self.problem.drops)
        outcomes: list[Any] = [None] * len(x)
        good = [k for k, row in enumerate(x) if p.makes_foam(row[:-2])]
        for k, made in zip(good, p.outcomes([(x[k, :-2], range(which)) for k in good], COARSE)):
            outcomes[k] = made
        saved, p.offset = p.offset, {}
        response = [np.full((len(x), len(KINDS)), math.nan) for _ in range(count)]
        failed = [np.ones(len(x), dtype=bool) for _ in range(count)]
        rest, by_chain = np.zeros(len(x)), np.zeros((count, len(x), len(KINDS)))
        for s, made in enumerate(outcomes):
            if made is None:
                continue
            for d, one in enumerate(made):
                failed[d][s] = bool(one.failure)
                if one.failure:
                    continue
                y, by_chain[d][s] = p.shifted(one, d, COARSE), one.by_chain()
                response[d][s] = y[:len(KINDS)] + self.offset[d]
                curve = p.drops[d].curve
                if curve:
                    rest[s] += float((((y[len(KINDS) + 1:] - curve.value / curve.peak) / curve.sd) ** 2).sum())
            tests = p.tests(x[s, :-2])
            rest[s] += float(tests @ tests)
        p.offset = saved
        return Simulated(x, np.array(response).reshape(by_chain.shape), np.array(failed, dtype=bool).reshape(count, len(x)), rest, by_chain)

    def exact(self, of: Simulated) -> Array:
        """Returns ln of the likelihood of simulated points."""
        y = np.stack([of.response[d][:, k] for d, k in self.rows], axis=1) if self.rows else np.empty((len(of.x), 0))
        dead = of.failed[:len(self.problem.measured)].any(axis=0) | ~np.isfinite(y).all(axis=1)
        return np.asarray(np.where(dead, -math.inf, self.likelihood(np.nan_to_num(y), of.rest, of.x[:, -2:])))


class Effort(NamedTuple):
    """Foams that are simulated, of the first design, of draws of each chain but the last and of that one; chains; steps of the last chain, and of these not counted."""

    first: int = 100
    second: int = 70
    draws: int = 120
    rounds: int = 3
    steps: int = 2400
    burn: int = 800


USUAL = Effort()


class Emulator:
    """The measured numbers of a model over its unknowns, learnt from simulated points."""

    def __init__(self, posterior: Posterior, of: Simulated) -> None:
        self.of, self.mid, self.scale = posterior, of.x[:, :-2].mean(axis=0), np.maximum(of.x[:, :-2].std(axis=0), 1e-6)
        z, p, rest = (of.x[:, :-2] - self.mid) / self.scale, posterior.problem, of.rest
        first, dead = len(p.model.unknown) + len(p.chain), of.failed[:len(p.measured)].any(axis=0)
        self.dead, self.surfaces = dead, _Surfaces(z)
        for d, k in posterior.rows:
            columns = np.array([c < first or p.speeds[c - first] == d for c in range(z.shape[1])])
            y, good = of.response[d][:, k], ~dead & np.isfinite(of.response[d][:, k])
            if good.sum() < z.shape[1] + 5:
                raise NumericError(f"the posterior of {p.model.label}: of {len(z)} foams near the best one {int((~good).sum())} make the drop {p.measured[d].name} fail", 5)
            self.surfaces.add(y, good, columns)
        self.error = np.array(self.surfaces.rms)
        self.has_rest = bool(np.any(rest > 0))
        if self.has_rest:
            self.surfaces.add(rest, ~dead, np.ones(z.shape[1], dtype=bool))

    def density(self, x: Array) -> Array:
        """Returns ln of the posterior density, by the emulator."""
        prior = self.of.prior(x)
        made = np.full(len(x), -math.inf)
        keep = np.isfinite(prior)
        if keep.any():
            made[keep] = prior[keep] + self.likelihood(x[keep])
        return made

    def numbers(self, x: Array) -> Array:
        return self.surfaces((x[:, :-2] - self.mid) / self.scale)[:, :len(self.error)]

    def likelihood(self, x: Array) -> Array:
        z = (x[:, :-2] - self.mid) / self.scale
        told = self.surfaces(z)
        made = self.of.likelihood(told[:, :len(self.error)], np.maximum(told[:, -1], 0.0) if self.has_rest else np.zeros(len(x)), x[:, -2:], self.error)
        if self.dead.any():  # where most neighbours fail the foam fails
            apart = ((z[:, None, :] - self.surfaces.points[None]) ** 2).sum(axis=2)
            near = np.argsort(apart, axis=1)[:, :NEAR]
            made = np.where(self.dead[near].mean(axis=1) > 0.5, -math.inf, made)
        return np.asarray(made)


def _chain(emulator: Emulator, begin: Array, seed: int, steps: int, burn: int, ensembles: int) -> tuple[Array, float, float]:
    """Returns states of a chain of an ensemble sampler, the largest R-hat over ensembles and parameters, and the least effective size."""
    n, kept, sizes = begin.shape[1], [], []
    walkers = max(2 * n + 2, 32)
    for k in range(ensembles):
        random = np.random.default_rng(seed + k)
        sampler = emcee.EnsembleSampler(walkers, n, emulator.density, vectorize=True, moves=[(emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)])
        sampler._random.seed(int(random.integers(2**31)))
        start = begin[random.choice(len(begin), walkers, replace=len(begin) < walkers)] + 1e-3 * random.standard_normal((walkers, n))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sampler.run_mcmc(start, steps, skip_initial_state_check=True)
            chain = sampler.get_chain(discard=burn)
            times = emcee.autocorr.integrated_time(chain, quiet=True)
        sizes.append(chain.shape[0] * walkers / np.maximum(times, 1.0))
        kept.append(chain)
    halves = [half.reshape(-1, n) for chain in kept for half in np.array_split(chain, 2)]
    within, means = np.mean([half.var(axis=0) for half in halves], axis=0), np.array([half.mean(axis=0) for half in halves])
    rhat = np.sqrt(1 + means.var(axis=0, ddof=1) / np.maximum(within, 1e-30))
    return np.concatenate([chain.reshape(-1, n) for chain in kept]), float(rhat.max()), float(np.sum(sizes, axis=0).min())


def infer(found: Found, tell: Callable[[str], None], effort: Effort | None = None) -> Posterior:
    """Samples the posterior of a model that was fitted."""
    effort = effort or USUAL
    made, p = Posterior(found), found.problem
    random, n = np.random.default_rng(p.given.seed), len(found.x)
    covariance = found.covariance / found.scale**2
    cap = p.sd / np.maximum(p.log_slope(found.x), 0.05)  # no wider than the prior
    root = np.linalg.cholesky(covariance + 1e-12 * np.eye(n))
    z = np.clip(random.standard_normal((effort.first, n)), -2.5, 2.5)
    spread = np.clip(INFLATE * z @ root.T, -2.5 * cap, 2.5 * cap)
    design = np.column_stack([np.clip(found.x + spread, p.low + 1e-6, p.high - 1e-6), math.log(0.5 * KAPPA) + 0.5 * random.standard_normal(effort.first), math.log(0.5 * TAU) + 0.5 * random.standard_normal(effort.first)])
    design[0, :-2] = found.x
    known = made.simulate(design, len(p.measured))
    for turn in range(effort.rounds):
        known = _near(made, known)
        emulator = Emulator(made, known)
        best = known.x[np.argsort(-emulator.density(known.x))[:max(8, len(known.x) // 3)]]
        last = turn == effort.rounds - 1
        length = (effort.steps, effort.burn, ENSEMBLES) if last else (effort.steps // 2, effort.burn // 2, 1)  # others only choose what is learnt
        states, made.rhat, made.effective = _chain(emulator, best, p.given.seed + 10 * turn, *length)
        draws = made.simulate(states[random.choice(len(states), effort.draws if last else effort.second, replace=False)], len(p.drops if last else p.measured))
        if not last:
            known = known.and_these(draws)
    made.rms, exact = float(emulator.error.max(initial=0.0)), made.exact(draws)
    if not np.isfinite(exact).any():
        raise NumericError(f"the posterior of {p.model.label}: the measured drops of all {effort.draws} draws fail", 5)
    made.weights, made.pareto_k = pareto(exact - emulator.likelihood(draws.x))
    made.drawn = draws
    _leave_out(made, emulator, states[random.choice(len(states), min(LEAVE_DRAWS, len(states)), replace=False)])
    tell(f"  posterior: R-hat {made.rhat:.3f}, effective size {made.effective:.0f}; {effort.draws} simulated draws are worth {1 / float((made.weights**2).sum()):.0f}, Pareto k {made.pareto_k:.2f}; "
         f"emulator {100 * made.rms:.2f} %")
    return made


def _near(made: Posterior, known: Simulated) -> Simulated:
    """Returns the points of a design that are not far less likely than the best one: an emulator is better without the others."""
    n = known.x.shape[1] - 2
    density = made.exact(known) + made.prior(known.x)
    order = np.argsort(-density)
    count = int((density > density[order[0]] - n - DEEP_ENOUGH).sum())
    return known.only(np.sort(order[:max(count, LEAST_POINTS * n)]))


def _leave_out(made: Posterior, emulator: Emulator, states: Array) -> None:
    """Fills the log predictive density of each measured drop by the others."""
    off, sizes = made.data - emulator.numbers(states), states[:, -2:]
    for d in range(len(made.problem.measured)):
        own = np.array([drop == d for drop, _ in made.rows])
        if own.any() and not own.all():
            others = np.flatnonzero(~own)
            own_density = normal_density(off, made.cover(sizes)) - normal_density(off[:, others], made.cover(sizes, others))
            weights, k = pareto(-own_density)
            made.left_out.append((float(np.log(np.sum(weights * np.exp(own_density - own_density.max()))) + own_density.max()), k))


class Errors(NamedTuple):
    """What a draw has beside its foam: of each of KINDS an error that all drops share, with what the accelerometer's chain adds, and the standard deviation of a drop's own;
    and the bend of the curve at BENDS."""

    shared: Array
    own_sd: Array
    bend: Array


def _normal(cover: Array, cross: Array, base: Array, off: Array, random: np.random.Generator, count: int) -> Array:
    """Returns draws of normal variables of mean 0, given residuals with covariance `base` and the covariance `cross` with them."""
    gain = np.linalg.solve(base, cross.T).T if len(base) else np.zeros((len(cover), 0))
    values, vectors = np.linalg.eigh(cover - gain @ cross.T) if len(cover) else (np.empty(0), np.empty((0, 0)))
    return np.asarray(gain @ off + random.standard_normal((count, len(cover))) @ (vectors * np.sqrt(np.maximum(values, 0.0))).T)


@dataclass
class Average:
    """All models with a posterior, weighed by how well each foretells every measured drop from the others."""

    posteriors: list[Posterior | None]
    labels: list[str]
    failures: list[str]
    seed: int

    def __post_init__(self) -> None:
        sums = [math.nan if one is None else sum(value for value, _ in one.left_out) for one in self.posteriors]
        best = max((s for s in sums if not math.isnan(s)), default=math.nan)
        raw = np.array([0.0 if math.isnan(s) else math.exp(s - best) for s in sums])
        self.densities, self.weights = sums, (raw / raw.sum()).tolist()
        self._predict()

    def _errors(self, one: Posterior, s: int, random: np.random.Generator) -> tuple[Array, Errors]:
        """Returns errors of the numbers to predict, given the residuals of a draw, [ERRORS][targets]; and those of the draw as a foam."""
        n, (kappa, tau) = len(one.rows), np.exp(one.draws.x[s, -2:])
        whole, off = one.error(kappa, tau), np.nan_to_num(one.data - np.array([one.draws.response[d][s, k] for d, k in one.rows]))
        base = one.noise + whole[:n, :n]
        errors = _normal(whole[n:, n:], whole[n:, :n], base, off, random, ERRORS)
        sd = kappa * np.array([kind.model_sd for kind in KINDS]) / math.sqrt(2)
        known = np.array([k for _, k in one.rows], dtype=int)
        first = np.zeros((len(KINDS) + len(BENDS),) * 2)
        first[:len(KINDS), :len(KINDS)], first[len(KINDS):, len(KINDS):] = np.diag(sd**2), tau**2 * one.alike
        acts = np.hstack([np.eye(len(KINDS))[known], one.slopes[:n]])
        drawn = _normal(first, first @ acts.T, base, off, random, 1)[0]
        chain = one.draws.by_chain[:, s][~one.draws.failed[:, s]]
        return errors, Errors(drawn[:len(KINDS)] + chain.mean(axis=0), np.hypot(sd, chain.std(axis=0)), drawn[len(KINDS):])

    def _predict(self) -> None:
        """Fills values of each number to predict over all models, with their weights."""
        random = np.random.default_rng(self.seed)
        self.draws: list[tuple[int, int, float, Errors]] = []  # model, draw, weight
        values: dict[tuple[int, int], list[Array]] = {}
        sizes: list[Array] = []
        models: list[int] = []
        for m, one in enumerate(self.posteriors):
            if one is None or self.weights[m] < 1e-6:
                continue
            for s, weight in enumerate(one.weights):
                if weight * self.weights[m] < 1e-9:
                    continue
                errors, drawn = self._errors(one, s, random)
                self.draws.append((m, s, weight * self.weights[m], drawn))
                sizes.append(np.full(ERRORS, weight * self.weights[m] / ERRORS))
                models += ERRORS * [m]
                for t, (d, k) in enumerate(one.targets):
                    dead = one.draws.failed[d][s] or not math.isfinite(one.draws.response[d][s, k])
                    made = np.full(ERRORS, COLLAPSED if KINDS[k].above else math.nan) if dead else np.exp(one.draws.response[d][s, k] + errors[:, t])
                    values.setdefault((d, k), []).append(made)
        self.values = {key: np.concatenate(parts) for key, parts in values.items()}
        self.sizes, self.model_of = np.concatenate(sizes) if sizes else np.empty(0), np.array(models)

    @property
    def first(self) -> Posterior:
        return next(one for one in self.posteriors if one is not None)

    @property
    def best(self) -> Posterior:
        """Returns that of the model of the largest weight, as fit.json tells its drops."""
        one = self.posteriors[int(np.argmax(self.weights))]
        assert one is not None
        return one

    def repeatability(self, k: int) -> float:
        """Returns the standard deviation of the logarithm by which a measurement of a number scatters: that of the measured drops."""
        told = [drop.sd[KINDS[k].key] for drop in self.first.problem.measured if KINDS[k].key in drop.sd]
        return math.sqrt(float(np.mean(np.square(told)))) if told else KINDS[k].sd

    def quantile(self, d: int, k: int, scatter: float | None = None, models: Array | None = None) -> Array:
        """Returns the quantiles TAIL of what is measured of a drop, or of a single pad and drop with their scatter, by some models or by all; NaN: not defined."""
        values, known = self.values[d, k], ~np.isnan(self.values[d, k])
        if models is not None:
            known &= np.isin(self.model_of, models)
        if not known.any():
            return np.full(len(TAIL), math.nan)
        random = np.random.default_rng(self.seed + d)
        scatter = self.repeatability(k) if scatter is None else scatter
        q = quantiles(values[known] * np.exp(scatter * random.standard_normal(int(known.sum()))), self.sizes[known])
        return stretched(q) if self.best.found.is_beyond(d) else q

    def missing(self, d: int, k: int) -> float:
        """Returns the share of draws without a value, as the foam collapses."""
        values = self.values[d, k]
        return float(self.sizes[~np.isfinite(values)].sum() / self.sizes.sum())

    def warnings(self) -> list[str]:
        """Returns what makes weights and intervals less sure than they look."""
        made = []
        for one, label, weight in zip(self.posteriors, self.labels, self.weights):
            if one is None or weight < 0.01:
                continue
            worst = max((k for _, k in one.left_out), default=0.0)
            size = 1 / float((one.weights**2).sum())
            made += [f"{label}: R-hat {one.rhat:.3f} is above {RHAT}"] * (one.rhat > RHAT) + [f"{label}: the effective size of its chain, {one.effective:.0f}, is below {EFFECTIVE:.0f}"] * (one.effective < EFFECTIVE)
            made += [f"{label}: Pareto k {one.pareto_k:.2f} of its simulated draws is above {PARETO}"] * (one.pareto_k > PARETO) + [f"{label}: Pareto k {worst:.2f} of a drop left out is above {PARETO}, so that its weight is unsure"] * (worst > PARETO)
            made += [f"{label}: its {len(one.weights)} simulated draws are worth {size:.0f}"] * (size < 30)
        return made

    def _scatter(self, d: int, k: int) -> float:
        value = self.first.found.own[d].get(f"{KINDS[k].stem}_scatter") if k < 2 else math.nan
        return value if math.isfinite(value) else math.nan

    def _parameters(self, one: Posterior) -> list[tuple[str, str, Array]]:
        """Returns name, unit and quantiles (SI) of the unknowns of a model, and of kappa and tau."""
        p, made = one.problem, []
        for k, name in enumerate(p.names):
            unit = p.model.form.parameters[p.model.form.index[name]].unit if name in p.model.form.index else ""
            made.append((name, unit, quantiles(np.array([Problem.value(name, v) for v in one.draws.x[:, k]]), one.weights)))
        return [*made, *((name, "", quantiles(np.exp(one.draws.x[:, k]), one.weights)) for name, k in (("kappa", -2), ("tau", -1)))]

    def summary(self) -> dict[str, Any]:
        """Returns "inference" of fit.json."""
        def number(value: float) -> float | None:
            return nine_digits(value) if math.isfinite(value) else None
        models: list[dict[str, Any]] = []
        for one, label, weight, density, failure in zip(self.posteriors, self.labels, self.weights, self.densities, self.failures):
            if one is None:
                models.append({"model": label, "weight": 0.0, "failure": failure})
                continue
            models.append({"model": label, "weight": number(weight), "log_predictive_density": number(density), "misfit": number(one.found.misfit), "converged": one.found.converged,
                           "reason": one.found.reason or None, "largest_rhat": number(one.rhat), "least_effective_sample_size": number(one.effective), "simulated_draws": len(one.weights),
                           "effective_simulated_draws": number(1 / float((one.weights**2).sum())), "pareto_k": number(one.pareto_k), "emulator_rms": number(one.rms),
                           "left_out": [{"drop": drop.name, "log_density": number(value), "pareto_k": number(k)} for drop, (value, k) in zip(one.problem.measured, one.left_out)],
                           "parameters": [{"name": name, "unit": "SI", "median": number(q[2]), "low95": number(q[0]), "high95": number(q[4])} for name, _, q in self._parameters(one)]})
        predictions = []
        for d, k in self.values:
            q, scatter = self.quantile(d, k), self._scatter(d, k)
            single = self.quantile(d, k, scatter) if math.isfinite(scatter) else np.full(len(TAIL), math.nan)
            predictions.append({"drop": self.first.problem.drops[d].name, "quantity": KINDS[k].key, "median": number(q[2]), "low95": number(q[0]), "high95": number(q[4]), "low90": number(q[1]),
                                "high90": number(q[3]), "open": None if math.isnan(q[2]) else "above" if math.isinf(q[4]) else "no", "single_drop_low95": number(single[0]),
                                "single_drop_high95": number(single[4]), "single_drop_low90": number(single[1]), "single_drop_high90": number(single[3]), "share_of_draws_without_value": number(self.missing(d, k)), "by_model": self._by_model(d, k)})
        return {"seed": self.seed, "criteria_reached": not self.warnings(), "warnings": self.warnings(), "weights_by": "leave-one-out predictive density", "models": models, "predictions": predictions}

    def _by_model(self, d: int, k: int) -> list[dict[str, Any]]:
        """Returns the interval of each model that has a weight, and that of all others."""
        made: list[dict[str, Any]] = []
        for m, label in enumerate(self.labels):
            own, rest = self.quantile(d, k, None, np.array([m])), self.quantile(d, k, None, np.delete(np.arange(len(self.labels)), m))
            if not math.isnan(own[2]):
                told = {"low90": own[1], "median": own[2], "high90": own[3], "without_low90": rest[1], "without_high90": rest[3]}
                made.append({"model": label} | {key: nine_digits(value) if math.isfinite(value) else None for key, value in told.items()})
        return made

    def page(self) -> dict[str, Any]:
        """Returns what report.html shows."""
        def text(value: float, digits: int) -> str:
            return "open above" if math.isinf(value) else f"{value:.{digits}f}" if math.isfinite(value) else "–"
        predictions = []
        for d, k in self.values:
            kind, q, scatter = KINDS[k], self.quantile(d, k), self._scatter(d, k)
            if not kind.always:
                continue
            single = self.quantile(d, k, scatter) if math.isfinite(scatter) else None
            predictions.append([self.first.problem.drops[d].name, kind.heading, text(q[2], kind.digits), f"{text(q[1], kind.digits)} to {text(q[3], kind.digits)}",
                                f"{text(q[0], kind.digits)} to {text(q[4], kind.digits)}", f"{text(single[0], kind.digits)} to {text(single[4], kind.digits)}" if single is not None else "–",
                                f"{100 * self.missing(d, k):.1f} %"])
        models, parameters = [], []
        for one, label, weight, density in zip(self.posteriors, self.labels, self.weights, self.densities):
            if one is None:
                continue
            models.append([label, f"{weight:.3f}", text(density, 2), text(one.found.misfit, 2), text(max((k for _, k in one.left_out), default=math.nan), 2), text(one.rhat, 3),
                           text(one.effective, 0), f"{1 / float((one.weights**2).sum()):.0f} of {len(one.weights)}", text(one.pareto_k, 2), f"{100 * one.rms:.2f} %"])
            parameters += [[label, name, f"{q[2]:.4g}", f"{q[0]:.4g} to {q[4]:.4g}"] for name, _, q in self._parameters(one)]
        return {"warnings": self.warnings(), "predictions": predictions, "models": models, "parameters": parameters}

    # ---- draws

    def chosen(self) -> list[tuple[int, int, Errors]]:
        """Returns equally likely draws, model by model: model, draw, its errors."""
        weights = np.array([weight for _, _, weight, _ in self.draws])
        places = (np.arange(OUTPUT_DRAWS) + 0.5) / OUTPUT_DRAWS
        at = np.searchsorted(np.cumsum(weights) / weights.sum(), places)
        return [(self.draws[k][0], self.draws[k][1], self.draws[k][3]) for k in np.minimum(at, len(self.draws) - 1)]

    def table(self) -> list[list[str]]:
        """Returns posterior.csv: the draws, one a line."""
        names: dict[str, tuple[str, float]] = {}
        for one in self.posteriors:
            for u in one.problem.model.unknown if one else []:
                about = one.problem.model.form.parameters[one.problem.model.form.index[u.name]]  # type: ignore[union-attr]
                names[u.name] = (f"{u.name} ({about.unit})" if about.unit else u.name, about.per_unit)
        rows = [["draw", "model", "kappa", "tau", *(heading for heading, _ in names.values()), *(key for kind in KINDS for key in (f"{kind.error}_error", f"{kind.error}_error_sd"))]]
        for number, (m, s, errors) in enumerate(self.chosen(), 1):
            one = self.posteriors[m]
            assert one is not None
            at = {name: Problem.value(name, one.draws.x[s, k]) for k, name in enumerate(one.problem.names)}
            rows.append([str(number), self.labels[m], f"{math.exp(one.draws.x[s, -2]):.6g}", f"{math.exp(one.draws.x[s, -1]):.6g}", *(f"{at[name] / per:.9g}" if name in at else "" for name, (_, per) in names.items()),
                         *(f"{value:.9g}" for pair in zip(errors.shared, errors.own_sd) for value in pair)])
        return rows

    def write_draws(self, folder: str, write: Callable[[str, str], None], read: Callable[[str], str]) -> None:
        """Writes draw-200.cfg ... draw-001.cfg with their curves and response_error: a folder without the first is not complete."""
        for number, (m, s, errors) in reversed(list(enumerate(self.chosen(), 1))):
            one = self.posteriors[m]
            assert one is not None
            name, p = f"draw-{number:03d}", one.problem
            foam = p.model.form.foam(p.foam_values(one.draws.x[s, :-2]))
            foam.bend(BENDS, errors.bend)
            mount = "The accelerometer's mount was an unknown of the fit.\n" if any(CHAIN[k].startswith("mount") for k in p.chain) else ""
            foam.write(folder, name, f"Draw {number} of {OUTPUT_DRAWS} of a posterior of softfall fit, equally likely.", f"Form of the curve: {self.labels[m]}.\n{mount}")
            lines = "".join(f"    {kind.error} = {errors.shared[k]:.12g}; {kind.error}_sd = {errors.own_sd[k]:.12g};\n" for k, kind in enumerate(KINDS))
            write(f"{folder}/{name}.cfg", read(f"{folder}/{name}.cfg") + "# Errors of ln(number) of a drop beside the foam: one that all drops share, and the standard deviation of each drop's "
                  f"own.\nresponse_error = {{\n{lines}}};\n")


def average(found: Sequence[Found | None], labels: Sequence[str], failures: Sequence[str], seed: int, tell: Callable[[str], None]) -> Average:
    """Samples the posterior of every model that was fitted, and averages them."""
    posteriors: list[Posterior | None] = []
    why = list(failures)
    for k, one in enumerate(found):
        try:
            if one is not None:
                tell(labels[k])
            posteriors.append(infer(one, tell) if one is not None else None)
        except (NumericError, np.linalg.LinAlgError) as error:
            posteriors.append(None)
            why[k] = str(error)
            tell(f"  FAILED: {error}")
    if not any(posteriors):
        raise NumericError(f"no model has a posterior: {next(text for text in why if text)}; posterior = false fits without one", 5)
    return Average(posteriors, list(labels), why, seed)


