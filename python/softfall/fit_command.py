# SPDX-License-Identifier: GPL-3.0-or-later
"""`softfall fit FIT.cfg -o DIR`: a foam from measured drops, and what else agrees with them (docs/identification.md)."""
from __future__ import annotations

import argparse
import math
import os
from pathlib import Path
from typing import Callable

import numpy as np

from . import output as output_files, settings
from .command import Parser, say
from .errors import InputError, NumericError
from .fit import files, input as fit_input, page
from .fit.drops import Bench
from .fit.files import Study
from .fit.input import KINDS, Input
from .fit.search import Found, Problem, find

MOST_JOBS = 64
FILES = ("fit-curve.csv", "fit-drops.csv", "fit.png", "fit.json", "report.html", "posterior.csv")
STALE = ("fit.gp",)  # of softfall-fit, which this command replaces with --force


def parser(prog: str) -> Parser:
    """Returns the options of the command."""
    made = Parser(prog, "[OPTION...] FIT.cfg -o DIR", "Identifies a foam from measured drops, compression tests and cushion curves, and predicts other drops.",
                  "Writes NAME.cfg, a material for a case, with fit.json, report.html, fit.png and, of a posterior, posterior.csv and posterior/draw-001.cfg ... After an "
                  "interruption run the same command again to resume. `softfall fit compression' fits compression tests alone.")
    made.add_argument("input", metavar="FIT.cfg", nargs="+", help=argparse.SUPPRESS)
    add = made.options.add_argument
    add("-o", "--output", metavar="DIR", required=True, help="write everything there (required); drops are kept in DIR/drops.sqlite")
    add("-f", "--force", action="store_true", help="replace the files of an earlier fit in DIR; drops that are finished are used again")
    add("-j", "--jobs", metavar="N", type=int, help=f"drops side by side, {MOST_JOBS} at most (default: as many as processors); the same results")
    add("-t", "--threads", metavar="N", type=int, help=argparse.SUPPRESS)
    return made


def _begin(o: argparse.Namespace) -> tuple[Input, Path]:
    """Checks the options and reads the file of the fit."""
    names = o.input[1:] if o.input[0] == "drop" and len(o.input) > 1 else o.input
    if len(names) != 1:
        raise InputError(f"one FIT.cfg is expected, not {len(names)}: {', '.join(names)}")
    if o.jobs is not None and not 1 <= o.jobs <= MOST_JOBS:
        raise InputError(f"--jobs {o.jobs} is outside of 1 to {MOST_JOBS}")
    given, folder = fit_input.read(names[0]), Path(o.output)
    output_files.refuse_existing(folder, (*FILES, f"{given.name}.cfg"), o.force)
    curves = (f"{given.name}{end}" for end in (".cfg", ".csv", *(f"-{k}.csv" for k in range(1, 9))))
    draws = (f"posterior/{path.name}" for path in (folder / "posterior").glob("draw-*"))
    output_files.check_all(folder, (*FILES, *STALE, "drops.sqlite", *curves, *draws), settings.files(names[0]))
    return given, folder


def _fit(given: Input, bench: Bench, tell: Callable[[str], None]) -> tuple[list[Found | None], list[str]]:
    """Fits every model; one that fails is told, the others go on."""
    found: list[Found | None] = []
    failures: list[str] = []
    for number, model in enumerate(given.models, 1):
        tell(f"model {number} of {len(given.models)}: {model.label}, {len(model.unknown)} unknown parameters")
        try:
            found.append(find(Problem(given, model, bench), tell))
            failures.append("")
        except NumericError as error:
            if len(given.models) == 1:
                raise
            tell(f"  FAILED: {error}")
            found.append(None)
            failures.append(str(error))
    if not any(found):
        raise NumericError(f"none of the {len(found)} models was fitted; the first: {failures[0]}", 5)
    return found, failures


