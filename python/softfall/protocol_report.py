# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of a protocol: report.html, protocol.json and drops.csv."""
from __future__ import annotations

import html
import json
import math
import os
from pathlib import Path
from typing import Any, Mapping, Sequence
from urllib.parse import quote

from . import library, output as output_files
from .advice import Advice
from .curves import hic
from .judge import Outcome, between, counted_of, spots_of
from .protocol import CAUTION, NEEDS, Figure, Protocol, speed
from .protocol_advice import rows
from .protocol_drops import Drop, Drops, Spot, figures_of, hic_from
from .protocol_pictures import curve_picture, height_picture

FIELDS = ("laboratory", "address", "sample", "order", "date", "conditioning", "operator", "remarks", "photo")

_STYLE = """body{font:15px/1.45 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}h1{font-size:1.5em}h2{font-size:1.15em;
margin-top:1.6em}table{border-collapse:collapse;width:100%;font-size:.92em}th,td{text-align:left;padding:.25em .6em;border-bottom:1px solid #ddd;
vertical-align:top}td.n,th.n{text-align:right}td.n{white-space:nowrap}.result{border-left:.4em solid #888;background:#f4f4f4;padding:.6em 1em;
font-size:1.25em}.good{border-color:#2a7}.bad{border-color:#c33}.note{color:#555;font-size:.9em}svg,img{max-width:100%;height:auto}
@media print{body{margin:0;font-size:11px}h2{break-after:avoid}tr,figure{break-inside:avoid}}"""


def _number(value: float, digits: int = 4) -> str:
    return "–" if math.isnan(value) else f"{value:.{digits}g}"


class _Link(str):
    """HTML that stands in a cell as it is."""


def _escape(text: str) -> str:
    return text if isinstance(text, _Link) else html.escape(text)


