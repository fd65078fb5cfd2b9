# SPDX-License-Identifier: GPL-3.0-or-later
"""A measured record of one impact, read and judged as softfall-post does with --reference."""
from __future__ import annotations

import os
from typing import Any

import numpy as np

from . import laboratory, library
from .curves import Column, column
from .drop import Figures, Verdict
from .errors import InputError
from .library import GRADES

READ = laboratory.RECORD
JUDGED = ("filter", "impact", "invert", "zero", "speed", "range")  # options of the record


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

    `options` are those of softfall read (column="a", columns="x,y,z", heading=..., units="ms,g", scale="0.1 mV/(m/s2)", rate="20 kHz",
    specimen="2", sheet=...) and of softfall-post --reference: filter=600 or "none" (1000 by default), impact=2, invert=True, zero=True;
    speed="4.5 m/s", known at contact, and range="200 g" of the channel are what the record is judged against. A file that cannot be read as
    a record is an InputError.
    """
    unknown = next((name for name in options if name not in READ + JUDGED), None)
    if unknown:
        raise InputError(f'a record has no option "{unknown}"; there are {", ".join(READ + JUDGED)}')
    reading = laboratory.read(path, kind="acceleration", **{name: value for name, value in options.items() if name in READ})
    if reading.axes:
        raise InputError(f"{os.fspath(path)} holds {len(reading.axes)} accelerations: take one with column=\"{reading.axes[0]}\", "
                         f"or the resultant of two or three with columns=\"{','.join(reading.axes[:3])}\"")
    time, *axes = (np.ascontiguousarray(values) for values in reading.frame.to_numpy(dtype=float).T)
    texts = [name if value is True else f"{name}={value}" for name, value in options.items()
             if name in JUDGED and value is not None and value is not False]
    return Record(os.fspath(path), library.make_record(os.fspath(path), reading.words, time, axes, texts))
