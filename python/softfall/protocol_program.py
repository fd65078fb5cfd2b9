# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall protocol: runs a protocol on a pad, on measured drops, or on both side by side."""
from __future__ import annotations

import argparse
import base64
import math
import os
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from . import output as output_files, worker
from .case import Case
from .command import Parser, say, values_of
from .curves import column
from .drop import read_results
from .errors import InputError
from .judge import Outcome, between, judge
from .protocol import CAUTION, Protocol, length, names, read
from .protocol_advice import advise, foams_interval
from .protocol_drops import Drop, Drops, simulate
from .protocol_measured import measure
from .protocol_report import FIELDS, write
from .rating import rate

PICTURES = {".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg"}
MOST_PHOTO = 4_000_000  # bytes
SHOWN = ("geometry.file", "geometry.parameters.thickness", "material.law", "material.density", "material.curve", "missile.mass", "pad.base", "pad.temperature")
FILES = ("report.html", "protocol.json", "drops.csv")


def read_laboratory(path: str | None) -> tuple[dict[str, str], str]:
    """Returns the fields of the text file of a laboratory, and its photo as HTML."""
    if path is None:
        return {}, ""
    fields = output_files.read_toml(path)
    for key, value in fields.items():
        if key not in FIELDS:
            raise InputError(f"{path}: there is no field {key!r}; there are {', '.join(FIELDS)}")
        if not isinstance(value, str):
            fields[key] = str(value)
    if "photo" not in fields:
        return fields, ""
    file = Path(path).parent / fields["photo"]
    if file.suffix.lower() not in PICTURES:
        raise InputError(f"{path}: photo {file} is no {', '.join(PICTURES)} file")
    try:
        data = base64.b64encode(output_files.read(file, MOST_PHOTO)).decode()
    except InputError as error:
        raise InputError(f"{path}: photo {error}") from None
    return fields, f'<figure><img alt="sample" src="data:image/{PICTURES[file.suffix.lower()]};base64,{data}"></figure>'


def compare(p: Protocol, measured: Drops, simulated: Drops) -> list[dict[str, Any]]:
    """Returns the differences of each simulated drop from the measured one of its number, or from the first one where it stands in for all."""
    by_number = {(drop.spot, drop.number): drop for drop in measured.drops}
    first = {drop.spot: drop for drop in sorted(measured.drops, key=lambda d: d.number, reverse=True)}
    pairs = []
    for drop in simulated.all:
        other = first.get(drop.spot) if simulated.stands_in else by_number.get((drop.spot, drop.number))
        if other is not None and drop.curve is not None and other.is_usable and drop.is_usable:
            pairs.append(_pair(p, other, drop))
    return pairs


def _pair(p: Protocol, measured: Drop, simulated: Drop) -> dict[str, Any]:
    """Compares two drops by softfall-post, which aligns the contacts, and rates the curves over the measured pulse."""
    with output_files.scratch() as scratch, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        curve = scratch / "measured.csv"
        np.savetxt(curve, np.column_stack(measured.curve), delimiter=",", header="time (s),acceleration (g)", comments="", fmt="%.12g")  # type: ignore[arg-type]
        told = read_results(simulated.source).post(scratch / "out", reference=str(curve), reference_filter="none", filter=int(p.filter))
    said = told["reference"]
    (t, a), (s, b) = measured.curve, simulated.curve  # type: ignore[misc]
    begin, end = (edge - said["shift_ms"] / 1e3 for edge in (s[0], s[-1]))
    rating = rate(t, a, column(s - said["shift_ms"] / 1e3, "s"), b, (max(t[0], begin), min(t[-1], end)))
    return {"spot": f"{measured.spot}, drop {measured.number}", "a_max_difference": told["a_max_g"] / said["a_max_g"] - 1,
            "hic_difference": told["hic"] / said["hic"] - 1, "r2": float(said["fits"][0]["r2"]), "rmse_g": float(said["fits"][0]["rmse_g"]),
            "rating": {**rating._asdict(), "word": rating.word}}


