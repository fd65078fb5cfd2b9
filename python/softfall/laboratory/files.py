# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines of a laboratory's file: text in its encodings, compressed, ISO-MME, a spreadsheet or a MATLAB file."""
from __future__ import annotations

import csv
import gzip
import io
import re
import unicodedata
import zlib
from typing import Any

import numpy as np

from ..errors import Error, InputError
from ..output import read
from .cells import LOST

MOST_BYTES = 1 << 30
SEPARATORS = (";", "\t", ",", " ")


class Sheet:
    """The lines of one table of a file, as text; `note` tells what was done to get them."""

    def __init__(self, path: str, lines: list[str], note: str = "") -> None:
        self.path, self.lines, self.note = path, lines, note
        self._split: dict[str, dict[int, list[str]]] = {}

    def is_empty(self, place: int) -> bool:
        """True of a line without content, and of a comment."""
        line = self.lines[place].lstrip(" \t")
        return not line or line.startswith("#")

    def next_content(self, place: int) -> int | None:
        """Returns the place of the next line with content after this one."""
        return next((k for k in range(place + 1, len(self.lines)) if not self.is_empty(k)), None)

    def row(self, place: int, separator: str) -> list[str]:
        """Returns the cells of a line; few lines of a long file are looked at by every separator."""
        known = self._split.setdefault(separator, {})
        if place not in known:
            known[place] = split(self.lines[place], separator)
        return known[place]


def split(line: str, separator: str) -> list[str]:
    """Returns the cells of a line, without blanks and quotes around them; " " stands for runs of blanks.

    >>> split('"Time, s" , 1', ","), split("t / ms   a [g]", " ")
    (['Time, s', '1'], ['t / ms', 'a [g]'])
    """
    if separator == " ":
        cells: list[str] = []
        for cell in line.split():
            if cells and (cell[0] in "([/" or cells[-1][-1] == "/"):  # a unit belongs to the cell before it
                cells[-1] += " " + cell
            else:
                cells.append(cell)
        return [cell.strip('"').strip() for cell in cells]
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    try:
        found = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [""])
    except csv.Error:
        found = line.split(separator)
    return [cell.strip().strip('"').strip() for cell in found]


def _bytes(path: str) -> bytes:
    try:
        data = read(path, MOST_BYTES)
        if data[:2] == b"\x1f\x8b":
            with gzip.open(io.BytesIO(data)) as stream:
                data = stream.read(MOST_BYTES)
        return data
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise InputError(f"{path} is compressed, and damaged: {error}") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None


