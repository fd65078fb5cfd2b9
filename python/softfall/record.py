# SPDX-License-Identifier: GPL-3.0-or-later
"""A measured record of one impact, read and judged as softfall-post does with --reference."""
from __future__ import annotations

import os
from typing import Any

from . import library
from .curves import Column, column
from .drop import Figures, Verdict

GRADES = ("valid", "valid with remarks", "do not use")


class Record:
    """A record: `time` (s, on the clock of the file), `deceleration` (g, filtered), `figures` by the keys of summary.json, `verdict`
    ("valid", "valid with remarks" or "do not use", with `remarks`), and `interpretation`, how the file was read."""

    def __init__(self, path: str, parts: library.RecordParts) -> None:
        self.path = path
        self.time: Column = column(parts.time, "s", "time on the clock of the file")
        self.deceleration: Column = column(parts.deceleration, "g", "deceleration of the missile, filtered")
        self.figures = Figures(parts.figures)
        self.verdict = Verdict(GRADES[parts.grade])
        self.verdict.remarks = [] if parts.grade == 0 else [parts.verdict]
        self.interpretation = parts.interpretation

    def __repr__(self) -> str:
        return f"<softfall.Record {self.path}: {self.verdict}>"


def read_record(path: str | os.PathLike[str], **options: Any) -> Record:
    """Reads a measured curve from a file of a laboratory (docs/formats.md) and judges it.

    `options` are those of softfall-post --reference: filter=600 or "none" (1000 by default), column="a", columns="x,y,z", heading=...,
    scale="0.1 mV/(m/s2)", rate="20 kHz", impact=2, invert=True, zero=True. A file that cannot be read as a record is an InputError.
    """
    texts = [name if value is True else f"{name}={value}" for name, value in options.items() if value is not None and value is not False]
    return Record(os.fspath(path), library.read_record(os.fspath(path), texts))
