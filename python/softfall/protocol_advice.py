# SPDX-License-Identifier: GPL-3.0-or-later
"""The next drop of a protocol: its places by softfall-cfh, its measured drops, and the advice as a result of the page."""
from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Mapping

import numpy as np

from . import advice
from .case import Case
from .errors import InputError
from .judge import Line, Outcome
from .protocol import Figure, Protocol
from .protocol_drops import Drop, Drops, Spot, case_at, folder_name, search

LISTED = 10


def _question(p: Protocol, required: float, bound: float | None) -> advice.Question:
    """Returns what the protocol asks, with limits of the figures of summary.json."""
    if p.kind == "cushion curve":
        raise InputError(f"{p.path}: --advise needs a protocol with limits; a cushion curve has none")
    if not math.isnan(required) and p.kind != "critical height":
        raise InputError("--required belongs to a critical height; this protocol has its heights")
    limits: dict[str, float] = {}
    for figure in p.figures:
        if figure.limit is None:
            continue
        if figure.key not in advice.CRITERIA:
            raise InputError(f"{p.path}: --advise knows limits of {' and '.join(advice.CRITERIA)}, not of {figure.key}")
        limits[figure.key] = (figure.limit - figure.offset) / figure.factor
    decides = p.kind == "pass" or not math.isnan(required)
    chosen = bound if bound is not None else 0.05 if decides else 0.1
    if not 0 < chosen < 0.5:
        raise InputError(f"--bound={chosen:g} is not between 0 and 0.5")
    heights = p.heights if p.kind == "pass" else ()
    return advice.Question((limits.get("a_max_g"), limits.get("hic")), heights, required, chosen)


def _value(drop: Drop, figures: tuple[Figure, ...], key: str) -> float:
    """Returns a figure of summary.json of a measured drop; NaN: the protocol does not read it."""
    found = next((f for f in figures if f.key == key and f.label in drop.figures), None)
    return (drop.figures[found.label] - found.offset) / found.factor if found else math.nan


def _measured(p: Protocol, drops: Drops, notes: list[str]) -> list[advice.Drop]:
    """Returns the mean of the counted drops of each spot, or of all if none of these is there yet."""
    spots: dict[Spot, list[Drop]] = {}
    for drop in drops.drops:
        if drop.is_usable:
            spots.setdefault(drop.spot, []).append(drop)
        else:
            notes.append(f"drop {drop.number} at {drop.spot} is not to be used ({drop.note}), and is left out")
    made = []
    for spot, group in spots.items():
        counted = [drop for drop in group if drop.number in p.counted] or group
        values = [float(np.exp(np.mean(np.log([_value(drop, p.figures, key) for drop in counted])))) for key in advice.CRITERIA]
        made.append(advice.Drop(f"{spot.condition}, {spot.position}", spot.height, (values[0], values[1]), len(counted)))
    return made


def advise(p: Protocol, pad: Case, measured: Drops, output: Path, posterior: str, required: float, bound: float | None,
           options: Mapping[str, Any]) -> tuple[advice.Advice, Outcome]:
    """Returns the advice of a protocol on a pad after some drops, and what the page says of it. Simulated drops are kept below `output`."""
    question, notes, places = _question(p, required, bound), list[str](), []
    for condition in p.conditions:
        for position in p.positions:
            case = case_at(p, pad, condition, position, notes)
            if case is not None:
                folder = output / folder_name(condition.name, position.name)
                search(p, case, condition, position, folder, posterior, options)
                places.append(advice.read_place(f"{condition.name}, {position.name}", folder))
    if not places:
        raise InputError(f"nothing of the protocol can be simulated: {'; '.join(notes)}")
    pads, lines = advice.Pads(places), []
    for drop in _measured(p, measured, notes):
        if drop.place not in pads.places:
            notes.append(f"the drop from {drop.height:g} m at {drop.place} is left out, as its place is not simulated")
            continue
        predicted, weight = np.exp(pads.predict(drop.place, drop.height)), pads.weight
        for c, key in enumerate(advice.CRITERIA):
            order = np.argsort(predicted[c])
            low, _, high = advice.quantiles(order, predicted[c], weight)
            lines.append(Line(f"{drop.place}, {drop.height:g} m", key, drop.figures[c], question.limits[c], None, float(low), float(high),
                              "" if low <= drop.figures[c] <= high else "outside of what was expected before it"))
        pads.learn(drop)
    told = advice.advise(pads, question, p.count, advice.test_stresses(Path(posterior)))
    outcome = Outcome(_stated(p, question, told), told.decision, told.height[1], told.height[0], told.height[2], lines, notes,
                      meaning="measured (interval: expected before)")
    if any("is not simulated" in note for note in notes) and told.decision:
        outcome.passed, outcome.stated = None, outcome.stated + " in what was simulated; not decided for the rest"
    if any(figure.least_window for figure in p.figures):
        notes.append("what is expected of HIC counts windows of every length")
    return told, outcome


def _stated(p: Protocol, question: advice.Question, told: advice.Advice) -> str:
    """Returns the state of knowledge in words."""
    known = f"probability of passing {told.probability:.2f}" if question.decides else f"interval of {100 * told.loss:.0f} % of the height"
    if told.problem:
        return f"not decided: {told.problem}"
    if not told.stop:
        return f"go on ({known}; to stop: {'a wrong decision' if question.decides else 'an interval'} of {100 * told.bound:g} %): {told.choices[0].name}"
    return f"{'passed' if told.decision else 'not passed'} ({known}); stop" if question.decides else f"stop ({known})"


def rows(told: advice.Advice) -> list[list[str]]:
    """Returns the best choices as rows of a table."""
    return [[choice.name, f"{choice.cost:g}", f"{100 * choice.loss:.1f}", f"{100 * choice.gain:.2f}"] for choice in told.choices[:LISTED]]
