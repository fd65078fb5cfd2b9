# SPDX-License-Identifier: GPL-3.0-or-later
"""The drops of a protocol that are simulated: those whose curves are shown by the programs, draws of a foam in memory."""
from __future__ import annotations

import hashlib
import json
import math
import re
import warnings
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Iterable, Mapping

import numpy as np

from . import cfh_command, memory, programs
from .array import Array
from .case import Case
from .command import say
from .curves import Hic, hic
from .drop import Verdict, later_results, read_results
from .errors import Error, InputError, NumericError, failure
from .plan import Limit
from .protocol import Condition, Figure, Position, Protocol, speed
from .study import Table, sweep
from .sweep_command import choose_views


@dataclass(frozen=True)
class Spot:
    """What a drop is identified by: where, how and from what height (m)."""

    condition: str
    position: str
    height: float
    mass: str = ""
    missile: str = ""  # another one than that of the protocol

    def __str__(self) -> str:
        return ", ".join(part for part in (self.condition, self.position, f"{self.height:g} m", self.mass, self.missile) if part)


@dataclass
class Drop:
    """A drop with its figures, or the sentence why it has none. `draws`: the figures of draws of a posterior, by their labels."""

    spot: Spot
    number: int
    source: str
    figures: dict[str, float] = field(default_factory=dict)
    grade: str = ""
    note: str = ""
    curve: tuple[Any, Any] | None = None  # s, g
    view: Path | None = None  # the folder of its report.html and view.html
    draws: dict[str, dict[str, float]] = field(default_factory=dict)
    mesh_error: float = 0.0  # expected of a_max, simulated; the figures fall short by it
    reading: str = ""  # how a measured record was read
    speed: float = math.nan  # m/s, as measured before the impact
    foam: str = ""  # the file of the draw whose curve it has

    @property
    def is_usable(self) -> bool:
        """True if its figures may be used."""
        return bool(self.figures) and self.grade != "do not use"


@dataclass
class Search:
    """A critical height of `softfall cfh` at one position: its cfh.json, and the drops that it simulated."""

    condition: str
    position: str
    folder: Path
    summary: dict[str, Any]
    study: cfh_command.Study | None = None
    view: Path | None = None  # as that of a drop, at the critical height
    drops: list[Drop] = field(default_factory=list)


@dataclass
class Drops:
    """All drops of one kind; `missing`: what of the protocol they do not have, and what looks wrong in them, in sentences; `doubt`: why nothing
    is decided by them."""

    drops: list[Drop] = field(default_factory=list)
    searches: list[Search] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    doubt: str = ""
    stands_in: bool = False  # the first drop on a spot stands for those that count

    @property
    def all(self) -> list[Drop]:
        """Those of the searches, too, which are no spots of the protocol."""
        return [*(drop for search in self.searches for drop in search.drops), *self.drops]


def hic_from(time: Any, deceleration: Any, least: float) -> Hic:
    """Returns HIC with windows of at least `least` seconds, and its window; NaN: the curve is shorter.

    It is the ordinary one where its window is long enough; else the best window has that length.

    >>> round(hic_from([0, 0.001, 0.001001, 0.01], [1000, 1000, 0, 0], 0.002), 2) == round(0.002 * 500.25 ** 2.5, 2)
    True
    """
    free = hic(time, deceleration)
    if not free > 0 or free.t2 - free.t1 >= least:
        return free
    t, a = np.asarray(time, float), np.asarray(deceleration, float)
    if t[-1] - t[0] < least:
        return _windowed(math.nan, math.nan, math.nan)
    integral = np.concatenate([[0], np.cumsum(0.5 * (a[1:] + a[:-1]) * np.diff(t))])
    begins = np.unique(np.concatenate([t[t <= t[-1] - least], t[t >= t[0] + least] - least, np.linspace(t[0], t[-1] - least, 20001)]))

    def at(when: Array) -> Array:
        k = np.clip(np.searchsorted(t, when, "right") - 1, 0, t.size - 2)
        slope = (a[k + 1] - a[k]) / (t[k + 1] - t[k])
        value: Array = integral[k] + (when - t[k]) * (a[k] + 0.5 * slope * (when - t[k]))
        return value

    mean = np.maximum(0, (at(begins + least) - at(begins)) / least)
    best = int(np.argmax(mean))
    return _windowed(least * float(mean[best]) ** 2.5, float(begins[best]), float(begins[best]) + least)


