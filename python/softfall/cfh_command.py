# SPDX-License-Identifier: GPL-3.0-or-later
"""`softfall cfh CASE -o DIR`: the critical fall height of a pad, and with draws of its foam the height that it has at least."""
from __future__ import annotations

import argparse
import hashlib
import json
import math
import shlex
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Sequence

import numpy as np

from . import cfh, cfh_draws, cfh_page, laboratory, library, memory, output as output_files
from .case import Case
from .cfh import CRITERIA, FIGURES, UNITS, Bench, Point, Result, Search
from .cfh_draws import Spread
from .command import Parser, add_jobs, jobs_of, say, values_of
from .curves import STANDARD_GRAVITY
from .errors import InputError, NumericError

LIST_LENGTH = (2, 16)
DRAW_TOLERANCE = 4  # of a draw over that of the case: its height is read between its drops, too
FASTEST = 1.03  # speed over that of free fall, beyond which a pair of a rig is wrong
OUTPUT = ("report.html", "cfh.png", "cfh.csv", "cfh_draws.csv", "cfh_curves.csv", "cfh.json")
STALE = ("cfh_band.csv", "cfh.gp")  # of softfall-cfh, which this command replaces with --force
CAUTION = "Figures of simulated drops: indicative, not a certification."


def parser(prog: str) -> Parser:
    """Returns the options of the command."""
    made = Parser(prog, "[OPTION...] CASE -o DIR", "Finds the critical fall height of a pad: the lowest drop height at which a_max or HIC reaches its limit.",
                  "Writes cfh.json, cfh.csv, cfh.png and report.html. With draws of the foam the answer is the height that 95 % of the foams reach at least. "
                  "After an interruption run the same command again to resume. The height is indicative, not a certification.")
    made.add_argument("case", metavar="CASE", help=argparse.SUPPRESS)
    add = made.options.add_argument
    add("-o", "--output", metavar="DIR", required=True, help="write everything there (required); drops are kept in DIR/drops.sqlite")
    add("-f", "--force", action="store_true", help="replace the files of an earlier command in DIR; drops that are finished are used again")
    add("--set", metavar="KEY=VALUE", action="append", default=[], help="override a key of the case, as softfall-pre does")
    add("--material", metavar="FILE", help="another foam: replaces the case's group material")
    add("--limit-g", metavar="G", type=float, default=200.0, help="limit of a_max in g (default 200)")
    add("--limit-hic", metavar="HIC", type=float, default=1000.0, help="limit of HIC (default 1000)")
    add("--height", metavar="LENGTH", help='first drop height, e.g. "1.5 m" (default: that of the case\'s velocity)')
    add("--max-height", metavar="LENGTH", help='go no higher (default "10 m")')
    add("--heights", metavar="LIST", help='these heights instead of a search: "0.5 m,1 m,1.5 m,2 m"')
    add("--tolerance", metavar="SHARE", type=float, default=0.005, help="two drops this close hold the limit between them (default 0.005, half a percent)")
    add("--rig", metavar="CSV", help="heights are those of a rig with friction: v^2 = 2 g_eff h, with g_eff fitted to a table of heights and speeds")
    add("--posterior", metavar="FOLDER", help="draws of the foam, draw-001.cfg ..., as softfall fit writes them: gives the height that the pad has at least")
    add("--quantile", metavar="SHARE", type=float, default=0.05, help="with --posterior: share of the foams that may be below the answer (default 0.05)")
    add_jobs(made)
    return made


@dataclass(frozen=True)
class Rig:
    """The fall: g_eff (m/s2) with its standard error, and how its table was read. Without pairs it is free fall."""

    gravity: float = STANDARD_GRAVITY
    error: float = math.nan
    pairs: int = 0
    path: str = ""

    def height(self, free_fall: float) -> float:
        """Returns the height on the rig, m."""
        return free_fall * STANDARD_GRAVITY / self.gravity


