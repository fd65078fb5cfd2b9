# SPDX-License-Identifier: GPL-3.0-or-later
"""The measured drops of a protocol: files of a laboratory, named by a list or by a pattern of their names."""
from __future__ import annotations

import csv
import math
import re
from pathlib import Path
from typing import Any, Iterable, Mapping

import numpy as np

from . import library
from .curves import STANDARD_GRAVITY
from .errors import Error, InputError, missing
from .output import read
from .protocol import Protocol, kilograms, length, same, speed
from .protocol_drops import Drop, Drops, Spot, take_figures
from .record import read_record

NAMED = ("condition", "position", "height", "drop", "mass", "missile", "speed")
OPTIONS = ("column", "columns", "heading", "units", "scale", "rate", "range", "sheet", "specimen", "impact", "invert", "zero")
WITH_NUMBERS = ("height", "speed", "mass", "scale", "rate", "range", "impact")  # which may have a decimal comma


def measure(p: Protocol, folder: Path, pattern: str | None = None, complete: bool = True) -> Drops:
    """Reads the measured drops of a folder: by its list.csv, or by a pattern of names such as "{position}_{height}_{drop}.csv".

    list.csv has a row for each file: file, condition, position, height, drop, mass, and options of the record (column, scale, rate, ...).
    A name that the protocol lacks, two files for one drop, a missing drop (if the test is `complete`) and a record that cannot be read are
    refused before anything is judged. Of a test that is not complete a drop may have any height.
    """
    if not folder.is_dir():
        raise InputError(f"there is no folder {folder}")
    rows = _listed(folder) if (folder / "list.csv").exists() and not pattern else _matched(folder, pattern)
    files: dict[object, str] = {}
    for where, row in rows:
        _take(files, _file(folder / row["file"]), where, f"{where}: {row['file']} is the record")
    made = Drops([_measured(p, folder, where, row, complete) for where, row in rows])
    _refuse_copies(made.drops, rows)
    seen: dict[tuple[Spot, int], str] = {}
    for drop in made.drops:
        key = (drop.spot, drop.number)
        if key in seen:
            raise InputError(f"{seen[key]} and {drop.source} are both drop {drop.number} at {drop.spot}")
        seen[key] = drop.source
    if complete:
        _refuse_missing(p, folder, set(seen))
    made.missing += [f"records have no {figure.label}" for figure in p.figures if made.drops and all(figure.label not in drop.figures for drop in made.drops)]
    _mark_exchanged(p.counted if complete else (1,), made)  # --advise learns from first drops
    _mark_others(made)
    return made


def _file(path: Path) -> object:
    """Returns what a file is known by, however its path is written."""
    try:
        state = path.stat()
        return state.st_dev, state.st_ino
    except (OSError, ValueError):  # a zero byte
        return str(path)


COPY = 1e-3  # of the peak, by which records of two drops differ at least; digits and units change copies by less


def _refuse_copies(drops: list[Drop], rows: list[tuple[str, dict[str, str]]]) -> None:
    """Refuses two records with the samples of one, also in other units, with fewer digits, shifted in time, or cut before or after the pulse."""
    curves = [tuple(np.asarray(part, float) for part in drop.curve or ((), ())) for drop in drops]
    for k, (time, value) in enumerate(curves):
        for j in range(k):
            if _is_copy(time, value, *curves[j]):
                raise InputError(f"{rows[k][0]}: {rows[k][1]['file']} holds the samples of the record of {rows[j][0]} already: each drop has a record of its own")


def _is_copy(t: Any, a: Any, s: Any, b: Any) -> bool:
    """Returns whether two curves of one sampling rate are the same about their peaks, as far as both reach."""
    if min(a.size, b.size) < 3 or not math.isclose(t[1] - t[0], s[1] - s[0], rel_tol=1e-3):
        return False
    p = int(np.argmax(a))
    for q in int(np.argmax(b)) + np.array([0, -1, 1]):  # of a flat top, rounding chooses the highest sample
        before, after = min(p, q), min(a.size - p, b.size - q)
        if 2 * (before + after) >= min(a.size, b.size) and np.max(np.abs(a[p - before:p + after] - b[q - before:q + after])) <= COPY * abs(a[p]):
            return True
    return False


def _take(known: dict[object, str], key: object, where: str, said: str) -> None:
    """Refuses a record that another row has: one drop would count as several."""
    if key in known:
        raise InputError(f"{said} of {known[key]} already: each drop has a record of its own")
    known[key] = where


ALIKE = 1.2  # factor within which drops from one height change their velocity: the rebound differs by less