def _text(path: str, data: bytes) -> str:
    """Returns the text; a line that is not UTF-8 is taken for Latin-1."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        try:
            return data.decode("utf-16")
        except UnicodeDecodeError:
            raise InputError(f"{path} begins like UTF-16, but is not: save it as CSV UTF-8") from None
    if b"\0" in data:
        raise InputError(f"{path} holds zero bytes: it is not a text in UTF-8 (save it as CSV UTF-8)")
    data = data.removeprefix(b"\xef\xbb\xbf")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return "\n".join(_line(line) for line in re.split(b"\r\n|\r|\n", data))


def _line(line: bytes) -> str:
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")


def sheets(path: str, sheet: str | None = None) -> list[Sheet]:
    """Returns the tables of a file, one but for a spreadsheet; InputError if there are none."""
    data = _bytes(path)
    if data[:4] == b"PK\x03\x04":
        return _spreadsheet(path, data, sheet)
    if sheet is not None:
        raise InputError(f"{path} is no spreadsheet: leave the sheet {sheet!r} out")
    if data[:6] == b"MATLAB":
        return [_matlab(path, data)]
    lines = _whole(re.split("\r\n|\r|\n", unicodedata.normalize("NFC", _text(path, data))))
    _check_width(path, lines)
    if lines[0].lower().startswith("test object number"):
        return [Sheet(path, _iso_mme(path, lines), "a channel in ISO-MME")]
    return [Sheet(path, lines)]


MOST_COLUMNS = 5000


def _check_width(path: str, lines: list[str]) -> None:
    """Refuses a line of more columns than a file of a laboratory has."""
    for k, line in enumerate(lines, 1):
        most = max(line.count(mark) for mark in SEPARATORS[:3]) + 1 if len(line) > MOST_COLUMNS else 0
        if most > MOST_COLUMNS:
            raise InputError(f"{path}:{k}: the line has {most} columns; a file of a laboratory has {MOST_COLUMNS} at most")


def _whole(lines: list[str]) -> list[str]:
    """Returns the lines with headings that a spreadsheet broke within quotes in one line."""
    for k in range(min(len(lines), 100)):
        end = next((j for j in range(k + 1, min(len(lines), k + 20)) if lines[j].count('"') % 2), 0)
        if lines[k].count('"') % 2 and end:
            lines[k:end + 1] = ["#"] * (end - k) + [" ".join(lines[k:end + 1])]
    return lines


def _iso_mme(path: str, lines: list[str]) -> list[str]:
    """Returns a channel in ISO-MME (ISO/TS 13499: lines "key :value", then a sample a line) as a table of time and channel in the same lines."""
    said: dict[str, str] = {}
    for line in lines:
        key, colon, value = line.partition(":")
        if colon:
            said.setdefault(key.strip().lower(), value.strip())
    samples = [k for k, line in enumerate(lines) if line.strip() and ":" not in line]
    try:
        step, first, count = float(said.get("sampling interval", "nan")), float(said.get("time of first sample", "0")), float(said.get("number of samples", "nan"))
    except ValueError:
        step = first = count = np.nan
    unit = said.get("unit", "")
    if not step > 0 or not unit or count != len(samples):
        raise InputError(f'{path}: its ISO-MME header gives a sampling interval of {step:g} s, the unit "{unit}" and {count:g} samples; it holds {len(samples)} samples')
    name = re.sub(r"[;()\[\]<>,/]", " ", said.get("name of the channel", "channel"))
    made = ["#"] * len(lines)
    made[samples[0] - 1] = f"Time (s);{name} ({unit})"
    for k, place in enumerate(samples):
        cell = lines[place].strip()
        made[place] = f"{first + k * step:.9g};{'NaN' if cell.lower() in LOST else cell}"
    return made


def _cell(value: Any) -> str:
    if value is None or value != value:
        return ""
    text = value.isoformat(sep=" ") if hasattr(value, "hour") and hasattr(value, "year") else str(value)
    return re.sub(r"\s+", " ", text)


def _spreadsheet(path: str, data: bytes, wanted: str | None) -> list[Sheet]:
    import pandas
    try:
        read = pandas.read_excel(io.BytesIO(data), sheet_name=None, header=None, dtype=object, engine="openpyxl")
    except ImportError:
        raise Error(f"{path} is a spreadsheet, which needs the package python3-openpyxl: install it, or save the sheet as CSV", 3) from None
    except Exception as error:  # openpyxl raises whatever its parsers do
        raise InputError(f"{path} cannot be read as a spreadsheet: {error}") from None
    if wanted is not None and wanted not in read:
        raise InputError(f"{path} has no sheet {wanted!r}; there are {', '.join(map(repr, read))}")
    return [Sheet(path, ["\t".join(map(_cell, row)) for row in frame.values.tolist()], f'sheet "{name}"')
            for name, frame in read.items() if wanted in (None, name)]


def _matlab(path: str, data: bytes) -> Sheet:
    """Returns the vectors of one length of a MATLAB file as columns with the names of the variables, a matrix as columns without names."""
    import scipy.io
    try:
        read = scipy.io.loadmat(io.BytesIO(data))
    except Exception as error:  # a damaged file fails in many ways
        raise InputError(f"{path} cannot be read as a MATLAB file: {error}") from None
    arrays = {name: np.atleast_2d(value).T if np.shape(value)[0] == 1 else value for name, value in read.items()
              if not name.startswith("__") and isinstance(value, np.ndarray) and value.ndim == 2 and value.dtype.kind in "iuf" and value.size > 1}
    longest = max((len(value) for value in arrays.values()), default=0)
    taken = {name: value for name, value in arrays.items() if len(value) == longest}
    if not taken:
        raise InputError(f"{path} holds no vectors of numbers")
    named = all(value.shape[1] == 1 for value in taken.values())
    rows = np.hstack(list(taken.values())).tolist()
    return Sheet(path, ([ "\t".join(taken)] if named else []) + ["\t".join(map(repr, row)) for row in rows], f"the variables {', '.join(taken)}")
