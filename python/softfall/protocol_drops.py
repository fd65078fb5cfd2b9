# SPDX-License-Identifier: GPL-3.0-or-later
"""The drops of a protocol: simulated by the programs, or read from the files of a laboratory."""
from __future__ import annotations

import csv
import json
import math
import re
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Iterable, Mapping

import numpy as np

from . import programs
from .case import Case
from .curves import hic
from .drop import later_results, read_results
from .errors import Error, InputError, NumericError
from .protocol import Condition, Figure, Position, Protocol, length, speed
from .record import read_record
from .study import Table, sweep

OPTIONS = ("column", "columns", "heading", "scale", "rate", "impact", "invert", "zero")


@dataclass(frozen=True)
class Spot:
    """What a drop is identified by: where, how and from what height (m)."""

    condition: str
    position: str
    height: float
    mass: str = ""

    def __str__(self) -> str:
        return ", ".join(part for part in (self.condition, self.position, f"{self.height:g} m", self.mass) if part)


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
    draws: dict[str, dict[str, float]] = field(default_factory=dict)

    @property
    def is_usable(self) -> bool:
        """True if its figures may be used."""
        return bool(self.figures) and self.grade != "do not use"


@dataclass
class Search:
    """A critical height of softfall-cfh at one position: the members of its cfh.json that a result needs."""

    condition: str
    position: str
    folder: Path
    summary: dict[str, Any]


@dataclass
class Drops:
    """All drops of one kind; `missing`: what of the protocol they do not have, in sentences."""

    drops: list[Drop] = field(default_factory=list)
    searches: list[Search] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    stands_in: bool = False  # the first drop on a spot stands for those that count


def hic_from(time: Any, deceleration: Any, least: float) -> float:
    """Returns HIC with windows of at least `least` seconds.

    It is the ordinary one where its window is long enough; else the best window has that length.

    >>> round(hic_from([0, 0.001, 0.001001, 0.01], [1000, 1000, 0, 0], 0.002), 2) == round(0.002 * 500.25 ** 2.5, 2)
    True
    """
    free = hic(time, deceleration)
    if not free > 0 or free.t2 - free.t1 >= least:
        return float(free)
    t, a = np.asarray(time, float), np.asarray(deceleration, float)
    integral = np.concatenate([[0], np.cumsum(0.5 * (a[1:] + a[:-1]) * np.diff(t))])
    begins = np.unique(np.concatenate([t[t <= t[-1] - least], t[t >= t[0] + least] - least, np.linspace(t[0], t[-1] - least, 20001)]))

    def at(when: np.ndarray) -> np.ndarray:
        k = np.clip(np.searchsorted(t, when, "right") - 1, 0, t.size - 2)
        slope = (a[k + 1] - a[k]) / (t[k + 1] - t[k])
        return integral[k] + (when - t[k]) * (a[k] + 0.5 * slope * (when - t[k]))

    mean = np.maximum(0, (at(begins + least) - at(begins)) / least)
    return float((least * mean**2.5).max())


def _take_figures(figures: Iterable[Figure], known: Mapping[str, Any], curve: tuple[Any, Any] | None) -> dict[str, float]:
    """Returns the figures of a protocol; one that needs a least window of HIC is computed from the curve."""
    taken = {}
    for figure in figures:
        if figure.least_window and figure.key == "hic" and curve is not None:
            taken[figure.label] = figure.of(hic_from(*curve, figure.least_window))
        elif figure.key in known:
            taken[figure.label] = figure.of(float(known[figure.key]))
    return taken


# ---- simulated ----

def folder_name(*parts: str) -> str:
    return "-".join(re.sub(r"[^\w.]+", "_", part) for part in parts)


def case_at(p: Protocol, pad: Case, condition: Condition, position: Position, missing: list[str]) -> Case | None:
    """Returns the case of a condition and a position; None, with a sentence in `missing`, if it does not have their keys."""
    if pad["series.drops"] != 1:
        raise InputError(f"{pad.path}: series.drops = {pad['series.drops']}: leave the group series out, as the protocol says how many drops there are")
    case = pad.copy()
    case.update(p.missile)
    for what, keys in ((f"condition {condition.name}", condition.keys),
                       (f"position {position.name}", {"missile.position": [f"{1e3 * x:g} mm" for x in position.at]} if position.at else {})):
        try:
            case.update(keys)
        except InputError as error:
            missing.append(f"{what} is not simulated: {error}")
            return None
    return case


