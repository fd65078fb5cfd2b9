# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a critical fall height: the answer first, a_max and HIC over the height, what the answer includes, the drops."""
from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Sequence

import numpy as np

from . import cfh, cfh_draws, library, output as output_files
from .cfh import CRITERIA, ENDINGS, UNITS
from .sweep_page import BAD, GOOD, PLAIN
from .template import base64_of, png, render

if TYPE_CHECKING:
    from .cfh_command import Study


def _safe(height: float) -> str:
    """Returns a height that is promised, rounded down.

    >>> _safe(1.4199)
    '1.41'
    """
    return f"{math.floor(100 * height) / 100:.2f}"


def limits_text(s: Study) -> str:
    """Returns the limits in words."""
    return " and ".join(f"{name} < {limit:g}{unit}" for name, limit, unit in zip(CRITERIA, s.limits, UNITS))


def simulated(s: Study) -> str:
    """Returns the sentence about the drops of the case's own material."""
    r, by = s.result, f", by {s.judged_by}" if s.judged_by else ""
    reached = f"{CRITERIA[r.deciding]} reaches {s.limits[r.deciding]:g}{UNITS[r.deciding]}" if r.deciding >= 0 else "the missile reaches the anvil"
    if r.verdict == "found":
        one = r.crossings[r.deciding]
        return f"Critical fall height {r.height:.3f} m of free fall{by}: {reached} first, between drops at {one.below:.4g} and {one.above:.4g} m"
    if r.verdict == "above the highest point":
        limit = f" and below {r.exceeding.height:.3f} m, where {'the missile reaches the anvil' if r.exceeding.on_anvil else 'a limit is exceeded'}" if r.exceeding else ""
        return f"Critical fall height above {r.highest:.3f} m of free fall{limit}{by}: {ENDINGS[s.ending]}"
    if r.verdict == "below the lowest point":
        lowest = r.lowest if math.isfinite(r.lowest) else r.exceeding.height if r.exceeding else math.nan
        return f"Critical fall height below {lowest:.3f} m of free fall{by}: {reached} at the lowest height"
    return f"No critical fall height: {r.problem}"


def headline(s: Study) -> str:
    """Returns the answer: with draws of the foam the height that it has at least."""
    if not s.spread:
        return simulated(s)
    whole, percent = s.spread.parts[cfh_draws.PARTS[2]], f"{100 * (1 - s.options.quantile):g} %"
    if whole.at_least <= 0:
        why = f"{s.spread.unknown} of {len(s.spread.draws)} draws of the foam have no drop that can be used" if s.spread.unknown else "the foams reach a limit at the lowest height"
        return f"No height can be promised ({percent}): {why}"
    least = whole.at_least if math.isfinite(whole.at_least) else max(p.height for points in s.draw_points for p in points if not p.failed)
    rig = f", {_safe(s.rig.height(least) if not s.spread.rig or math.isinf(s.spread.rig.at_least) else s.spread.rig.at_least)} m on the rig" if s.rig.pairs else ""
    return f"At least {_safe(least)} m of free fall ({percent}){rig}: {limits_text(s)} in {percent} of the foams that agree with the tests"


def _range(one: cfh_draws.Interval) -> str:
    ends = ["none" if end <= 0 else "beyond the heights looked at" if math.isinf(end) else f"{end:.3f} m" for end in (one.low, one.median, one.high)]
    return f"median {ends[1]}, 95 % interval {ends[0]} to {ends[2]}"


def answer(s: Study) -> list[str]:
    """Returns the answer in sentences, the headline first."""
    said = [headline(s)]
    if s.spread:
        differ, same = cfh_draws.sources(s.spread.draws)
        said.append(f"Of {len(s.spread.draws)} foams: {_range(s.spread.parts[cfh_draws.PARTS[2]])}; first limit: {cfh_draws.deciding(s.spread)}")
        said.append(simulated(s))
        included = [*differ, *["errors of the responses"] * (s.spread.draws[0].response is not None), *["the mesh"] * math.isfinite(s.spread.mesh_error),
                    *["g_eff of the rig"] * bool(s.rig.pairs)]
        mounted = all(draw.mount for draw in s.spread.draws)
        included += ["the mount of the accelerometer"] * mounted
        left_out = [*same, *["errors of the responses, which the draws do not state"] * (s.spread.draws[0].response is None),
                    *["the mesh, whose error is not known"] * math.isnan(s.spread.mesh_error), *["the mount of the accelerometer but for what the draws hold of it"] * (not mounted)]
        said.append(f"Included: {', '.join(included)}. Not included: {'; '.join([*left_out, 'single pads and drops'])}")
        form = cfh_draws.lowest_form(s.spread, s.spread.parts[cfh_draws.PARTS[2]].at_least)
        said.append(f"The lowest draws have the form {form}" if form else "The draws do not state the form of their curve: posterior.csv of softfall fit beside their folder does")
        if s.spread.bounded:
            said.append(f"{s.spread.bounded} draws stay below the limits up to a drop that cannot be used: the last height before it is taken for theirs, so that "
                        "median and upper end may be too low")
    elif s.no_interval:
        said.append(f"No interval: {s.no_interval}")
    else:
        said.append("The uncertainty of the foam is not included: --posterior FOLDER, draws of the foam, gives the height that the pad has at least")
    if s.rig.pairs:
        height = s.result.height if s.result.verdict == "found" else math.nan
        rest = f"{s.rig.height(height):.3f} m; " if math.isfinite(height) else ""
        rest += f"{_range(s.spread.rig)}; " if s.spread and s.spread.rig else ""
        said.append(f"On the rig: {rest}g_eff = {s.rig.gravity:.3f} ± {s.rig.error:.3f} m/s2 from {s.rig.pairs} pairs")
    for one in s.result.crossings[s.result.deciding:s.result.deciding + 1] if s.result.verdict == "found" else ():
        if one.above / one.below > 1 + 10 * s.options.tolerance:
            failed = any(one.below < p.height < one.above for p in s.points)
            said.append(f"{'The drops' if failed else 'No drop was simulated'} between {one.below:.3f} and {one.above:.3f} m{' cannot be used' if failed else ''}: the height "
                        "there is interpolated")
        said += [f"At {p.height:.3f} m: {p.note}" for p in s.points if p.height in (one.below, one.above) and "extrapolated" in p.note]
    return said


