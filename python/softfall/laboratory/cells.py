# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells as numbers: decimal marks, marks of thousands, lost samples, times of day. What could be read in two ways is refused."""
from __future__ import annotations

import math
import re
from typing import Sequence

import numpy as np

from ..array import Array
from ..errors import InputError

_NUMBER = re.compile(r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?")
_GROUPS = re.compile(r"([+-]?[1-9]\d{0,2})((?:([.,])\d{3})(?:\3\d{3})*)(?:([.,])(\d*))?")
_CLOCK = re.compile(r"(?:.*[ T])?(\d{1,2}):(\d{2}):(\d{2})(?:[.,:](\d+))?(?: *([AaPp])\.?[Mm]\.?)?(?:Z|[+-]\d\d:?\d\d)?")
LOST = ("nan", "novalue", "n/a", "#n/a", "-nan", "1.#qnan")
DAY = 86400.0  # s


def is_number(cell: str) -> bool:
    """True of "1.5", "1,5" and "1e3", of "inf" and of marks of thousands."""
    return bool(_NUMBER.fullmatch(cell)) or cell.lower().lstrip("+-") in ("inf", "infinity", *LOST) or bool(_GROUPS.fullmatch(cell))


def is_clock(cell: str) -> bool:
    """True of a time of day, perhaps with its date before it."""
    return bool(_CLOCK.fullmatch(cell))


def without_thousands(cell: str, quoted: bool) -> str:
    """Returns "1,017.76" and "1.017,76" without their groups of digits; `quoted`: "1,017" is one, too, as in quotes among commas with decimal points.

    >>> without_thousands("1,017.76", False), without_thousands("1.017,76", False), without_thousands("1,017", False)
    ('1017.76', '1017,76', '1,017')
    """
    found = _GROUPS.fullmatch(cell)
    if not found:
        return cell
    first, groups, group, decimal, rest = found.groups()
    if decimal == group or (decimal is None and not (group == "," and quoted)):
        return cell
    return first + groups.replace(group, "") + (decimal + rest if decimal else "")


class Marks:
    """The decimal mark of a file, as its numbers show it one after the other."""

    def __init__(self, path: str, separator: str) -> None:
        self.path, self.separator = path, separator
        self.point = self.comma = self.decimal = False
        self.first_comma = (0, "")

    @property
    def word(self) -> str:
        """The mark in words."""
        return "comma" if self.comma else "point"

    def number(self, cell: str, line: int, name: str) -> float:
        """Returns the number of a cell; InputError names file, line and cell."""
        where = f'{self.path}:{line}: {name} "{cell}"'
        is_plain = "," not in cell and _NUMBER.fullmatch(cell)
        text = cell if is_plain else without_thousands(cell, self.separator == "," and self.point)
        if not is_plain and not _NUMBER.fullmatch(text):
            raise InputError(f"{where} is not finite" if text.lower().lstrip("+-") in ("inf", "infinity") else
                             f"{where} is not a number ({'expected a number such as 12.5' if cell else 'the cell is empty'})")
        self.point = self.point or "." in text
        if "," in text:
            self._comma(text, line, where)
        elif self.point and self.comma:
            raise InputError(f'{where} has a decimal point after numbers with a decimal comma (line {self.first_comma[0]}, "{self.first_comma[1]}")')
        value = float(text.replace(",", "."))
        if not math.isfinite(value):
            raise InputError(f"{where} is not finite")
        return value

    def _comma(self, text: str, line: int, where: str) -> None:
        if self.separator == ",":
            raise InputError(f"{where} holds a comma, which separates the columns here: write a decimal point, or separate by semicolons")
        if self.point:
            raise InputError(f"{where} has a comma where the file has decimal points: it could be a decimal comma or a mark of thousands")
        if not self.comma:
            self.comma, self.first_comma = True, (line, text)
        whole, _, rest = text.lstrip("+-").partition(",")
        self.decimal = self.decimal or whole in ("",) or whole.startswith("0") or len(whole) > 3 or not re.match(r"\d{3}(?!\d)", rest)

    def check(self) -> None:
        """Refuses a file all of whose commas could be marks of thousands."""
        if self.comma and not self.decimal:
            line, text = self.first_comma
            raise InputError(f'{self.path}:{line}: "{text}" and every other number with a comma could hold a decimal comma or a mark of thousands: write decimal points')


def clock(cells: Sequence[str], path: str, lines: Sequence[int]) -> Array:
    """Returns times of day as seconds that go on over midnight."""
    seconds = np.empty(len(cells))
    for k, cell in enumerate(cells):
        found = _CLOCK.fullmatch(cell)
        if not found:
            raise InputError(f'{path}:{lines[k]}: time "{cell}" is not a time of day as in the rows before')
        hour, minute, second, part, half = found.groups()
        hours = int(hour) % 12 + (12 if half in "pP" else 0) if half else int(hour)
        seconds[k] = 3600 * hours + 60 * int(minute) + float(f"{second}.{part or 0}")
    midnights: Array = np.cumsum(np.diff(seconds, prepend=seconds[:1]) < -DAY / 2).astype(float)
    return seconds + DAY * midnights
