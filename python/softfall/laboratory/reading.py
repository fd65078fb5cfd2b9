# SPDX-License-Identifier: GPL-3.0-or-later
"""A laboratory's file as the one CSV that the programs read, and in words how it was read."""
from __future__ import annotations

import math
import os
import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Sequence

import numpy as np

from ..array import Array
from ..curves import STANDARD_GRAVITY
from ..errors import InputError, missing, path_of
from ..output import write
from .cells import LOST, Marks, is_clock
from .files import Sheet, sheets
from .headings import Column, Role, other_title
from .kinds import KINDS, PHRASES, ROLES, USUAL, Options, problem_of
from .tables import PREAMBLE, Table, choose_table, find, part_rows, rows_of, with_heading
from .times import Times, are_times_of_day, parse_rate, quantum, stated_rates, time_notes
from .units import factor, parse_scale, quantity

CLEAN = {"time": ("time_s", 1.0), "acceleration": ("acceleration_g", STANDARD_GRAVITY), "strain": ("strain", 1.0), "stress": ("stress_kPa", 1e3),
         "displacement": ("displacement_mm", 1e-3), "gap": ("displacement_mm", 1e-3), "force": ("force_N", 1.0), "lateral_strain": ("lateral_strain", 1.0), "height": ("height_m", 1.0),
         "speed": ("speed_m_s", 1.0), "static_stress": ("static_stress_kPa", 1e3), "peak": ("peak_g", STANDARD_GRAVITY)}
READ = "# softfall read "  # begins the line of a clean table that says how it was read
SEPARATOR_WORDS = {"\t": "tab", " ": "blanks"}
INVERSIONS = {"acceleration": ("acceleration",), "compression": ("strain", "stress", "both")}
_ZERO_ROW = re.compile(r"(?i)data zero.*|zero.*(?:counts?|cnts?)\)?|offset.*(?:counts?|cnts?)\)?")
_SCALE_ROW = re.compile(r"(?i)scale factor.*eu/(?:counts?|cnts?).*")
_PER_COUNT = re.compile(r"([+-]?\d+(?:\.\d*)?(?:[eE][+-]?\d+)?)\s*([^\s\d,;()/]\S{0,10}?)\s*(?:/|per)\s*(?:adc )?(?:counts?|cnts?|lsbs?|digits?|codes?)\b", re.I)


