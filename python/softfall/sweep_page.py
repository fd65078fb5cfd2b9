# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a sweep: the answer first, pictures, and the table of runs with pass and fail."""
from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Callable

import matplotlib
import numpy as np

from . import effects, output as output_files
from .campaign import ANVIL, REFINED, Table
from .effects import Statements
from .library import GRADES
from .plan import Limit, Plan
from .template import base64_of, png, render

matplotlib.use("agg")
matplotlib.rcParams.update({"font.size": 8, "axes.titlesize": 9})
LISTED, CELLS_SHOWN, POINTS = 500, 200, 3000
NAMES = {"a_max_g": "a_max (g)", "hic": "HIC", "max_indentation_mm": "largest indentation (mm)", "v_rebound_m_s": "rebound speed (m/s)", "hic15": "HIC15", "hic36": "HIC36",
         "gadd": "Gadd index"}
GOOD, BAD, PLAIN = "#2e7d32", "#c62828", "#1f4e79"

THICKNESS = "geometry.parameters.thickness"  # of the pad


def name_of(figure: str) -> str:
    """Returns a figure as axes and tables have it."""
    return NAMES.get(figure, figure)


def verdict(table: Table, k: int) -> str:
    """Returns "pass", "fail", or "?" for a run that tells neither."""
    row = table.rows[k]
    if row.state == "failed" and ANVIL in row.message:
        return "fail"
    limits = [limit for limit in table.plan.figures if not math.isnan(limit.limit)]
    values = [row.value(limit.figure) for limit in limits]
    if any(value >= limit.limit for value, limit in zip(values, limits)):
        return "fail"
    return "pass" if limits and all(map(math.isfinite, values)) else "?"


def limits_text(plan: Plan) -> str:
    """Returns the limits in words.

    >>> class P: figures = [Limit("hic", 1000.0), Limit("gadd", math.nan)]
    >>> limits_text(P)
    'HIC < 1000'
    """
    return " and ".join(f"{name_of(limit.figure).removesuffix(' (g)')} < {limit.limit:g}{' g' if limit.figure.endswith('_g') else ''}" for limit in plan.figures
                        if not math.isnan(limit.limit))


def _one(plan: Plan, k: int, value: float) -> str:
    factor = plan.factors[k]
    return f"{factor.text(value)} {factor.unit or (plan.length_unit if factor.key == THICKNESS else '')}".strip()


def answer(table: Table) -> str:
    """Returns the answer in a sentence: the thinnest pad below the limits, the highest speed, or how many runs stay below."""
    plan, limits = table.plan, limits_text(table.plan)
    states = [verdict(table, k) for k in range(plan.rows)]
    passed, unknown = states.count("pass"), states.count("?")
    if not limits:
        return f"{sum(row.is_usable for row in table.rows)} of {plan.rows} runs can be used; the plan has no limit"
    count = f"{passed} of {plan.rows} runs stay below {limits}" + (f"; of {unknown} this is not known" if unknown else "")
    numbers = [k for k in effects.numbers(plan) if not plan.factors[k].uncertain and plan.block_of[k].kind != "sample"]
    thick = next((k for k in numbers if plan.factors[k].key == THICKNESS), None)
    fast = next((k for k in numbers if plan.factors[k].key in ("missile.velocity", "missile.mass", "missile.height")), None)
    rest = len(numbers) - (thick is not None) - (fast is not None)
    words = [k for k, f in enumerate(plan.factors) if f.words and not f.uncertain]
    together = thick is not None and fast is not None and plan.block_of[thick] is plan.block_of[fast]  # no pad meets all speeds
    if rest or words or together or (thick is None and fast is None):
        return count
    draws = " in every run" if any(f.uncertain for f in plan.factors) else ""
    good = np.array([state == "pass" for state in states])
    if fast is None:
        assert thick is not None
        column = plan.column(thick)
        fit = [value for value in np.unique(column) if good[column >= value].all()]
        return f"thinnest pad below {limits}{draws}: {_one(plan, thick, fit[0])}" if fit else f"no pad of the plan stays below {limits}{draws}; {count}"
    speeds = plan.column(fast)
    best: tuple[float, float] | None = None
    for pad in [math.nan] if thick is None else np.unique(plan.column(thick)).tolist():
        of_pad = np.ones(plan.rows, dtype=bool) if thick is None else plan.column(thick) == pad
        fine = [speed for speed in np.unique(speeds[of_pad]) if bool(good[of_pad & (speeds <= speed)].all())]
        if fine and (best is None or fine[-1] > best[1]):
            best = (float(pad), float(fine[-1]))
    if best is None:
        return f"nothing of the plan stays below {limits}{draws}; {count}"
    if thick is None:
        return f"below {limits}{draws} up to {_one(plan, fast, best[1])}"
    return f"thinnest pad below {limits}{draws} up to {_one(plan, fast, best[1])}: {_one(plan, thick, best[0])}"