def _windowed(value: float, begin: float, end: float) -> Hic:
    made = Hic(value)
    made.t1, made.t2 = begin, end
    return made


def _mesh_error(verdict: Verdict) -> float:
    """Returns the expected relative error of a_max from the mesh; 0: it is not known."""
    value = next((check["value"] for check in verdict.checks if check["key"] == "mesh"), None)
    return value or 0.0


def take_figures(figures: Iterable[Figure], known: Mapping[str, Any], curve: tuple[Any, Any] | None) -> dict[str, float]:
    """Returns the figures of a protocol; one that needs a least window of HIC is computed from the curve."""
    taken = {}
    for figure in figures:
        if figure.least_window and figure.key == "hic" and curve is not None:
            value = hic_from(*curve, figure.least_window)
            taken.update({} if math.isnan(value) else {figure.label: figure.of(float(value))})
        elif figure.key in known:
            taken[figure.label] = figure.of(float(known[figure.key]))
    return taken


# ---- simulated ----

def folder_name(*parts: str) -> str:
    """Returns the name of a folder; where a part has other characters than those of names, with a hash of it."""
    if any(re.search(r"[^\w. -]", part) for part in parts):
        parts = (*parts, hashlib.sha256("\0".join(parts).encode()).hexdigest()[:6])
    return "-".join(re.sub(r"[^\w.]+", "_", part) for part in parts)


def case_at(p: Protocol, pad: Case, condition: Condition, position: Position, missing: list[str],
            missile: Mapping[str, Any] | None = None) -> Case | None:
    """Returns the case of a condition, a position and a missile (by default that of the protocol); None, with a sentence in `missing`, if it
    does not have the keys of the first two."""
    if pad["series.drops"] != 1:
        raise InputError(f"{pad.path}: series.drops = {pad['series.drops']}: leave the group series out, as the protocol says how many drops there are")
    if "missile.velocity" in pad.overrides:
        raise InputError(f"{pad.path}: --set missile.velocity: the speed is that of the fall from the heights of the protocol")
    case = pad.copy()
    try:
        case.update(p.missile if missile is None else missile)
    except InputError as error:
        raise InputError(f"{p.path}: missile, on {pad.path}: {str(error).removeprefix('--set ')}") from None
    for what, keys in ((f"condition {condition.name}", condition.keys),
                       (f"position {position.name}", {"missile.position": [f"{1e3 * x:g} mm" for x in position.at]} if position.at else {})):
        unknown = [key for key in keys if key not in case]
        if unknown:
            raise InputError(f"{p.path}: {what}: the case has no key {unknown[0]!r}")
        try:
            case.update(keys)
        except InputError as error:
            missing.append(f"{what} is not simulated: {str(error).removeprefix('--set ')}")
            return None
    return case