def _picture(s: Study, criteria: Sequence[int]) -> bytes:
    from matplotlib.figure import Figure
    figure = Figure(figsize=(3.8 * len(criteria), 3.5), dpi=150, layout="constrained")
    good = [p for p in s.points if not p.failed]
    for c, ax in zip(criteria, figure.subplots(1, len(criteria), squeeze=False)[0]):
        for k, points in enumerate(s.draw_points):
            drops = [p for p in points if not p.failed]
            ax.plot([p.height for p in drops], [p.value[c] for p in drops], "-", color="0.75", lw=0.5, marker=".", ms=2, mew=0, zorder=1,
                    label="drops of the draws" if k == 0 else None)
        if len(good) > 1:
            h = np.geomspace(good[0].height, good[-1].height, 200)[1:-1]
            ax.plot(h, np.exp(cfh.curve(good, c)(np.log(h))), "-", color=PLAIN, lw=1.2, zorder=2)
        ax.plot([p.height for p in good], [p.value[c] for p in good], "o", color=PLAIN, ms=4, zorder=3, label="drops of the case")
        ax.axhline(s.limits[c], color=BAD, lw=0.9, ls="--", label=f"limit, {s.limits[c]:g}{UNITS[c]}")
        for k, p in enumerate(p for p in s.points if p.failed):
            ax.axvline(p.height, color="0.5", lw=0.6, ls=":", label="drops that cannot be used" if k == 0 else None)
        if s.result.verdict == "found":
            ax.axvline(s.result.height, color=PLAIN, lw=0.9, label=f"critical height, {s.result.height:.3f} m")
        whole = s.spread.parts[cfh_draws.PARTS[2]] if s.spread else None
        if whole and 0 < whole.at_least < math.inf:
            ax.axvline(whole.at_least, color=GOOD, lw=1.4, label=f"at least, {_safe(whole.at_least)} m")
        ax.set(xlabel="drop height of free fall (m)", ylabel=f"{CRITERIA[c]}{' (g)' if c == 0 else ''}")
        ax.set_ylim(bottom=0)
        ax.margins(x=0.03)
        ax.legend(fontsize=7, loc="upper left", framealpha=0.9)
    return png(figure)


def write(s: Study, folder: Path, digest: str) -> None:
    """Writes cfh.png and report.html into the folder, unless a page with this digest of its figures is there."""
    if (folder / "cfh.png").exists() and (folder / "report.html").exists() and f'"{digest}"' in (folder / "report.html").read_text(encoding="utf-8", errors="replace")[:2000]:
        return
    output_files.write(folder / "cfh.png", _picture(s, (0, 1)))

    def text(value: float, digits: int) -> str:
        return f"{value:.{digits}f}" if math.isfinite(value) else "–"
    rows = [{"cells": [text(p.height, 3), *([text(s.rig.height(p.height), 3)] if s.rig.pairs else []), text(cfh.speed_of(p.height), 3), text(p.value[0], 1), text(p.value[1], 0),
                       text(p.figures.get("max_indentation_mm", math.nan), 1), text(p.figures.get("max_local_strain", math.nan), 3)],
             "verdict": "?" if math.isnan(p.excess(s.limits)) else "pass" if p.excess(s.limits) < 0 else "fail", "grade": p.grade, "note": p.note} for p in s.points]
    limits = [[f"{name} = {limit:g}{unit}", f"{one.height:.3f} m" if one.state == "crossed" else one.state,
               f"{one.below:.4g} and {one.above:.4g} m" if one.state == "crossed" else "–"] for name, limit, unit, one in zip(CRITERIA, s.limits, UNITS, s.result.crossings)]
    names = {"foam": "the foam alone", "foam_response": "with the errors of the responses", "foam_response_mesh": "with the mesh: the answer",
             "single_drop": "of a single pad and drop, with their scatter"}
    intervals = [[names[name], *("–" if end <= 0 or math.isinf(end) else f"{end:.3f}" for end in (s.spread.parts[name].at_least, *s.spread.parts[name][:3]))] for name in cfh_draws.PARTS] if s.spread else []
    said = answer(s)
    kind = "plain" if s.result.verdict != "found" else "good" if s.spread else "fair"
    output_files.write(folder / "report.html", render(
        "cfh.html", title=f"Critical fall height: {Path(s.options.case).resolve().parent.name}", said=said, kind=kind, rows=rows,
        limits=limits, intervals=intervals, percent=100 * (1 - s.options.quantile), pictures=[(name, base64_of(_picture(s, (c,)))) for c, name in enumerate(CRITERIA)], rig=bool(s.rig.pairs), ending=ENDINGS[s.ending],
        program=f"softfall cfh {library.version()}", case=s.options.case, simulated=s.simulated, found=s.found, digest=digest))