def read_rig(path: str) -> Rig:
    """Fits v^2 = 2 g_eff h through the pairs of a table. InputError: fewer than two, one that is not above 0, or faster than free fall."""
    frame = laboratory.read(path, kind="rig").frame
    height, speed = (frame.iloc[:, k].to_numpy(float) for k in (0, 1))
    if len(height) < 2:
        raise InputError(f"{path} has {len(height)} pairs of height and speed; at least 2 are needed")
    for k, (h, v) in enumerate(zip(height, speed), 1):
        if not (h > 0 and v > 0):
            raise InputError(f"{path}: pair {k}, {h:g} m and {v:g} m/s, is not above 0")
        if v > FASTEST * cfh.speed_of(h):
            raise InputError(f"{path}: pair {k}, {v:g} m/s from {h:g} m, is faster than free fall ({cfh.speed_of(h):.4g} m/s)")
    x, y = 2 * height, speed**2
    gravity = float(x @ y / (x @ x))
    return Rig(gravity, math.sqrt(float(((y - gravity * x) ** 2).sum()) / (len(x) - 1) / float(x @ x)), len(x), path)


@dataclass
class Study:
    """A command, what it found, and what the page says of it."""

    options: argparse.Namespace
    case: Case
    rig: Rig
    limits: tuple[float, float]
    judged_by: str = ""
    data_end: float = math.nan
    points: list[Point] = field(default_factory=list)
    ending: str = ""
    result: Result = field(default_factory=lambda: Result("not determined"))
    spread: Spread | None = None
    draw_points: list[list[Point]] = field(default_factory=list)
    no_interval: str = ""
    simulated: int = 0
    found: int = 0

    def bench(self, tell: Callable[[str], None]) -> Bench:
        """Returns what simulates drops of the case, kept in the folder of the output."""
        memory.hold_units()
        return Bench(str(self.case.path), _overrides(self.case), Path(self.options.output), jobs_of(self.options), self.options.retry, tell)

    @property
    def middle(self) -> float:
        """The critical height of the case's own material, or the highest drop that can be used (m)."""
        return self.result.height if self.result.verdict == "found" else max(p.height for p in self.points if not p.failed)

    @property
    def nearest(self) -> Point:
        """The drop of the case's own material that can be used and is nearest to its critical height."""
        return min((p for p in self.points if not p.failed), key=lambda p: abs(math.log(p.height / self.middle)))


def _length(option: str, text: str) -> float:
    try:
        value, unit = library.quantity(text.strip())
    except InputError as error:
        raise InputError(f"{option}: {error}") from None
    if unit != "m":
        raise InputError(f'{option}: "{text}" is no length, such as "1.5 m"')
    if not cfh.LOWEST <= value <= cfh.GREATEST:
        raise InputError(f"{option} {text}: the drop height is outside of 1 cm to {cfh.GREATEST:g} m")
    return value


def _check(o: argparse.Namespace) -> None:
    """Refuses options that are wrong in themselves."""
    for name, low, high in (("limit_g", 0, 1e9), ("limit_hic", 0, 1e9), ("tolerance", 1e-4, 0.2), ("quantile", 0, 0.5)):
        if not low < getattr(o, name) <= high:
            raise InputError(f"--{name.replace('_', '-')} {getattr(o, name):g} is outside of {low:g} to {high:g}")
    jobs_of(o)
    if o.heights and (o.height or o.max_height):
        raise InputError(f"--heights is the whole list: {'--height' if o.height else '--max-height'} does not go with it")
    if "missile.velocity" in values_of(o.set):
        raise InputError("--set missile.velocity: the drop height decides the speed; --height gives the first one")


def _search(o: argparse.Namespace, s: Study) -> Search:
    """Returns the search of the case, in heights of free fall."""
    unit = s.rig.gravity / STANDARD_GRAVITY
    highest = _length("--max-height", o.max_height or "10 m")
    listed = sorted(_length("--heights", text) for text in o.heights.split(",")) if o.heights else []
    if listed and not LIST_LENGTH[0] <= len(listed) <= LIST_LENGTH[1]:
        raise InputError(f"--heights: {len(listed)} heights; {LIST_LENGTH[0]} to {LIST_LENGTH[1]} are possible")
    twice = next((a for a, b in zip(listed, listed[1:]) if math.isclose(a, b, rel_tol=1e-6)), None)
    if twice:
        raise InputError(f"--heights: {twice:g} m is given twice")
    first = _length("--height", o.height) if o.height else library.quantity(s.case["missile.velocity"])[0] ** 2 / (2 * STANDARD_GRAVITY) / unit
    if o.height and first > highest:
        raise InputError(f"--height {o.height} is above the greatest height, {highest:g} m: raise --max-height")
    return Search(s.limits, min(max(first, cfh.LOWEST), highest) * unit, highest * unit, o.tolerance, unit, heights=tuple(h * unit for h in listed))