def simulate(p: Protocol, pad: Case, output: Path, posterior: str | None = None, draws: int | None = None, beside: Drops | None = None,
             **options: Any) -> Drops:
    """Simulates the drops of a protocol on the pad of a case, below `output`. What is there is used again.

    `posterior`: a folder of draws of the foam. `beside`: measured drops, from whose heights a place of a search is simulated, too. `options`: jobs, engine and profile of searches and of draws, threads; `views`
    chooses drops at each position as `softfall sweep` does, and makes the view at a critical height.
    """
    made = Drops()
    output.mkdir(parents=True, exist_ok=True)
    for condition in p.conditions:
        for position in p.positions:
            case = case_at(p, pad, condition, position, made.missing)
            if case is None:
                continue
            folder, remembers = output / folder_name(condition.name, position.name), p.count > 1 and any(case[key] for key in case if key.endswith("memory.reload"))
            if p.count > 1 and not remembers and not made.stands_in:
                made.stands_in = True
                made.missing.append(f"of the {p.count} drops on a spot ({p.interval} apart) the first is simulated; it stands for drop"
                                    f"{'s' if len(p.counted) > 1 else ''} {', '.join(map(str, p.counted))}, as the foam has no material.memory")
            if remembers:
                made.drops += _series(p, case, condition, position, folder, made, options)
            elif p.kind == "critical height" and not p.heights:
                made.searches.append(search(p, case, condition, position, folder, posterior, options))
                made.searches[-1].drops += _beside(p, case, condition, position, folder, made.searches[-1], beside, options)
            else:
                made.drops += _sweep(p, case, condition, position, folder, posterior, draws, options)
    if posterior and any(drop.number > 1 for drop in made.drops):
        made.missing.append("draws of the foam are not used where later drops are simulated: there is no interval")
    if not made.drops and not made.searches:
        raise InputError(f"nothing of the protocol can be simulated: {'; '.join(made.missing)}")
    made.missing += search_notes(p, made.searches)
    return made


def search_notes(p: Protocol, searches: Iterable[Search]) -> list[str]:
    """Returns what searches do otherwise than the protocol asks, where it changed figures of their drops by more than their digits."""
    asked = "windows of HIC of every length" if any(figure.least_window for figure in p.figures) else ""
    asked = " and ".join(part for part in (asked, f"CFC {SEARCH_FILTER}" if p.filter != SEARCH_FILTER else "") if part)
    changed = [abs(figure.value_of(drop.figures[figure.label]) / point[figure.key] - 1) for one in searches
               for drop, point in zip(one.drops, one.summary["points"]) for figure in p.figures
               if figure.key in ("a_max_g", "hic") and drop.source and point.get(figure.key) and figure.label in drop.figures]
    largest = max(changed, default=0.0)
    return [f"the search takes {asked}, which changes the figures of its drops by up to {largest:.2%}"] if asked and largest > 1e-6 else []


SEARCH_WIDTH, SEARCH_MOST = 1.02, 8  # of the heights on both sides of a limit; series of a search


def _series(p: Protocol, case: Case, condition: Condition, position: Position, folder: Path, made: Drops, options: Mapping[str, Any]) -> list[Drop]:
    """Returns the drops of the series on each spot: at the heights of the protocol, or at those of a search for the critical one."""
    def at(height: float, mass: str = "") -> list[Drop]:
        return _run_series(p, case, Spot(condition.name, position.name, height, mass), folder, options)

    if p.heights:
        return [drop for height in p.heights for mass in (p.masses or ("",)) for drop in at(height, mass)]
    summary = search(p, case, condition, position, folder, None, options).summary
    found, heights = summary["critical_fall_height"], [point["height_m"] for point in summary["points"] if not point["failed"]]
    begin = {"found": found.get("height_m"), "above the highest point": max(heights, default=None), "below the lowest point": min(heights, default=None)}
    first = begin.get(found["verdict"])
    if first is None:
        made.missing.append(f"{condition.name}, {position.name} is not simulated: no height was found where the search for later drops could begin")
        return []
    tried: dict[float, list[Drop]] = {}
    height = float(f"{0.95 * first:.3g}")
    while height not in tried and len(tried) < SEARCH_MOST:
        tried[height] = at(height)
        height = _next_height(p, tried)
    if height not in tried:
        made.missing.append(f"{condition.name}, {position.name}: the search ended after {SEARCH_MOST} series, before two heights within "
                            f"{100 * (SEARCH_WIDTH - 1):.0f} % held the limit")
    return [drop for height in sorted(tried) for drop in tried[height]]