def simulate(p: Protocol, pad: Case, output: Path, posterior: str | None = None, draws: int | None = None, **options: Any) -> Drops:
    """Simulates the drops of a protocol on the pad of a case, below `output`. What is there is used again.

    `posterior`: a folder of draws of the foam. `options` are those of softfall-sweep and softfall-cfh: jobs, threads, engine, profile.
    """
    made = Drops()
    output.mkdir(parents=True, exist_ok=True)
    for condition in p.conditions:
        for position in p.positions:
            case = case_at(p, pad, condition, position, made.missing)
            if case is None:
                continue
            folder, remembers = output / folder_name(condition.name, position.name), p.count > 1 and bool(case["material.memory.reload"])
            if p.count > 1 and not remembers and not made.stands_in:
                made.stands_in = True
                made.missing.append(f"of the {p.count} drops on a spot ({p.interval} apart) the first is simulated; it stands for drop"
                                    f"{'s' if len(p.counted) > 1 else ''} {', '.join(map(str, p.counted))}, as the foam has no material.memory")
            if remembers:
                made.drops += _series(p, case, condition, position, folder, made, options)
            elif p.kind == "critical height" and not p.heights:
                made.searches.append(search(p, case, condition, position, folder, posterior, options))
            else:
                made.drops += _sweep(p, case, condition, position, folder, posterior, draws, options)
    if posterior and any(drop.number > 1 for drop in made.drops):
        made.missing.append("draws of the foam are not used where later drops are simulated: there is no interval")
    if not made.drops and not made.searches:
        raise InputError(f"nothing of the protocol can be simulated: {'; '.join(made.missing)}")
    if any(figure.least_window for figure in p.figures) and made.searches:
        made.missing.append("the search counts windows of HIC of every length")
    return made


SEARCH_WIDTH, SEARCH_MOST = 1.02, 8  # of the heights on both sides of a limit; series of a search


def _series(p: Protocol, case: Case, condition: Condition, position: Position, folder: Path, made: Drops, options: Mapping[str, Any]) -> list[Drop]:
    """Returns the drops of the series on each spot: at the heights of the protocol, or at those of a search for the critical one."""
    def at(height: float, mass: str = "") -> list[Drop]:
        return _run_series(p, case, Spot(condition.name, position.name, height, mass), folder, options)

    if p.heights:
        return [drop for height in p.heights for mass in (p.masses or ("",)) for drop in at(height, mass)]
    found = search(p, case, condition, position, folder / "first-drop", None, options).summary["critical_fall_height"].get("height_m")
    if found is None:
        made.missing.append(f"{condition.name}, {position.name}: no critical height of first drops was found, where the search for later ones begins")
        return []
    tried: dict[float, list[Drop]] = {}
    height = float(f"{0.95 * found:.3g}")
    while height not in tried and len(tried) < SEARCH_MOST:
        tried[height] = at(height)
        height = _next_height(p, tried)
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
    place = folder / folder_name("series", f"{spot.height:g}m", *([spot.mass] if spot.mass else []))
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
            result = read_results(path)
            result.post(filter=int(p.filter))
            drops.append(Drop(spot, number, str(path), _take_figures(p.figures, result.figures, result.curve()), str(result.verdict),
                              "; ".join(result.verdict.remarks), result.curve()))
    return drops


def search(p: Protocol, case: Case, condition: Condition, position: Position, folder: Path, posterior: str | None,
            options: Mapping[str, Any]) -> Search:
    folder.mkdir(parents=True, exist_ok=True)
    limits = {figure.key: figure.limit for figure in p.figures}
    given = {"limit_g": limits.get("a_max_g") or 1e6, "limit_hic": limits.get("hic") or 1e9, "posterior": posterior,
             "force": (folder / "cfh.json").exists(), **options}
    programs.run("cfh", [str(case.path), f"--output={folder}", *(f"--set={key}={text}" for key, text in case.overrides.items()),
                         *programs.options(given)])
    return Search(condition.name, position.name, folder, json.loads((folder / "cfh.json").read_text(encoding="utf-8")))


def _sweep(p: Protocol, case: Case, condition: Condition, position: Position, folder: Path, posterior: str | None,
           draws: int | None, options: Mapping[str, Any]) -> list[Drop]:
    factors: list[dict[str, Any]] = [{"key": "missile.velocity", "name": "speed", "values": [f"{speed(h):.12g} m/s" for h in p.heights]}]
    if p.masses:
        factors.append({"key": "missile.mass", "name": "mass", "values": list(p.masses)})
    if posterior:
        factors.append({"key": "material", "name": "foam", "posterior": str(Path(posterior).absolute()),
                        **({"draws": draws} if draws else {})})
    plan = {"case": str(case.path), "set": [f"{key}={text}" for key, text in case.overrides.items()], "factors": factors,
            "figures": [{"key": figure.key, **({"limit": (figure.limit - figure.offset) / figure.factor} if figure.limit is not None else {})}
                        for figure in p.figures]}
    plan = {key: value for key, value in plan.items() if value != []}
    sweep(plan, output=folder, **options)
    return _rows(p, condition, position, folder)


