# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of a protocol: report.html, protocol.json and drops.csv."""
from __future__ import annotations

import csv
import html
import io
import json
import math
from pathlib import Path
from typing import Any, Mapping, Sequence

from . import library
from .advice import Advice
from .judge import Outcome
from .protocol import CAUTION, Protocol
from .protocol_advice import rows
from .protocol_drops import Drops

FIELDS = ("laboratory", "address", "sample", "order", "date", "conditioning", "operator", "remarks", "photo")

_STYLE = """body{font:15px/1.45 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}h1{font-size:1.5em}h2{font-size:1.15em;
margin-top:1.6em}table{border-collapse:collapse;width:100%;font-size:.92em}th,td{text-align:left;padding:.25em .6em;border-bottom:1px solid #ddd;
vertical-align:top}td.n,th.n{text-align:right;white-space:nowrap}.result{border-left:.4em solid #888;background:#f4f4f4;padding:.6em 1em;
font-size:1.25em}.good{border-color:#2a7}.bad{border-color:#c33}.note{color:#555;font-size:.9em}svg,img{max-width:100%;height:auto}
@media print{body{margin:0;font-size:11px}h2{break-after:avoid}tr,figure{break-inside:avoid}}"""


def _number(value: float, digits: int = 4) -> str:
    return "–" if math.isnan(value) else f"{value:.{digits}g}"


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Returns a table without its empty columns; a heading that begins with > is of numbers."""
    used = [k for k, head in enumerate(heads) if any(row[k] not in ("", "–") for row in rows) or not rows]
    heads, rows = [heads[k] for k in used], [[row[k] for k in used] for row in rows]
    classes = [' class="n"' if head.startswith(">") else "" for head in heads]
    head = "".join(f"<th{kind}>{html.escape(text.lstrip('>'))}</th>" for kind, text in zip(classes, heads))
    body = "".join("<tr>" + "".join(f"<td{kind}>{html.escape(text)}</td>" for kind, text in zip(classes, row)) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _curves(parts: Mapping[str, Drops]) -> str:
    """Returns the filtered curves as SVG: simulated ones dashed."""
    import matplotlib
    matplotlib.use("agg")
    import matplotlib.pyplot as plt
    shown = [(what, drop) for what, drops in parts.items() for drop in drops.drops if drop.curve is not None][:24]
    if not shown:
        return ""
    figure, ax = plt.subplots(figsize=(8, 3.6), layout="constrained")
    for what, drop in shown:
        time, value = drop.curve  # type: ignore[misc]
        ax.plot(1e3 * (time - time[0]), value, "--" if what == "simulated" and len(parts) > 1 else "-", lw=1.1,
                label=f"{what}: {drop.spot}, drop {drop.number}")
    ax.set(xlabel="time (ms)", ylabel="deceleration (g)")
    if len(shown) <= 8:
        ax.legend(fontsize=8)
    text = io.StringIO()
    with plt.rc_context({"svg.hashsalt": "softfall"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    plt.close(figure)
    return "<figure>" + text.getvalue()[text.getvalue().index("<svg"):] + "</figure>"


def _result(what: str, outcome: Outcome) -> str:
    kind = {True: " good", False: " bad", None: ""}[outcome.passed]
    more = []
    if not math.isnan(outcome.low) or not math.isnan(outcome.high):
        more.append(f"95 % interval {_number(outcome.low)} to {_number(outcome.high)} m")
    if outcome.probability:
        share, low, high = outcome.probability
        more.append(f"probability of passing {share:.2f} (95 % interval of the draws {low:.2f} to {high:.2f})")
    text = f"{what}: <b>{html.escape(outcome.stated)}</b>" + (f"; {html.escape('; '.join(more))}" if more else "")
    rows = [[line.of, line.figure, _number(line.value), f"{_number(line.low)} to {_number(line.high)}" if not math.isnan(line.low) else "–",
             "–" if line.limit is None else f"{line.limit:g}", {True: "yes", False: "NO", None: "–"}[line.passed], line.note]
            for line in outcome.lines]
    return f'<p class="result{kind}">{text}</p>' + _table(["of", "figure", f">{outcome.meaning}", ">95 % interval", ">limit", "met", "note"], rows)


def _header(p: Protocol, laboratory: Mapping[str, str], photo: str) -> str:
    rows = [[key, laboratory[key]] for key in FIELDS if key in laboratory and key != "photo"]
    return (f"<h1>{html.escape(p.title)}</h1><p>{html.escape(p.standard)}; protocol {html.escape(p.name)}. <b>{CAUTION}</b></p>"
            + (_table(["", ""], rows) if rows else "") + photo)


def _drop_table(p: Protocol, parts: Mapping[str, Drops]) -> str:
    keys = [figure.label for figure in p.figures]
    rows = [[what, drop.spot.condition, drop.spot.position, f"{drop.spot.height:g}", drop.spot.mass, str(drop.number),
             *(_number(drop.figures.get(key, math.nan)) for key in keys), drop.grade, drop.note]
            for what, drops in parts.items() for drop in drops.drops]
    if not rows:
        return ""
    return "<h2>Drops</h2>" + _table(["", "condition", "position", ">height (m)", "mass", ">drop", *(f">{key}" for key in keys), "grade", "note"], rows)


def _choices(advice: Advice | None) -> str:
    if advice is None or not advice.choices:
        return ""
    return "<h2>The next measurement</h2>" + _table(["measurement", ">cost (drops)", ">expected loss after it (%)", ">fall of the loss for each drop (%)"],
                                                    rows(advice)) + (
        f'<p class="note">Now the loss is {100 * advice.loss:.1f} %: the probability of a wrong decision, or the length of the 95 % interval over the '
        "height. Expected over the draws of the foam, the errors of the model, and the scatter of drops by speed and thickness.</p>")


def _clauses(p: Protocol) -> str:
    rows = [[clause.of, clause.text, clause.source, "confirmed" if clause.confirmed else "UNCONFIRMED"] for clause in p.clauses]
    note = f"<p>{len(p.unconfirmed)} of {len(p.clauses)} clauses are unconfirmed: check them in the standard before use.</p>" if p.unconfirmed else ""
    return "<h2>Clauses</h2>" + note + _table(["of", "clause", "source", "status"], rows)


def write(p: Protocol, parts: Mapping[str, Drops], outcomes: Mapping[str, Outcome], pairs: Sequence[Mapping[str, Any]],
          laboratory: Mapping[str, str], photo: str, output: Path, advice: Advice | None = None) -> None:
    """Writes the three files; each is whole or as it was before."""
    compared = "<h2>Measured and simulated</h2>" + _table(
        ["drop", ">a_max simulated − measured", ">HIC simulated − measured", ">R²", ">RMSE (g)", ">ISO/TS 18571", "in words"],
        [[pair["spot"], f"{pair['a_max_difference']:+.1%}", f"{pair['hic_difference']:+.1%}", _number(pair["r2"]), _number(pair["rmse_g"]),
          f"{pair['rating']['overall']:.3f}", pair["rating"]["word"]] for pair in pairs]) if pairs else ""
    notes = [note for outcome in outcomes.values() for note in outcome.notes]
    page = "".join([
        f'<!DOCTYPE html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{html.escape(p.title)}</title>'
        f"<style>{_STYLE}</style>", _header(p, laboratory, photo), *(_result(what, outcome) for what, outcome in outcomes.items()),
        "<h2>What was not done as the protocol asks</h2><ul>" + "".join(f"<li>{html.escape(note)}</li>" for note in notes) + "</ul>" if notes else "",
        _choices(advice), _drop_table(p, parts), _curves(parts), compared, _clauses(p),
        f'<p class="note">softfall-protocol, softfall {html.escape(library.version())}. Curves are filtered with CFC {p.filter:g}.</p></html>'])
    _replace(output / "report.html", page)
    _replace(output / "protocol.json", json.dumps(_summary(p, parts, outcomes, pairs, laboratory, advice), indent=2, allow_nan=False) + "\n")
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["kind", "condition", "position", "height_m", "mass", "drop", *(figure.label for figure in p.figures), "grade", "note", "source"])
    for what, drops in parts.items():
        for drop in drops.drops:
            table.writerow([what, *(_cell(part) for part in (drop.spot.condition, drop.spot.position)), f"{drop.spot.height:g}", drop.spot.mass,
                           drop.number, *(drop.figures.get(figure.label, "") for figure in p.figures), drop.grade, _cell(drop.note), _cell(drop.source)])
    _replace(output / "drops.csv", text.getvalue())


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
            "results": {what: {"stated": o.stated, "passed": o.passed, "value_m": _plain(o.value), "low_m": _plain(o.low), "high_m": _plain(o.high),
                               "probability": o.probability, "lines": lines(o), "notes": o.notes} for what, o in outcomes.items()},
            "drops": [{"kind": what, "condition": d.spot.condition, "position": d.spot.position, "height_m": d.spot.height, "mass": d.spot.mass,
                       "drop": d.number, "figures": {key: _plain(value) for key, value in d.figures.items()}, "grade": d.grade, "note": d.note,
                       "source": d.source} for what, drops in parts.items() for d in drops.drops],
            "comparison": [{key: _plain(value) for key, value in pair.items()} for pair in pairs],
            "advice": advice and {"probability": _plain(advice.probability), "height_m": [_plain(h) for h in advice.height], "loss": advice.loss,
                                  "bound": advice.bound, "stop": advice.stop, "decision": advice.decision, "problem": advice.problem,
                                  "choices": [vars(choice) for choice in advice.choices]},
            "unconfirmed": [{"of": c.of, "text": c.text, "source": c.source} for c in p.unconfirmed]}


def _replace(path: Path, text: str) -> None:
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text, encoding="utf-8")
    partial.replace(path)