# ---- pictures

def _axes(width: float = 6.4, height: float = 3.8, columns: int = 1) -> Any:
    from matplotlib.figure import Figure
    figure = Figure(figsize=(width, height), dpi=150, layout="constrained")
    return figure, figure.subplots(1, columns, squeeze=False)[0]


def _factors(table: Table, _: list[Statements]) -> Any:
    """Each figure over the first factors that are numbers."""
    plan = table.plan
    own = effects.numbers(plan)[:3]
    if not own:
        return None
    from matplotlib.figure import Figure
    shown = plan.figures[:3]
    figure = Figure(figsize=(2.6 * len(own) + 0.8, 2.3 * len(shown)), dpi=150, layout="constrained")
    axes = figure.subplots(len(shown), len(own), squeeze=False)
    pick = np.sort(np.random.default_rng(1).choice(plan.rows, POINTS, replace=False)) if plan.rows > POINTS else np.arange(plan.rows)
    for i, limit in enumerate(shown):
        y = table.values(limit.figure)[pick]
        for j, k in enumerate(own):
            ax = axes[i][j]
            colour = np.where(y < limit.limit, GOOD, BAD) if not math.isnan(limit.limit) else PLAIN
            ax.scatter(plan.column(k)[pick], y, s=12, c=colour, linewidths=0)
            if not math.isnan(limit.limit):
                ax.axhline(limit.limit, color="0.4", lw=0.8, ls="--")
            ax.set(xlabel=plan.factors[k].heading if i == len(shown) - 1 else "", ylabel=name_of(limit.figure) if j == 0 else "")
    return figure


def _tornado(table: Table, said: list[Statements]) -> Any:
    """Main effects: bars from the least to the greatest mean."""
    plan = table.plan
    figure, axes = _axes(3.2 * len(said) + 1.0, 0.42 * len(plan.factors) + 1.2, len(said))
    drawn = False
    for ax, limit, s in zip(axes, plan.figures, said):
        width = [float(np.nan_to_num(e.high - e.low)) for e in s.effects]
        order = sorted(range(len(plan.factors)), key=width.__getitem__)
        for place, k in enumerate(order):
            e = s.effects[k]
            if math.isfinite(e.low):
                ax.barh(place, e.high - e.low, left=e.low, height=0.6, color=PLAIN)
                drawn = True
        ax.set(yticks=range(len(order)), yticklabels=[plan.factors[k].name for k in order], xlabel=f"mean of {name_of(limit.figure)}")
        ax.locator_params(axis="x", nbins=5)
    return figure if drawn else None


