# SPDX-License-Identifier: GPL-3.0-or-later
"""The result of a protocol, of measured and of simulated drops alike."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from .cfh_draws import MESH_HIC
from .curves import STANDARD_GRAVITY
from .protocol import NEEDS, Figure, Protocol, kilograms
from .protocol_drops import NO_LIMIT, Drop, Drops, Search, Spot, figures_of
from .scatter import ENOUGH, Scatter, of_crossing, of_mean, of_repeats

LEAST_DRAWS = 20  # for a 95 % interval


@dataclass
class Line:
    """A row of the result: what it is of, the figure, its value with a 95 % interval (NaN: none), the limit, and whether it is met."""

    of: str
    figure: str
    value: float
    limit: float | None = None
    passed: bool | None = None
    low: float = math.nan
    high: float = math.nan
    note: str = ""


@dataclass
class Outcome:
    """The result: as it is stated, passed or not (None: not decided), value and interval (m, of a critical height), and its lines.

    `probability` is the share of the draws of a posterior that pass at every spot, with its 95 % interval.
    """

    stated: str
    passed: bool | None = None
    value: float = math.nan
    low: float = math.nan
    high: float = math.nan
    lines: list[Line] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    probability: tuple[float, float, float] | None = None
    meaning: str = "value"  # of the lines' values
    expected: bool = False  # the pad is expected to pass, and no measured drop has shown it
    not_done: list[str] = field(default_factory=list)  # what confirmed clauses ask for beyond the drops: the result is partial
    tested: float = math.nan  # m, greatest height tested that meets all limits at every place; 0: none does
    bounds: tuple[float, float] = (math.nan, math.nan)  # m, of a critical height that is no number: it lies between
    interval_from: str = ""  # what the interval is made of: "repeated drops" or "draws of the foam"; "": there is none


class Foams(NamedTuple):
    """The 95 % interval (m) of a critical height by the draws of the foam, weighed by measured drops; NaN, with the reason why there is none."""

    low: float
    high: float
    words: str


def between(low: float, high: float) -> str:
    """Returns an interval in words; "": there is none. A height has no lower bound at 0, and no upper one at inf.

    >>> between(0.7, 0.9), between(0.7, math.inf), between(math.nan, math.nan)
    ('0.7 to 0.9', 'above 0.7', '')
    """
    if math.isnan(low) or math.isnan(high):
        return ""
    if math.isinf(high):
        return f"above {low:.4g}" if low > 0 else "without bounds"
    return f"{low:.4g} to {high:.4g}" if low > 0 else f"below {high:.4g}"


_PASSES = {False: "passed", True: "expected to pass"}


def judge(p: Protocol, drops: Drops, simulated: bool = False, foams: Foams | None = None) -> Outcome:
    """Returns the result of the drops by the rules of the protocol. Only measured drops pass; simulated ones are expected to.

    Measured figures and heights have intervals by repeated drops; where these are too few, a height has that of `foams`.
    """
    scatter = {} if simulated else _repeats(p, drops)
    made = {"pass": _judge_pass, "critical height": _judge_height, "cushion curve": _judge_cushion}[p.kind](p, drops, scatter)
    made.notes += drops.missing
    alone = ["in what was simulated"] if any("is not simulated" in note for note in drops.missing) else []
    alone += ["by the first drop"] if drops.stands_in and 1 not in p.counted else []  # later drops on a spot are mostly harder
    if alone:
        made.stated = f"not decided: {_PASSES[simulated]} {' and '.join(alone)} alone" if made.passed else f"{made.stated}, {' and '.join(alone)} alone"
        made.passed = None if made.passed else made.passed
    if made.passed and simulated:
        made.passed, made.expected, made.stated = None, True, f"{_PASSES[True]}, by simulation; measured drops have to show it"
    made.not_done = _not_done(p, drops)
    if made.not_done:
        made.stated = f"partial: {made.stated}"
        made.passed = None if made.passed else made.passed
        made.notes += made.not_done
    if simulated and math.isnan(made.low) and made.probability is None and all(math.isnan(line.low) for line in made.lines):
        made.notes.append("there is no interval: the uncertainty of the foam is not included (--posterior=FOLDER, draws of the foam, includes it)")
    elif not simulated and made.lines:
        made.notes.append(_interval_note(p, made, scatter, foams))
    if drops.doubt:
        made.passed, made.value, made.low, made.high, made.tested, made.interval_from = None, math.nan, math.nan, math.nan, math.nan, ""
        made.stated = f"not decided, as {drops.doubt} (as they are listed: {made.stated})"
    if any(0 < len(drop.draws) < LEAST_DRAWS for drop in drops.drops):
        made.notes.append(f"figures have no 95 % intervals, which need {LEAST_DRAWS} draws of the foam and more")
    return made


def _repeats(p: Protocol, drops: Drops) -> dict[str, Scatter]:
    """Returns the scatter of each figure over the drops that count on each spot."""
    groups = [[drop for drop in group if drop.number in counted_of(p, group) and drop.is_usable] for group in spots_of(drops).values()]
    return {f.label: of_repeats([drop.figures[f.label] for drop in group if f.label in drop.figures] for group in groups) for f in p.figures}


def _interval_note(p: Protocol, made: Outcome, scatter: dict[str, Scatter], foams: Foams | None) -> str:
    """Returns what the intervals of measured drops rest on, in a sentence; a height whose repeats are too few takes the interval of the draws."""
    freedom = max((one.freedom for one in scatter.values()), default=0)
    bounds = (made.bounds if math.isnan(made.value) else (made.value, made.value)) if p.kind == "critical height" else (math.nan, math.nan)
    why = "" if foams is None else foams.words
    if foams is not None and freedom < ENOUGH and not any(map(math.isnan, (foams.low, foams.high, *bounds))):
        if foams.low <= bounds[1] and bounds[0] <= foams.high:
            made.low, made.high, made.interval_from = foams.low, foams.high, "draws of the foam"
            return f"the 95 % interval of the height is of {foams.words}, as {freedom or 'no'} repeated drops are too few; the scatter from sample to sample is not included"
        why = f"the draws of the foam have {between(foams.low, foams.high)} m, which does not hold what was measured: the foam is none of them"
    if not freedom:
        return ("no interval is known: no spot has two drops that count, whose scatter would give one"
                + (f"; {why}" if why else "; --pad=CASE with --posterior=FOLDER, draws of its foam, gives that of a height by first drops" if p.kind == "critical height" else ""))
    made.interval_from = "repeated drops"
    said = ", ".join(f"{100 * one.sd:.2g} % of {label}" for label, one in scatter.items() if one.freedom)
    return (f"95 % intervals are by the scatter of repeated drops on one spot ({said}; {freedom} degree{'s' if freedom > 1 else ''} of freedom); the scatter from sample to sample is not "
            f"included{', nor is the form of the curve between the heights' if p.kind == 'critical height' else ''}" + (f"; {why}" if why and freedom < ENOUGH else ""))


def _not_done(p: Protocol, drops: Drops) -> list[str]:
    """Returns what the confirmed clauses of a protocol ask for that the drops do not have, a sentence each."""
    places: dict[tuple[str, str], set[float]] = {}
    spots: dict[Spot, set[int]] = {}
    for drop in drops.all:
        if drop.is_usable:
            places.setdefault((drop.spot.condition, drop.spot.position), set()).add(drop.spot.height)
            spots.setdefault(drop.spot, set()).add(drop.number)
    there = {"positions": len({position for _, position in places}), "conditions": len({condition for condition, _ in places}),
             "heights": min(map(len, places.values()), default=0), "drops": min(map(len, spots.values()), default=0),
             "masses": len({spot.mass for spot in spots})}
    return [f'"{clause.text}" ({clause.source}): {NEEDS[key]}: {there[key]} of {least}' for clause in p.clauses if clause.confirmed
            for key, least in clause.needs.items() if there[key] < least]


def _greatest(p: Protocol, drops: Drops) -> float:
    """Returns the greatest height up to which all drops meet all limits, at the place where it is least; 0: the lowest does not."""
    places: dict[tuple[str, str], dict[float, list[Drop]]] = {}
    for drop in drops.all:
        places.setdefault((drop.spot.condition, drop.spot.position), {}).setdefault(drop.spot.height, []).append(drop)
    least = math.inf
    for heights in places.values():
        best = 0.0
        for height in sorted(heights):
            group = heights[height]
            values = {figure: figures_of(group, figure.label, counted_of(p, group)) for figure in p.figures if figure.limit is not None}
            if not all(value < figure.limit for figure, value in values.items()):  # type: ignore[operator]
                break
            best = height
        least = min(least, best)
    return least if places else math.nan


def _why(lines: list[Line]) -> str:
    """Returns why a limit is not decided: of the first drop that is not to be used, or else of the first line."""
    open_lines = [line for line in lines if line.limit is not None and line.passed is None]
    line = next((line for line in open_lines if "not to be used" in line.note or "there is no" in line.note), open_lines[0])
    return f"{line.of}: {line.note or f'there is no {line.figure}'}"


def spots_of(drops: Drops) -> dict[Spot, list[Drop]]:
    """Returns the drops of each spot."""
    spots: dict[Spot, list[Drop]] = {}
    for drop in drops.drops:
        spots.setdefault(drop.spot, []).append(drop)
    return spots


def counted_of(p: Protocol, drops: list[Drop]) -> tuple[int, ...]:
    """Returns the numbers of the drops of a spot that count: of one without all drops, such as a simulated one, the first that there is."""
    return p.counted if len(drops) == p.count else (min(drop.number for drop in drops),)


def _unusable(drops: list[Drop], counted: tuple[int, ...]) -> str:
    return "; ".join(f"drop {drop.number} is not to be used ({drop.note})" for drop in drops if drop.number in counted and not drop.is_usable)


def _judge_pass(p: Protocol, drops: Drops, scatter: dict[str, Scatter]) -> Outcome:
    made = Outcome("")
    for spot, group in spots_of(drops).items():
        counted = counted_of(p, group)
        for figure in p.figures:
            value = figures_of(group, figure.label, counted)
            passed = None if figure.limit is None or math.isnan(value) else value < figure.limit
            low, high = _draw_interval(group[0], figure.label) if group[0].draws else of_mean(value, len(counted), scatter.get(figure.label))
            notes = [_unusable(group, counted)]
            if passed and not group[0].draws and high >= figure.limit:  # type: ignore[operator]
                notes.append("the interval reaches the limit")
            if passed and figure.of(figure.value_of(value) * (1 + _mesh_error(group, figure.key))) >= figure.limit:  # type: ignore[operator]
                passed = None
                notes.append("the expected error of the mesh reaches the limit")
            if len(group) > 1 and len(counted) < len(group):
                notes.append(f"of drop{'s' if len(counted) > 1 else ''} {', '.join(map(str, counted))}")
            made.lines.append(Line(str(spot), figure.label, value, figure.limit, passed, low, high, "; ".join(note for note in notes if note)))
    judged = [line.passed for line in made.lines if line.limit is not None]
    if any(passed is False for passed in judged):
        made.passed, made.stated = False, "not passed"
    elif any(passed is None for passed in judged):
        made.stated = f"not decided: {_why(made.lines)}"
    elif not judged:
        made.stated = f"not decided: {'no figure of the protocol has a limit' if made.lines else 'there is no drop'}"
    else:
        made.passed, made.stated = True, "passed"
    made.probability = _probability(p, drops)
    return made


def _mesh_error(group: list[Drop], key: str) -> float:
    """Returns the expected relative error of a figure from the mesh; that of HIC is greater than that of a_max (docs/cfh.md)."""
    return {"a_max_g": 1.0, "hic": MESH_HIC}.get(key, 0.0) * max(drop.mesh_error for drop in group)


def _draw_interval(drop: Drop, key: str) -> tuple[float, float]:
    """Returns 2.5 and 97.5 % of the draws of a drop, NaN of fewer than LEAST_DRAWS."""
    values = sorted(figures[key] for figures in drop.draws.values() if key in figures)
    if len(values) < LEAST_DRAWS:
        return math.nan, math.nan
    return values[int(0.025 * (len(values) - 1))], values[math.ceil(0.975 * (len(values) - 1))]


def _probability(p: Protocol, drops: Drops) -> tuple[float, float, float] | None:
    """Returns the share of the draws that pass at every spot, with the interval of Wilson; a draw that lacks a figure does not pass."""
    labels = sorted({label for drop in drops.drops for label in drop.draws})
    if not labels:
        return None
    limits = [figure for figure in p.figures if figure.limit is not None]
    passed = sum(all(drop.draws.get(label, {}).get(figure.label, math.inf) < figure.limit for drop in drops.drops for figure in limits)  # type: ignore[operator]
                 for label in labels)
    n, z = len(labels), 1.959963984540054
    share = passed / n
    middle, half = (share + z * z / 2 / n) / (1 + z * z / n), z * math.sqrt(share * (1 - share) / n + z * z / 4 / n / n) / (1 + z * z / n)
    return share, max(0.0, middle - half), min(1.0, middle + half)


def _judge_height(p: Protocol, drops: Drops, scatter: dict[str, Scatter]) -> Outcome:
    made = Outcome("", meaning="height at the limit (m)")
    bounds: list[tuple[float, float]] = []  # heights of all positions, between which the figure reaches its limit
    for search in drops.searches:
        bounds.append(_take_search(p, search, made))
    measured: dict[tuple[str, str], dict[float, list[Drop]]] = {}
    for spot, group in spots_of(drops).items():
        measured.setdefault((spot.condition, spot.position), {})[spot.height] = group
    for (condition, position), heights in measured.items():
        bounds.append(_cross(p, f"{condition}, {position}", heights, made, scatter))
    low, high = (min((bound[k] for bound in bounds), default=math.nan) for k in (0, 1))
    made.bounds = low, high
    made.tested = _greatest(p, drops)
    if not bounds or any(math.isnan(value) for bound in bounds for value in bound):
        made.stated = "not determined: " + (made.notes[-1] if made.notes else _why(made.lines))
        return made
    if (high, high) in bounds and low:
        made.value = high
        decisive = min((line for line in made.lines if not math.isnan(line.value)), key=lambda line: line.value)
        made.low, made.high = decisive.low, decisive.high
    if measured and scatter:  # the lowest of all figures and places lies between the lowest ends of theirs
        made.low, made.high = (min((getattr(line, end) for line in made.lines), default=math.nan) for end in ("low", "high"))
    if not low:
        made.stated = f"below {high:.3g} m"
    elif math.isinf(high):
        made.stated = f"above {low:.3g} m"
    elif low < high:
        made.stated = f"between {low:.3g} and {high:.3g} m"
    else:
        rounded = math.floor(high / p.rounding + 1e-9) * p.rounding if p.rounding else high
        if p.rounding and not rounded:
            made.notes.append(f"the height is below one step of the rounding, {p.rounding:g} m")
        made.stated = f"{rounded:.3g} m"
    return made


def _take_search(p: Protocol, search: Search, made: Outcome) -> tuple[float, float]:
    """Adds the line of a search; returns the heights between which its own lies: twice the same where it is exact, 0 or inf without a bound."""
    found: dict[str, Any] = search.summary["critical_fall_height"]
    of = f"{search.condition}, {search.position}"
    verdict, value = found["verdict"], found.get("height_m")
    note = "" if verdict == "found" else verdict
    low, high = (math.nan if found.get(key) is None else float(found[key]) for key in ("height_low_m", "height_high_m"))
    labels = {name: next((figure.label for figure in p.figures if figure.key == key), name) for name, key in (("a_max", "a_max_g"), ("HIC", "hic"))}
    first = Line(of, labels.get(found["deciding"], found["deciding"] or ""), math.nan if value is None else float(value), None, None, low, high, note)
    made.lines.append(first)
    for one in search.summary["criteria"]:
        limit, height = one.get("limit_g", one.get("limit")), one["height_m"]
        if one["criterion"] == found["deciding"]:
            first.limit = limit
        elif limit < NO_LIMIT and verdict == "found":
            made.lines.append(Line(of, labels[one["criterion"]], math.nan if height is None else height, limit,
                                   note="" if height else f"{one['state']} up to {found['highest_simulated_m']:g} m"))
    exceeded = float(found.get("exceeded_at_m") or math.inf)  # by a drop that cannot be used
    if verdict == "found":
        return first.value, first.value
    if verdict.startswith("above"):
        if exceeded < math.inf:
            first.note += f"; a drop from {exceeded:.3g} m exceeds a limit, though its figures cannot be used"
        return float(found["highest_simulated_m"]), exceeded  # of a drop that can be used
    if verdict.startswith("below"):
        return 0.0, float(found["lowest_simulated_m"] or exceeded)
    made.notes.append(f"{of}: {found.get('problem') or verdict}")
    return math.nan, math.nan


def _cross(p: Protocol, of: str, heights: dict[float, list[Drop]], made: Outcome, scatter: dict[str, Scatter]) -> tuple[float, float]:
    """Returns between which heights a figure first reaches its limit, as _take_search: straight lines of its logarithm over that of the height."""
    order = sorted(heights)
    best = (order[-1], math.inf)
    for figure in p.figures:
        if figure.limit is None:
            continue
        values = [figures_of(heights[h], figure.label, counted_of(p, heights[h])) for h in order]
        first = next((h for h, value in zip(order, values) if value >= figure.limit), math.inf)  # what is above it does not matter
        bad = next((h for h, value in zip(order, values) if math.isnan(value) and h < first), None)
        if bad is not None:
            made.lines.append(Line(of, figure.label, math.nan, figure.limit, None,
                                   note=f"{bad:g} m: {_unusable(heights[bad], counted_of(p, heights[bad])) or f'there is no {figure.label}'}"))
            return math.nan, math.nan
        k = next((k for k, value in enumerate(values) if value >= figure.limit), None)
        low, high = _crossing_interval(p, heights, order, values, figure, scatter)
        if k is None:
            made.lines.append(Line(of, figure.label, math.nan, figure.limit, None, low, high, f"not reached up to {order[-1]:g} m"))
        elif k == 0:
            made.lines.append(Line(of, figure.label, math.nan, figure.limit, None, low, high, f"exceeded at the lowest height, {order[0]:g} m"))
            return 0.0, order[0]
        else:
            share = math.log(figure.limit / values[k - 1]) / math.log(values[k] / values[k - 1])
            height = order[k - 1] * (order[k] / order[k - 1]) ** share
            made.lines.append(Line(of, figure.label, height, figure.limit, None, low, high, f"between {order[k - 1]:g} and {order[k]:g} m"))
            if height < best[1]:
                best = (height, height)
    return best


def _crossing_interval(p: Protocol, heights: dict[float, list[Drop]], order: list[float], values: list[float], figure: Figure,
                       scatter: dict[str, Scatter]) -> tuple[float, float]:
    """Returns the 95 % interval of the height where a figure reaches its limit, by repeats; NaN: there are none. Heights from the first one without the figure on tell nothing."""
    there = next((k for k, value in enumerate(values) if not value > 0), len(values))
    known = scatter.get(figure.label)
    if not known or not known.freedom or not there or not figure.limit or figure.limit <= 0:
        return math.nan, math.nan
    counts = [len(counted_of(p, heights[h])) for h in order[:there]]
    return of_crossing(order[:there], values[:there], counts, figure.limit, known)


def _judge_cushion(p: Protocol, drops: Drops, scatter: dict[str, Scatter]) -> Outcome:
    made = Outcome("curve of the table")
    for spot, group in sorted(spots_of(drops).items(), key=lambda entry: kilograms(entry[0].mass)):
        stress = kilograms(spot.mass) * STANDARD_GRAVITY / p.area / 1e3
        for what, counted in (("first drop", (1,)), ("mean of the later ones", p.counted)):
            if not set(counted) <= {drop.number for drop in group}:
                continue
            for figure in p.figures:
                value = figures_of(group, figure.label, counted)
                low, high = of_mean(value, len(counted), scatter.get(figure.label))
                made.lines.append(Line(f"{spot.condition}, {spot.height:g} m, {stress:.3g} kPa, {what}", figure.label, value, figure.limit, None, low, high, _unusable(group, counted)))
    return made
