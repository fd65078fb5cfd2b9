# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall run: one drop from the case to the report, kept by content."""
from __future__ import annotations

import argparse
import contextlib
import os
import re
import signal
import sys
import warnings
from pathlib import Path
from typing import Any, Callable

from . import library
from .case import RUNS, Case, Step, example, locked
from .command import Parser
from .drop import Drop
from .errors import Error, InputError, NumericError
from .progress import Bar, DropProgress
from .run_keys import listed, resolve, split

STRICT = {"valid": 0, "valid with remarks": 8, "do not use": 9}  # exit codes with --strict, those of softfall-post
MOST_REMARKS = 3
NAMES = {"a_max_g": ("a_max", "g"), "hic": ("HIC", "")}


class _Parser(Parser):
    """Options may stand between the case and its values."""

    def parse_args(self, arguments: Any = None, namespace: Any = None) -> Any:
        return super().parse_args(arguments, namespace) if {"-V", "--version"} & set(arguments) else self.parse_intermixed_args(arguments, namespace)


def parser(prog: str) -> Parser:
    """Returns the command line."""
    made = _Parser(prog, "[OPTION...] [CASE] [KEY=VALUE...]",
                   "Runs a drop: mesh, solution, figures, report. Prints the verdict and where the\npage is. A drop that is there already is not computed again.",
                   "CASE is a case file, a folder with a case.cfg (default: that of the present one),\nor the name of an example. KEY may be short: thickness=60 finds "
                   "geometry.parameters.thickness.\nheight=\"1.3 m\" sets the speed of a free fall, or with rig=PAIRS.csv of that on a rig.\n\nExample:\n"
                   "  softfall run case.cfg thickness=60 height=\"1.3 m\"\n\n"
                   "Exit code: 0, also if limits are exceeded; 2 a wrong input, 3 a file, 4 the model,\n5 the solution failed, 130 interrupted; with --strict 8 and 9.")
    add = made.options.add_argument
    made.add_argument("arguments", metavar="CASE", nargs="*", help=argparse.SUPPRESS)
    add("--keys", action="store_true", help="list the keys of the case with their values, and end")
    add("-o", "--output", metavar="DIR", default=RUNS, help=f"keep the drops below DIR, each in a folder of its own (default: {RUNS}); DIR/latest is the last one")
    add("-q", "--quiet", action="store_true", help="show no progress")
    add("--strict", action="store_true", help="exit code 8 if the verdict is \"valid with remarks\", 9 if it is \"do not use\"")
    add("-t", "--threads", metavar="N", type=int, help="threads of the solver (default: all processors)")
    return made


def find_case(arguments: list[str]) -> tuple[Case, list[str]]:
    """Returns the case of a command line, and the texts after it."""
    if "" in arguments:
        raise InputError("CASE is empty: give a case file, a folder with a case.cfg, or the name of an example")
    named = bool(arguments) and "=" not in arguments[0]
    name, rest = (arguments[0], arguments[1:]) if named else ("case.cfg", arguments)
    path = Path(name) / "case.cfg" if Path(name).is_dir() else Path(name)
    if path.exists() or "/" in name or name.endswith(".cfg"):
        if not named and not path.exists():
            raise InputError("give a case: there is no case.cfg here; `softfall new pad` makes one")
        return Case(path), rest
    try:
        return example(name), rest
    except KeyError as error:
        raise InputError(f"there is no file {name}, and {error.args[0]}") from None


def _shown(path: Path) -> str:
    """Returns a path as short as it can be typed here."""
    near = os.path.relpath(path)
    return near if not near.startswith("../..") else str(path)


def _limit(limit: dict[str, Any]) -> str:
    name, unit = NAMES.get(limit["key"], (limit["key"], ""))
    value, bound = (f"{limit[key]:.4g} {unit}".strip() if limit[key] is not None else "not defined" for key in ("value", "bound"))
    compared = {True: "below", False: "ABOVE", None: "not comparable with"}[limit["passed"]]
    return f"  {name:<6} {value:<9} {compared} the limit of {bound}"


