# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the table of a file begins and ends: its heading among up to 1000 lines, rows of units, several specimens or cycles, remarks below."""
from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Callable, Sequence

from ..errors import InputError
from .cells import is_clock, is_number
from .files import SEPARATORS, Sheet, split
from .headings import Column
from .units import factor

PREAMBLE, MOST_COLUMNS, MOST_PARTS = 1000, 256, 64
_UNIT_ROW = re.compile(r"(?i)(?:engineering )?(?:units?|eu|einheit(?:en)?|unités?|unidad(?:es)?|unità)\b.{0,12}")
_ABOUT_ROW = re.compile(r"(?i)(?:channel |iso channel )?(?:description|name|code)|channel location|kanalname|bezeichnung")
PARTS = {"specimen": "specimen|specimens|probe|probekörper|prüfkörper|éprouvette|probeta|provino", "cycle": "cycle|cycles|zyklus|ciclo"}
_NUMBERING = "no|nr|number|id|index|count|total|elapsed|name"


@dataclass
class Choice:
    """What a heading's columns are: the columns by the keys of roles, or why they are not enough."""

    columns: dict[str, list[Column]] = field(default_factory=dict)
    problem: str = ""
    found: int = 0  # of the two quantities that are needed, those that the heading seems to hold

    @property
    def is_good(self) -> bool:
        """True if the heading holds what is needed."""
        return self.found == 2 and not self.problem


class NotFound(InputError):
    """No heading of a kind was found; `found` of the two quantities the best one seems to hold."""

    def __init__(self, sentence: str, found: int = 0) -> None:
        super().__init__(sentence)
        self.found = found


Chooser = Callable[[Sequence[Column]], Choice]


@dataclass
class Table:
    """A table: its heading and the rows below it."""

    sheet: Sheet
    place: int  # of the heading among the lines, -1 if the user gave it
    separator: str
    width: int  # cells of the heading, without empty ones at its end
    choice: Choice
    first: int  # place of the first row
    end: int  # place behind the last row
    units_place: int = -1  # of a row of units
    all_columns: list[Column] = field(default_factory=list)

    def cells(self, place: int) -> list[str]:
        """Returns the cells of a line; empty ones beyond the heading do not count."""
        cells = list(self.sheet.row(place, self.separator))
        while len(cells) > self.width and not cells[-1]:
            cells.pop()
        return cells


def _number_at(cells: Sequence[str], place: int) -> bool:
    return place < 0 or place < len(cells) and (is_number(cells[place]) or is_clock(cells[place]))


def is_data(line: str, least: int = 2) -> str:
    """Returns the separator by which numbers begin the line, or ""."""
    for separator in SEPARATORS:
        cells = split(line, separator)
        if len(cells) >= least and all(is_number(cell) or is_clock(cell) for cell in cells[:2]) and any(map(is_number, cells[:2])):
            return separator
    return ""


def _columns(sheet: Sheet, place: int, separator: str, cells: list[str], units: Sequence[str]) -> tuple[list[Column], int, int]:
    """Returns the columns of a heading, the place of a row of units (-1: none), and that of the first row."""
    made = [Column(k, cell, given=units[k] if k < len(units) else "") for k, cell in enumerate(cells)]
    following = sheet.next_content(place)
    first, units_place = len(sheet.lines) if following is None else following, -1
    below = sheet.row(following, separator) if following is not None else []
    if any(below) and not any(map(is_number, below)) and not any(map(is_clock, below)) and len(below) <= len(cells):
        for column, cell in zip(made, below):
            column.below = cell
        units_place = first
    for k in range(max(0, place - PREAMBLE), place):
        row = sheet.row(k, separator)
        if len(row) < 2 or abs(len(row) - len(cells)) > 1:
            continue
        if _UNIT_ROW.fullmatch(row[0]):
            units_place = k
            for column, cell in zip(made[1:], row[1:]):
                column.above = cell
        elif _ABOUT_ROW.fullmatch(row[0]):
            for column, cell in zip(made[1:], row[1:]):
                column.about = f"{column.about} {cell}".strip()
    return made, units_place, first


def _try(sheet: Sheet, place: int, separator: str, choose: Chooser, units: Sequence[str], cells: list[str] | None = None) -> Table:
    """Reads a line as a heading."""
    cells = list(sheet.row(place, separator) if cells is None else cells)
    if cells and cells[0].startswith("#"):
        cells[0] = cells[0].lstrip("# ")
    while cells and not cells[-1]:
        cells.pop()
    if len(cells) > MOST_COLUMNS:
        return Table(sheet, place, separator, len(cells), Choice(problem=f"more than {MOST_COLUMNS} columns"), 0, 0)
    columns, units_place, first = _columns(sheet, place, separator, cells, units)
    choice = choose(columns)
    taken = [column for found in choice.columns.values() for column in found]
    if units_place > place and not any(factor(column.below, quantity) is not None for column in taken if column.below
                                       for quantity in ("time", "acceleration", "force", "length", "pressure", "ratio", "speed", "count", "voltage")):
        units_place = -1 if units_place > place else units_place
    if units_place > place:
        after = sheet.next_content(units_place)
        first = len(sheet.lines) if after is None else after
    width = 1 if not cells else len(cells)
    return Table(sheet, place, ";" if width == 1 else separator, width, choice, first, len(sheet.lines), units_place, columns)