def _rows(p: Protocol, condition: Condition, position: Position, folder: Path) -> list[Drop]:
    """Returns the rows of runs.csv as drops; the draws of a posterior are one drop, whose curve is that of the first."""
    table = Table(folder / "runs.csv")
    drops: dict[Spot, Drop] = {}
    for row in table.rows:
        cell = dict(zip(table.columns, row))
        height = min(p.heights, key=lambda h: abs(speed(h) - float(cell["speed (m/s)"])))
        mass = min(p.masses, key=lambda m: abs(float(m.split()[0]) - float(cell["mass (kg)"])), default="") if p.masses else ""
        spot = Spot(condition.name, position.name, height, mass)
        results = folder / "runs" / cell["folder"] / "results.h5"
        usable = cell["run_status"] == "done" and cell["grade"] != "do not use"
        drop = drops.setdefault(spot, Drop(spot, 1, str(results), grade=cell["grade"] or "do not use", note=cell["message"]))
        if not usable:
            drop.note = cell["message"] or "do not use"
            drop.grade = "do not use"
            continue
        if drop.curve is None:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result = read_results(results)
                result.post(filter=int(p.filter))
                drop.curve, own = result.curve(), result.figures
            drop.figures = _take_figures(p.figures, own, drop.curve)
        if "foam" in cell:
            drop.draws[cell["foam"]] = _take_figures(p.figures, {key: float(text) for key, text in cell.items()
                                                                 if key in {f.key for f in p.figures} and text}, None)
    for drop in drops.values():
        if len(drop.draws) > 1:
            drop.figures = {key: float(np.median([values[key] for values in drop.draws.values()])) for key in drop.figures}
    return list(drops.values())


# ---- measured ----

def measure(p: Protocol, folder: Path, pattern: str | None = None, complete: bool = True) -> Drops:
    """Reads the measured drops of a folder: by its list.csv, or by a pattern of names such as "{position}_{height}_{drop}.csv".

    list.csv has a row for each file: file, condition, position, height, drop, mass, and options of the record (column, scale, rate, ...).
    A name that the protocol lacks, two files for one drop, a missing drop (if the test is `complete`) and a record that cannot be read are
    refused before anything is judged. Of a test that is not complete a drop may have any height.
    """
    if not folder.is_dir():
        raise InputError(f"there is no folder {folder}")
    rows = _listed(folder) if (folder / "list.csv").exists() and not pattern else _matched(folder, pattern)
    made = Drops([_measured(p, folder, where, row, complete) for where, row in rows])
    seen: dict[tuple[Spot, int], str] = {}
    for drop in made.drops:
        key = (drop.spot, drop.number)
        if key in seen:
            raise InputError(f"{seen[key]} and {drop.source} are both drop {drop.number} at {drop.spot}")
        seen[key] = drop.source
    if complete:
        _refuse_missing(p, folder, set(seen))
    return made


def _listed(folder: Path) -> list[tuple[str, dict[str, str]]]:
    with open(folder / "list.csv", newline="", encoding="utf-8-sig") as stream:
        reader = csv.DictReader(stream)
        known = {"file", "condition", "position", "height", "drop", "mass", *OPTIONS}
        unknown = [name for name in reader.fieldnames or [] if name not in known]
        if "file" not in (reader.fieldnames or []) or unknown:
            raise InputError(f"{folder / 'list.csv'}: {'there is no column ' + repr(unknown[0]) if unknown else 'the column file is missing'}; "
                             f"there are {', '.join(sorted(known))}")
        return [(f"{folder / 'list.csv'}:{reader.line_num}", {key: (value or "").strip() for key, value in row.items() if key})
                for row in reader]


