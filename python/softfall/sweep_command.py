# SPDX-License-Identifier: GPL-3.0-or-later
"""`softfall sweep PLAN.cfg -o DIR`: a drop for each row of a plan, in memory, with the statistics and the report about them."""
from __future__ import annotations

import argparse
import contextlib
import json
import math
import shlex
import sys
import warnings
from pathlib import Path
from typing import Any, Callable, Iterator, Sequence

import numpy as np

from . import effects, library, memory, output as output_files, rows_command, sweep_page
from .array import Array
from .campaign import ANVIL, REFINED, Campaign, Table, estimate
from .case import Case
from .command import Parser, add_jobs, jobs_of, say
from .drop import read_results
from .effects import Statements
from .errors import Error, InputError, NumericError, SoftfallWarning
from .library import GRADES
from .plan import Limit, Plan
from .progress import duration
from .store import NAME

MOST_VIEWS, TABLE_ROWS = 50, 10
OUTPUT = ("report.html", "sweep.json", "drops.csv", *(f"{name}.png" for name in sweep_page.PICTURES))
CAUTION = "Figures of simulated drops: indicative, not a certification."


def parser(prog: str) -> Parser:
    """Returns the options of the command."""
    made = Parser(prog, "[OPTION...] PLAN.cfg -o DIR", "Simulates a case for many values of its keys.",
                  "Writes runs.csv, sweep.json, pictures and report.html. After an interruption run the same command again to resume; two at a time share the work. "
                  "docs/campaigns.md explains plans. Figures are indicative, not a certification.")
    made.add_argument("plan", metavar="PLAN.cfg", help=argparse.SUPPRESS)
    add = made.options.add_argument
    add("-o", "--output", metavar="DIR", required=True, help="write everything there (required); drops are kept in DIR/drops.sqlite")
    add("-f", "--force", action="store_true", help="replace the files of an earlier command in DIR; drops that are finished are used again")
    add("--dry-run", action="store_true", help="print the table and what it will take, and end")
    add("-y", "--yes", action="store_true", help="take a plan of more than 20,000 runs")
    add("--views", metavar="RUNS", help="afterwards simulate some runs with all fields, and link their report.html and view.html: worst, limit (nearest to it), all, or "
                                        "ids, with commas between them")
    add("--engine", metavar="NAME", default="local", help="what runs the drops: local (default) or snakemake, in jobs of a block of rows each")
    add("--profile", metavar="PROFILE", help="with --engine snakemake: a profile of Snakemake; slurm: the one that comes with softfall")
    add("--per-job", metavar="N", type=int, help="with --engine snakemake: rows of a job (default: as many as take three minutes)")
    add_jobs(made)
    return made


def run(options: argparse.Namespace, tell: Callable[[str], None] = say, command: str = "") -> int:
    """Runs the command and returns its exit code. `command`: what was called, for the report, if it was not the command line."""
    jobs = jobs_of(options)
    if options.per_job is not None and options.per_job < 1:
        raise InputError(f"--per-job {options.per_job} is below 1")
    rows_command.check_engine(options.engine, options.profile, options.per_job)
    memory.hold_units()
    folder, plan = Path(options.output), Plan(options.plan, options.yes)
    if options.views is not None:
        choose_views(options.views, plan.figures, plan.rows)
    _check_folder(folder, plan, options)
    plan.check()
    if plan.refine:
        plan.check(coarse=True)
    campaign = Campaign(plan, folder, options.retry, tell)
    if (folder / NAME).exists():
        campaign.open()
    try:
        return _run(campaign, options, jobs, command or shlex.join(["softfall", *sys.argv[1:]]))
    finally:
        campaign.close()


def _run(campaign: Campaign, options: argparse.Namespace, jobs: int, command: str) -> int:
    plan, folder = campaign.plan, campaign.folder
    _print_table(plan, campaign.tell)
    seconds, basis = estimate(plan, campaign.store, options.dry_run)
    if plan.rows > plan.allowed:
        hours = f"about {duration(seconds * plan.rows / jobs)}" if math.isfinite(seconds) else "a time that is not known"
        raise InputError(f"{plan.path}: {plan.rows} runs take {hours} with {jobs} at a time: a sample of some hundred rows (sample = \"sobol\") tells as much; "
                         "give --yes if it is meant")
    table = campaign.look()
    count = len(campaign.open_keys(table))
    cost = f" of about {seconds:.2g} s of one core: about {duration(seconds * count / jobs)} with {jobs} at a time" if math.isfinite(seconds) else "; what they cost is not known"
    campaign.tell(f"{count} open runs" + (f"{cost if count else ''}\n  ({basis})" if basis else ""))
    if options.dry_run:
        return 0
    campaign.open()
    assert campaign.store
    campaign.store.put("plan", plan.hash())
    try:
        if options.engine == "local":
            campaign.run(table, jobs)
        else:
            campaign.run_elsewhere(table, jobs, seconds, options.profile, options.per_job)
        campaign.check_unchanged(table)
    except BaseException as error:
        with contextlib.suppress(Error):
            if isinstance(error, Error) and error.code == 3:
                for name in OUTPUT:
                    (folder / name).unlink(missing_ok=True)
            campaign.refresh(table)
            table.write(folder / "runs.csv")
        raise
    table.write(folder / "runs.csv")
    _report(campaign, table, options.views, command)
    return 0


