# SPDX-License-Identifier: GPL-3.0-or-later
"""`softfall fit compression FIT.cfg -o DIR`: a material file from compression tests of a foam (docs/identification.md)."""
from __future__ import annotations

import argparse
import json
import warnings
from pathlib import Path
from typing import Callable

from .. import library, output as output_files, settings
from ..command import Parser, say
from ..errors import SoftfallWarning
from . import compression, compression_report as report, curve_fit, hyperfoam_fit

FILES = ("fit.csv", "fit.json", "fit.png", "report.html", "material.cfg")
STALE = ("fit.gp", "loading_curve.csv", "material.csv", *(f"material-{k}.csv" for k in range(1, 9)))  # of another kind of fit, which this one replaces


def parser(prog: str) -> Parser:
    """Returns the options of the command."""
    made = Parser(prog, "[OPTION...] FIT.cfg -o DIR", "Makes a material file from compression tests of a foam.",
                  "Writes material.cfg with its curves, report.html, fit.json, fit.png and fit.csv. docs/identification.md explains FIT.cfg.")
    made.add_argument("input", metavar="FIT.cfg", help=argparse.SUPPRESS)
    add = made.options.add_argument
    add("-o", "--output", metavar="DIR", required=True, help="write everything there (required)")
    add("-f", "--force", action="store_true", help="replace the files of an earlier fit in DIR")
    return made


def _write(folder: Path, fit: curve_fit.FormFit | hyperfoam_fit.HyperfoamFit, page: report.Page) -> None:
    given = fit.given
    summary, rows = (report.form_summary(fit), report.form_table(fit)) if isinstance(fit, curve_fit.FormFit) else (report.hyperfoam_summary(fit), report.hyperfoam_table(fit))
    output_files.write(folder / "fit.csv", output_files.table(rows))
    output_files.write(folder / "fit.json", json.dumps(summary, indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    assert fit.foam
    fit.foam.write(str(folder), "material", given.name, "\n".join([f"Identified by softfall fit compression {library.version().split()[0]} from {given.path}. ±: one standard error.", *page.lines(), ""]))


def _fit(path: str, folder: Path, tell: Callable[[str], None]) -> report.Page:
    """Fits, and writes material, tables and fit.json."""
    if compression.is_free(settings.read(path)):
        library.fit_compression(path, str(folder), True)
        return report.free_page(folder)
    given = compression.read(path)
    for test in (*given.tests, *given.predicted):
        tell(f"test {test.path}: {test.data.words}" + (f", {len(given.lateral[0])} points of lateral strain" if given.lateral else ""))
    fit: curve_fit.FormFit | hyperfoam_fit.HyperfoamFit = curve_fit.run(given) if given.form else hyperfoam_fit.run(given)
    page = report.form_page(fit) if isinstance(fit, curve_fit.FormFit) else report.hyperfoam_page(fit)
    _write(folder, fit, page)
    return page


def run(options: argparse.Namespace, tell: Callable[[str], None] = say) -> int:
    """Runs the command and returns its exit code."""
    o, folder = options, Path(options.output)
    output_files.refuse_existing(folder, FILES, o.force)
    output_files.check_all(folder, (*FILES, *STALE), settings.files(o.input))
    with output_files.scratch() as scratch:  # a failure leaves the earlier files as they are
        page = _fit(o.input, scratch, tell)
        report.write_page(page, scratch, f"softfall fit compression {library.version()}, {o.input}")
        made = sorted(scratch.iterdir(), key=lambda path: path.name == "material.cfg")
        folder.mkdir(parents=True, exist_ok=True)
        for name in STALE:
            if not (scratch / name).exists():
                (folder / name).unlink(missing_ok=True)
        for path in made:
            output_files.write(folder / path.name, path.read_bytes())
    tell("\n".join([page.title, *(line for line in page.lines() if not line.startswith("WARNING"))]))
    for doubt in page.doubts:
        warnings.warn(doubt, SoftfallWarning, stacklevel=1)
    tell(f"{report.STATES[page.kind]}: the largest rms of a branch is {100 * page.worst:.2g} % of the largest stress\nWritten: {folder}/material.cfg, report.html, fit.json, fit.png, fit.csv")
    return 0
