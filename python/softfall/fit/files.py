# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of a fit: the material, fit.json, the curve and the drops as tables."""
from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import library, output as output_files
from ..array import Array
from ..errors import Error
from ..library import GRADES
from ..memory import nine_digits
from .drops import GRID
from .input import KINDS, Input
from .search import STRETCH, Found, press

if TYPE_CHECKING:
    from .posterior import Average

BIN = 0.05  # strain, of the table of the curve
BINS = 19


@dataclass
class Study:
    """A fit with all that was found: one Found or a failure for each model."""

    given: Input
    text: str  # of the file
    found: list[Found | None]
    failures: list[str]
    best: int = 0
    average: Average | None = None
    simulated: int = 0
    kept: int = 0
    seconds: float = 0.0
    curve: list[tuple[float, float, float, float, float]] = field(default_factory=list)  # strain, kPa, 95 % interval, width left of the prior
    informed: tuple[float, float] = (0.0, 0.0)  # strains between which the drops inform the curve

    @property
    def fit(self) -> Found:
        found = self.found[self.best]
        assert found is not None
        return found


def number(value: float) -> float | None:
    """Returns a number for JSON: nine digits, None where it is not defined."""
    return nine_digits(value) if math.isfinite(value) else None


def stresses(foam: library.Foam, strain: Array) -> Array:
    """Returns ln of the stress (Pa) of a foam's first curve; beyond its table that of its last point."""
    _, x, y = foam.curves[0]
    return np.asarray(np.log(np.maximum(np.interp(strain, x, y), 1e-6)))


def look_at_curve(s: Study) -> None:
    """Fills the table of the curve, with errors by the parameters, and the strains between which the drops inform it."""
    fit = s.fit
    p, strain = fit.problem, BIN * (np.arange(BINS) + 0.5)
    count, form = len(p.model.unknown), p.model.form
    base = stresses(form.foam(p.foam_values(fit.x)), strain)
    slope = np.zeros((BINS, len(fit.x)))
    for k in range(count):
        for step in (1e-3, -1e-3):
            try:
                slope[:, k] = (stresses(form.foam(p.foam_values(fit.x + step * np.eye(len(fit.x))[k])), strain) - base) / step
                break
            except Error:
                continue
    sd = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slope, fit.covariance, slope), 0.0))
    wide = np.sqrt(np.sum((slope / np.maximum(p.log_slope(fit.x), 1e-9) * p.sd) ** 2, axis=1))
    left = np.divide(sd, wide, out=np.ones(BINS), where=wide > 0)
    s.curve = [(float(e), math.exp(y) / 1e3, math.exp(y - fit.half_width * w) / 1e3, math.exp(y + fit.half_width * w) / 1e3, float(part))
               for e, y, w, part in zip(strain, base, sd, left)]
    seen = [e for e, part in zip(strain, left) if part < 0.5 and e - BIN / 2 < fit.deepest]
    s.informed = (float(seen[0] - BIN / 2), float(min(seen[-1] + BIN / 2, fit.deepest))) if seen else (0.0, 0.0)


def extrapolated(s: Study) -> list[str]:
    """Returns which predicted drops strain the foam beyond what was measured, in words."""
    made = []
    for d, drop in enumerate(s.given.drops):
        strain, wide = s.fit.own[d].get("max_local_strain"), f", {STRETCH:g} times as wide as the models say" if s.average and s.fit.is_beyond(d) else ""
        if drop.predicted and s.fit.own[d].failure and wide:
            made.append(f"{drop.name} fails with the best foam: its interval is an extrapolation{wide}")
        elif drop.predicted and strain > s.informed[1]:
            made.append(f"{drop.name} strains the foam to {strain:.3f}, the data to {s.informed[1]:.3f}: its interval is an extrapolation{wide}, and still too narrow if the foam locks up early: "
                        "measure a drop that strains the foam as far, or at least give the pole, ALPHA and rate_factor wide priors (docs/validation.md, coverage)")
    return made