def _next_height(p: Protocol, tried: Mapping[float, list[Drop]]) -> float:
    """Returns where a straight line in logarithms reaches the first limit, or one of the heights that were tried if it is found well enough."""
    def excess(height: float) -> float:
        """Returns ln of the largest figure over its limit; drops without figures are far beyond it."""
        values = [math.log(figures_of(tried[height], f.label, p.counted) / f.limit) for f in p.figures if f.limit is not None]
        return 1.0 if any(math.isnan(value) for value in values) else max(values)

    low = max((h for h in tried if excess(h) < 0), default=math.nan)
    high = min((h for h in tried if excess(h) >= 0), default=math.nan)
    if math.isnan(high):
        return float(f"{1.06 * low:.3g}")
    if math.isnan(low):
        return float(f"{0.94 * high:.3g}")
    if high / low <= SEARCH_WIDTH:
        return low
    part = min(max(-excess(low) / (excess(high) - excess(low)), 0.2), 0.8)
    return float(f"{low * (high / low) ** part:.4g}")


def _run_series(p: Protocol, case: Case, spot: Spot, folder: Path, options: Mapping[str, Any]) -> list[Drop]:
    """Simulates all drops on a spot, one after another on the same foam. One that fails has no figures, and none comes after it."""
    if not p.interval:
        raise InputError(f"{p.path}: drops: interval is missing, the time from one drop to the next")
    one = case.copy()
    one.update({"missile.velocity": f"{speed(spot.height):.12g} m/s", "series.drops": p.count, "series.interval": p.interval,
                **({"missile.mass": spot.mass} if spot.mass else {})})
    values = hashlib.sha256(repr((p.count, p.interval, sorted(one.overrides.items()))).encode()).hexdigest()[:8]
    place = folder / folder_name("series", f"{spot.height:g}m", *([spot.mass] if spot.mass else []), values)
    files = [later_results(place / "results.h5", number) for number in range(1, p.count + 1)]
    failure, drops = "", []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            one.run(threads=options.get("threads"), output=place)
        except NumericError as error:
            failure = str(error)
        for number, path in enumerate(files, 1):
            if failure and (not path.exists() or read_results(path).figures["status"] not in ("finished", "rebound")):
                drops.append(Drop(spot, number, str(path), grade="do not use", note=failure))
                continue
            drops.append(_result(p, spot, number, path))
            if options.get("views"):  # they have all fields
                drops[-1].view = read_results(path, output=place / f"view-{number}").report().parent
    return drops


SEARCH_FILTER, NO_LIMIT = 1000, 1e6  # of a search and of draws; a limit that no drop reaches
OF_THE_DROP = (4, 5)  # exit codes of a model or a solution that fails: others end the command


def search(p: Protocol, case: Case, condition: Condition, position: Position, folder: Path, posterior: str | None,
           options: Mapping[str, Any], limits: tuple[float | None, float | None] | None = None, shown: bool = True) -> Search:
    """Searches the critical height below a folder, and simulates its drops with their curves and its page if they are shown. `limits` of a_max (g) and HIC are those of the protocol unless given."""
    folder /= "heights"
    folder.mkdir(parents=True, exist_ok=True)
    a_max, hic_value = limits or (p.limit_of("a_max_g"), p.limit_of("hic"))
    given = {"limit_g": a_max or NO_LIMIT, "limit_hic": hic_value or NO_LIMIT, "force": True}
    words = [f"--output={folder}", *(f"--set={key}={text}" for key, text in case.overrides.items()),
             *programs.options({**given, "posterior": posterior, "jobs": options.get("jobs")}), "--", str(case.path)]
    study = cfh_command.find(cfh_command.parser("softfall cfh").parse_args(words), lambda text: None, say if posterior else lambda text: None,
                             f"critical height of {p.path}", page=shown)
    found = Search(condition.name, position.name, folder, json.loads((folder / "cfh.json").read_text(encoding="utf-8")), study)
    threads = options.get("threads")
    height = found.summary["critical_fall_height"].get("height_m")
    if shown:
        found.drops = [_point(p, case, Spot(condition.name, position.name, point["height_m"]), point, folder / "runs", threads) for point in found.summary["points"]]
    if options.get("views") and height:
        found.view = _view(_case_of(case, Spot(condition.name, position.name, height)), folder / "runs", threads)  # None: the foam may lock up between drops that worked
    return found


