# SPDX-License-Identifier: GPL-3.0-or-later
"""The next drop of a protocol: its places by softfall-cfh, its measured drops, and the advice as a result of the page."""
from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Iterator, Mapping

import numpy as np

from . import advice
from .case import Case
from .errors import InputError
from .judge import Line, Outcome
from .protocol import Figure, Protocol
from .protocol_drops import Drop, Drops, case_at, folder_name, search

LISTED = 10


def _question(p: Protocol, required: float, bound: float | None) -> advice.Question:
    """Returns what the protocol asks, with limits of the figures of summary.json."""
    if p.kind == "cushion curve":
        raise InputError(f"{p.path}: --advise needs a protocol with limits; a cushion curve has none")
    if not math.isnan(required) and p.kind != "critical height":
        raise InputError("--required belongs to a critical height; this protocol has its heights")
    for figure in p.figures:
        if figure.limit is not None and figure.key not in advice.CRITERIA:
            raise InputError(f"{p.path}: --advise knows limits of {' and '.join(advice.CRITERIA)}, not of {figure.key}")
    decides = p.kind == "pass" or not math.isnan(required)
    chosen = bound if bound is not None else 0.05 if decides else 0.1
    if not 0 < chosen < 0.5:
        raise InputError(f"--bound={chosen:g} is not between 0 and 0.5")
    heights = p.heights if p.kind == "pass" else ()
    return advice.Question((p.limit_of("a_max_g"), p.limit_of("hic")), heights, required, chosen)


def _value(drop: Drop, figures: tuple[Figure, ...], key: str) -> float:
    """Returns a figure of summary.json of a measured drop; NaN: the protocol does not read it."""
    found = next((f for f in figures if f.key == key and f.label in drop.figures), None)
    return found.value_of(drop.figures[found.label]) if found else math.nan


def _measured(p: Protocol, drops: Drops, pads: advice.Pads, notes: list[str]) -> list[advice.Drop]:
    """Returns the drops that can be learnt from: the first on each spot, as the draws are foams without memory."""
    made = []
    for drop in drops.drops:
        at, named = f"{drop.spot.condition}, {drop.spot.position}", f"drop {drop.number} at {drop.spot} is left out"
        if not drop.is_usable:
            notes.append(f"{named}: it is not to be used ({drop.note})")
        elif drop.number > 1:
            notes.append(f"{named}: the draws of the foam know first drops alone")
        elif at not in pads.places:
            notes.append(f"{named}: its place is not simulated")
        elif not pads.places[at].ends[0] <= drop.spot.height <= pads.places[at].ends[1]:
            low, high = pads.places[at].ends
            notes.append(f"{named}: it lies outside of the heights looked at, {low:.3g} to {high:.3g} m")
        else:
            made.append(advice.Drop(at, drop.spot.height, (_value(drop, p.figures, "a_max_g"), _value(drop, p.figures, "hic"))))
    return made


def _expected(pads: advice.Pads, question: advice.Question, drop: advice.Drop) -> Iterator[Line]:
    """Yields what was expected of a drop before it, with the scatter of drops."""
    weight, error = pads.weight, np.random.default_rng(4).standard_normal(pads.draw.size)
    predicted = np.exp(pads.predict(drop.place, drop.height) + pads.scatter(drop.place, drop.height)[:, None] * error)
    for c, key in enumerate(advice.CRITERIA):
        if not math.isnan(drop.figures[c]):
            low, _, high = (float(v) for v in advice.quantiles(np.argsort(predicted[c]), predicted[c], weight))
            yield Line(f"{drop.place}, {drop.height:g} m", key, drop.figures[c], question.limits[c], None, low, high,
                       "" if low <= drop.figures[c] <= high else "outside of what was expected before it")


def advise(p: Protocol, pad: Case, measured: Drops, output: Path, posterior: str, required: float, bound: float | None,
           options: Mapping[str, Any]) -> tuple[advice.Advice, Outcome]:
    """Returns the advice of a protocol on a pad after some drops, and what the page says of it. Simulated drops are kept below `output`."""
    question, notes, places = _question(p, required, bound), list[str](), []
    for condition in p.conditions:
        for position in p.positions:
            case = case_at(p, pad, condition, position, notes)
            if case is not None:
                folder = output / folder_name(condition.name, position.name)
                places.append(advice.read_place(f"{condition.name}, {position.name}",
                                                search(p, case, condition, position, folder, posterior, options).folder))
    if not places:
        raise InputError(f"nothing of the protocol can be simulated: {'; '.join(notes)}")
    pads, lines = advice.Pads(places), list[Line]()
    notes += [note for place in places for note in place.notes]
    for drop in _measured(p, measured, pads, notes):
        lines += _expected(pads, question, drop)
        pads.learn(drop)
    told = advice.advise(pads, question, advice.test_stresses(Path(posterior)))
    if any(line.note for line in lines):
        notes.append("some measured figures were not expected: the foam may be none of the draws")
    notes.append(f"{pads.effective_draws:.0f} of {pads.draws} draws are left after what was measured")
    outcome = Outcome(_stated(p, question, told), told.decision, told.height[1], told.height[0], told.height[2], lines, notes,
                      meaning="measured; the interval was expected before the drop")
    if any("is not simulated" in note for note in notes) and told.decision:
        outcome.passed, outcome.stated = None, outcome.stated + " in what was simulated, and not decided for the rest"
    if outcome.passed and any(line.note for line in lines):
        outcome.passed = None
    if 1 not in p.counted:
        outcome.passed = None if told.decision else told.decision
        outcome.stated += ", by first drops, and not decided for those that count"
    if any(figure.least_window for figure in p.figures):
        notes.append("what is expected of HIC counts windows of every length")
    return told, outcome


def _stated(p: Protocol, question: advice.Question, told: advice.Advice) -> str:
    """Returns the state of knowledge in words."""
    known = f"probability of passing {told.probability:.2f}" if question.decides else f"interval of {100 * told.loss:.0f} % of the height"
    if told.problem:
        return f"not decided: {told.problem}"
    if told.stop:
        return f"{'passed' if told.decision else 'not passed'} ({known}); stop" if question.decides else f"stop ({known})"
    best = f": {told.choices[0].name}" if told.choices else ""
    return f"go on{best} ({known}; measuring stops below {100 * told.bound:g} % {'of a wrong decision' if question.decides else 'of the height'})"


def rows(told: advice.Advice) -> list[list[str]]:
    """Returns the best choices as rows of a table."""
    return [[choice.name, f"{choice.cost:g}", f"{100 * choice.loss:.1f}", f"{100 * choice.gain:.2f}"] for choice in told.choices[:LISTED]]
