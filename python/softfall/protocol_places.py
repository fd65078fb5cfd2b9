# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of the drops at a place of a protocol: figures over the height by drops of each draw of the foam, and the errors of the model."""
from __future__ import annotations

import math
from typing import Callable, Mapping, Sequence

import numpy as np

from . import cfh, cfh_draws
from .advice import LEAST_DRAWS, SAME, Place
from .array import Array
from .cfh import Point, Result, Search
from .cfh_command import Study
from .command import say
from .errors import InputError, NumericError

LOWEST, HIGHEST = 0.45, 2.0  # of the critical height: the heights that are looked at
ABOVE, GAP, STEP = 1.15, 0.4, 0.035  # highest drop of a draw over its critical height; greatest gap between its drops, and step of the grid, of ln(height)
UNCHECKED = 0.05  # error of ln(figure) between drops where it could not be checked
CHECKS = 5  # draws with one more drop in their widest gap, which tells the error of the interpolation


def place_of(name: str, study: Study | None, asked: Sequence[float] = (), missile: str = "", cost: float = 1.0) -> Place:
    """Simulates what the search of each draw lacks between the heights that are looked at, among them those `asked` for (m). InputError: there are no draws."""
    if study is None or study.spread is None:
        raise InputError(f"{name}: no draws of the foam, which advice needs: {study.no_interval if study else 'it was made without --posterior'}")
    draws, results, limits, middle, bench = study.spread.draws, study.spread.results, study.limits, study.middle, study.bench(say)
    low, high = min([LOWEST * middle, *asked]), max([HIGHEST * middle, *asked])
    materials = {draw.path: draw.path for draw in draws}

    def add(wanted: Mapping[str, Sequence[float]]) -> dict[str, list[Point]]:
        """Returns the drops of draws from heights, by the path of the draw."""
        searches = {path: Search(limits, heights[0], high, 1.0, heights=tuple(heights)) for path, heights in wanted.items() if heights}
        return {path: points for path, (points, _) in bench.run(searches, materials).items()}

    more = add({draw.path: _lacking(points, result, limits, low) for draw, points, result in zip(draws, study.draw_points, results)})
    points = [sorted([*old, *more.get(draw.path, [])], key=lambda p: p.height) for draw, old in zip(draws, study.draw_points)]
    known = [cfh.usable(one, limits)[0] for one in points]
    if sum(len(one) > 1 for one in known) < LEAST_DRAWS:
        raise NumericError(f"{name}: fewer than {LEAST_DRAWS} of {len(draws)} draws of the foam have two drops that can be used", 5)
    between, notes = _between(known, study, add)
    log_height = np.linspace(math.log(low), math.log(high), 1 + math.ceil(math.log(high / low) / STEP))
    value = np.array([_values(one, log_height) for one in known]).swapaxes(0, 1)  # [2][draws][grid]
    value = np.where(np.isnan(value), np.nanmean(value, axis=1, keepdims=True), value)
    bound = np.array([_bound(one, good, result, float(foam)) for one, good, result, foam in zip(points, known, results, study.spread.foam)])
    error = np.array([draw.response or (0.0,) * 4 for draw in draws]).T
    scatter, usable = np.empty((2, log_height.size)), [p for p in study.points if not p.failed]
    for c, key in enumerate(("a_max_scatter", "hic_scatter")):
        scatter[c] = np.interp(log_height, [math.log(p.height) for p in usable], [p.figures[key] for p in usable])
    mesh = cfh_draws.MESH_SIZE * np.nan_to_num(study.spread.mesh_error) * np.array([1.0, cfh_draws.MESH_HIC])
    notes += _doubts(study, bound, bool(np.isnan(scatter).any()))
    return Place(name, log_height, value, bound, error[:2], error[2:], np.maximum(np.nan_to_num(scatter), SAME), mesh, between, tuple(f"{name}: {note}" for note in notes), missile, cost,
                 max(p.height for p in usable))