def _point(p: Protocol, case: Case, spot: Spot, point: Mapping[str, Any], runs: Path, threads: int | None) -> Drop:
    """Returns a drop of a search, simulated once more for its curve if it can be used; its grade is that of the search."""
    drop = Drop(spot, 1, "", grade="do not use" if point["failed"] else point["grade"], note=point["note"] or "")
    if point["failed"]:
        return drop
    one = _case_of(case, spot)
    one.update(text.split("=", 1) for text in memory.LEAN)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return replace(_result(p, spot, 1, Path(one.run(threads=threads, runs=runs).results)), grade=drop.grade, note=drop.note)


def _result(p: Protocol, spot: Spot, number: int, path: Path) -> Drop:
    """Returns the drop of results, with figures and curve by the filter of the protocol."""
    result = read_results(path)
    result.post(filter=int(p.filter))
    curve, verdict = result.curve(), result.verdict
    return Drop(spot, number, str(path), take_figures(p.figures, result.figures, curve), str(verdict), "; ".join(verdict.remarks), curve, mesh_error=_mesh_error(verdict))


def _beside(p: Protocol, case: Case, condition: Condition, position: Position, folder: Path, there: Search, measured: Drops | None,
            options: Mapping[str, Any]) -> list[Drop]:
    """Returns the drops from the heights that were measured at a place, as far as its search has not simulated them."""
    heights = {drop.spot.height for drop in measured.drops if (drop.spot.condition, drop.spot.position) == (condition.name, position.name)} if measured else set()
    new = tuple(sorted(heights - {drop.spot.height for drop in there.drops}))
    return _sweep(replace(p, heights=new), case, condition, position, folder / "measured_heights", None, None, options) if new else []


def _sweep(p: Protocol, case: Case, condition: Condition, position: Position, folder: Path, posterior: str | None,
           draws: int | None, options: Mapping[str, Any]) -> list[Drop]:
    """Returns a drop from each height with each mass. The draws of a posterior are one drop, whose curve and file are those of the first one that can be used."""
    unknown = [figure.key for figure in p.figures if figure.key not in memory.figure_keys()]
    if unknown:
        raise InputError(f'{p.path}, on {case.path}: unknown figure "{unknown[0]}" of summary.json (docs/formats.md lists them)')
    spots = [Spot(condition.name, position.name, height, mass) for height in p.heights for mass in p.masses or ("",)]
    limits = [Limit(figure.label, math.nan if figure.limit is None else figure.limit) for figure in p.figures]
    words, threads = options.get("views"), options.get("threads")
    if words:
        choose_views(words, limits, len(spots))
    folder.mkdir(parents=True, exist_ok=True)
    if posterior:
        rows = _draws(p, case, spots, folder / "sweep", posterior, draws, options)
        drops = [_of_draws(p, case, spot, rows[spot], folder, threads) for spot in spots]
    else:
        drops = [_simulated(p, _case_of(case, spot), spot, folder, threads) for spot in spots]
    chosen = choose_views(words, limits, len(drops), lambda label: np.array([drop.figures.get(label, math.nan) for drop in drops])) if words else {}
    for number in chosen:
        drops[number].view = _view(_case_of(case, drops[number].spot, drops[number].foam), folder, threads)
    return drops


def _case_of(case: Case, spot: Spot, foam: str = "") -> Case:
    """Returns the case of a spot, with a draw of the foam if one is given."""
    one = Case(case.path, {**({"material": f"@{foam}"} if foam else {}), **case.overrides})
    one.update({"missile.velocity": f"{speed(spot.height):.12g} m/s", **({"missile.mass": spot.mass} if spot.mass else {})})
    return one