def _mark_others(made: Drops) -> None:
    """Takes a record whose velocity changes otherwise than in most drops from its height as one that is not to be used."""
    groups: dict[tuple[Any, ...], list[Drop]] = {}
    for drop in made.drops:
        if drop.is_usable:
            groups.setdefault((drop.spot.condition, drop.spot.height, drop.spot.mass, drop.spot.missile), []).append(drop)
    for group in groups.values():
        changes = [_change(drop) for drop in group]
        middle = float(np.median(changes))
        for drop, change in zip(group, changes):
            if not middle / ALIKE <= change <= middle * ALIKE:
                _refuse(drop, f"its velocity changes by {change:.3g} m/s, and in the middle of the {len(group)} drops from {drop.spot.height:g} m by {middle:.3g} m/s: "
                              "another scale, or another height")


SCATTER = 0.05  # of a_max from drop to drop, relative, beyond which a lower height is not expected to be harder
MOST_FALL = 3.0  # factor of a_max between heights that are exchanged; a greater one is another unit


def _mark_exchanged(counted: tuple[int, ...], made: Drops) -> None:
    """Marks drops of one place and number whose a_max falls with the height: the two of the largest fall look exchanged.

    Nothing is decided by drops that count then. A record that another height would explain is one of those that may be exchanged.
    """
    peak = {id(drop): float(np.max(drop.curve[1])) for drop in made.drops
            if drop.curve is not None and (drop.is_usable or drop.note.startswith("do not use: its velocity changes"))}
    groups: dict[tuple[Any, ...], list[Drop]] = {}
    for drop in made.drops:
        if peak.get(id(drop), 0.0) > 0:
            spot = drop.spot
            groups.setdefault((spot.condition, spot.position, spot.mass, spot.missile, drop.number), []).append(drop)
    for group in groups.values():
        pairs = [(peak[id(low)] / peak[id(high)], low, high) for low in group for high in group
                 if low.spot.height < high.spot.height and peak[id(low)] <= MOST_FALL * peak[id(high)]]
        fall, low, high = max(pairs, key=lambda pair: pair[0], default=(0.0, None, None))
        if low is None or high is None or fall <= 1 + SCATTER:
            continue
        said = (f"drops {low.number} at {low.spot} and at {high.spot} look exchanged: a_max falls from {peak[id(low)]:.4g} to {peak[id(high)]:.4g} g "
                "where the height grows; check the heights and the files")
        made.missing.append(said)
        made.doubt = "drops look exchanged" if low.number in counted else made.doubt
        for drop, other in ((low, high), (high, low)):
            drop.note = "; ".join(part for part in (drop.note, f"looks exchanged with the drop from {other.spot.height:g} m") if part)


def _text(path: Path) -> str:
    data = read(path)
    try:
        return data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path} is not UTF-8 text: save it as CSV UTF-8, also where a spreadsheet program writes it") from None