def _lacking(points: Sequence[Point], result: Result, limits: Sequence[float], low: float) -> list[float]:
    """Returns the heights where drops of a draw are missing: from `low` to a bit above its critical height, if its drops can be used there."""
    good, _ = cfh.usable(points, limits)
    if not good:
        return []
    failed = min((p.height for p in points if p.failed and p.height > good[-1].height), default=math.inf)
    top = ABOVE * result.height if result.verdict == "found" else 0.0
    ends = [*[low] * (low < 0.95 * good[0].height), *(p.height for p in good), *[top] * (1.05 * good[-1].height < top < 0.98 * failed)]
    wanted = {end for end in ends if end in (low, top)}
    for below, above in zip(ends, ends[1:]):
        count = math.ceil(math.log(above / below) / GAP)
        wanted |= {below * (above / below) ** (k / count) for k in range(1, count)}
    return [float(f"{height:.4g}") for height in sorted(wanted)]


def _values(good: Sequence[Point], log_height: Array) -> Array:
    """Returns ln(figure) [2][grid] of a draw, beyond its drops by straight lines; NaN if there are fewer than two drops."""
    if len(good) < 2:
        return np.full((2, log_height.size), math.nan)
    x, made = np.log([p.height for p in good]), []
    first, last = (next((k for k in order if abs(x[k] - x[end]) > cfh.APART), far) for order, end, far in ((range(1, x.size), 0, -1), (range(x.size - 2, -1, -1), -1, 0)))
    for c in range(2):
        y = np.log([p.value[c] for p in good])
        below, above = ((y[k] - y[end]) / (x[k] - x[end]) for k, end in ((first, 0), (last, -1)))
        inside = cfh.curve(good, c)(np.clip(log_height, x[0], x[-1]))
        made.append(inside + below * np.minimum(0, log_height - x[0]) + above * np.maximum(0, log_height - x[-1]))
    return np.array(made)


def _bound(points: Sequence[Point], good: Sequence[Point], result: Result, foam: float) -> float:
    """Returns the height (m) above which a draw counts as beyond the limits, as no drop of it can be used there; inf: there is none."""
    if result.verdict != "found":
        return foam
    return good[-1].height if any(p.height > good[-1].height for p in points) else math.inf


def _between(known: list[list[Point]], study: Study, add: Callable[[Mapping[str, Sequence[float]]], dict[str, list[Point]]]) -> tuple[Array, list[str]]:
    """Simulates some draws where their drops are farthest apart; returns the rms error of ln(figure) [2] between drops, and notes. The drops are added to the known ones."""
    assert study.spread
    order = [int(k) for k in np.argsort(study.spread.foam, kind="stable") if len(known[k]) > 1]
    wanted = dict[int, float]()
    for k in {order[int(place)] for place in np.linspace(0, len(order) - 1, CHECKS)}:
        heights = [p.height for p in known[k]]
        widest = int(np.argmax(np.diff(np.log(heights))))
        wanted[k] = float(f"{math.sqrt(heights[widest] * heights[widest + 1]):.4g}")
    draws = study.spread.draws
    made, errors = add({draws[k].path: [height] for k, height in wanted.items()}), []
    for k, height in wanted.items():
        point, = made[draws[k].path]
        if not point.failed:
            errors.append(np.log(point.value) - _values(known[k], np.array([math.log(height)]))[:, 0])
            known[k] = sorted([*known[k], point], key=lambda p: p.height)
    if not errors:
        return np.full(2, UNCHECKED), [f"no drop between those of a draw can be used: {100 * UNCHECKED:g} % is taken for the error of the interpolation"]
    return np.asarray(np.sqrt(np.mean(np.square(errors), axis=0))), []


def _doubts(study: Study, bound: Array, no_scatter: bool) -> list[str]:
    """Returns what is not known of a place, in sentences."""
    assert study.spread
    below, said = int((bound < np.inf).sum()), []
    if below:
        said.append(f"{below} of {bound.size} draws have no drop that can be used above some height: there they count as beyond the limits")
    if math.isnan(study.spread.mesh_error):
        said.append("the error of the mesh is not known, and is left out")
    if study.spread.draws[0].response is None:
        said.append("the draws state no errors of the responses, which are left out")
    if no_scatter:
        said.append(f"the scatter from drop to drop is not known; {100 * SAME:g} % is taken")
    return said