def _links(view: Path | None, output: Path) -> str:
    """Returns the links to report and view of a drop, relative to the page."""
    names = [name for name in ("report", "view") if view is not None and (view / f"{name}.html").exists()]
    return _Link(" ".join(f'<a href="{quote(os.path.relpath(view / f"{name}.html", output))}">{name}</a>' for name in names))  # type: ignore[operator]


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Returns a table without its empty columns; a heading that begins with > is of numbers."""
    used = [k for k, head in enumerate(heads) if any(row[k] not in ("", "–") for row in rows) or not rows]
    heads, rows = [heads[k] for k in used], [[row[k] for k in used] for row in rows]
    classes = [' class="n"' if head.startswith(">") else "" for head in heads]
    head = "".join(f"<th{kind}>{html.escape(text.lstrip('>'))}</th>" for kind, text in zip(classes, heads))
    body = "".join("<tr>" + "".join(f"<td{kind}>{_escape(text)}</td>" for kind, text in zip(classes, row)) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _result(what: str, outcome: Outcome) -> str:
    kind = {True: " good", False: " bad", None: ""}[outcome.passed]
    more = []
    if between(outcome.low, outcome.high):
        more.append(f"95 % interval of the critical height {between(outcome.low, outcome.high)} m" + (f", by {outcome.interval_from}" if outcome.interval_from else ""))
    if outcome.probability:
        share, low, high = outcome.probability
        more.append(f"probability of passing {share:.2f} (95 % interval of the draws {low:.2f} to {high:.2f})")
    if not math.isnan(outcome.tested):
        more.append(f"greatest height tested that meets all limits: {outcome.tested:g} m" if outcome.tested else "no height tested meets all limits")
    text = f"{what}: <b>{html.escape(outcome.stated)}</b>" + (f"; {html.escape('; '.join(more))}" if more else "")
    rows = [[line.of, line.figure, _number(line.value), between(line.low, line.high) or "–",
             "–" if line.limit is None else f"{line.limit:g}", {True: "yes", False: "NO", None: "–"}[line.passed], line.note]
            for line in outcome.lines]
    return f'<p class="result{kind}">{text}</p>' + ("" if not rows else _table(["of", "figure", f">{outcome.meaning}", ">95 % interval", ">limit", "met", "note"], rows))


def _header(p: Protocol, laboratory: Mapping[str, str], photo: str) -> str:
    rows = [[key, laboratory[key]] for key in FIELDS if key in laboratory and key != "photo"]
    return (f"<h1>{html.escape(p.title)}</h1><p>{html.escape(p.standard)}; protocol {html.escape(p.name)}. <b>{CAUTION}</b></p>"
            + (_table(["", ""], rows) if rows else "") + photo)


def _set_up(p: Protocol, told: Mapping[str, str]) -> str:
    """Returns what was tested by what, as a table."""
    figures = [f"{f.label}{'' if f.limit is None else f' below {f.limit:g}'}" + (f" in windows of {1e3 * f.least_window:g} ms and longer" if f.least_window else "") for f in p.figures]
    rows = [["figures", ", ".join(figures)], ["drops", f"{p.count} on a spot" + (f", {p.interval} apart" if p.interval else "") + f"; counted: {', '.join(map(str, p.counted))}"],
            ["missile of the protocol", ", ".join(f"{key} = {value}" for key, value in p.missile.items()) or "that of the case"], *([key, text] for key, text in told.items())]
    return "<h2>Set-up</h2>" + _table(["", ""], rows)


def _drop_table(p: Protocol, parts: Mapping[str, Drops], output: Path) -> str:
    keys, of_hic = [figure.label for figure in p.figures], next((figure for figure in p.figures if figure.key in LONGEST), None)
    place = {(c.name, q.name): k for k, (c, q) in enumerate((c, q) for c in p.conditions for q in p.positions)}
    rows = []
    for what, drops in parts.items():
        groups: dict[Spot, list[Drop]] = {}
        for drop in sorted(drops.all, key=lambda drop: (place[drop.spot.condition, drop.spot.position], drop.spot.height, drop.number)):
            groups.setdefault(drop.spot, []).append(drop)
        for spot, group in groups.items():
            at = [what, spot.condition, spot.position, spot.missile, f"{spot.height:g}", f"{speed(spot.height):.3f}"]
            counts = counted_of(p, group)
            rows += [[*at, _number(drop.speed), spot.mass, str(drop.number), "yes" if drop.number in counts else "no",
                      *(_number(drop.figures.get(key, math.nan)) for key in keys), _window(drop, of_hic), drop.grade, drop.note.removeprefix(f"{drop.grade}: "),
                      _links(drop.view, output)] for drop in group]
            if len(group) > 1:
                rows.append([*at, "", spot.mass, f"mean of {', '.join(map(str, counts))}", "", *(_number(figures_of(group, key, counts)) for key in keys), "", "", "", ""])
    found = [[search.condition, search.position, _links(search.view, output)] for drops in parts.values() for search in drops.searches
             if search.view]
    searches = "<h2>Drops at the critical height</h2>" + _table(["condition", "position", "look"], found) if found else ""
    if not rows:
        return searches
    return searches + "<h2>Drops</h2>" + _table(["", "condition", "position", "missile", ">height (m)", ">speed of the fall (m/s)", ">measured speed (m/s)", "mass", ">drop", "counts",
                                                   *(f">{key}" for key in keys), ">window of HIC (ms)", "grade", "note", "look"], rows)


LONGEST = {"hic": math.inf, "hic15": 0.015, "hic36": 0.036}  # s, of a window


def _window(drop: Drop, figure: Figure | None) -> str:
    """Returns the window of HIC of a drop, in ms of its curve; "" if the protocol has no HIC."""
    if figure is None or drop.curve is None:
        return ""
    value = hic_from(*drop.curve, figure.least_window) if figure.least_window else hic(*drop.curve, LONGEST[figure.key])
    return f"{1e3 * value.t1:.2f} to {1e3 * value.t2:.2f}" if value > 0 else ""


def _readings(parts: Mapping[str, Drops]) -> str:
    rows = [[str(drop.spot), str(drop.number), Path(drop.source).name, drop.reading] for drops in parts.values() for drop in drops.drops if drop.reading]
    return "<h2>How the records were read</h2>" + _table(["spot", ">drop", "file", "read as"], rows) if rows else ""


def _choices(advice: Advice | None) -> str:
    if advice is None or not advice.choices:
        return ""
    loss = "length of the 95 % interval over the height" if math.isnan(advice.probability) else "probability of a wrong decision"
    listed = rows(advice)
    return "<h2>The next measurement</h2>" + _table([">rank", "measurement", ">cost", ">expected loss after it (%)", ">fall of the loss over the cost (%)"], listed) + (
        f'<p class="note">The best of {len(advice.choices)}, and the best one of each kind. The loss is the {loss}; now it is {100 * advice.loss:.1f} %. Expected over the '
        "draws of the foam, the errors of the model, and the scatter of drops by speed and thickness, or of specimens. A measured drop of any height stands in list.csv with "
        "this height, one of another missile with its name in the column missile.</p>")


def _clauses(p: Protocol) -> str:
    rows = [[clause.of, clause.text, clause.source, "confirmed" if clause.confirmed else "UNCONFIRMED",
             ", ".join(f"{NEEDS[key]}: {least}" for key, least in clause.needs.items())] for clause in p.clauses]
    note = f"<p>{len(p.unconfirmed)} of {len(p.clauses)} clauses are unconfirmed: check them in the standard before use.</p>" if p.unconfirmed else ""
    return "<h2>Clauses</h2>" + note + _table(["of", "clause", "source", "status", "needs at least"], rows)


def write(p: Protocol, parts: Mapping[str, Drops], outcomes: Mapping[str, Outcome], pairs: Sequence[Mapping[str, Any]],
          laboratory: Mapping[str, str], photo: str, output: Path, advice: Advice | None = None, told: Mapping[str, str] | None = None) -> None:
    """Writes the three files; each is whole or as it was before."""
    compared = "<h2>Measured and simulated</h2>" + _table(
        ["drop", ">a_max simulated − measured", ">HIC simulated − measured", ">R²", ">RMSE (g)", ">ISO/TS 18571", "in words"],
        [[pair["spot"], f"{pair['a_max_difference']:+.1%}", f"{pair['hic_difference']:+.1%}", _number(pair["r2"]), _number(pair["rmse_g"]),
          f"{pair['rating']['overall']:.3f}", pair["rating"]["word"]] for pair in pairs]) if pairs else ""
    notes = [note for outcome in outcomes.values() for note in outcome.notes]
    page = "".join([
        f'<!DOCTYPE html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{html.escape(p.title)}</title>'
        f"<style>{_STYLE}</style>", _header(p, laboratory, photo), *(_result(what, outcome) for what, outcome in outcomes.items()),
        "<h2>Notes, and what was not done as the protocol asks</h2><ul>" + "".join(f"<li>{html.escape(note)}</li>" for note in notes) + "</ul>" if notes else "",
        _choices(advice), _set_up(p, told or {}), _drop_table(p, parts, output), height_picture(p, parts), curve_picture(parts), compared, _readings(parts), _clauses(p),
        f'<p class="note">softfall-protocol, softfall {html.escape(library.version())}. Curves are filtered with CFC {p.filter:g}.</p></html>'])
    output_files.write(output / "protocol.json", json.dumps({**_summary(p, parts, outcomes, pairs, laboratory, advice), "set_up": dict(told or {})}, indent=2, allow_nan=False) + "\n")
    output_files.write(output / "report.html", page)
    rows: list[list[Any]] = [["kind", "condition", "position", "missile", "height_m", "speed_m_s", "mass", "drop", "counts", *(figure.label for figure in p.figures), "grade", "note", "source"]]
    for what, drops in parts.items():
        counts = {spot: counted_of(p, group) for spot, group in spots_of(drops).items()}
        for drop in drops.all:
            rows.append([what, *(_cell(part) for part in (drop.spot.condition, drop.spot.position, drop.spot.missile)), f"{drop.spot.height:g}", "" if math.isnan(drop.speed) else f"{drop.speed:g}", drop.spot.mass,
                           drop.number, "yes" if drop.number in counts.get(drop.spot, p.counted) else "no", *(drop.figures.get(figure.label, "") for figure in p.figures), drop.grade, _cell(drop.note), _cell(drop.source)])
    output_files.write(output / "drops.csv", output_files.table(rows))


def _cell(text: str) -> str:
    """Returns a text that no spreadsheet computes."""
    return "'" + text if text[:1] in ("=", "+", "-", "@", "\t") else text


def _plain(value: Any) -> Any:
    """Returns a value as JSON has it: NaN is null."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _summary(p: Protocol, parts: Mapping[str, Drops], outcomes: Mapping[str, Outcome], pairs: Sequence[Mapping[str, Any]],
             laboratory: Mapping[str, str], advice: Advice | None) -> dict[str, Any]:
    def lines(outcome: Outcome) -> list[dict[str, Any]]:
        return [{key: _plain(value) for key, value in vars(line).items()} for line in outcome.lines]

    return {"caution": CAUTION, "protocol": p.name, "title": p.title, "standard": p.standard, "laboratory": dict(laboratory),
            "results": {what: {"stated": o.stated, "passed": o.passed, "expected_to_pass": o.expected, "partial": bool(o.not_done), "not_done": o.not_done, "greatest_height_tested_m": _plain(o.tested), "value_m": _plain(o.value), "low_m": _plain(o.low), "high_m": _plain(o.high), "interval_from": o.interval_from or None,
                               "probability": o.probability, "lines": lines(o), "notes": o.notes} for what, o in outcomes.items()},
            "drops": [{"kind": what, "condition": d.spot.condition, "position": d.spot.position, "missile": d.spot.missile, "height_m": d.spot.height, "mass": d.spot.mass,
                       "drop": d.number, "figures": {key: _plain(value) for key, value in d.figures.items()}, "speed_m_s": _plain(d.speed), "grade": d.grade, "note": d.note,
                       "source": d.source, "reading": d.reading, "view": None if d.view is None else str(d.view)} for what, drops in parts.items() for d in drops.all],
            "comparison": [{key: _plain(value) for key, value in pair.items()} for pair in pairs],
            "advice": advice and {"probability": _plain(advice.probability), "height_m": [_plain(h) for h in advice.height], "loss": _plain(advice.loss),
                                  "bound": advice.bound, "stop": advice.stop, "decision": advice.decision, "expected_to_pass": advice.expected, "problem": advice.problem,
                                  "choices": [{key: _plain(value) for key, value in vars(choice).items()} for choice in advice.choices]},
            "unconfirmed": [{"of": c.of, "text": c.text, "source": c.source} for c in p.unconfirmed]}