class Reading:
    """A file that was read: `kind`, `frame` (a pandas DataFrame whose headings have units) and `words`, how it was read.

    `axes` are the headings of several accelerations in the frame, of which the user has chosen none.
    """

    def __init__(self, path: str, kind: str, frame: Any, words: str, axes: Sequence[str] = ()) -> None:
        self.path, self.kind, self.frame, self.words, self.axes = path, kind, frame, words, list(axes)

    def __repr__(self) -> str:
        return f"<softfall.Reading {self.path}: {self.kind}, {len(self.frame)} rows>"

    def text(self) -> str:
        """Returns the table as the CSV that the programs read, with how it was read in a comment above it."""
        return f"{READ}{os.path.basename(self.path)}: {self.words}\n{self.frame.to_csv(index=False)}"

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Writes the table as the CSV that the programs read."""
        write(path, self.text(), self.path)
        return Path(path)


class _Reader:
    """A table while it is read."""

    def __init__(self, options: Options, kind: str, table: Table, several_tables: bool) -> None:
        self.o, self.kind, self.table, self.path = options, kind, table, table.sheet.path
        self.columns = {key: list(found) for key, found in table.choice.columns.items() if found}
        self.marks = Marks(self.path, table.separator)
        self.notes: list[str] = []
        self._take_time()
        self._take_rows(several_tables)

    # ---- rows ----

    def _take_time(self) -> None:
        """Leaves one column of time: two in different units must agree, where no acceleration stands between them."""
        times = self.columns.get("time", [])
        cells = self.table.cells(self.table.first) if self.table.first < len(self.table.sheet.lines) else []
        if times and not times[0].unit("time") and not times[0].is_exactly(ROLES["time"]):
            times = sorted(times, key=lambda column: not (column.place < len(cells) and is_clock(cells[column.place])))
        self.columns["time"] = times[:1]
        chosen = any(times and times[0].is_called(name) for name in self.o.column)
        if self.kind != "acceleration" or len(times) < 2 or chosen or self.o.specimen:
            self.rivals: list[Column] = []
            return
        values = [column.place for column in self.columns["acceleration"]]
        first = times[0]
        self.rivals = [column for column in times[1:] if column is not first and
                       not any(min(column.place, first.place) < place < max(column.place, first.place) for place in values)]

    def _take_rows(self, several_tables: bool) -> None:
        o = self.o
        needed = [column.place for found in self.columns.values() for column in found]
        leading = self.columns["time"][0] if self.columns["time"] else next(found[0] for found in self.columns.values() if found)
        rows, self.footer = rows_of(self.table, self.kind in ("acceleration", "rig"), leading.place, needed)
        rows, taken = part_rows(self.table, rows, {"specimen": None if several_tables else o.specimen, "cycle": o.cycle}, o.spell)
        sides = any(len(found) > 1 for found in self.table.choice.columns.values()) or self._side_by_side()
        if o.specimen and not (several_tables or sides or "specimen" in taken):
            raise InputError(f"{self.path} holds one specimen, not several to choose from: leave {o.spell('specimen', o.specimen)} out")
        if o.cycle and "cycle" not in taken:
            raise InputError(f"{self.path} numbers no cycles: leave {o.spell('cycle', o.cycle)} out")
        while rows and not any(place < len(rows[-1][1]) and rows[-1][1][place] for place in needed):
            rows.pop()  # a column that is shorter than others
        self.index = [k for k, (_, cells) in enumerate(rows) if not any(cells[place].lower() in LOST for place in needed if place < len(cells))]
        self.lost = len(rows) - len(self.index)
        self.lines, self.cells = [rows[k][0] for k in self.index], [rows[k][1] for k in self.index]

    def _side_by_side(self) -> bool:
        """True if the chosen quantity has other columns of its own, as of several specimens."""
        roles = [ROLES[key] for key in self.columns if key != "lateral_strain"]
        return any(sum(column.is_exactly(role) != "" or (column.holds(role.words) and column.unit(role.quantity) is not None) for column in self.table.all_columns) > 1
                   for role in roles)

    def texts(self, column: Column) -> list[str]:
        """Returns the cells of a column."""
        return [cells[column.place] for cells in self.cells]

    def numbers(self, column: Column, name: str) -> Array:
        """Returns the numbers of a column as they are written."""
        return np.array([self.marks.number(cell, line, name) for cell, line in zip(self.texts(column), self.lines)])

    # ---- quantities ----

    def scale(self, column: Column, role: Role) -> tuple[str, float, Array | float]:
        """Returns the unit of a column, its SI value, and the number that is zero."""
        exact = column.is_exactly(role)
        unit = exact or ((column.unit(role.quantity) or ("", "", 0))[1])
        given = [scale for text in self.o.scale if (scale := parse_scale(text))[0] == role.quantity]
        if unit:
            if given:
                raise InputError(f'{self.path}: "{column.heading}" is in "{unit}", which is neither volts nor counts: leave {self.o.spell("scale", self.o.scale[0])} out')
            return unit, factor(unit, role.quantity) or math.nan, 0.0
        kind = "count" if column.unit("count") else "voltage"
        raw = column.unit(kind) or ("", kind, 1.0)
        zero, value = 0.0, next((value for _, of, value in given if of == kind), None)
        if value is None and kind == "count":
            value, zero = self._stated_scale(column, role)
        if value is None:
            unit = PHRASES[role.quantity][1]
            raise InputError(f'{self.path}: "{column.heading}" is in "{raw[1]}": give the scale of the channel with '
                             + self.o.spell("scale", f"10 mV/{unit}" if kind == "voltage" and role.quantity == "acceleration" else f"0.01 {unit}/{'V' if kind == 'voltage' else 'count'}"))
        self.notes.append(f'"{column.heading}" at {value / CLEAN[role.key][1]:.6g} {CLEAN[role.key][0].rpartition("_")[2]}/{"V" if kind == "voltage" else "count"}')
        return raw[1], value * raw[2], zero

    def _stated_scale(self, column: Column, role: Role) -> tuple[float | None, float]:
        """Returns the scale of counts that the lines above the table state, and the count that is zero."""
        zero, found = 0.0, set[float]()
        for place in range(max(0, self.table.first)):  # the heading, too, which may be "Acc (0.0122 g/count)"
            row = self.table.sheet.row(place, self.table.separator)
            cell = row[column.place] if column.place < len(row) else ""
            try:
                if _ZERO_ROW.fullmatch(row[0]):
                    zero = float(cell)
                elif _SCALE_ROW.fullmatch(row[0]) and (size := factor(column.above, role.quantity)):
                    found.add(abs(float(cell)) * size)
            except ValueError:
                continue
            for number, unit in _PER_COUNT.findall(self.table.sheet.lines[place]):
                size = factor(unit, role.quantity)
                found.update({float(number) * size} if size else ())
        return (found.pop() if len(found) == 1 else None), zero

    def values(self, key: str, column: Column) -> tuple[Array, str]:
        """Returns a column in the unit of its clean heading, and its own unit and heading in words."""
        role = ROLES[key]
        unit, size, zero = self.scale(column, role)
        named = "" if column.holds(role.words) and key != "gap" else f' ("{column.heading}")'
        return (self.numbers(column, key.replace("_", " ")) - zero) * (size / CLEAN[key][1]), f"{role.label if key in ('lateral_strain', 'gap') else key} in {unit}{named}"

    # ---- time ----

    def time(self) -> tuple[Array, str]:
        """Returns the times of the samples (s), and what they are in words."""
        rate = parse_rate(self.o.rate) if self.o.rate else None
        stated = stated_rates(self.table.sheet.lines[:max(self.table.place, 0)], self.table.separator != ",")
        times = Times(self.path, self.lines, np.array(self.index, float), self.o.spell("rate", "{}"))
        if not self.columns["time"]:
            how = f"line {self.o.stated_at} states" if self.o.stated_at else "given"
            return times.by_rate(rate or 1.0), f"a sample in each row at {(rate or 1.0) / 1e3:.6g} kHz as {how}"
        column = self.columns["time"][0]
        cells = self.texts(column)
        if are_times_of_day(cells):
            return times.by_clock(cells, rate, stated), self._and("time of day", times)
        number = self.numbers(column, "time")
        unit = column.is_exactly(ROLES["time"]) or (column.unit("time") or ("", "", 0.0))[1]
        size = factor(unit, "time") if unit else None
        how = f"time in {unit}"
        if size is None and len(number) > 1:
            unit, size = times.unit_of(number, stated, rate)
            how = f"time in {unit}, which agrees with the rate of {rate or next(iter(stated), 0):g} Hz"
        if not size:
            raise InputError(f"{self.path}:{self.table.place + 1}: " + problem_of(ROLES["time"], [], [column], self.o))
        self._check_rivals(column, number * size)
        step = quantum(cells) * size if cells else 0.0
        if self.kind != "acceleration":
            return number * size, how
        return times.checked(number * size, step, rate, stated), self._and(how, times)

    def _and(self, how: str, times: Times) -> str:
        return f"{how} ({times.words})" if times.words else how

    def _check_rivals(self, column: Column, time: Array) -> None:
        for other in self.rivals:
            unit = other.unit("time")
            if unit is None or len(time) < 2 or other is column:
                continue
            span = (self.numbers(other, "time") * unit[2])
            if abs((span[-1] - span[0]) - (time[-1] - time[0])) > 0.02 * abs(time[-1] - time[0]):
                raise InputError(f'{self.path}: two time columns ("{column.heading}" and "{other.heading}") that do not agree: '
                                 f"name one with {self.o.spell('column', column.heading)}")

    # ---- the kinds ----

    def read(self) -> Reading:
        """Returns the table that was read."""
        import pandas
        if not self.cells:
            raise InputError(f"{self.path}: no row of numbers stands below the heading")
        data: dict[str, Array] = {}
        words, axes = self._acceleration(data) if self.kind == "acceleration" else (self._compression(data) if self.kind == "compression" else self._plain(data), [])
        self.marks.check()
        self._check_used()
        if "time_s" in data:
            self.notes += time_notes(data["time_s"])
        t = self.table
        first = [t.sheet.note] if t.sheet.note else [f'separator {SEPARATOR_WORDS.get(t.separator, chr(34) + t.separator + chr(34))}', f"decimal {self.marks.word}"]
        last = ([f"heading in line {t.place + 1}"] if t.place > 0 else ["with a heading that was given for it"] if t.place < 0 else []) \
            + ([f"units in line {t.units_place + 1}"] if 0 <= t.units_place != t.place + 1 else []) \
            + ([f"without what stands from line {self.footer} on"] if self.footer else []) + ([f"{self.lost} lost samples (NaN)"] if self.lost else []) + self.notes
        return Reading(self.path, self.kind, pandas.DataFrame(data), ", ".join([*first, *words, *last]), axes)

    def _check_used(self) -> None:
        """Refuses columns, scales and units that the user named, and that nothing was read by."""
        used = [column for found in self.columns.values() for column in found] + self.rivals
        for name in self.o.column:
            if not any(column.is_called(name) for column in used):
                raise InputError(f'{self.path}: the column "{name}" is not what is read ({", ".join(repr(column.heading) for column in used)}): '
                                 f"leave {self.o.spell('column', name)} out")
        quantities = {ROLES[key].quantity for key in self.columns}
        for text in self.o.scale:
            if parse_scale(text)[0] not in quantities:
                raise InputError(f"{self.path}: no column that is read takes the scale \"{text}\": leave {self.o.spell('scale', text)} out")
        beyond = [unit for unit in self.o.units[len(self.table.all_columns):] if unit]
        if beyond:
            raise InputError(f"{self.path}: {len(self.o.units)} units for {len(self.table.all_columns)} columns: leave {', '.join(beyond)} out")

    def _plain(self, data: dict[str, Array]) -> list[str]:
        words = []
        for key, found in ((key, found) for key, found in self.columns.items() if found):
            value, said = self.time() if key == "time" else self.values(key, found[0])
            data[CLEAN[key][0]] = value
            words.append(said)
        return words

    def _acceleration(self, data: dict[str, Array]) -> tuple[list[str], list[str]]:
        found = self.columns["acceleration"]
        data["time_s"], said = self.time()
        words = [said]
        names = [" ".join(re.sub(r"""[,;"'\[\](){}<>#]+""", " ", column.name).split()) or f"column {column.place + 1}" for column in found]
        names = [name if names.count(name) == 1 else f"{name} {k + 1}" for k, name in enumerate(names)]
        for name, column in zip(names, found):
            value, said = self.values("acceleration", column)
            data["acceleration_g" if len(found) == 1 else f"{name} (g)"] = 0 - value if self.o.invert else value
            words.append(said if len(found) == 1 else f'{said.partition(" (")[0]} ("{column.heading}")')
        if self.o.invert:
            words.append("acceleration inverted as asked for")
        return words, [] if len(found) == 1 or self.o.columns else names

    def _compression(self, data: dict[str, Array]) -> list[str]:
        keys = [key for key in self.columns if key not in ("time", "lateral_strain") and self.columns[key]]
        for place, line in enumerate(self.table.sheet.lines[:max(self.table.place, 0)]):
            if other := other_title(line) if not line.startswith(READ) else "":
                raise InputError(f'{self.path}:{place + 1}: "{line.strip("# ,;")[:80]}" stands above the table, and {other.lower()} is no nominal stress or strain in compression: '
                                 "if the table holds the nominal ones, leave that line out")
        words, value = [], dict[str, Array]()
        places = [self.columns[key][0].place + 1 for key in keys]
        for k, key in enumerate(keys):
            value[key], said = self.values(key, self.columns[key][0])
            words.append(said)
            if self.o.invert in (("strain", "both") if k == 0 else ("stress", "both")):
                value[key] = 0 - value[key]
                words.append(f"{key} inverted as asked for")
        first, second = keys
        if first in ("gap", "displacement"):
            way = self._way(first, value[first], value[second])
            if way is not value[first]:
                words.append(f'displacement = {value[first][0]:.6g} mm, the first gap, less "{self.columns[first][0].heading}"')
            value = {"displacement": way, second: value[second]}
        negative = {"strain" if key in ("strain", "displacement") else "stress": key for key, number in value.items() if -np.min(number) > np.max(number)}
        if negative:
            given = set(INVERSIONS["compression"][:2] if self.o.invert == "both" else [self.o.invert] if self.o.invert else [])
            wanted = given ^ set(negative)  # channels whose sign is to be changed then
            how = f"change the sign with {self.o.spell('invert', 'both' if len(wanted) == 2 else min(wanted))}" if wanted else f"leave {self.o.spell('invert', self.o.invert or '')} out"
            raise InputError(f"{self.path}: {' and '.join(negative.values())} {'is' if len(negative) == 1 else 'are'} negative; compression is positive: {how}")
        value = self._of_specimen(value, words)
        for key, number in value.items():
            data[CLEAN[key][0]] = number
        labels = [ROLES[key].label for key in reversed(value)]
        words.insert(0, f"{' over '.join(labels).replace(' in compression over', ' over')}{'' if 'strain' in value else ' in compression'}, columns {places[0]} and {places[1]}")
        if self.columns.get("lateral_strain"):
            number, said = self.values("lateral_strain", self.columns["lateral_strain"][0])
            data["lateral_strain"] = number
            words.append(f"{said} (column {self.columns['lateral_strain'][0].place + 1})")
        if self.columns["time"] and self.columns["time"][0].unit("time"):
            data["time_s"], said = self.time()
            words.append(said)
        return words

    def _way(self, key: str, way: Array, load: Array) -> Array:
        """Returns the displacement: the first gap less the gap, where that falls while the load rises."""
        top = int(np.argmax(np.abs(load)))
        falls = way[0] > 0 and way[top] < way[0] - 0.01 * abs(way[0]) and np.min(way) >= -0.02 * way[0]
        if key == "gap" and not falls:
            raise InputError(f'{self.path}: "{self.columns[key][0].heading}" does not fall from its first value while the load rises: it is no gap of the platens, '
                             "and there is no displacement")
        below: Array = way[0] - way
        return below if falls else way

    def _of_specimen(self, value: dict[str, Array], words: list[str]) -> dict[str, Array]:
        """Returns strain and stress where the user gives the specimen."""
        o = self.o
        side, width, diameter, area, thickness = (quantity(text, kind, self.path) if text else 0.0
                                                  for text, kind in ((o.side, "length"), (o.width, "length"), (o.diameter, "length"), (o.area, "area"), (o.thickness, "length")))
        if bool(side) + bool(diameter) + bool(area) > 1 or (width and not side):
            raise InputError("give side (with width, if the face is no square), diameter or area of the specimen")
        area = side * (width or side) if side else math.pi / 4 * diameter ** 2 if diameter else area
        wants = {"displacement": (thickness, "thickness"), "force": (area, "area (or side, or diameter)")}
        for size, name, key in ((thickness, "thickness", "displacement"), (area, "area", "force")):
            if size and key not in value:
                raise InputError(f"{self.path} holds {' and '.join(value)}: leave the {name} of the specimen out")
        lacking = [name for key, (size, name) in wants.items() if key in value and not size]
        if not (area or thickness):
            return value
        if lacking:
            raise InputError(f"{self.path} holds {' and '.join(value)}: give the {lacking[0]} of the specimen, too")
        words.append("over " + " and ".join([f"{1e6 * area:.6g} mm2"] * bool(area) + [f"{1e3 * thickness:.6g} mm"] * bool(thickness)))
        return {"strain": value["displacement"] / (1e3 * thickness) if thickness else value["strain"], "stress": value["force"] / (1e3 * area) if area else value["stress"]}


