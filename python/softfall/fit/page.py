# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a fit: how the foam meets what was measured, its parameters and its curve, predictions with their intervals."""
from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from .. import library, output as output_files
from ..library import GRADES
from ..sweep_page import PLAIN
from ..template import base64_of, png, render
from .drops import GRID
from .files import Study, chain_lines, extrapolated, tests_of
from .input import KINDS


def percent(value: float, digits: int = 1, sign: bool = True) -> str:
    """Returns a share in percent, "–" where it is not defined.

    >>> percent(0.0123)
    '+1.2 %'
    """
    return f"{100 * value:{'+' if sign else ''}.{digits}f} %" if math.isfinite(value) else "–"


def text(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "–"


def end(s: Study) -> str:
    """Returns how the search ended, in a sentence."""
    fit = s.fit
    told = f"misfit {fit.misfit:.2f} with {fit.freedom:.1f} degrees of freedom"
    told += f", more than the stated standard deviations allow: the intervals are widened by {fit.scale:.2f}" if fit.scale > 1 else ""
    told += f"; {fit.reason}" if fit.reason else ""
    told += "".join(f"; {one}, where its interval means nothing" for one in fit.on_bounds)
    objectives = [objective for objective, _ in fit.starts if math.isfinite(objective)]
    apart = sum(objective > min(objectives) + 0.5 for objective in objectives)
    told += f"; {apart} of {len(fit.starts)} starts ended elsewhere, with a larger objective" if apart else ""
    return told


def _picture(s: Study) -> bytes:
    from matplotlib.figure import Figure
    figure = Figure(figsize=(9, 7 if s.given.drops else 3.6), dpi=150, layout="constrained")
    top = figure.subplots(2 if s.given.drops else 1, 2, squeeze=False)
    curve = np.array(s.curve)
    ax = top[0][0]
    ax.fill_between(curve[:, 0], curve[:, 2], curve[:, 3], color="#c6dbef", lw=0, label="95 %, linearised")
    ax.plot(curve[:, 0], curve[:, 1], color=PLAIN, label="loading curve")
    for e in s.informed:
        ax.axvline(e, color="0.5", lw=0.7, ls=":")
    ax.set(xlabel="engineering strain", ylabel="nominal stress (kPa)", yscale="log")
    ax.legend(fontsize=7)
    ax = top[0][1]
    ax.bar(curve[:, 0], 100 * curve[:, 4], width=0.045, color="#fd8d3c")
    ax.set(xlabel="engineering strain", ylabel="width left of the prior (%)", ylim=(0, 105))
    if s.given.drops:
        grid = top[1][0].get_gridspec()
        for one in top[1]:
            one.remove()
        ax = figure.add_subplot(grid[1, :])
        for k, (drop, one) in enumerate(zip(s.given.drops, s.fit.own)):
            if one.failure:
                continue
            ax.plot(1e3 * np.array(GRID), one.shown(), color=f"C{k}", ls="--" if drop.predicted else "-", label=f"{drop.name}{' (predicted)' if drop.predicted else ''}")
            if drop.curve:
                ax.plot(1e3 * drop.curve.time, drop.curve.value, ".", ms=2.5, color=f"C{k}")
            elif "a_max_g" in drop.value:
                ax.plot(1e3 * GRID[int(np.argmax(one.shown()))], drop.value["a_max_g"], "o", mfc="none", color=f"C{k}")
        ax.set(xlabel="time after contact (ms)", ylabel="acceleration (g)")
        ax.set_xlim(left=0)
        ax.legend(fontsize=7)
        ax.set_title("lines: simulated; circles: measured peaks", fontsize=8)
    return png(figure)


def _drops(s: Study) -> tuple[list[list[str]], list[list[str]]]:
    """Returns rows of measured drops and of predicted ones."""
    fit, measured, predicted = s.fit, [], []
    for d, drop in enumerate(s.given.drops):
        sd, others = fit.response_sd(d), fit.without(d) if not drop.predicted else None
        one = fit.own[d] if drop.predicted or not fit.own[d].failure else fit.fitted[d]
        for k, kind in enumerate(KINDS):
            if not kind.always and kind.key not in drop.value:
                continue
            value = math.nan if one.failure else one.get(kind.key)
            if drop.predicted:
                scatter = one.get(f"{kind.stem}_scatter") if k < 2 else 0.0
                width = math.hypot(fit.half_width * sd[k], 1.96 * (scatter if math.isfinite(scatter) else 0.0))
                predicted.append([drop.name, kind.heading, text(value, kind.digits), f"{text(value * math.exp(-width), kind.digits)} to {text(value * math.exp(width), kind.digits)}",
                                  text(one.get("max_local_strain"), 3), one.failure or GRADES[one.grade]])
            else:
                m = drop.value.get(kind.key, math.nan)
                measured.append([drop.name, kind.heading, text(m, kind.digits), percent(drop.sd.get(kind.key, math.nan), sign=False), text(value, kind.digits), percent(value / m - 1),
                                 percent(math.exp(others[k]) / m - 1) if others is not None else "–"])
    return measured, predicted


def context(s: Study) -> dict[str, Any]:
    """Returns what the page shows."""
    fit = s.fit
    unknown, form = fit.problem.model.unknown, fit.problem.model.form
    measured, predicted = _drops(s)
    parameters = []
    for k, u in enumerate(unknown):
        about = form.parameters[form.index[u.name]]
        value, low, high = (f"{v / about.per_unit:.4g}" for v in fit.interval(k))
        parameters.append([u.name + (f" ({about.unit})" if about.unit else ""), value, f"± {100 * fit.sd_of_log()[k]:.1f} %", f"{low} to {high}", f"{u.start / about.per_unit:.4g}",
                           f"{100 * fit.sd_of_log()[k] / u.sd:.0f} %", about.description])
    spread = np.sqrt(np.diag(fit.covariance))
    correlation = fit.covariance / np.outer(spread, spread)
    speeds = []
    for d in fit.problem.speeds:
        drop, k = s.given.measured[d], fit.problem.names.index(f"speed of {s.given.measured[d].name}")
        width = fit.half_width * spread[k]
        speeds.append([drop.name, f"{drop.speed:.4g}", percent(drop.speed_sd, 2, False), percent(math.expm1(fit.x[k]), 2), f"{percent(math.expm1(fit.x[k] - width), 2)} to {percent(math.expm1(fit.x[k] + width), 2)}",
                       text(fit.fitted[d].get("a_max_g"), 2), text(fit.fitted[d].get("HIC"), 1)])
    compressions, cushions = tests_of(s)
    tests = [[one["name"], f"{one['rate_1_s']:.3g}" + (", below rate_reference" if one["below_rate_reference"] else ""), percent(one["loading_rms"], sign=False),
              percent(one["unloading_rms"], sign=False) if one["unloading_rms"] is not None else "–"] for one in compressions]
    blocks = [[one["name"], f"{one['static_stress_Pa'] / 1e3:.4g}", f"{one['peak_measured_g']:.1f}", f"{one['peak_g']:.1f}", percent(one["peak_g"] / one["peak_measured_g"] - 1)] for one in cushions]
    rows = [[drop.name, kind.heading, *(percent(v, 3).removesuffix(" %") for v in row[:len(unknown)])]
            for d, drop in enumerate(s.given.drops) if d in fit.slope for kind, row in zip(KINDS, fit.slope[d]) if kind.always]
    return {"kind": "bad" if not fit.converged else "fair" if fit.scale > 1 or fit.on_bounds else "good", "state": "converged" if fit.converged else "not converged", "end": end(s),
            "informed": s.informed, "extrapolated": extrapolated(s), "measured": measured, "predicted": predicted, "parameters": parameters, "names": [u.name for u in unknown],
            "correlation": [[u.name, *(f"{v:+.2f}" for v in row[:len(unknown)])] for u, row in zip(unknown, correlation)], "sensitivities": rows, "speeds": speeds, "tests": tests,
            "blocks": blocks, "chain": chain_lines(s), "formula": form.formula, "average": s.average.page() if s.average else None,
            "failed": [[m.label, why] for m, why in zip(s.given.models, s.failures) if why], "model": fit.problem.model.label}


def write(s: Study, folder: Path) -> None:
    """Writes fit.png and report.html into the folder."""
    image = _picture(s)
    output_files.write(folder / "fit.png", image)
    output_files.write(folder / "report.html", render(
        "fit.html", title=f"Identification from drops: {s.given.name}", picture=base64_of(image),
        program=f"softfall fit {library.version()}", input=str(s.given.path), simulated=s.simulated, kept=s.kept, seconds=s.seconds, **context(s)))