def provenance(s: Study) -> str:
    """Returns the comment lines of the material file."""
    fit, given = s.fit, s.given
    lines = [f"Identified by softfall fit {library.version().split()[0]} from {given.path}; everything else is that of its start material."]
    if not fit.converged:
        lines.append(f"NOT CONVERGED: {fit.reason}. These values are not to be used.")
    lines += [f"{text}." for text in fit.on_bounds]
    if s.average:
        lines.append("Weights of the models (leave-one-out predictive density): " + "; ".join(
            f"{m.label} {w:.3f}{' (this file, its maximum)' if k == s.best else ''}" for k, (m, w) in enumerate(zip(given.models, s.average.weights))) + ".")
    lines += [f"Read through the accelerometer's {text}." for text in chain_lines(s)]
    for drop, one in zip(given.measured, fit.fitted):
        told = [f" {kind.name} {drop.value[kind.key]:.4g}{' ' * bool(kind.unit)}{kind.unit} measured, {one.get(kind.key):.{kind.digits}f} simulated;" for kind in KINDS if kind.key in drop.value]
        lines.append(f"{drop.name}:{''.join(told)}" + (f" measured curve, RMSE {rmse(fit, drop.name):.2f} g;" if drop.curve else ""))
    lines += [f"Compression test {test.name}, {test.rate:.4g} 1/s." for test in given.compressions]
    lines += [f"Cushion curve {cushion.name}, {len(cushion.peak)} points." for cushion in given.cushions]
    for k, u in enumerate(fit.problem.model.unknown):
        about = fit.problem.model.form.parameters[fit.problem.model.form.index[u.name]]
        value, low, high = (v / about.per_unit for v in fit.interval(k))
        lines.append(f"{u.name} = {value:.4g}{' ' * bool(about.unit)}{about.unit} (95 %, linearised: {low:.4g} to {high:.4g}; {about.description})")
    lines.append(f"The data inform the curve between strains of {s.informed[0]:.2f} and {s.informed[1]:.2f}; beyond, its form determines it.")
    return "\n".join([*lines, f"Curve: {fit.problem.model.form.formula}.", ""])


def chain_lines(s: Study) -> list[str]:
    """Returns what is known of the accelerometer's mount and high pass, in words."""
    fit, words = s.fit, ("mount: frequency {} Hz", "mount: damping {}", "coupling: time constant {} s")
    given, now, first = s.given.chain, s.fit.problem.chain_of(s.fit.x), len(s.fit.problem.model.unknown)
    made = []
    for k, text in enumerate(words):
        if not (given[2] > 0 if k == 2 else given[0] > 0):
            continue
        line = text.format(f"{now[k]:.4g}")
        if k in fit.problem.chain:
            width = fit.half_width * math.sqrt(fit.covariance[first + fit.problem.chain.index(k), first + fit.problem.chain.index(k)])
            line += f" (95 %, linearised: {now[k] * math.exp(-width):.4g} to {now[k] * math.exp(width):.4g}; given {given[k]:.4g})"
        made.append(line)
    return made


def rmse(fit: Found, name: str) -> float:
    """Returns the deviation (g) of a simulated curve from the measured one."""
    d = next(k for k, drop in enumerate(fit.problem.measured) if drop.name == name)
    curve = fit.problem.measured[d].curve
    return float(np.sqrt(np.mean((fit.fitted[d].samples(len(curve.time)) - curve.value) ** 2))) if curve else math.nan