def _best(sheet: Sheet, place: int, choose: Chooser, units: Sequence[str]) -> Table:
    """Returns the best heading that the line can be, by any separator."""
    line = sheet.lines[place]
    tables = [_try(sheet, place, separator, choose, units) for separator in SEPARATORS
              if separator == "," or separator in line or (separator == " " and "\t" in line)]
    return max(tables, key=lambda table: (table.choice.is_good and _is_followed(table), table.choice.found, _is_even(table), _is_followed(table), table.choice.is_good))


def _is_even(table: Table) -> bool:
    """True if the first row below has as many cells as the heading, of several."""
    return table.width > 1 and table.first < len(table.sheet.lines) and len(table.cells(table.first)) == table.width


def _needed(table: Table) -> list[int]:
    return [column.place for found in table.choice.columns.values() for column in found]


def _is_followed(table: Table) -> bool:
    """True unless the first row below is too short for the columns that were chosen, or has words there."""
    if table.first >= len(table.sheet.lines):
        return True
    cells, needed = table.cells(table.first), _needed(table)
    return len(cells) > max(needed, default=-1) and not any(cell and not re.search(r"\d", cell) and not is_number(cell) for cell in (cells[place] for place in needed))


def find(sheet: Sheet, choose: Chooser, units: Sequence[str], counted: bool, headless: str) -> Table:
    """Returns the first table whose heading is good; InputError says what is wrong with the best of the others.

    `counted`: samples are numbered or not told apart, so that one column is enough; `headless`: how the user gives a heading.
    """
    best: Table | None = None
    below_data = any_data = False
    first = place = sheet.next_content(-1)
    for _ in range(PREAMBLE):
        if place is None:
            break
        data = bool(is_data(sheet.lines[place], 1 if counted else 2))
        if data and place == first:
            comment = next((k for k in range(place - 1, -1, -1) if sheet.lines[k].lstrip().startswith("#")), -1)
            above = _best(sheet, comment, choose, units) if comment >= 0 else None
            if above and above.choice.is_good and _is_followed(above):
                return above
        if place == first and (data or is_number(sheet.lines[place].strip())):
            raise NotFound(f"{sheet.path}:{place + 1}: numbers begin here without a heading, which names the columns and their units: "
                           f"write one above them, or give it with {headless}")
        if not data:
            table = _best(sheet, place, choose, units)
            if table.choice.is_good and below_data:
                break
            if table.choice.is_good and _is_followed(table):
                return table
            if best is None or table.choice.found > best.choice.found or (table.choice.found == best.choice.found and not any_data and not _is_short(sheet.lines[place])):
                best = table
        any_data = any_data or data
        below_data = data and place + 1 < len(sheet.lines) and bool(sheet.lines[place + 1].strip())
        place = sheet.next_content(place)
    if best is None:
        raise NotFound(f"{sheet.path} is empty: it has neither a heading nor numbers")
    if best.choice.is_good:
        _check_width(best, best.first, best.cells(best.first), True, max(_needed(best)))
        raise NotFound(f"{sheet.path}:{best.first + 1}: no numbers stand below the heading", best.choice.found)
    raise NotFound(f"{sheet.path}:{best.place + 1}: {best.choice.problem}", best.choice.found)


def _is_short(line: str) -> bool:
    """True if every cell is as short as a unit."""
    return max((len(cell) for cell in re.split(r'[;\t,"]', line)), default=0) <= 6


def with_heading(sheet: Sheet, heading: str, choose: Chooser, option: str) -> Table:
    """Returns the table of a file without a heading, under the user's."""
    alone = Sheet(sheet.path, [heading])
    given = _best(alone, 0, choose, ())
    if not given.choice.is_good:
        raise InputError(f'{option} "{heading}": {given.choice.problem or "names no columns"}')
    for place in range(min(len(sheet.lines), PREAMBLE)):
        if sheet.is_empty(place):
            continue
        separator = is_data(sheet.lines[place], given.width if given.width < 2 else 2)
        if not separator:
            if _best(sheet, place, choose, ()).choice.is_good:
                raise InputError(f"{sheet.path}:{place + 1}: the file has a heading of its own: leave {option} out")
            continue
        separator = ";" if given.width == 1 else separator
        cells = split(sheet.lines[place], separator)
        while len(cells) > given.width and not cells[-1]:
            cells.pop()
        if len(cells) != given.width:
            raise InputError(f"{sheet.path}:{place + 1}: {len(cells)} values where {option} names {given.width} columns")
        return Table(sheet, -1, separator, given.width, given.choice, place, len(sheet.lines), -1, given.all_columns)
    raise InputError(f"{sheet.path}: no line begins with numbers")


def begins_with_letter(line: str) -> bool:
    """True if a letter begins the line, after a quote perhaps."""
    first = line.lstrip(' \t"')[:1]
    return first.isalpha() or first > "\x7f"


