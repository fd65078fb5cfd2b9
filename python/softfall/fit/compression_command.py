# SPDX-License-Identifier: GPL-3.0-or-later
"""`softfall fit compression FIT.cfg -o DIR`: a material file from compression tests of a foam (docs/identification.md)."""
from __future__ import annotations

import argparse
import csv
import io
import json
import warnings
from pathlib import Path
from typing import Callable

from .. import library, output as output_files, programs, settings
from ..command import Parser, say
from ..errors import InputError, SoftfallWarning
from . import compression, compression_report as report, curve_fit, hyperfoam_fit

FILES = ("fit.csv", "fit.json", "fit.png", "report.html", "material.cfg")
STALE = ("fit.gp", "loading_curve.csv", *(f"material-{k}.csv" for k in range(1, 9)))  # of another kind of fit, which this one replaces


def parser(prog: str) -> Parser:
    """Returns the options of the command."""
    made = Parser(prog, "[OPTION...] FIT.cfg -o DIR", "Makes a material file from compression tests of a foam.",
                  "Writes material.cfg with its curves, report.html, fit.json, fit.png and fit.csv. docs/identification.md explains FIT.cfg.")
    made.add_argument("input", metavar="FIT.cfg", help=argparse.SUPPRESS)
    add = made.options.add_argument
    add("-o", "--output", metavar="DIR", required=True, help="write everything there (required)")
    add("-f", "--force", action="store_true", help="replace the files of an earlier fit in DIR")
    return made


def _free(o: argparse.Namespace, tell: Callable[[str], None]) -> report.Page:
    """Runs softfall-fit, which fits the free curve."""
    said = programs.run("fit", ["compression", o.input, f"--output={o.output}", *(["--force"] if o.force else [])])
    tell(said.rstrip("\n"))
    return report.free_page(Path(o.output))


def _write(o: argparse.Namespace, fit: curve_fit.FormFit | hyperfoam_fit.HyperfoamFit, lines: list[str], tell: Callable[[str], None]) -> None:
    folder, is_form = Path(o.output), isinstance(fit, curve_fit.FormFit)
    folder.mkdir(parents=True, exist_ok=True)
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(report.form_table(fit) if isinstance(fit, curve_fit.FormFit) else report.hyperfoam_table(fit))
    summary = report.form_summary(fit) if isinstance(fit, curve_fit.FormFit) else report.hyperfoam_summary(fit)
    output_files.write(folder / "fit.csv", stream.getvalue())
    output_files.write(folder / "fit.json", json.dumps(summary, indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    for name in STALE if is_form else (*STALE, "material.csv"):
        (folder / name).unlink(missing_ok=True)
    sources = [f"  {test.path} at {test.rate:.6g} 1/s, to a strain of {test.data.largest_strain:.4g}" for test in fit.given.tests]
    assert fit.foam
    fit.foam.write(str(folder), "material", fit.given.name, "\n".join([f"Identified by softfall fit compression {library.version().split()[0]} from", *sources, *lines,
                                                                       f"Beyond the strain {fit.given.informed:.4g} and at other rates it is extrapolation. ±: one standard error.", ""]))
    tell("\n".join([f"{fit.given.name}: " + (summary["curve_form"] if is_form else f"hyperfoam of {len(fit.terms)} terms"), *lines]))  # type: ignore[union-attr]


def run(options: argparse.Namespace, tell: Callable[[str], None] = say) -> int:
    """Runs the command and returns its exit code."""
    o, folder = options, Path(options.output)
    if compression.is_free(settings.read(o.input)):
        page = _free(o, tell)
    else:
        there = [name for name in FILES if (folder / name).exists()]
        if there and not o.force:
            raise InputError(f"{folder} already holds {there[0]}: give another directory, or --force to replace it")
        given = compression.read(o.input)
        for test in (*given.tests, *given.predicted):
            tell(f"test {test.path}: {test.data.words}" + (f", {len(given.lateral[0])} points of lateral strain" if given.lateral else ""))
        for line in report.offers(given.tests if not given.cycles else []):
            tell(line)
        if given.form:
            form = curve_fit.run(given)
            _write(o, form, report.form_lines(form), tell)
            page = report.form_page(form)
        else:
            terms = hyperfoam_fit.run(given)
            _write(o, terms, report.hyperfoam_lines(terms), tell)
            page = report.hyperfoam_page(terms)
        doubts = ([report.POOR_FORM] if given.form and page.worst > curve_fit.POOR else []) + page.doubts
        for doubt in doubts:
            warnings.warn(doubt, SoftfallWarning, stacklevel=1)
    report.write_page(page, folder, f"softfall fit compression {library.version()}, {o.input}")
    tell(f"{report.STATES[page.kind]}: the largest rms of a branch is {100 * page.worst:.2g} % of the largest stress\nWritten: {folder}/material.cfg, report.html, fit.json, fit.png, fit.csv")
    return 0