def _probable(outcome: Outcome) -> str:
    return f" (probability of passing {outcome.probability[0]:.2f}, {outcome.probability[1]:.2f} to {outcome.probability[2]:.2f})" if outcome.probability else ""


def _interval(outcome: Outcome) -> str:
    read_off = "" if math.isnan(outcome.value) else f"{outcome.value:.4g} m, "
    return f"; {read_off}95 % interval {between(outcome.low, outcome.high)} m by {outcome.interval_from}" if outcome.interval_from and between(outcome.low, outcome.high) else ""


def _tested(outcome: Outcome) -> str:
    return "" if math.isnan(outcome.tested) else f"; greatest height tested that meets all limits: {outcome.tested:g} m" if outcome.tested else "; no height tested meets all limits"


def _is_own(output: Path) -> bool:
    """Returns whether a folder with files of our names has our protocol.json."""
    try:
        return output_files.read(output / "protocol.json").startswith(b'{\n  "caution": "softfall')
    except InputError:
        return False


def perform(o: argparse.Namespace) -> str:
    """Runs the command; returns what it prints."""
    if o.list:
        return "\n".join(f"{name:12} {read(name).title}, {read(name).standard}" for name in names())
    if not o.protocol or not o.output or not (o.pad or o.measured):
        raise InputError("PROTOCOL, --output=DIR and --pad=CASE or --measured=DIR are needed; --list lists the protocols")
    p, output = read(o.protocol), Path(o.output)
    laboratory, photo = read_laboratory(o.laboratory)
    if o.measured and os.path.realpath(output) == os.path.realpath(o.measured):
        raise InputError(f"--output={output} is the folder of the measured drops, whose files stay as they are: give another one")
    there = [name for name in FILES if (output / name).exists()]
    if there and not _is_own(output):
        raise InputError(f"{output} has {there[0]}, and no protocol.json of softfall: it is not replaced; give another directory")
    if there and not o.force:
        raise InputError(f"{output} has {there[0]} already: give --force to replace it (finished drops are used again), or another directory")
    if o.advise and not (o.pad and o.posterior):
        raise InputError("--advise needs --pad=CASE and --posterior=FOLDER, draws of its foam")
    ignored = [name for name in ("posterior", "draws", "set", "engine", "profile") if getattr(o, name)] if not o.pad else []
    if ignored:
        raise InputError(f"--{ignored[0]} belongs to --pad")
    if o.engine not in (None, "local") and (o.advise or p.kind == "critical height" and not p.heights):
        raise InputError(f"--engine={o.engine} is for draws of the foam at given heights; a search runs its drops in memory, --jobs of them side by side: leave it out")
    if o.draws is not None and o.draws < 1:
        raise InputError(f"--draws={o.draws} is not a number from 1 on")
    if o.advise and o.draws:
        raise InputError("--draws is not for --advise, which takes all draws")
    if not o.advise and (o.required or o.bound is not None):
        raise InputError("--required and --bound belong to --advise")
    parts: dict[str, Drops] = {}
    if o.measured:
        parts["measured"] = measure(p, Path(o.measured), o.pattern, complete=not o.advise)
    outcomes, told, pairs, set_up = {}, None, [], dict[str, str]()
    if o.pad:
        pad = Case(o.pad, values_of(o.set))
        set_up = {"case": str(pad.path), **({"changed": ", ".join(o.set)} if o.set else {}), **{key: str(pad[key]) for key in SHOWN if pad.get(key) is not None},
                  **({"draws of the foam": str(o.posterior)} if o.posterior else {})}
        options = {"jobs": o.jobs, "threads": o.threads, "engine": o.engine, "profile": o.profile, "views": o.views}
        output.mkdir(parents=True, exist_ok=True)
        if o.advise:
            required = length(o.required, "--required") if o.required else math.nan
            told, outcomes["advice"], parts["simulated"] = advise(p, pad, parts.get("measured", Drops()), output / "drops", o.posterior, required, o.bound, options)
        else:
            parts["simulated"] = simulate(p, pad, output / "drops", o.posterior, o.draws, parts.get("measured"), **options)
    if not o.advise:
        foams = foams_interval(p, parts["measured"], parts["simulated"].searches) if len(parts) == 2 and o.posterior and p.kind == "critical height" else None
        outcomes = {what: judge(p, drops, what == "simulated", None if what == "simulated" else foams) for what, drops in parts.items()}
        pairs = compare(p, parts["measured"], parts["simulated"]) if len(parts) == 2 else []
    output.mkdir(parents=True, exist_ok=True)
    write(p, parts, outcomes, pairs, laboratory, photo, output, told, {**set_up, **({"measured records": str(o.measured)} if o.measured else {}), "command": " ".join(sys.argv[1:])})
    said = [f"{p.title} ({p.standard})", *(f"  {what:10} {outcome.stated}{_probable(outcome)}{_interval(outcome)}{_tested(outcome)}" for what, outcome in outcomes.items()),
            *(f"  note: {note}" for outcome in outcomes.values() for note in outcome.notes),
            f"  {len(p.unconfirmed)} of {len(p.clauses)} clauses are unconfirmed. {CAUTION}", f"Written: {output}/report.html, protocol.json, drops.csv"]
    return "\n".join(said)


