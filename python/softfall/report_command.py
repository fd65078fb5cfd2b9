# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall report: the page of a drop, or of several that are compared, from the output of softfall-post."""
from __future__ import annotations

import argparse
from pathlib import Path

from . import report
from .command import Parser, say
from .errors import InputError


def parser(prog: str) -> Parser:
    """Returns the command line."""
    made = Parser(prog, "[OPTION...] DIR", "Makes report.html in DIR, one page to read, print or hand on: verdict, curves, pad,\nchecks, case, figures and provenance.",
                  "DIR is the output of softfall-post, also of `softfall-post compare' and `series',\nor a folder of `softfall run'. What is missing or of another run is told in the page.\n\n"
                  "Example:\n  softfall-post results.h5 -o out && softfall report out")
    made.add_argument("folder", metavar="DIR", help=argparse.SUPPRESS)
    return made


def run(o: argparse.Namespace) -> int:
    """Makes the page and returns the exit code."""
    folder = Path(o.folder)
    if not folder.is_dir():
        raise InputError(f"{folder} is no folder: give the output of softfall-post, which `softfall-post RESULTS.h5 -o DIR' makes")
    if not any((folder / name).exists() for name in ("summary.json", "compare.json")) and (folder / "out/summary.json").exists():
        folder /= "out"
    say(f"Written: {report.write(folder)}")
    return 0