def _by_stated_rate(sheet: Sheet, o: Options) -> Options | None:
    """Returns the options with the only sampling rate that the file states above its numbers, of a file without times."""
    stated = stated_rates(sheet.lines[:PREAMBLE], True)
    return replace(o, rate=f"{next(iter(stated)):.9g} Hz", stated_at=next(iter(stated.values()))) if len(stated) == 1 and not o.rate else None


def _locate(sheet: Sheet, kind: str, o: Options) -> tuple[Table, bool]:
    choose = partial(KINDS[kind], o=o)
    if o.heading:
        table = with_heading(sheet, o.heading, choose, o.spell("heading", o.heading).partition(" ")[0].partition("=")[0])
    else:
        table = find(sheet, choose, o.units, bool(o.rate), o.spell("heading", "Time (ms), Acceleration (g)" if kind == "acceleration" else "Displacement (mm), Force (N)"))
        table, several = choose_table(table, choose, o.units, o.specimen, o.spell("specimen", "1"))
        return table, several
    return table, False


_OF_KIND = {"columns": ("acceleration",), "rate": ("acceleration",), "lateral": ("compression",), "side": ("compression",), "width": ("compression",),
            "diameter": ("compression",), "area": ("compression",), "thickness": ("compression",), "invert": ("acceleration", "compression")}


