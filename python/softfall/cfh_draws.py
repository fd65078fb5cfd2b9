# SPDX-License-Identifier: GPL-3.0-or-later
"""How sure a critical fall height is: the heights of draws of the foam, each by drops of its own, with the other errors that are known (docs/cfh.md)."""
from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np

from . import library, memory
from .array import Array
from .case import Case
from .cfh import CRITERIA, Point, Result, evaluate
from .curves import STANDARD_GRAVITY
from .errors import InputError

LEAST_DRAWS, MOST_DRAWS, REPEATS, SEED, TAIL = 100, 2000, 64, 1, 0.025
MESH_SIZE, MESH_HIC = 0.78, 1.3  # rms of the mesh error of a_max over the expected one, and that of HIC over that of a_max (docs/cfh.md)
PARTS = ("foam", "foam_response", "foam_response_mesh", "single_drop")  # the third is the whole interval
SOURCES = {"curve": "the curve", "densification.limit": "the pole", "rate_filter_time": "rate_filter_time", "rate_factor": "the rate factor", "HU": "unloading"}
RESPONSES = ("a_max", "HIC", "a_max_sd", "HIC_sd")


class Draw(NamedTuple):
    """A draw of the foam: its file, its values, the errors of its responses, the form of its curve ("": not stated), and whether the accelerometer's mount differs among the draws."""

    path: str
    values: dict[str, str]
    response: tuple[float, ...] | None
    form: str
    mount: bool = False  # it was an unknown of the fit, and its effect is in the response


def _flat(settings: Sequence[Mapping[str, Any]], before: str = "") -> dict[str, str]:
    found: dict[str, str] = {}
    for one in settings:
        name = before + str(one["name"])
        found.update(_flat(one["value"], f"{name}.") if one["kind"] == "group" else {name: str(one["value"])})
    return found