def _indices(table: Table, said: list[Statements]) -> Any:
    """Sobol' indices with their intervals."""
    plan = table.plan
    if not any(s.indices and math.isfinite(s.indices[0].first) for s in said):
        return None
    figure, axes = _axes(3.2 * len(said) + 1.0, 0.5 * len(plan.factors) + 1.4, len(said))
    for ax, limit, s in zip(axes, plan.figures, said):
        for place, index in enumerate(s.indices):
            for shift, value, low, high, colour in ((0.15, index.first, index.first_low, index.first_high, PLAIN), (-0.15, index.total, index.total_low, index.total_high, "#e09a00")):
                ax.errorbar(value, place + shift, xerr=[[max(0, value - low)], [max(0, high - value)]], fmt="o", ms=4, color=colour, capsize=2)
        ax.set(yticks=range(len(plan.factors)), yticklabels=[f.name for f in plan.factors], xlabel=f"share of the variance of {name_of(limit.figure)}", ylim=(-0.6, len(plan.factors) - 0.4))
    axes[0].plot([], [], "o", ms=4, color=PLAIN, label="alone")
    axes[0].plot([], [], "o", ms=4, color="#e09a00", label="with interactions")
    axes[0].legend(fontsize=7)
    return figure


def _surface(table: Table, said: list[Statements]) -> Any:
    """Runs against the surface without them."""
    pairs = [(limit, s.surface) for limit, s in zip(table.plan.figures, said) if s.surface.names and not s.surface.problem]
    if not pairs:
        return None
    figure, axes = _axes(3.2 * len(pairs), 3.2, len(pairs))
    for ax, (limit, s) in zip(axes, pairs):
        ends = [float(np.nanmin([s.simulated, s.left_out])), float(np.nanmax([s.simulated, s.left_out]))]
        ax.plot(ends, ends, color="0.6", lw=0.8)
        ax.plot(s.simulated, s.left_out, ".", ms=4, color=PLAIN)
        ax.set(xlabel=f"{name_of(limit.figure)}, simulated", ylabel="response surface without the run", title=f"Q² = {s.q2:.3f}")
    return figure