def choose_table(table: Table, choose: Chooser, units: Sequence[str], wanted: str | None, option: str) -> tuple[Table, bool]:
    """Returns the specimen's table of several one below the other, ended where the next begins, and whether there are several."""
    found, data = [table], False
    if any(len(columns) > 1 for columns in table.choice.columns.values()) or part_place(table, "specimen") >= 0:
        return table, False
    for place in range(table.first, len(table.sheet.lines)):
        line = table.sheet.lines[place]
        if data and begins_with_letter(line):
            other = _best(table.sheet, place, choose, units)
            if other.choice.is_good and _is_followed(other):
                found[-1].end = place
                found.append(other)
                data = False
                continue
        data = data or (not table.sheet.is_empty(place) and not begins_with_letter(line) and bool(is_data(line)))
    if len(found) == 1:
        return table, False
    if wanted is None:
        raise InputError(f"{table.sheet.path}:{found[1].place + 1}: another table begins here, the file holds {len(found)}: choose one with {option}")
    if not wanted.isdigit() or not 1 <= int(wanted) <= len(found):
        raise InputError(f"{table.sheet.path}: specimen {wanted} was asked for; the file holds {len(found)} tables")
    return found[int(wanted) - 1], True


def numbering(column: Column, words: str) -> bool:
    """True if the heading consists of words of the list, at least one of them, and of words that mean a number."""
    own = re.findall(r"[^\W_]+", column.heading.casefold())
    return any(word in words.split("|") for word in own) and all(word in words.split("|") + _NUMBERING.split("|") for word in own)


def same_part(cell: str, chosen: str) -> bool:
    """True of the same text, or the same number."""
    try:
        return cell == chosen or float(cell.replace(",", ".")) == float(chosen.replace(",", "."))
    except ValueError:
        return False


_DIGITS = tuple("0123456789")
Rows = list[tuple[int, list[str]]]  # numbers of lines, and their cells


def part_place(table: Table, part: str) -> int:
    """Returns the place of the column that numbers specimens or cycles, or -1."""
    return next((column.place for column in table.all_columns if numbering(column, PARTS[part]) and column.place not in _needed(table)), -1)


def part_rows(table: Table, rows: Rows, wanted: dict[str, str | None], spell: Callable[[str, str], str]) -> tuple[Rows, set[str]]:
    """Returns the rows of the specimen and cycle that the user chose where columns number them, and which of both were chosen so."""
    taken: set[str] = set()
    for part in PARTS:
        place = part_place(table, part)
        if place < 0:
            continue
        cells = [cells[place] for _, cells in rows if place < len(cells) and cells[place]]
        listed: list[str] = []
        for cell in dict.fromkeys(cells):
            if not any(same_part(cell, other) for other in listed):
                listed.append(cell)
        fractions = any(is_number(cell) and float(cell.replace(",", ".")) % 1 for cell in listed)
        if not listed or fractions or len(listed) >= MOST_PARTS or (len(rows) > 8 and 2 * len(listed) > len(rows)):
            continue  # the counter of a logger
        chosen = wanted[part]
        if chosen is None and len(listed) > 1:
            raise InputError(f"{table.sheet.path} holds the {part}s {', '.join(listed)}: choose one with {spell(part, listed[0])}")
        if chosen is not None and not any(same_part(cell, chosen) for cell in listed):
            raise InputError(f'{table.sheet.path}: {part} "{chosen}" was asked for; it holds the {part}s {", ".join(listed)}')
        if chosen is not None:
            rows = [(line, cells) for line, cells in rows if place < len(cells) and same_part(cells[place], chosen)]
            taken.add(part)
    return rows, taken


def rows_of(table: Table, ragged: bool, number_place: int, needed: Sequence[int]) -> tuple[Rows, int]:
    """Returns the lines' numbers and cells of all rows, and the line from which on remarks stand below them (0: none).

    `number_place`: the column that is a number in every row; `needed`: all columns that are read. No remark may hide data: what follows on
    one is refused.
    """
    sheet, found = table.sheet, Rows()

    def holds_point(place: int) -> bool:
        cells = table.cells(place)
        return not sheet.is_empty(place) and all(_number_at(cells, k) for k in needed)

    for place in range(table.first, table.end):
        if sheet.is_empty(place):
            continue
        cells = table.cells(place)
        if not any(cells):
            continue
        if found and cells[0][:1] not in _DIGITS and re.match(r"[^\d\s+.,-]|-+(?!\d)", cells[0]) and not _number_at(cells, number_place) and not any(map(holds_point, range(place + 1, table.end))):
            return found, place + 1
        _check_width(table, place, cells, ragged, max(needed))
        found.append((place + 1, cells))
    return found, 0


def _check_width(table: Table, place: int, cells: list[str], ragged: bool, last: int) -> None:
    if len(cells) == table.width or (ragged and last < len(cells) < table.width):
        return
    hint = " (with decimal commas, separate the columns by semicolons)" if table.separator == "," and len(cells) > table.width else ""
    raise InputError(f"{table.sheet.path}:{place + 1}: {len(cells)} values where the heading has {table.width} columns{hint}")