def _forms(folder: Path) -> dict[int, str]:
    """Returns the form of each draw of the fit, from the posterior.csv of softfall fit beside the folder of draws."""
    path = folder.parent / "posterior.csv"
    if not path.exists():
        return {}
    with open(path, newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    names = {name.removesuffix("_1"): name for name in (rows[0] if rows else {})}
    return {int(row[names["draw"]]): row[names["model"]] for row in rows} if {"draw", "model"} <= set(names) else {}


def read(folder: Path, case: Case, sets: Mapping[str, str]) -> list[Draw]:
    """Reads draw-001.cfg, draw-002.cfg, ... InputError: a gap, too few, another law or density than the case has, all the same, errors that only some state."""
    where = f"--posterior {folder}"
    same = next((key for key in sets if key == "material" or key.startswith("material.")), None)
    if same:
        raise InputError(f"--set {same}={sets[same]}: with --posterior the draws are the material, and this would be the same in every one of them")
    numbers = sorted(int(found[1]) for path in folder.glob("draw-*.cfg") if (found := re.fullmatch(r"draw-(\d{3,})\.cfg", path.name)))
    if not numbers or numbers[0] != 1:
        raise InputError(f"{where}: there is no draw-001.cfg")
    gap = next((k for k, number in enumerate(numbers, 1) if number != k), None)
    if gap:
        raise InputError(f"{where}: draw-{numbers[gap - 1]:03d}.cfg is there, but draw-{gap:03d}.cfg is not")
    if not LEAST_DRAWS <= len(numbers) <= MOST_DRAWS:
        raise InputError(f"{where}: {len(numbers)} draws; an interval needs {LEAST_DRAWS} to {MOST_DRAWS}")
    forms, draws = _forms(folder), list[Draw]()
    for number in numbers:
        path = folder / f"draw-{number:03d}.cfg"
        values = _flat(memory.settings(str(path))["value"])
        head = path.read_text(encoding="utf-8", errors="replace")[:1000]
        said, form = re.search(r"Draw (\d+) of", head), re.search(r"^# Form of the curve: (.*)\.$", head, re.MULTILINE)
        response = tuple(float(values.get(f"response_error.{key}", "nan")) for key in RESPONSES)
        own = case["material.law"] or "low_density_foam"
        law, density = values.get("law", "low_density_foam"), values.get("density", "")
        if law != own:
            raise InputError(f"--posterior: the law of {path} is {law}, that of the case's material {own}")
        if not density or not math.isclose(library.quantity(density)[0], library.quantity(case["material.density"])[0], rel_tol=1e-6):
            raise InputError(f"--posterior: the density of {path} is {density or 'missing'}, that of the case's material {case['material.density']}")
        stated = any(key.startswith("response_error.") for key in values)
        if stated and any(map(math.isnan, response)):
            raise InputError(f"--posterior: response_error of {path} has no {RESPONSES[int(np.argmax(np.isnan(response)))]}")
        if draws and (draws[0].response is None) == stated:
            raise InputError(f"--posterior: {path} has {'a' if stated else 'no'} response_error, but {draws[0].path} has {'none' if stated else 'one'}")
        curve = values.get("curve")
        if curve and (path.parent / curve).is_file():
            values["curve"] = (path.parent / curve).read_text(encoding="utf-8", errors="replace")
        draws.append(Draw(str(path), values, response if stated else None, form[1] if form else forms.get(int(said[1]) if said else number, ""),
                          "# The accelerometer's mount was an unknown" in head))
    if all(_foam(draw) == _foam(draws[0]) for draw in draws):
        raise InputError(f"{where}: all {len(draws)} draws are the same material")
    return draws


def _foam(draw: Draw) -> dict[str, str]:
    return {key: value for key, value in draw.values.items() if not key.startswith("response_error.")}


def sources(draws: Sequence[Draw]) -> tuple[list[str], list[str]]:
    """Returns what differs among the draws, and what has one value in all of them."""
    differ = [key for key in SOURCES if len({draw.values.get(key) for draw in draws}) > 1]
    return [SOURCES[key] for key in differ], [SOURCES[key] for key in SOURCES if key not in differ]


class Interval(NamedTuple):
    """Quantiles of heights, m; 0 and inf: beyond those looked at."""

    low: float
    median: float
    high: float
    at_least: float

    @property
    def open(self) -> str:
        return {(False, False): "no", (True, False): "below", (False, True): "above", (True, True): "both"}[self.low <= 0, math.isinf(self.high)]


@dataclass
class Spread:
    """Heights of the draws, [draw] of the foam alone and [draw][repeat] with the other errors; 0: not known, or below all that was looked at."""

    draws: list[Draw]
    results: list[Result]
    foam: Array
    parts: dict[str, Interval] = field(default_factory=dict)
    rig: Interval | None = None
    mesh_error: float = math.nan
    whole: Array = field(default_factory=lambda: np.empty(0))

    @property
    def unknown(self) -> int:
        return sum(one.verdict == "not determined" for one in self.results)

    @property
    def bounded(self) -> int:
        """The draws that stay below the limits up to a drop that cannot be used: the height of the last one stands for theirs."""
        return sum(one.verdict == "above the highest point" and math.isfinite(height) for one, height in zip(self.results, self.foam))


def _interval(values: Array, quantile: float) -> Interval:
    """Returns quantiles that are values themselves, towards the safe side: heights may be 0 or infinite."""
    ordered, last = np.sort(values), len(values) - 1
    low, median, least = (float(ordered[math.floor(share * last)]) for share in (TAIL, 0.5, quantile))
    return Interval(low, median, float(ordered[math.ceil((1 - TAIL) * last)]), least)


def _heights(points: Sequence[Point], result: Result, limits: Sequence[float], raises: Array) -> Array:
    """Returns the heights of a draw whose ln(figures) [2][repeats] are raised: where a figure reaches its limit it moves by the slope of its drops there."""
    first = np.full(raises.shape[1], math.inf)
    good = [p for p in points if not p.failed and (result.exceeding is None or p.height < result.exceeding.height)]
    x = np.log([p.height for p in good])
    for c in range(2):
        y = np.log([p.value[c] for p in good])
        near = np.argsort(np.abs(y - math.log(limits[c])))[:3]
        slope, at = np.polyfit(x[near] - x[near].mean(), y[near], 1) if len(near) > 1 else (math.nan, y[0])
        crossing = result.crossings[c]
        if crossing.state == "crossed":
            slope, at_x = slope, math.log(crossing.height)
        else:
            at_x = x[near].mean() + (math.log(limits[c]) - at) / slope if slope > 0.1 else math.inf
        first = np.minimum(first, np.exp(at_x - raises[c] / max(slope, 0.1)))
    return first


def spread(draws: list[Draw], searches: Sequence[tuple[Sequence[Point], str]], limits: Sequence[float], mesh_error: float, scatter: Sequence[float],
           rig: tuple[float, float, int], quantile: float) -> Spread:
    """Returns intervals of the height: of the foam alone, then with the errors of the responses, of the mesh, and with the scatter of single drops.

    `searches`: the drops of each draw, and how its search ended. `scatter`: of ln(a_max) and ln(HIC), NaN: not known. `rig`: g_eff, its standard error, pairs.
    """
    points, results = [one for one, _ in searches], [evaluate(one, limits) for one, _ in searches]
    foam = np.array([{"found": one.height, "above the highest point": math.inf if ending == "max" else one.highest}.get(one.verdict, 0.0)
                     for one, (_, ending) in zip(results, searches)])
    made = Spread(draws, results, foam, mesh_error=mesh_error)
    random = np.random.default_rng(SEED)
    shape = (len(draws), 2, REPEATS)
    response = np.zeros(shape)
    if draws[0].response is not None:
        errors = np.array([draw.response for draw in draws])
        response = errors[:, :2, None] + errors[:, 2:, None] * random.standard_normal(shape)
    mesh = MESH_SIZE * (0.0 if math.isnan(mesh_error) else mesh_error) * np.array([1.0, MESH_HIC])[:, None] * random.standard_normal((len(draws), 1, REPEATS))
    single = np.nan_to_num(np.asarray(scatter, float))[:, None] * random.standard_normal(shape)
    for name, raises in zip(PARTS, (np.zeros(shape), response, response + mesh, response + mesh + single)):
        heights = np.repeat(foam[:, None], REPEATS, axis=1)
        for k, result in enumerate(results):
            if result.verdict == "found" and raises[k].any():
                heights[k] = _heights(points[k], result, limits, raises[k])
        made.parts[name] = _interval(heights.ravel(), quantile)
        made.whole = heights if name == PARTS[2] else made.whole
    gravity, error, pairs = rig
    if pairs:
        factor = STANDARD_GRAVITY / gravity * np.exp(-random.standard_t(pairs - 1, made.whole.size) * error / gravity) if pairs > 1 else \
            STANDARD_GRAVITY / gravity
        made.rig = _interval(made.whole.ravel() * factor, quantile)
    return made


def lowest_form(made: Spread, at_least: float) -> str:
    """Returns from which form the draws come that are lower than the headline, in words; "": they state none."""
    low = [draw.form for draw, height in zip(made.draws, made.foam) if height <= max(at_least, float(np.sort(made.foam)[max(1, len(made.foam) // 20) - 1]))]
    forms = sorted(set(filter(None, low)), key=lambda form: -low.count(form))
    return ", ".join(f"{form} ({low.count(form)} of {len(low)})" for form in forms)


def deciding(made: Spread) -> str:
    """Returns which limit is met first, in words."""
    counts = [sum(one.deciding == c for one in made.results) for c in range(2)]
    return ", ".join(f"{name} in {count}" for name, count in zip(CRITERIA, counts) if count)