def _read_case(o: argparse.Namespace) -> Study:
    values = {**({"material": f"@{o.material}"} if o.material else {}), **values_of(o.set)}
    case = Case(o.case, values)
    made = Study(o, case, read_rig(o.rig) if o.rig else Rig(), (o.limit_g, o.limit_hic))
    if [float(x) for x in str(case["missile.direction"]).strip("[] ").split(",")] != [0, 0, -1]:
        raise InputError("missile.direction is not [0, 0, -1]: a drop height belongs to a vertical fall")
    with memory.Inputs(str(case.path), _overrides(case)) as inputs:
        counted, ends = inputs.counted(), inputs.data_ends()
        if len(counted) > 1 and o.posterior:
            raise InputError(f"series.drops = {len(counted)}: --posterior is for first drops, as its draws were identified by those")
        if not inputs.is_alike():
            raise InputError("series.drops: a drop has keys of its own: drops from one height are alike")
        inputs.check()
    numbers = [str(k) for k, counts in enumerate(counted, 1) if counts]
    if len(counted) > 1:
        made.judged_by = f"the mean of drops {', '.join(numbers)} of {len(counted)}" if numbers[1:] else f"drop {numbers[0]} of {len(counted)}"
    made.data_end = min(ends)
    if o.posterior and "material.law" not in case:
        raise InputError(f"--posterior: its draws are of one material, the pad of {o.case} has layers")
    return made


def _overrides(case: Case) -> list[str]:
    return [f"{key}={text}" for key, text in case.overrides.items()]


def run(options: argparse.Namespace) -> int:
    """Runs the command and returns its exit code."""
    find(options, say, say, shlex.join(["softfall", *sys.argv[1:]]))
    return 0


