# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of a protocol's page, as SVG: curves of the drops, and figures over the height."""
from __future__ import annotations

import io
import math
from typing import Any, Mapping

import numpy as np
from scipy.interpolate import PchipInterpolator

from .cfh import FIGURES
from .protocol import Figure, Protocol
from .protocol_drops import Drop, Drops, Search, figures_of

MOST_PANELS, MOST_PLACES = 12, 6


def _plots(rows: int, columns: int, height: float, share: bool = False) -> Any:
    """Returns a figure of matplotlib and its axes [rows][columns], which may share their scales."""
    import matplotlib
    matplotlib.use("agg")
    import matplotlib.pyplot as plt
    matplotlib.rcParams["text.parse_math"] = False  # a name with $ is no formula
    return plt.subplots(rows, columns, figsize=(8, height), layout="constrained", squeeze=False, sharex=share, sharey=share)


def _svg(figure: Any) -> str:
    """Returns a figure as an element of the page; the same one has the same bytes."""
    import matplotlib.pyplot as plt
    text = io.StringIO()
    with plt.rc_context({"svg.hashsalt": "softfall"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    plt.close(figure)
    return "<figure>" + text.getvalue()[text.getvalue().index("<svg"):] + "</figure>"


def _by_height(drops: list[Drop]) -> dict[float, list[Drop]]:
    heights: dict[float, list[Drop]] = {}
    for drop in drops:
        heights.setdefault(drop.spot.height, []).append(drop)
    return dict(sorted(heights.items()))


# ---- curves ----

def curve_picture(parts: Mapping[str, Drops]) -> str:
    """Returns the filtered curves: a panel for each spot with simulated ones dashed, and one for all other drops of a search."""
    spots: dict[str, list[tuple[str, Drop, str]]] = {}
    measured = {drop.spot for drop in parts.get("measured", Drops()).drops}
    for what, drops in parts.items():
        searched = {id(drop) for one in drops.searches for drop in one.drops}
        for drop in drops.all:
            together = id(drop) in searched and drop.spot not in measured
            name = f"{drop.spot.condition}, {drop.spot.position}, the search" if together else str(drop.spot)
            if drop.curve is not None and (name in spots or len(spots) < MOST_PANELS):
                spots.setdefault(name, []).append((what, drop, f"{drop.spot.height:g} m" if together else f"{what}, drop {drop.number}"))
    if not spots:
        return ""
    rows = math.ceil(len(spots) / 2)
    figure, axes = _plots(rows, min(2, len(spots)), 0.6 + 2.4 * rows, share=True)
    for ax in axes.flat[len(spots):]:
        ax.set_visible(False)
    for ax, (name, shown) in zip(axes.flat, spots.items()):
        for what, drop, label in shown:
            time, value = (np.asarray(part, float) for part in drop.curve)  # type: ignore[union-attr]
            contact = time[int(np.argmax(value > 0.05 * value.max()))]
            ax.plot(1e3 * (time - contact), value, "--" if what == "simulated" and len(parts) > 1 else "-", lw=1.1, label=label)
        ax.set_title(name, fontsize=9)
        ax.set(xlabel="time from 5 % of the peak (ms)", ylabel="deceleration (g)")
        ax.legend(fontsize=7)
    return "<h2>Curves</h2>" + _svg(figure)


# ---- figures over the height ----

def height_picture(p: Protocol, parts: Mapping[str, Drops]) -> str:
    """Returns each limited figure over the height: the curve of the search with its drops, and the measured drops beside; "" of other protocols."""
    figures = [figure for figure in p.figures if figure.limit is not None] if p.kind == "critical height" else []
    places = list(dict.fromkeys((drop.spot.condition, drop.spot.position) for drops in parts.values() for drop in drops.all if not drop.spot.missile))
    if not figures or not places:
        return ""
    chart, axes = _plots(1, len(figures), 3.6)
    one = len({condition for condition, _ in places}) == 1
    for ax, figure in zip(axes[0], figures):
        for k, place in enumerate(places[:MOST_PLACES]):
            _draw_place(ax, p, figure, place, parts, f"C{k}", (place[1] if one else ", ".join(place)) + ", " if len(places) > 1 else "")
        ax.axhline(figure.limit, color="0.4", lw=1, ls=":")
        ax.annotate(f"limit {figure.limit:g}", (0.02, figure.limit), xycoords=("axes fraction", "data"), fontsize=7, va="bottom")
        values = [drop.figures[figure.label] for drops in parts.values() for drop in drops.all if figure.label in drop.figures]
        ax.set(xlabel="height of free fall (m)", ylabel=figure.label, ylim=(0, 1.15 * max([figure.limit or 0.0, *values])))  # draws may be far higher
    axes[0, -1].legend(fontsize=7)
    told = ["Filled: measured drops, hollow: simulated ones. Full lines join the measured means of the drops that count; dashed lines lead through the simulated drops."]
    told += ["Thin lines join the drops of each draw of the foam."] if any(one.study and one.study.draw_points for drops in parts.values() for one in drops.searches) else []
    told += [f"The first {MOST_PLACES} of {len(places)} places."] if len(places) > MOST_PLACES else []
    return "<h2>Figures over the height</h2>" + _svg(chart) + f'<p class="note">{" ".join(told)}</p>'


def _draw_place(ax: Any, p: Protocol, figure: Figure, place: tuple[str, str], parts: Mapping[str, Drops], colour: str, prefix: str) -> None:
    """Draws a place: measured drops filled, and the mean of those that count; simulated ones hollow, with their curve."""
    for what, drops in parts.items():
        here = [drop for drop in drops.all if (drop.spot.condition, drop.spot.position) == place and not drop.spot.missile and drop.is_usable
                and figure.label in drop.figures]
        if not here:
            continue
        filled = what == "measured"
        ax.plot([d.spot.height for d in here], [d.figures[figure.label] for d in here], "o" if filled else "s", color=colour, ms=4, mfc=colour if filled else "none",
                label=f"{prefix}{what}")
        search = next((one for one in drops.searches if (one.condition, one.position) == place), None)
        if search:
            _draw_search(ax, figure, search, colour)
            continue
        spots = _by_height(here)
        ax.plot(list(spots), [figures_of(group, figure.label, p.counted if len(group) == p.count else (group[0].number,)) for group in spots.values()],
                "-" if filled else "--", color=colour, lw=1)


def _draw_search(ax: Any, figure: Figure, search: Search, colour: str) -> None:
    """Draws a curve through the drops of a search, and thin lines through those of the draws if there are any."""
    usable = [(point["height_m"], point[figure.key]) for point in search.summary["points"] if point[figure.key]]
    if len(usable) > 1:
        x, y = np.log(np.array(usable).T)
        h = np.linspace(x[0], x[-1], 100)
        ax.plot(np.exp(h), [figure.of(float(value)) for value in np.exp(PchipInterpolator(x, y)(h))], "--", color=colour, lw=1.2)
    for points in search.study.draw_points if search.study else ():
        drops = [p for p in points if not p.failed]
        ax.plot([p.height for p in drops], [figure.of(p.value[FIGURES.index(figure.key)]) for p in drops], "-", color=colour, alpha=0.3, lw=0.4)