def _matched(folder: Path, pattern: str | None) -> list[tuple[str, dict[str, str]]]:
    if not pattern:
        raise InputError(f"{folder} has no list.csv: write one (file, condition, position, height, drop), or give a pattern of the names")
    parts = re.split(r"\{(\w+)\}", pattern)
    unknown = [name for name in parts[1::2] if name not in ("condition", "position", "height", "drop", "mass")]
    if unknown or len(parts) < 3:
        raise InputError(f"pattern {pattern!r}: {{{unknown[0]}}}" if unknown else f"pattern {pattern!r} names nothing" +
                         "; {condition}, {position}, {height}, {drop} and {mass} may be named")
    regex = re.compile("".join(re.escape(part) if k % 2 == 0 else f"(?P<{part}>.+?)" for k, part in enumerate(parts)) + r"\Z")
    found = [(str(path), {"file": path.name, **match.groupdict()}) for path in sorted(folder.iterdir()) if (match := regex.match(path.name))]
    if not found:
        raise InputError(f"no file of {folder} is named {pattern}")
    return found


def _measured(p: Protocol, folder: Path, where: str, row: Mapping[str, str], complete: bool) -> Drop:
    def name(key: str, entries: Iterable[Any]) -> str:
        names = [entry.name for entry in entries]
        value = row.get(key) or (names[0] if len(names) == 1 else "")
        if value not in names:
            raise InputError(f"{where}: the protocol has no {key} {value!r}; there are {', '.join(names)}")
        return value

    if not row.get("height") and len(p.heights) != 1:
        raise InputError(f"{where}: height is missing")
    height = length(row["height"].replace("_", " "), where) if row.get("height") else p.heights[0]
    if p.heights and complete:
        height_there = min(p.heights, key=lambda h: abs(h - height))
        if abs(height_there - height) > 1e-3:
            raise InputError(f"{where}: the protocol has no height of {height:g} m; there are {', '.join(f'{h:g} m' for h in p.heights)}")
        height = height_there
    mass = row.get("mass", "")
    if p.masses and mass not in p.masses or mass and not p.masses:
        raise InputError(f"{where}: the protocol has no mass {mass!r}; there are {', '.join(p.masses) or 'none'}")
    number = row.get("drop") or "1"
    if not number.isdigit() or not 1 <= int(number) <= p.count:
        raise InputError(f"{where}: drop {number} is none of the {p.count} of the protocol")
    spot = Spot(name("condition", p.conditions), name("position", p.positions), height, mass)
    path = folder / row["file"]
    options: dict[str, Any] = {key: row[key] for key in OPTIONS if row.get(key)}
    for flag in ("invert", "zero"):
        if flag in options:
            if options[flag] not in ("yes", "no"):
                raise InputError(f"{where}: {flag} is yes or no, not {options[flag]!r}")
            options[flag] = options[flag] == "yes"
    try:
        record = read_record(path, filter=int(p.filter), **options)
    except Error as error:
        raise InputError(f"{where}: {error}") from None
    curve = (record.time, record.deceleration)
    taken = _take_figures(p.figures, record.figures, curve)
    drop = Drop(spot, int(number), str(path), taken, str(record.verdict), "; ".join(record.verdict.remarks), curve)
    absent = [figure.label for figure in p.figures if figure.limit is not None and figure.label not in taken]
    if absent:
        raise InputError(f"{where}: a measured record has no {absent[0]}, which the protocol limits")
    return drop


def _refuse_missing(p: Protocol, folder: Path, seen: set[tuple[Spot, int]]) -> None:
    """Refuses drops that the protocol has and the folder lacks. Heights of a search are those that were measured."""
    heights = p.heights or tuple(sorted({spot.height for spot, _ in seen}))
    spots = {(Spot(c.name, q.name, h, m), k) for c in p.conditions for q in p.positions for h in heights
             for m in (p.masses or ("",)) for k in range(1, p.count + 1)}
    if not p.heights:  # each position of a search has its own heights, but all drops of each, and at least one
        spots = {(spot, k) for spot, _ in seen for k in range(1, p.count + 1)}
        empty = [(c.name, q.name) for c in p.conditions for q in p.positions
                 if not any(spot.condition == c.name and spot.position == q.name for spot, _ in seen)]
        if empty:
            raise InputError(f"{folder}: there is no drop of {', '.join(empty[0])}")
    absent = sorted(spots - seen, key=lambda entry: (str(entry[0]), entry[1]))
    if absent:
        raise InputError(f"{folder}: {len(absent)} drop{'s are' if len(absent) > 1 else ' is'} missing, first drop {absent[0][1]} at {absent[0][0]}")


def figures_of(drops: Iterable[Drop], key: str, counted: Iterable[int]) -> float:
    """Returns the mean of a figure over the counted drops; NaN unless all of them are usable."""
    wanted = set(counted)
    values = [drop.figures.get(key, math.nan) for drop in drops if drop.number in wanted and drop.is_usable]
    return float(np.mean(values)) if len(values) == len(wanted) else math.nan