def find(o: argparse.Namespace, tell: Callable[[str], None], progress: Callable[[str], None], command: str, page: bool = True) -> Study:
    """Finds the height, and writes the files of the command, with its page or without. `command`: what was called, for the files."""
    folder = Path(o.output)
    _check(o)
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is not a folder")
    output_files.refuse_existing(folder, OUTPUT, o.force)
    for name in (*OUTPUT, *STALE):
        output_files.check(folder / name, *filter(None, (o.case, o.rig, o.material)))
    output_files.check_page(folder / "report.html")
    s = _read_case(o)
    draws = cfh_draws.read(Path(o.posterior), s.case, values_of(o.set)) if o.posterior else []
    search = _search(o, s)
    if s.rig.pairs:
        tell(f"rig {o.rig}: g_eff = {s.rig.gravity:.3f} ± {s.rig.error:.3f} m/s2 from {s.rig.pairs} pairs")
    bench = s.bench(tell)
    s.points, s.ending = bench.run({"": search})[""]
    s.result = cfh.evaluate(s.points, s.limits)
    if draws:
        bench.tell = progress
        _spread(s, bench, search, draws)
    s.simulated, s.found = bench.simulated, bench.found
    summary = _summary(s, command)
    if page:
        cfh_page.write(s, folder, _digest(s, summary))
    _write_tables(s, folder)
    output_files.write(folder / "cfh.json", json.dumps(summary, indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    for name in STALE:
        (folder / name).unlink(missing_ok=True)
    for c, one in enumerate(s.result.crossings):
        place = f"at {one.height:.3f} m, between drops at {one.below:.4g} and {one.above:.4g} m" if one.state == "crossed" else one.state
        tell(f"  {CRITERIA[c]:<5} {s.limits[c]:6g}{UNITS[c]:<2}  {place}")
    for line in cfh_page.answer(s):
        tell(line)
    tell(f"{s.simulated} drops simulated, {s.found} were there\nWritten: {folder}/report.html, cfh.json, cfh.csv, cfh.png\n{CAUTION}")
    if s.result.verdict == "not determined":
        raise NumericError(s.result.problem, 5)
    return s


def _spread(s: Study, bench: Bench, search: Search, draws: list[cfh_draws.Draw]) -> None:
    """Finds the height of every draw by drops of its own, beginning at that of the case's material."""
    usable = [p for p in s.points if not p.failed]
    if not usable:
        s.no_interval = "no drop of the case's own material can be used"
        return
    first = s.middle
    near = sorted(sorted(usable, key=lambda p: abs(math.log(p.height / first)))[:2], key=lambda p: p.height)
    slope = (near[1].excess(s.limits) - near[0].excess(s.limits)) / math.log(near[1].height / near[0].height) if near[1:] else cfh.FIRST_SLOPE
    one = Search(s.limits, first, search.highest, DRAW_TOLERANCE * search.tolerance, at_once=1, slope=slope)
    bench.tell(f"{len(draws)} draws of {s.options.posterior}, each by drops of its own")
    made = bench.run({draw.path: one for draw in draws}, {draw.path: draw.path for draw in draws})
    s.draw_points = [made[draw.path][0] for draw in draws]
    at = s.nearest.figures
    s.spread = cfh_draws.spread(draws, [made[draw.path] for draw in draws], s.limits, at.get("a_max_mesh_error", math.nan), (at["a_max_scatter"], at["hic_scatter"]),
                                (s.rig.gravity, s.rig.error, s.rig.pairs), s.options.quantile)


# ---- files

def _number(value: float | None) -> float | None:
    return float(f"{value:.9g}") if value is not None and math.isfinite(value) else None


def _interval(name: str, one: cfh_draws.Interval | None) -> dict[str, Any]:
    if one is None:
        return {f"{name}_{end}": None for end in ("low_m", "median_m", "high_m", "open")}
    return {f"{name}_low_m": _number(one.low) or None, f"{name}_median_m": _number(one.median) or None, f"{name}_high_m": _number(one.high) or None, f"{name}_open": one.open}


def _summary(s: Study, command: str) -> dict[str, Any]:
    """Returns cfh.json."""
    r, rig, found = s.result, s.rig, s.spread
    whole = found.parts[cfh_draws.PARTS[2]] if found else None
    height: dict[str, Any] = {"answer": cfh_page.answer(s)[0], "verdict": r.verdict, "problem": r.problem or None,
                              "deciding": CRITERIA[r.deciding] if r.deciding >= 0 else "anvil" if r.exceeding and r.verdict.startswith("below") else None,
                              "at_least_m": (_number(whole.at_least) or None) if whole else None, "at_least_share": 1 - s.options.quantile if whole else None,
                              "height_m": _number(r.height), **_interval("height", whole)}
    if rig.pairs:
        height |= {"rig_at_least_m": (_number(found.rig.at_least) or None) if found and found.rig else None, "rig_height_m": _number(rig.height(r.height)),
                   **_interval("rig_height", found.rig if found else None)}
    height |= {"speed_m_s": _number(cfh.speed_of(r.height)), "confidence": 0.95, "lowest_simulated_m": _number(r.lowest), "highest_simulated_m": _number(r.highest),
               "exceeded_at_m": _number(r.exceeding.height) if r.exceeding else None,
               "reaches_anvil_m": _number(r.exceeding.height) if r.exceeding and r.exceeding.on_anvil else None, "search_ended": cfh.ENDINGS[s.ending]}
    criteria = [{"criterion": CRITERIA[c], "limit_g" if c == 0 else "limit": s.limits[c], "state": one.state, "height_m": _number(one.height),
                 **({"rig_height_m": _number(rig.height(one.height))} if rig.pairs else {}), "below_m": _number(one.below), "above_m": _number(one.above)}
                for c, one in enumerate(r.crossings)]
    posterior: dict[str, Any] = {"folder": s.options.posterior, "no_interval": s.no_interval or None}
    if found:
        differ, same = cfh_draws.sources(found.draws)
        posterior |= {"draws": len(found.draws), "draws_above": int(np.isinf(found.foam).sum()), "draws_below": int((found.foam <= 0).sum()) - found.unknown,
                      "draws_bounded": found.bounded, "draws_unknown": found.unknown, "repeats": cfh_draws.REPEATS, "expected_mesh_error": _number(found.mesh_error),
                      "mesh_error_factor": cfh_draws.MESH_SIZE, "mesh_error_hic_factor": cfh_draws.MESH_HIC,
                      "response_errors": found.draws[0].response is not None, "included": differ, "same_in_all_draws": same,
                      "lowest_forms": cfh_draws.lowest_form(found, whole.at_least if whole else 0.0) or None}
        for name in cfh_draws.PARTS:
            posterior |= _interval(name, found.parts[name])
    points = [{"height_m": _number(p.height), "speed_m_s": _number(cfh.speed_of(p.height)), "a_max_g": _number(p.value[0]), "hic": _number(p.value[1]),
               **{key: _number(p.figures.get(key)) for key in ("v_rebound_m_s", "max_indentation_mm", "max_local_strain", "energy_error")},
               "failed": p.failed, "grade": p.grade, "note": p.note or None, **({"rig_height_m": _number(rig.height(p.height))} if rig.pairs else {})} for p in s.points]
    return {"program": f"softfall cfh {library.version()}", "command_line": command, "caution": CAUTION, "case": s.options.case,
            "material": s.options.material, "missile_mass_kg": _number(library.quantity(s.case["missile.mass"])[0]), "judged_by": s.judged_by or None,
            "compression_table_end": _number(s.data_end), "critical_fall_height": height,
            "rig": {"file": s.options.rig, "pairs": rig.pairs, "g_eff_m_s2": _number(rig.gravity), "standard_error_m_s2": _number(rig.error)},
            "posterior": posterior, "criteria": criteria, "points": points}


def _digest(s: Study, summary: dict[str, Any]) -> str:
    """Returns a digest of what the page shows."""
    shown = {key: value for key, value in summary.items() if key != "command_line"}
    return hashlib.sha256(json.dumps([shown, [[(p.height, *p.value) for p in points] for points in s.draw_points]]).encode()).hexdigest()


def _table(path: Path, heading: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    cells = ([("" if not math.isfinite(cell) else f"{cell:.9g}") if isinstance(cell, float) else cell for cell in row] for row in rows)
    output_files.write(path, output_files.table([heading, *cells]))


def _write_tables(s: Study, folder: Path) -> None:
    """Writes cfh.csv, and of draws cfh_draws.csv and cfh_curves.csv."""
    rig = ["rig_height_m"] * bool(s.rig.pairs)
    keys = ("v_rebound_m_s", "max_indentation_mm", "max_local_strain", "energy_error")
    _table(folder / "cfh.csv", ["height_m", "speed_m_s", "a_max_g", "hic_1", *keys[:2], *(f"{key}_1" for key in keys[2:]), "failed_1", *rig],
           [[p.height, cfh.speed_of(p.height), *p.value, *(float(p.figures.get(key, math.nan)) for key in keys), int(p.failed), *([s.rig.height(p.height)] if rig else [])]
            for p in s.points])
    if not s.spread:
        for name in ("cfh_draws.csv", "cfh_curves.csv"):
            (folder / name).unlink(missing_ok=True)
        return
    none = (math.nan,) * 4
    _table(folder / "cfh_draws.csv", ["draw_1", "form", "height_m", "a_max_height_m", "hic_height_m", "a_max_shared_1", "hic_shared_1", "a_max_sd_1", "hic_sd_1", "verdict"],
           [[k, draw.form, float(height) or math.nan, *(one.height for one in result.crossings), *(draw.response or none), result.verdict]
            for k, (draw, height, result) in enumerate(zip(s.spread.draws, s.spread.foam, s.spread.results), 1)])
    _table(folder / "cfh_curves.csv", ["draw_1", "height_m", *(f"{key.removesuffix('_g')}{end}" for key, end in zip(FIGURES, ("_g", "_1")))],
           [[k, p.height, *p.value] for k, points in enumerate(s.draw_points, 1) for p in points])