def _probability(table: Table, said: list[Statements]) -> Any:
    """A map over two chosen blocks, or intervals over one."""
    plan = table.plan
    own = [(limit, s.chances) for limit, s in zip(plan.figures, said) if s.chances]
    chosen = [block for block in plan.blocks if plan.is_chosen(block) and block.rows > 1]
    if not own or not 1 <= len(chosen) <= 2 or len(own[0][1]) > 400:
        return None
    figure, axes = _axes(3.6 * len(own), 3.4, len(own))
    labels = [[_short(plan.factors[block.first].text(float(value))) for value in plan.factors[block.first].values] for block in chosen]
    headings = [plan.factors[block.first].heading for block in chosen]
    for ax, (limit, found) in zip(axes, own):
        title = f"P({limits_text_of(limit)})"
        share = np.array([chance.share for chance in found])
        if len(chosen) == 1:
            low, high = (np.array([getattr(chance, end) for chance in found]) for end in ("low", "high"))
            ax.errorbar(range(len(found)), share, yerr=[np.maximum(0, share - low), np.maximum(0, high - share)], fmt="o", color=PLAIN, capsize=3)
            ax.set(xticks=range(len(found)), xticklabels=labels[0], xlabel=headings[0], ylabel=title, ylim=(-0.05, 1.05))
            continue
        grid = share.reshape(chosen[0].rows, chosen[1].rows)
        ax.imshow(grid, vmin=0, vmax=1, cmap="RdYlGn", origin="lower", aspect="auto", alpha=0.8)
        for k, chance in enumerate(found):
            if grid.shape[1] <= 12:
                ax.text(k % grid.shape[1], k // grid.shape[1], f"{chance.share:.2f}{'?' if chance.unknown else ''}", ha="center", va="center", fontsize=7)
        ax.set(xticks=range(grid.shape[1]), xticklabels=labels[1], yticks=range(grid.shape[0]), yticklabels=labels[0], xlabel=headings[1], ylabel=headings[0], title=title)
    for ax in axes:
        if max(map(len, labels[-1])) > 6 or len(labels[-1]) > 8:
            ax.tick_params(axis="x", labelrotation=60, labelsize=7)
    return figure


def limits_text_of(limit: Limit) -> str:
    return f"{name_of(limit.figure).removesuffix(' (g)')} < {limit.limit:g}{' g' if limit.figure.endswith('_g') else ''}"


PICTURES: dict[str, tuple[Callable[[Table, list[Statements]], Any], str]] = {
    "probability": (_probability, "Probability of staying below the limit, with its 95 % interval; ?: runs that failed or are not to be used are among them, and are taken as above."),
    "factors": (_factors, "All runs that can be used, over the factors; the dashed line is the limit."),
    "effects": (_tornado, "Main effects: how far the mean moves between the values of one factor, all else equal."),
    "indices": (_indices, "Sobol' indices with 95 % intervals: the share of the variance that a factor explains alone, and with its interactions."),
    "surface": (_surface, "The response surface at runs that were left out of its fit."),
}


def write(table: Table, said: list[Statements], folder: Path, facts: dict[str, Any]) -> None:
    """Writes the pictures and report.html into the folder."""
    pictures = []
    for name, (draw, caption) in PICTURES.items():
        drawn = draw(table, said)
        path = folder / f"{name}.png"
        if drawn is None:
            path.unlink(missing_ok=True)
            continue
        image = png(drawn)
        output_files.write(path, image)
        pictures.append({"name": name, "caption": caption, "data": base64_of(image)})
    output_files.write(folder / "report.html", page(table, said, pictures, facts))


def page(table: Table, said: list[Statements], pictures: list[dict[str, str]], facts: dict[str, Any]) -> str:
    """Returns report.html."""
    plan = table.plan
    shown = list(range(min(plan.rows, LISTED)))
    runs = [{"id": k + 1, "factors": [_short(plan.factors[f].text(plan.value(f, k))) for f in range(len(plan.factors))], "verdict": verdict(table, k),
             "figures": [f"{row.judged.figures[limit.figure]:.4g}" if row.judged and math.isfinite(row.judged.figures[limit.figure]) else "–" for limit in plan.figures],
             "grade": GRADES[row.judged.grade] if row.judged else row.state, "message": row.message} for k, row in ((k, table.rows[k]) for k in shown)]
    states = [verdict(table, k) for k in range(plan.rows)]
    chosen = [k for k in range(len(plan.factors)) if plan.is_chosen(plan.block_of[k])]
    limited = [(limit, s.chances) for limit, s in zip(plan.figures, said) if s.chances]
    chances = [{"factors": [_short(plan.factors[k].text(plan.value(k, limited[0][1][c].row))) for k in chosen],
                "cells": [found[c] for _, found in limited]} for c in range(min(len(limited[0][1]), CELLS_SHOWN) if limited else 0)]
    refined = [{"id": k + 1, "cells": [f"{value:.4g} ± {error:.2g}" if math.isfinite(value) else "–" for value, error in table.refined(k)[0]], "note": table.refined(k)[1]}
               for k in shown] if table.coarse else []
    return render(
        "sweep.html", plan=plan, answer=answer(table), limits=limits_text(plan), passed=states.count("pass"),
        failed=states.count("fail"), unknown=states.count("?"), facts=facts, pictures=pictures, runs=runs, name_of=name_of, chosen=[plan.factors[k].heading for k in chosen],
        chances=chances, limited=[limits_text_of(limit) for limit, _ in limited], refined=refined, refined_names=[name_of(key) for key in REFINED],
        factors=[(f.name, f.key, plan.describe(k), "uncertain" if f.uncertain else "chosen") for k, f in enumerate(plan.factors)],
        said=list(zip(plan.figures, said)), isfinite=math.isfinite)


def _short(text: str) -> str:
    """Returns a path as its name."""
    return text.rsplit("/", 1)[-1]