def _listed(folder: Path) -> list[tuple[str, dict[str, str]]]:
    """Returns the rows of list.csv with their places: columns separated by semicolons, tabs or commas; decimal commas unless these separate."""
    path, heading, rows = folder / "list.csv", list[str](), []
    separator = ","
    for number, line in enumerate(_text(path).splitlines(), 1):
        if not line.strip(" \t;,") or line.lstrip().startswith("#"):
            continue
        separator = separator if heading else next((mark for mark in ";\t" if mark in line), ",")
        cells = [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
        if not heading:
            heading = _heading(path, [cell.lower() for cell in cells])
            continue
        if len(cells) > len(heading) and any(cells[len(heading):]):
            raise InputError(f"{path}:{number}: the row has {len(cells)} cells, and the heading {len(heading)}"
                             + ("; a number takes a decimal point where commas separate the columns, or separate them by semicolons" if separator == "," else ""))
        row = dict(zip(heading, cells))
        if separator != ",":
            row.update({key: re.sub(r"(?<=\d),(?=\d)", ".", row[key]) for key in WITH_NUMBERS if key in row})
        if not row.get("file"):
            raise InputError(f"{path}:{number}: file is empty")
        rows.append((f"{path}:{number}", row))
    if not heading:
        raise InputError(f"{path} is empty: it has a heading with the column file, and a row for each record")
    return rows


def _heading(path: Path, names: list[str]) -> list[str]:
    known = ("file", *NAMED, *OPTIONS)
    if len(names) > len(known):
        raise InputError(f"{path}: the heading has {len(names)} columns; there are {', '.join(known)}")
    unknown = [name for name in names if name not in known]
    double = [name for name in names if names.count(name) > 1]
    if unknown or double or "file" not in names:
        wrong = f"there is no column {unknown[0]!r}" if unknown else f"the column {double[0]} is there twice" if double else "the column file is missing"
        raise InputError(f"{path}: {wrong}; there are {', '.join(known)}")
    return names


def _matched(folder: Path, pattern: str | None) -> list[tuple[str, dict[str, str]]]:
    if not pattern:
        raise InputError(f"{folder} has no list.csv: write one (file, condition, position, height, drop), or give --pattern, a pattern of the names")
    parts = re.split(r"\{(\w+)\}", pattern)
    unknown = [name for name in parts[1::2] if name not in NAMED]
    if unknown or len(parts) < 3:
        raise InputError(f"pattern {pattern!r} " + (f"has {{{unknown[0]}}}, which is no name" if unknown else "names nothing") +
                         "; there are " + ", ".join(f"{{{name}}}" for name in NAMED))
    double = next((name for name in parts[1::2] if parts[1::2].count(name) > 1), None)
    if double:
        raise InputError(f"pattern {pattern!r} has {{{double}}} twice")
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
    if p.masses:
        mass = next((one for one in p.masses if mass and same(kilograms(mass, f"{where}: mass"), kilograms(one))), mass)
    if p.masses and mass not in p.masses or mass and not p.masses:
        raise InputError(f"{where}: " + (f"the protocol has no mass {mass!r}; there are {', '.join(p.masses)}" if p.masses else
                                         "the column mass belongs to a protocol with drops.masses, and this one has one missile"))
    number = row.get("drop") or "1"
    if not re.fullmatch("[0-9]{1,4}", number) or not 1 <= int(number) <= p.count:
        raise InputError(f"{where}: drop {number} is none of the {p.count} of the protocol")
    spot = Spot(name("condition", p.conditions), name("position", p.positions), height, mass, _missile(p, where, row.get("missile", ""), complete))
    path = folder / row["file"]
    options: dict[str, Any] = {key: row[key] for key in OPTIONS if row.get(key)}
    for flag in ("invert", "zero"):
        if flag in options:
            if options[flag] not in ("yes", "no"):
                raise InputError(f"{where}: {flag} is yes or no, not {options[flag]!r}")
            options[flag] = options[flag] == "yes"
    arrival = _speed(where, row, height)
    try:
        record = read_record(path, filter=int(p.filter), speed=f"{arrival or speed(height):.9g} m/s", **options)
    except Error as error:
        raise InputError(f"{where}: {error}") from None
    curve = (record.time, record.deceleration)
    taken = take_figures(p.figures, record.figures, curve)
    drop = Drop(spot, int(number), str(path), taken, str(record.verdict), "; ".join(record.verdict.remarks), curve)
    absent = next((figure for figure in p.figures if figure.limit is not None and figure.label not in taken), None)
    if absent and absent.key in record.figures:
        raise InputError(f"{where}: the record is shorter than the least window of {absent.label} in {p.path}, {1e3 * absent.least_window:g} ms")
    if absent:
        raise InputError(f"{p.path} limits what a measured record does not have: {missing('figure', absent.key, record.figures).args[0]}")
    drop.speed = arrival or math.nan
    drop.reading = f"{record.interpretation.rstrip('.')}; its velocity changes by {_change(drop) / (arrival or speed(height)):.2f} times that of the fall"
    return drop


SLOWEST, FASTEST = 0.7, 1.05  # of the speed of a free fall from the height, that a rig reaches


def _speed(where: str, row: Mapping[str, str], height: float) -> float:
    """Returns the measured speed (m/s) of a row; 0: it has none."""
    if not row.get("speed"):
        return 0.0
    try:
        value, unit = library.quantity(row["speed"])
    except Error as error:
        raise InputError(f'{where}: speed: {error}; expected a speed, such as "3.4 m/s"') from None
    if unit != "m s-1" or not SLOWEST * speed(height) <= value <= FASTEST * speed(height):
        raise InputError(f"{where}: speed {row['speed']} is not one of a fall from {height:g} m, which is {speed(height):.3g} m/s without friction "
                         f"({SLOWEST:g} to {FASTEST:g} times that)")
    return value


def _missile(p: Protocol, where: str, name: str, complete: bool) -> str:
    """Returns the name of another missile of a drop, "" for that of the protocol."""
    names = [other.name for other in p.others]
    if name and complete:
        raise InputError(f"{where}: missile {name!r}: a test has the missile of its protocol alone; --advise learns from others, too")
    if name and name not in names:
        raise InputError(f"{where}: the protocol has no missile {name!r} in its group advice; there are {', '.join(names) or 'none'}")
    return name


def _change(drop: Drop) -> float:
    """Returns the change of velocity (m/s) of a record."""
    time, value = (np.asarray(part, float) for part in drop.curve or ((), ()))
    return STANDARD_GRAVITY * float(np.sum(0.5 * (value[1:] + value[:-1]) * np.diff(time)))


def _refuse(drop: Drop, why: str) -> None:
    drop.grade = "do not use"
    drop.note = "; ".join(part for part in (drop.note, why) if part)


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
        more = f", and {len(absent) - 10} more" if len(absent) > 10 else ""
        raise InputError(f"{folder}: missing: " + ", ".join(f"drop {number} at {spot}" for spot, number in absent[:10]) + more)