def _simulated(p: Protocol, case: Case, spot: Spot, runs: Path, threads: int | None) -> Drop:
    """Simulates a drop, whose results stay below `runs`; one that fails or is not to be used has no figures."""
    case.update(text.split("=", 1) for text in memory.LEAN)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            drop = _result(p, spot, 1, case.run(threads=threads, runs=runs).results)
        except Error as error:
            if error.code not in OF_THE_DROP:
                raise
            return Drop(spot, 1, getattr(error, "results", None) or "", grade="do not use", note=str(error))
    return drop if drop.is_usable else replace(drop, figures={}, curve=None, mesh_error=0.0)


def _view(case: Case, runs: Path, threads: int | None) -> Path | None:
    """Simulates a drop with all fields, and returns the folder of its pages; None: it failed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return case.run(threads=threads, runs=runs).report().parent
        except NumericError:
            return None


def _draws(p: Protocol, case: Case, spots: list[Spot], folder: Path, posterior: str, draws: int | None, options: Mapping[str, Any]) -> dict[Spot, list[dict[str, str]]]:
    """Simulates all spots with the draws of a posterior, and returns the rows of runs.csv of each spot."""
    factors: list[dict[str, Any]] = [{"key": "missile.velocity", "name": "speed", "values": [f"{speed(h):.12g} m/s" for h in p.heights]}]
    if p.masses:
        factors.append({"key": "missile.mass", "name": "mass", "values": list(p.masses)})
    factors.append({"key": "material", "name": "foam", "posterior": str(Path(posterior).absolute()), **({"draws": draws} if draws else {})})
    figures: list[dict[str, Any]] = [{"key": figure.key} if figure.limit is None else {"key": figure.key, "limit": figure.value_of(figure.limit)} for figure in p.figures]
    plan: dict[str, Any] = {"case": str(case.path), "factors": factors, "figures": figures}
    if case.overrides:
        plan["set"] = [f"{key}={text}" for key, text in case.overrides.items()]
    try:
        sweep(plan, output=folder, **{name: options.get(name) for name in ("jobs", "engine", "profile")})
    except Error as error:  # a user does not know the plan that is written here
        raise failure(re.sub(rf"{re.escape(str(folder))}\.cfg:\d+: ", f"{p.path}, on {case.path}: ", str(error)), error.code) from None
    table = Table(folder / "runs.csv")
    rows = [dict(zip(table.columns, row)) for row in table.rows]
    count = len(rows) // len(spots)  # the foam is the last factor, and changes fastest
    return {spot: rows[k * count:(k + 1) * count] for k, spot in enumerate(spots)}


def _of_draws(p: Protocol, case: Case, spot: Spot, rows: list[dict[str, str]], runs: Path, threads: int | None) -> Drop:
    """Returns the drop of a spot with the medians of its draws."""
    usable = [row for row in rows if row["run_status"] == "done" and row["grade"] != "do not use"]
    if not usable:
        return Drop(spot, 1, "", grade="do not use", note=rows[-1]["message"] or "do not use", foam=rows[0]["foam"])
    made = _simulated(p, _case_of(case, spot, usable[0]["foam"]), spot, runs, threads)
    made.foam = usable[0]["foam"]
    of_curve = p.filter != SEARCH_FILTER or any(figure.least_window for figure in p.figures)
    for row in usable:
        numbers = {figure.key: float(row[figure.key]) for figure in p.figures if row[figure.key]}
        made.draws[row["foam"]] = _simulated(p, _case_of(case, spot, row["foam"]), spot, runs, threads).figures if of_curve else take_figures(p.figures, numbers, None)
    if len(made.draws) > 1:
        made.note = "; ".join(part for part in (f"medians of {len(made.draws)} draws; curve and file are of the first", made.note) if part)
        made.figures = {key: float(np.median([values[key] for values in made.draws.values() if key in values])) for key in made.figures}
    return made


def figures_of(drops: Iterable[Drop], key: str, counted: Iterable[int]) -> float:
    """Returns the mean of a figure over the counted drops; NaN unless all of them are usable."""
    wanted = set(counted)
    values = [drop.figures.get(key, math.nan) for drop in drops if drop.number in wanted and drop.is_usable]
    return float(np.mean(values)) if len(values) == len(wanted) else math.nan