def _check_folder(folder: Path, plan: Plan, options: argparse.Namespace) -> None:
    """Refuses a folder that holds something else."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is not a folder")
    if (folder / NAME).exists():
        campaign = Campaign(plan, folder)
        campaign.open()
        assert campaign.store
        kept = campaign.store.get("plan")
        campaign.close()
        if kept not in (None, plan.hash()) and not options.force:
            raise InputError(f"{folder} holds the runs of another plan: give another directory, or --force to replace its table (finished drops of the same inputs are "
                             "used again)")
        return
    output_files.refuse_existing(folder, ("runs.csv", *OUTPUT), options.force)


def _print_table(plan: Plan, tell: Callable[[str], None]) -> None:
    for k, factor in enumerate(plan.factors):
        tell(f"  {factor.name:<36} {plan.describe(k)}")
    tell(f"{plan.rows} runs\n  id, {', '.join(factor.heading for factor in plan.factors)}")
    for row in range(min(plan.rows, TABLE_ROWS)):
        tell(f"  {row + 1}, {', '.join(factor.text(plan.value(k, row)) for k, factor in enumerate(plan.factors))}")
    if plan.rows > TABLE_ROWS:
        tell("  ...")


# ---- views

def choose_views(words: str, figures: Sequence[Limit], runs: int, values: Callable[[str], Array] | None = None) -> dict[int, list[str]]:
    """Returns the runs to be looked at, from 0, with the reasons. `values` returns a figure of all runs, NaN where one is not usable; without it the words are checked."""
    chosen: dict[int, list[str]] = {}
    for word in words.split(","):
        if word == "all":
            for row in range(runs):
                chosen.setdefault(row, []).append("all")
        elif word in ("worst", "limit"):
            limits = [limit for limit in figures if word == "worst" or not math.isnan(limit.limit)]
            if not limits:
                raise InputError("--views limit: no figure of the plan has a limit")
            for limit in limits if values else ():
                found = values(limit.figure) if values else np.empty(0)
                merit = found if word == "worst" else -np.abs(found - limit.limit)
                if np.isfinite(merit).any():
                    chosen.setdefault(int(np.nanargmax(merit)), []).append(f"largest {limit.figure}" if word == "worst" else f"{limit.figure} nearest to its limit")
        elif word.isascii() and word.isdigit() and 1 <= int(word) <= runs:
            chosen.setdefault(int(word) - 1, []).append("asked for")
        else:
            raise InputError(f'--views: "{word}" is neither worst, limit, all nor the id of one of the {runs} runs')
    if len(chosen) > MOST_VIEWS:
        raise InputError(f"--views: more than {MOST_VIEWS} runs")
    return chosen


def _make_views(campaign: Campaign, chosen: dict[int, list[str]]) -> Iterator[dict[str, Any]]:
    """Simulates the runs once more with all fields."""
    for row, reasons in chosen.items():
        report: Path | None = None
        place, problem = campaign.folder / "views" / f"run-{row + 1}", ""
        values = dict(text.split("=", 1) for text in campaign.plan.overrides(row))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SoftfallWarning)
            try:
                drop = Case(campaign.plan.case, values).run(output=place, force=True)
                report = drop.report()
            except NumericError as error:
                problem = str(error)
                report = read_results(error.results, place / "out").report() if error.results else None
            except Error as error:
                problem = str(error)
        yield {"id": row + 1, "reason": ", ".join(reasons), "folder": f"run-{row + 1}/out" if report else None, "problem": problem or None,
               "has_view": bool(report and report.with_name("view.html").exists())}


# ---- report

def _report(campaign: Campaign, table: Table, words: str | None, command: str) -> None:
    plan, folder = campaign.plan, campaign.folder
    anvil = np.array([row.state == "failed" and ANVIL in row.message for row in table.rows])
    is_open = np.array([row.state == "open" for row in table.rows])
    said = []
    for limit in plan.figures:
        scatter = {"a_max_g": "a_max_scatter", "hic": "hic_scatter"}.get(limit.figure)
        said.append(effects.statements(plan, limit.limit, table.values(limit.figure), anvil=anvil, is_open=is_open,
                                       scatter=table.values(scatter) if scatter else np.zeros(plan.rows)))
    views = list(_make_views(campaign, choose_views(words, plan.figures, plan.rows, table.values))) if words is not None else []
    usable = sum(row.is_usable for row in table.rows)
    facts = {"done": table.count("done"), "failed": table.count("failed"), "open": table.count("open"), "usable": usable,
             "remarks": sum(row.judged is not None and row.judged.grade == 1 for row in table.rows),
             "do_not_use": sum(row.judged is not None and GRADES[row.judged.grade] == "do not use" for row in table.rows), "judged_by": plan.series_text(),
             "views": views, "program": f"softfall sweep {library.version()}", "command": command}
    sweep_page.write(table, said, folder, facts)
    output_files.write(folder / "sweep.json", json.dumps(_summary(table, said, facts), indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    if facts["judged_by"]:
        table.write_drops(folder / "drops.csv")
    _print_result(campaign, table, said, facts)


def _number(value: float) -> float | None:
    return float(f"{value:.9g}") if math.isfinite(value) else None


def _summary(table: Table, said: list[Statements], facts: dict[str, Any]) -> dict[str, Any]:
    """Returns sweep.json."""
    plan = table.plan
    out: dict[str, Any] = {"plan": plan.path, "judged_by": facts["judged_by"] or None, "answer": sweep_page.answer(table), "runs": plan.rows,
                           **{key: facts[key] for key in ("done", "failed", "open", "do_not_use")}}
    if table.coarse:
        out["coarse_drops"] = len({row.key for row in table.coarse if row.state == "done"})
    out["factors"] = [{"key": f.key, "name": f.name, "unit": f.unit or None, "values": plan.describe(k), "uncertain": f.uncertain} for k, f in enumerate(plan.factors)]
    if table.coarse:
        out["refined"] = []
        for k in range(plan.rows):
            pairs, note = table.refined(k)
            cells: dict[str, Any] = {name: _number(value) for key, pair in zip(REFINED, pairs)
                                     for name, value in ((f"{key}_refined", pair[0]), (f"{key}_refined_error", pair[1]))}
            out["refined"].append({"id": k + 1, **cells, "refined_note": note or None})
    out["views"] = [{key: view[key] for key in ("id", "reason", "folder", "problem")} for view in facts["views"]]
    out["figures"] = [_figure(plan, k, s) for k, s in enumerate(said)]
    return out


def _figure(plan: Plan, number: int, s: Statements) -> dict[str, Any]:
    limit = plan.figures[number]
    out: dict[str, Any] = {"figure": limit.figure, "limit": _number(limit.limit)}
    chosen = [k for k in range(len(plan.factors)) if plan.is_chosen(plan.block_of[k])]
    if s.chances:
        out["probability_below_limit"] = [{**{plan.factors[k].name: plan.factors[k].text(plan.value(k, c.row)) for k in chosen}, "probability": _number(c.share),
                                           "low": _number(c.low), "high": _number(c.high), "below": c.below, "above": c.above, "unknown": c.unknown,
                                           "within_scatter": c.within} for c in s.chances]
    out["main_effects"] = [{"factor": f.name, "low": _number(e.low), "high": _number(e.high), "at_least_value": _number(e.first), "at_greatest_value": _number(e.last),
                            "by_response_surface": effects.is_by_surface(plan, k), "combinations": e.used, "all_combinations": e.of}
                           for k, (f, e) in enumerate(zip(plan.factors, s.effects))]
    if s.indices:
        out["sobol_samples"] = s.samples
        out["sobol_indices"] = [{"factor": f.name, **{name: _number(value) for name, value in index._asdict().items()}} for f, index in zip(plan.factors, s.indices)]
    fit, own = s.surface, effects.numbers(plan)
    out["response_surface"] = {
        "problem": fit.problem or None, "rows": fit.rows, "rms": _number(fit.rms), "left_out_rms": _number(fit.left_out_rms), "q2": _number(fit.q2),
        "numbers": [{"factor": plan.factors[k].name, "centre": _number(fit.centre[i]), "half_range": _number(fit.half[i])} for i, k in enumerate(own)] if fit.names else [],
        "terms": [{"term": term, "coefficient": _number(value)} for term, value in zip(fit.names, fit.coefficients)]}
    return out


def _print_result(campaign: Campaign, table: Table, said: list[Statements], facts: dict[str, Any]) -> None:
    plan, tell = table.plan, campaign.tell
    answer = sweep_page.answer(table)
    tell(f"{answer[0].upper()}{answer[1:]}")
    tell(f"{plan.rows} runs: {facts['done']} done, {facts['failed']} failed, {facts['open']} open; {facts['do_not_use']} of the done are not to be used")
    if facts["judged_by"]:
        tell(f"  each of a series of drops, judged by {facts['judged_by']}")
    failed = [(k + 1, row.message) for k, row in enumerate(table.rows) if row.state == "failed"]
    for k, message in failed[:5]:
        tell(f"  run {k} failed: {message}")
    if failed[5:]:
        tell(f"  {len(failed) - 5} more in runs.csv; --retry does them again")
    for limit, s in zip(plan.figures, said):
        if s.surface.names:
            error = s.surface.problem or f"rms error at runs left out {s.surface.left_out_rms:.4g}, Q2 {s.surface.q2:.4f}"
            tell(f"  {limit.figure}: response surface of {len(s.surface.names)} terms, {error}")
    tell(CAUTION)
    tell(f"{campaign.simulated} drops simulated, {campaign.found} were there")
    tell(f"Written: {campaign.folder}/report.html, runs.csv, {'drops.csv, ' if facts['judged_by'] else ''}sweep.json")