def summarise(drop: Drop, name: str = "") -> list[str]:
    """Returns what is printed of a drop: the verdict, the figures, the remarks, the page."""
    verdict, figures = drop.verdict, drop.figures
    said = [f"Verdict{name}: {verdict}"]
    if figures["prescribed_motion"]:
        said.append(f"  peak stress {figures['peak_stress_kPa']:.4g} kPa, peak force {figures['peak_force_N']:.4g} N")
    else:
        said += [_limit(limit) for limit in verdict.limits]
    said += [f"  remark: {remark}" for remark in verdict.remarks[:MOST_REMARKS]]
    if len(verdict.remarks) > MOST_REMARKS:
        said.append(f"  and {len(verdict.remarks) - MOST_REMARKS} more remarks in the report")
    view = drop.report().with_name("view.html")
    return [*said, f"  page   {_shown(drop.report())}" + (f", in 3-D {view.name} beside it" if view.exists() else "")]


def _link(drop: Drop, runs: Path) -> None:
    """Makes `latest` in the folder of the drops lead to this one."""
    link, new = runs / "latest", runs / f".latest-{os.getpid()}"
    if link.is_symlink() or not link.exists():
        new.symlink_to(drop.results.parent.name)
        new.replace(link)


def simulate(case: Case, output: str, threads: int | None, bar: Bar, watch: Callable[[Step], object] | None = None) -> Drop:
    """Runs the drop and makes its figures and pages; of one that failed, too, before the NumericError goes on. `watch` is called with its steps."""
    free = case["missile.motion"] is None
    drops = case["series.drops"] if isinstance(case["series.drops"], int) else 1
    progress = None
    made = DropProgress(bar, library.quantity(str(case["solver.end_time"]))[0], drops, free)
    try:
        drop = case.find(output)
        if drop is None:
            progress = made
            progress.begin()
            drop = case.run(threads, lambda step: [tell(step) for tell in (made, watch) if tell], runs=output)
    except NumericError as error:
        if error.results:
            with contextlib.suppress(Error):  # of too few rows nothing is made; the failure is what counts
                _finish(failed_drop(error.results), progress, Path(output), bar)
        raise
    _finish(drop, progress, Path(output), bar)
    return drop


def failed_drop(results: str) -> Drop:
    """Returns the drop of the results so far of a solution that failed."""
    return Drop(results, Path(results).with_name("out"), own=True)


def _finish(drop: Drop, progress: DropProgress | None, runs: Path, bar: Bar) -> None:
    """Makes the figures and pages of a drop, or of all of its series."""
    with locked(drop.results.parent):
        if progress:
            progress.figures()
        for each in drop.series:
            each.report()
        _link(drop, runs)
    bar.clear()


def perform(o: argparse.Namespace) -> tuple[str, int]:
    """Runs the command; returns what is printed at the end, and the exit code."""
    case, rest = find_case(o.arguments)
    if o.keys:
        return "\n".join(listed(case)), 0
    values, said = resolve(case, split(rest))
    try:
        case.update(values)
    except InputError as error:
        raise InputError(re.sub(r"^--set (?:(\S+?)=.*?: (?=\1))?", "", str(error), flags=re.DOTALL)) from None
    if said and not o.quiet:
        print("\n".join(said), flush=True)
    bar = Bar(quiet=o.quiet)

    told: set[str] = set()

    def tell(message: Any, *_: Any, **__: Any) -> None:
        sentence = re.sub(r"^softfall-\w+: ", "", str(message))  # softfall-post repeats what softfall-solve said
        if sentence not in told:
            bar.clear()
            print(f"softfall run: warning: {sentence}", file=sys.stderr)
        told.add(sentence)

    warnings.showwarning = tell
    try:
        drop = simulate(case, o.output, o.threads, bar)
    except NumericError as error:
        if error.results:
            bar.clear()
            with contextlib.suppress(Error):
                print("\n".join(summarise(failed_drop(error.results))))
        raise
    finally:
        bar.clear()
    series = drop.series
    lines = [line for number, each in enumerate(series, 1) for line in summarise(each, f", drop {number} of {len(series)}" if len(series) > 1 else "")]
    code = max(STRICT[each.verdict] for each in series) if o.strict else 0
    return "\n".join([*lines, "These figures are indicative, not a certification."]), code


def run(o: argparse.Namespace) -> int:
    """Runs a drop and returns the exit code."""
    if o.threads is not None and o.threads < 1:
        raise InputError(f"--threads={o.threads} is not a number from 1 on")

    def end(*_: Any) -> None:
        raise KeyboardInterrupt

    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, end)
    text, code = perform(o)
    print(text)
    return code