def _print(s: Study, tell: Callable[[str], None]) -> None:
    fit = s.fit
    tell(f"\n{'Converged' if fit.converged else 'NOT converged'}: {page.end(s)}")
    for k, u in enumerate(fit.problem.model.unknown):
        about = fit.problem.model.form.parameters[fit.problem.model.form.index[u.name]]
        value, low, high = (v / about.per_unit for v in fit.interval(k))
        tell(f"  {u.name:<15} {value:10.4g} {about.unit:<5} ± {100 * fit.sd_of_log()[k]:.1f} %; 95 %, linearised: {low:.4g} to {high:.4g}")
    for line in files.chain_lines(s):
        tell(f"  {line}")
    for d, drop in enumerate(s.given.drops):
        one = fit.own[d] if drop.predicted or not fit.own[d].failure else fit.fitted[d]
        told = [f"{kind.name} {one.get(kind.key):.{kind.digits + 1}f}{' ' * bool(kind.unit)}{kind.unit}" + (f" (measured {drop.value[kind.key]:.4g})" if kind.key in drop.value else "")
                for kind in KINDS if (kind.always or kind.key in drop.value) and math.isfinite(one.get(kind.key))]
        tell(f"  {drop.name:<20} {'FAILED: ' + one.failure if one.failure else '  '.join(told)}{'  predicted' if drop.predicted else ''}")
    compressions, cushions = files.tests_of(s)
    for test in compressions:
        tell(f"  {test['name']:<20} deviation {100 * test['loading_rms']:.1f} % of the largest stress in loading"
             + (f", {100 * test['unloading_rms']:.1f} % in unloading" if test["unloading_rms"] is not None else ""))
    for block in cushions:
        tell(f"  {block['name']:<20} {block['static_stress_Pa'] / 1e3:.4g} kPa: peak {block['peak_g']:.1f} g (measured {block['peak_measured_g']:.4g})")


def run(options: argparse.Namespace, tell: Callable[[str], None] = say) -> int:
    """Runs the command and returns its exit code."""
    o = options
    given, folder = _begin(o)
    tell(f"softfall fit: {len(given.models)} model{'s' * (len(given.models) > 1)}, {len(given.drops)} drops; finished drops are kept in {folder}/drops.sqlite")
    for drop in given.drops:
        if drop.curve:
            tell(f"reference {drop.curve.path}: {drop.curve.words}")
    for test in given.compressions:
        tell(f"test {test.name}: {test.words}")
    folder.mkdir(parents=True, exist_ok=True)
    with Bench(given, folder, o.jobs or min(MOST_JOBS, len(os.sched_getaffinity(0))), tell) as bench:
        found, failures = _fit(given, bench, tell)
        s = Study(given, given.path.read_text(encoding="utf-8", errors="replace"), found, failures)
        s.best = min((k for k, one in enumerate(found) if one), key=lambda k: found[k].misfit)  # type: ignore[union-attr]
        if given.posterior:
            from .fit import posterior  # with scikit-learn, which takes two seconds
            s.average = posterior.average(found, [model.label for model in given.models], failures, given.seed, tell)
            s.best = int(np.argmax(s.average.weights))
        s.simulated, s.kept, s.seconds = bench.simulated, bench.found, bench.seconds
        files.look_at_curve(s)
    files.write(s, folder)
    page.write(s, folder)
    files.write_posterior(s, folder)
    for name in STALE:
        (folder / name).unlink(missing_ok=True)
    _print(s, tell)
    for line in files.extrapolated(s):
        tell(f"  beyond the data: {line}")
    for line in s.average.warnings() if s.average else []:
        tell(f"  less sure than it looks: {line}")
    for row in s.average.page()["predictions"] if s.average else []:
        tell(f"  {row[0]:<20} {row[1]} {row[2]} (90 %: {row[3]}; 95 %: {row[4]}; of a single pad and drop: {row[5]})")
    tell(f"{s.simulated} drops simulated in {s.seconds:.0f} s of processor time, {s.kept} were there\nWritten: {folder}/{given.name}.cfg, report.html, fit.json, fit.png")
    lost = [f"{one.problem.model.label}: {one.reason}" for one in found if one and not one.converged]
    if lost:
        raise NumericError(f"{len(lost)} of {len(found)} fits did not converge ({lost[0]}): the files are written, but their values are not to be used; start nearer to the foam, or "
                           "leave out what contradicts", 5)
    return 0


