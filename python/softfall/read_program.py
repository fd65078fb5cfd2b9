# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall read: turns any laboratory's file into the one CSV that the programs read, and says how it was read."""
from __future__ import annotations

import argparse
import os
import shlex
from pathlib import Path

from .command import Parser, say
from .errors import InputError
from .laboratory import options
from .laboratory.kinds import KINDS
from .laboratory.reading import READ, read
from .output import check_own

FIELDS = ("kind", "lateral", "heading", "units", "rate", "specimen", "cycle", "sheet", "side", "width", "diameter", "area", "thickness", "invert")


def parser(prog: str) -> Parser:
    """Returns the command line."""
    made = Parser(prog, "[OPTION...] FILE [-o CLEAN.csv]",
                  "Reads the file of a laboratory, whatever wrote it, says how, and writes the table\nthat softfall-post, softfall fit and `curve =` of a material read.",
                  "What could be read in two ways is refused. docs/formats.md lists what is read.")
    add = made.options.add_argument
    add("file", metavar="FILE", help=argparse.SUPPRESS)
    add("--area", metavar="AREA", help="area of the specimen, such as \"25 cm2\": force becomes stress")
    add("--column", metavar="NAME", action="append", default=[], help="heading of a column to take, where several could be; may be repeated")
    add("--columns", metavar="X,Y,Z", help="headings of two or three axes of an accelerometer (with semicolons between if a heading holds commas)")
    add("--cycle", metavar="N", help="the cycle, where a column numbers cycles")
    add("--diameter", metavar="LENGTH", help="diameter of a round specimen: force becomes stress")
    add("-f", "--force", action="store_true", help="replace CLEAN.csv")
    add("--heading", metavar="TEXT", help="heading of a file without one, such as \"Time (ms), Acceleration (g)\"")
    add("--invert", metavar="WHAT", help="change the sign of acceleration, strain (or displacement), stress (or force) or both")
    add("--kind", metavar="KIND", help=f"what the file holds: {', '.join(KINDS)} (default: acceleration or compression, as the headings say)")
    add("--lateral", metavar="NAME", help="heading of the lateral strain")
    add("-o", "--output", metavar="CLEAN.csv", help="write the table there (default: only say how the file is read)")
    add("--rate", metavar="RATE", help="sampling rate, such as \"20 kHz\", where the file has no time, or rounded times")
    add("--scale", metavar="SCALE", action="append", default=[], help="scale of a channel in volts or counts: \"10 mV/g\", \"0.0122 g/count\", \"5 kN/V\"")
    add("--sheet", metavar="NAME", help="sheet of a spreadsheet")
    add("--side", metavar="LENGTH", help="side of a square specimen, or of a rectangular one with --width: force becomes stress")
    add("--specimen", metavar="N", help="the specimen of a file that holds several")
    add("--thickness", metavar="LENGTH", help="thickness of the specimen: displacement becomes strain")
    add("--units", metavar="A,B,...", help="units of the columns from left to right, where the headings have none: \"ms,g\"")
    add("--width", metavar="LENGTH", help="other side of a rectangular specimen")
    return made


def perform(o: argparse.Namespace) -> str:
    """Reads the file; returns what is printed."""
    given = {name: getattr(o, name) for name in FIELDS}
    reading = read(o.file, options({**given, "column": tuple(o.column), "columns": o.columns, "scale": tuple(o.scale)}))
    said = [f"{reading.kind} of {o.file}: {reading.words}"]
    if reading.axes:
        joined = shlex.quote(",".join(reading.axes[:3]))
        said.append(f"it holds {len(reading.axes)} accelerations: softfall-post takes one with --reference-column={shlex.quote(reading.axes[0])}, "
                    f"or the resultant of axes with --reference-columns={joined}")
    span = reading.frame.min().to_numpy(), reading.frame.max().to_numpy()
    said.append(f"{len(reading.frame)} rows, " + "; ".join(f"{name} from {low:.6g} to {high:.6g}" for name, low, high in zip(reading.frame.columns, *span)))
    if o.output:
        path = Path(o.output)
        if path.exists() and (os.path.samefile(path, o.file) or not o.force):
            raise InputError(f"{path} is the file that is read: give another name" if os.path.samefile(path, o.file) else
                             f"{path} is there already: give --force to replace it, or another name")
        check_own(path, READ.encode(), "softfall read")
        reading.write(path)
        said.append(f"Written: {path}")
    return "\n".join(said)


def run(o: argparse.Namespace) -> int:
    """Reads a file and returns the exit code."""
    say(perform(o))
    return 0