def _check_options(path: str, kind: str, o: Options) -> None:
    """Refuses options that the table of this kind does not use."""
    for name, kinds in _OF_KIND.items():
        value = getattr(o, name)
        if value and kind not in kinds and not (name == "rate" and o.stated_at):
            raise InputError(f"{path} is read as {kind}, where {name} has no meaning: leave {o.spell(name, ','.join(value) if isinstance(value, tuple) else value)} out")
    if o.invert and o.invert not in INVERSIONS.get(kind, ()):
        raise InputError(f"{path} is read as {kind}: leave {o.spell('invert', o.invert)} out, or give {' or '.join(INVERSIONS[kind])}")


def read(path: str | os.PathLike[str], o: Options) -> Reading:
    """Reads a laboratory's file; InputError says in one sentence why it cannot be read."""
    path = path_of(path, "a laboratory's table")
    if o.kind is not None and o.kind not in KINDS:
        raise InputError(str(missing("kind of table", o.kind, KINDS).args[0]))
    if o.invert and o.invert not in (INVERSIONS.get(o.kind or "") or sum(INVERSIONS.values(), ())):
        raise InputError(f"invert = {o.invert} is none of {', '.join(sum(INVERSIONS.values(), ()))}")
    for text in o.scale:
        parse_scale(text)
    found: list[tuple[str, Options, Table, bool]] = []
    failures: list[InputError] = []
    for sheet in sheets(path, o.sheet):
        for kind in [o.kind] if o.kind else USUAL:
            try:
                found.append((kind, o, *_locate(sheet, kind, o)))
            except InputError as error:
                other = _by_stated_rate(sheet, o) if kind == "acceleration" and "no column of time" in str(error) else None
                if other is None:
                    failures.append(error)
                else:
                    found.append((kind, other, *_locate(sheet, kind, other)))
    if not found:
        raise max(failures, key=lambda error: getattr(error, "found", 3))
    kinds, notes = [kind for kind, *_ in found], [table.sheet.note for _, _, table, _ in found]
    if len(set(kinds)) > 1:
        raise InputError(f"{path} holds an acceleration and a compression test: choose one with {o.spell('kind', kinds[0])} or {o.spell('kind', kinds[-1])}")
    if len(found) > 1:
        raise InputError(f"{path} holds several tables ({', '.join(notes)}): choose one with {o.spell('sheet', notes[0].partition(chr(34))[2].strip(chr(34)))}")
    kind, o, table, several = found[0]
    _check_options(path, kind, o)
    for name in (*o.column, *o.columns, *([o.lateral] if o.lateral else [])):
        if not any(column.is_called(name) for column in table.all_columns):
            raise InputError(f'{path}: no column is called "{name}"; there are {", ".join(repr(column.heading) for column in table.all_columns)}')
    return _Reader(o, kind, table, several).read()