def parser(prog: str) -> Parser:
    """Returns the command line."""
    made = Parser(prog, "[OPTION...] PROTOCOL -o DIR",
                  "Runs a test protocol on a simulated pad, on the measured drops of a laboratory,\nor on both side by side. softfall "
                    "indicates; it certifies nothing.",
                  "PROTOCOL is a name of --list or a file NAME.toml. After an interruption the\nsame command resumes. docs/protocols.md explains it.")
    add = made.options.add_argument
    add("protocol", metavar="PROTOCOL", nargs="?", help=argparse.SUPPRESS)
    add("--advise", action="store_true", help="tell which drop to do next, by --pad, --posterior and what is measured so far")
    add("--bound", metavar="SHARE", type=float, help="with --advise: stop at this probability of a wrong decision (default 0.05), or relative interval "
                                                     "(0.1)")
    add("--draws", metavar="N", type=int, help="draws of --posterior (default: all)")
    add("--engine", metavar="NAME", help="what runs draws of the foam at given heights: local (default) or snakemake")
    add("-f", "--force", action="store_true", help="replace the report of an earlier command in DIR; its finished drops are used again")
    add("-j", "--jobs", metavar="N", type=int, help="drops of searches and of draws side by side")
    add("--laboratory", metavar="FILE", help="laboratory, sample, date, conditioning, photo: a text file of fields")
    add("--list", action="store_true", help="list the protocols, and end")
    add("--measured", metavar="DIR", help="measured drops: a folder with list.csv")
    add("-o", "--output", metavar="DIR", help="write everything there")
    add("--pad", metavar="CASE", help="simulate the drops on the pad of this case")
    add("--pattern", metavar="TEXT", help="names of measured files in place of list.csv: \"{position}_{height}_{drop}.csv\"")
    add("--posterior", metavar="FOLDER", help="draws of the foam: intervals and the probability of passing")
    add("--profile", metavar="PROFILE", help="with --engine snakemake: a profile of Snakemake")
    add("--required", metavar="HEIGHT", help="with --advise: the critical height that decides, such as \"1.5 m\"")
    add("--set", metavar="KEY=VALUE", action="append", default=[], help="a value of the case, as of softfall-pre")
    add("-t", "--threads", metavar="N", type=int, help="threads of all drops together (default: every processor)")
    add("--views", metavar="RUNS", help="link report and view of some drops: worst, limit (nearest to it), all or numbers of drops at each "
        "position; of a critical height the drop at that height, whatever RUNS is")
    return made


def run(o: argparse.Namespace) -> int:
    """Runs a protocol and returns the exit code."""
    with worker.kept():  # for its many searches
        say(perform(o))
    return 0