def tests_of(s: Study) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Returns how the foam meets compression tests and cushion curves."""
    p = s.fit.problem
    foam, values = p.model.form.foam(p.foam_values(s.fit.x)), p.foam_values(s.fit.x)
    at = {name: float(values[k]) for name, k in p.model.form.index.items()}
    compressions, cushions = [], []
    for test in s.given.compressions:
        off = (press(foam, test.rate, test.strain, test.loading, test.turn) - test.stress) / test.stress.max()
        rms = [float(np.sqrt(np.mean(part**2))) if len(part) else math.nan for part in (off[:test.loading], off[test.loading:])]
        compressions.append({"name": test.name, "understood": test.words, "rate_1_s": test.rate, "below_rate_reference": at["rate_factor"] > 0 and test.rate < at["rate_reference"],
                             "points": len(test.strain), "loading_rms": number(rms[0]), "unloading_rms": number(rms[1])})
    for one in s.given.cushions:
        cushions += [{"name": one.name, "static_stress_Pa": number(stress), "peak_measured_g": number(peak), "peak_g": number(foam.cushion(stress, one.thickness, one.height))}
                     for stress, peak in zip(one.stress, one.peak)]
    return compressions, cushions


def _drop(s: Study, d: int) -> dict[str, Any]:
    fit, drop = s.fit, s.given.drops[d]
    measured = d < len(fit.fitted)
    one, others = fit.own[d], fit.without(d) if measured else None
    at_fitted = measured and bool(one.failure)
    one = fit.fitted[d] if at_fitted else one
    made: dict[str, Any] = {"name": drop.name, "used": not drop.predicted}
    if measured and d in fit.problem.speeds:
        made |= {"speed_fitted_m_s": number(drop.speed * fit.problem.speed_of(fit.x, d)), "figures_at": "fitted speed" if at_fitted else "given speed"}
    if drop.number:
        made["drop_of_series"] = drop.number
    sd = fit.response_sd(d)
    for k, kind in enumerate(KINDS):
        value = math.nan if one.failure else one.get(kind.key)
        made |= {f"{kind.stem}_measured{kind.suffix}": drop.value.get(kind.key), f"{kind.stem}_measured_sd": drop.sd.get(kind.key),
                 f"{kind.stem}{kind.suffix}": number(value), f"{kind.stem}_sd_by_parameters": number(sd[k])}
        if k < 2:
            made[f"{kind.stem}_scatter"] = number(one.get(f"{kind.stem}_scatter"))
        if measured and d in fit.problem.speeds:
            made[f"{kind.stem}_at_fitted_speed{kind.suffix}"] = number(fit.fitted[d].get(kind.key))
        made[f"{kind.stem}_from_others{kind.suffix}"] = number(math.exp(others[k])) if others is not None and math.isfinite(others[k]) else None
    made |= {"curve_rmse_g": number(rmse(fit, drop.name)) if drop.curve else None, "max_local_strain": number(one.get("max_local_strain")),
             "energy_error": number(one.get("energy_error")), "grade": GRADES[one.grade], "verdict": one.verdict}
    return made | ({"failure": one.failure} if one.failure else {})


def summary(s: Study) -> dict[str, Any]:
    """Returns fit.json."""
    fit = s.fit
    unknown, n = fit.problem.model.unknown, len(fit.problem.model.unknown)
    slope = fit.problem.log_slope(fit.x)
    covariance = fit.covariance * np.outer(slope, slope)
    compressions, cushions = tests_of(s)
    made: dict[str, Any] = {"program": f"softfall fit {library.version()}", "input": str(s.given.path), "input_text": s.text, "model": fit.problem.model.label,
                            "converged": fit.converged, **({"reason": fit.reason} if fit.reason else {}), "on_bounds": fit.on_bounds,
                            "starts": [{"objective": number(objective), "ended": how} for objective, how in fit.starts],
                            "simulations": s.simulated, "simulations_kept": s.kept, "processor_s": round(s.seconds, 1), "expected_gain": number(fit.gain), "misfit": number(fit.misfit),
                            "degrees_of_freedom": number(fit.freedom), "sd_scale": number(fit.scale), "parameters": [], "accelerometer": chain_lines(s)}
    for k, u in enumerate(unknown):
        value, low, high = fit.interval(k)
        made["parameters"].append({"name": u.name, "value_SI": number(value), "low95_SI": number(low), "high95_SI": number(high), "prior_SI": number(u.start),
                                   "prior_sd_of_logarithm": u.sd, "sd_of_logarithm": number(math.sqrt(covariance[k, k]))})
    made["covariance_of_logarithms"] = [[number(v) for v in row[:n]] for row in covariance[:n]]
    made |= {"compressions": compressions, "cushions": cushions, "drops": [_drop(s, d) for d in range(len(s.given.drops))], "extrapolated": extrapolated(s)}
    return made | ({"inference": s.average.summary()} if s.average else {})


def curve_table(s: Study) -> str:
    """Returns fit-curve.csv."""
    return output_files.table([["strain", "stress_kPa", "low95_kPa", "high95_kPa", "width_left_of_prior"], *([f"{e:.3f}", *(f"{v:.6g}" for v in rest)] for e, *rest in s.curve)])


def drops_table(s: Study) -> str:
    """Returns fit-drops.csv: time after contact (ms), then the acceleration (g) of each drop at its given speed."""
    fit = s.fit
    curves = [one.shown() if not one.failure else np.full(len(GRID), math.nan) for one in fit.own]
    rows = [[f"{1e3 * t:.6g}", *("" if math.isnan(v) else f"{v:.6g}" for v in values)] for t, *values in zip(GRID, *curves)]
    return output_files.table([["time_ms", *(f"{drop.name}_g" for drop in s.given.drops)], *rows])


def write_material(s: Study, folder: Path) -> None:
    """Writes the material with its curve."""
    p = s.fit.problem
    p.model.form.foam(p.foam_values(s.fit.x), s.informed[1]).write(str(folder), s.given.name, s.given.title, provenance(s))


def write(s: Study, folder: Path) -> None:
    """Writes the material, the tables and fit.json."""
    output_files.write(folder / "fit-curve.csv", curve_table(s))
    if s.given.drops:
        output_files.write(folder / "fit-drops.csv", drops_table(s))
    write_material(s, folder)
    output_files.write(folder / "fit.json", json.dumps(summary(s), indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def write_posterior(s: Study, folder: Path) -> None:
    """Writes posterior.csv and the draws; those of an earlier fit go before, also where this one has none."""
    place = folder / "posterior"
    for path in [*place.glob("draw-*.cfg"), *place.glob("draw-*.csv")]:
        path.unlink()
    (folder / "posterior.csv").unlink(missing_ok=True)
    if s.average:
        place.mkdir(exist_ok=True)
        s.average.write_draws(str(place), output_files.write, lambda path: Path(path).read_text(encoding="utf-8"))
        output_files.write(folder / "posterior.csv", output_files.table(s.average.table()))
    elif place.is_dir() and not any(place.iterdir()):
        place.rmdir()
