# SPDX-License-Identifier: GPL-3.0-or-later
"""The next measurement of a protocol: its places by drops of the draws, its measured drops, and the advice as a result of the page."""
from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any, Iterator, Mapping, Sequence

import numpy as np

from . import advice, library
from .array import Array
from .case import Case
from .errors import InputError, NumericError
from .judge import Foams, Line, Outcome, spots_of
from .protocol import Condition, Figure, Missile, Position, Protocol
from .protocol_drops import Drop, Drops, Search, Spot, case_at, figures_of, folder_name, search, search_notes
from .protocol_places import place_of

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
        raise InputError(f"--bound={chosen:g} is outside 0 to 0.5")
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
        at, named = _place_name(drop.spot.condition, drop.spot.position, drop.spot.missile), f"drop {drop.number} at {drop.spot} is left out"
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


def _shown(p: Protocol, measured: Drops, required: float) -> tuple[list[tuple[str, float]], list[str]]:
    """Returns the places and heights (m) that lack a drop which shows that the pad passes, and measured spots that exceed a limit, in words.

    Such a drop is counted, from the height asked for or above, and below every limit; a limit that is exceeded counts up to that height.
    """
    spots: dict[Spot, list[Drop]] = {}
    for drop in measured.drops:
        if not drop.spot.missile:
            spots.setdefault(drop.spot, []).append(drop)
    means = {spot: [(figures_of(group, f.label, p.counted), f.limit) for f in p.figures if f.limit is not None] for spot, group in spots.items()}
    lacking, exceeded = [], []
    for condition, position in ((c.name, q.name) for c in p.conditions for q in p.positions):
        there = {spot: values for spot, values in means.items() if (spot.condition, spot.position) == (condition, position)}
        for height in p.heights if p.kind == "pass" else (required,):
            meets = any(values and all(value < limit for value, limit in values) for spot, values in there.items() if spot.height >= height - 1e-3)
            lacking += [] if meets else [(_place_name(condition, position, ""), height)]
            exceeded += [f"the measured drop at {spot} exceeds a limit" for spot, values in there.items()
                         if spot.height <= height + 1e-3 and any(value >= limit for value, limit in values)]
    return lacking, sorted(set(exceeded))


def _expected(pads: advice.Pads, question: advice.Question, drop: advice.Drop) -> Iterator[Line]:
    """Yields what was expected of a drop before it, with the scatter of drops."""
    weight, error = pads.weight, np.random.default_rng(4).standard_normal(pads.draw.size)
    predicted = np.exp(pads.predict(drop.place, drop.height) + pads.scatter(drop.place, drop.height)[:, None] * error)
    for c, key in enumerate(advice.CRITERIA):
        if not math.isnan(drop.figures[c]):
            low, _, high = (float(v) for v in advice.quantiles(np.argsort(predicted[c]), predicted[c], weight))
            yield Line(f"{drop.place}, {drop.height:g} m", key, drop.figures[c], question.limits[c], None, low, high,
                       "" if low <= drop.figures[c] <= high else "outside of what was expected before it")


BELOW = 0.95  # of the figures of a drop, for the limits of a missile that reaches none


def _place_name(condition: str, position: str, missile: str) -> str:
    return ", ".join([condition, position, *([f"missile {missile}"] if missile else [])])


def _places(p: Protocol, question: advice.Question, pad: Case, output: Path, posterior: str, options: Mapping[str, Any],
            notes: list[str]) -> tuple[list[advice.Place], list[Search]]:
    """Returns what is known of drops at each place, with the missile of the protocol and with others, and the searches of the first."""
    places, searches = [], []
    for condition in p.conditions:
        for position in p.positions:
            case = case_at(p, pad, condition, position, notes)
            if case is None:
                continue
            searches.append(search(p, case, condition, position, output / folder_name(condition.name, position.name), posterior, options))
            places.append(place_of(_place_name(condition.name, position.name, ""), searches[-1].study, question.asked, cost=p.drop_cost))
            for other in p.others:
                made = _other_place(p, pad, condition, position, other, output, posterior, options, notes)
                places += [made] if made else []
    return places, searches


def _search_other(p: Protocol, case: Case, condition: Condition, position: Position, folder: Path, posterior: str, options: Mapping[str, Any]) -> Search | None:
    """Returns a search of another missile with draws; where no limit is reached, the figures of its highest drop that can be used stand for the limits."""
    first = search(p, case, condition, position, folder, None, options, shown=False)
    usable = [point for point in first.summary["points"] if not point["failed"]]
    if len(usable) < 2:
        return None
    reached = first.summary["critical_fall_height"]["verdict"] == "found"
    highest = max(usable, key=lambda point: float(point["height_m"]))
    limits = None if reached else (BELOW * highest["a_max_g"], BELOW * highest["hic"])
    return search(p, case, condition, position, folder, posterior, options, limits, shown=False)


def _other_place(p: Protocol, pad: Case, condition: Condition, position: Position, other: Missile, output: Path, posterior: str,
                 options: Mapping[str, Any], notes: list[str]) -> advice.Place | None:
    """Returns what is known of drops of another missile; None, with a note, if it is too little."""
    name, folder = _place_name(condition.name, position.name, other.name), output / folder_name(condition.name, position.name, other.name)
    try:
        case = case_at(p, pad, condition, position, [], other.keys)
        found = _search_other(p, case, condition, position, folder, posterior, {**options, "views": None}) if case else None
        if found:
            return place_of(name, found.study, (), other.name, other.cost)
    except InputError as error:
        raise InputError(f"{p.path}: advice: missile {other.name}: {error}") from None
    except NumericError as error:
        notes.append(f"drops at {name} are not weighed: {error}")
        return None
    notes.append(f"drops at {name} are not weighed: fewer than two of them can be used")
    return None


def foams_interval(p: Protocol, measured: Drops, searches: Sequence[Search]) -> Foams:
    """Returns the 95 % interval of the measured critical height by the draws of the foam at the places of the searches, weighed by the measured first drops."""
    named = {_place_name(spot.condition, spot.position, "") for spot in spots_of(measured)}
    made = [_place_name(one.condition, one.position, "") for one in searches if one.study and one.study.spread]
    if p.counted != (1,):
        return Foams(math.nan, math.nan, "the draws of the foam know first drops alone")
    if not named or set(made) != named:
        return Foams(math.nan, math.nan, f"the draws of the foam were not simulated at {', '.join(sorted(named - set(made))) or 'the measured places'}")
    limits, notes = (p.limit_of("a_max_g"), p.limit_of("hic")), list[str]()
    pads = advice.Pads([place_of(name, one.study) for name, one in zip(made, searches)], limits=limits)
    for drop in _measured(p, measured, pads, notes):
        pads.learn(drop)
    if pads.misfits:
        return Foams(math.nan, math.nan, pads.misfits)
    return Foams(*pads.interval(limits), f"{pads.draws} draws of the foam, weighed by the measured drops"
                 + (f" but {len(notes)} that {'are' if len(notes) > 1 else 'is'} left out" if notes else ""))


def compression_stresses(folder: Path, rate: float, strains: Sequence[float]) -> Array:
    """Returns the stress (Pa) [draws][strains] of the foam of each draw-NNN.cfg, pressed from rest at a rate (1/s) with its sides held."""
    ramp = np.unique([*np.linspace(0, max(strains), 201), *strains])
    at = np.searchsorted(ramp, strains)
    paths = sorted(folder.glob("draw-*.cfg"), key=lambda path: int(re.sub(r"\D", "", path.stem) or 0))
    return np.array([library.Material(str(path)).compress(ramp / rate, ramp)[at] for path in paths])


def _tests(p: Protocol, posterior: Path, notes: list[str]) -> list[advice.Test]:
    """Returns the compression tests of a protocol, as the draws expect them."""
    try:
        return [advice.Test(f"a compression test at {test.rate:g} 1/s, for softfall fit", compression_stresses(posterior, test.rate, advice.TEST_STRAINS),
                            test.error, test.cost) for test in p.tests]
    except InputError as error:
        notes.append(f"compression tests are not weighed: {error}")
        return []


def advise(p: Protocol, pad: Case, measured: Drops, output: Path, posterior: str, required: float, bound: float | None,
           options: Mapping[str, Any]) -> tuple[advice.Advice, Outcome, Drops]:
    """Returns the advice of a protocol on a pad after some drops, what the page says of it, and what was simulated, below `output`."""
    question, notes = _question(p, required, bound), list[str]()
    places, searches = _places(p, question, pad, output, posterior, options, notes)
    if not places:
        raise InputError(f"nothing of the protocol can be simulated: {'; '.join(notes)}")
    pads, lines = advice.Pads(places, limits=question.limits), list[Line]()
    highest = {place.name: 0.0 for place in places}  # m, measured
    notes += [note for place in places for note in place.notes]
    for drop in _measured(p, measured, pads, notes):
        lines += _expected(pads, question, drop)
        pads.learn(drop)
        highest[drop.place] = max(highest[drop.place], drop.height)
    asked, least = max(question.heights, default=question.required), min(highest[place.name] for place in pads.judged)
    if asked > least:  # False of NaN
        notes.append(f"{asked:g} m lies above {f'what was measured, {least:g} m' if least else 'every measured drop'}: the foam may lock up in between, "
                     f"earlier than any draw; the result counts with a probability of {pads.locking(highest, asked):.2g} of that")
    lacking, exceeded = _shown(p, measured, required) if question.decides else ([], [])
    told = advice.advise(pads, question, _tests(p, Path(posterior), notes), lacking)
    notes += measured.missing
    notes.append(f"{pads.effective_draws:.0f} of {pads.draws} draws are left after what was measured")
    unexpected, partial = sum(bool(line.note) for line in lines), any("is not simulated" in note for note in notes)
    doubts = [measured.doubt] if measured.doubt else []
    if unexpected:
        doubts.append(f"{unexpected} of {len(lines)} measured figures were not expected: check height and scale of the record, or the foam is none of the draws")
    doubts += exceeded if told.decision or told.expected else []
    if doubts:
        told = replace(told, decision=None, stop=False, expected=False)
    elif told.decision and (partial or 1 not in p.counted):
        told = replace(told, decision=None, stop=False, expected=True)
    stated = _stated(question, told, lacking)
    if doubts and not told.problem:
        stated += f"; but {' and '.join(doubts)}"
    elif measured.doubt:
        stated += f"; and {measured.doubt}"
    if partial and told.expected:
        stated += "; a part of the protocol is not simulated"
    if 1 not in p.counted:
        stated += "; this is of first drops, and those that count are not decided"
    outcome = Outcome(stated, told.decision, told.height[1], told.height[0], told.height[2], lines, notes, interval_from="" if math.isnan(told.height[0]) else "draws of the foam",
                      meaning="measured; the interval was expected before the drop", expected=told.expected)
    notes += search_notes(p, searches)
    return told, outcome, Drops(searches=searches)


def _stated(question: advice.Question, told: advice.Advice, lacking: list[tuple[str, float]]) -> str:
    """Returns the state of knowledge in words."""
    known = f"probability of passing {told.probability:.2f}" if question.decides else f"interval of {100 * told.loss:.3g} % of the height"
    if told.problem:
        return f"not decided: {told.problem}"
    if told.expected:
        drops = " and ".join(f"a drop from {height:g} m, {place}" for place, height in lacking)
        return f"not decided: expected to pass, not shown ({known})" + (f"; {drops} would show it" if drops else "")
    if told.stop:
        return f"{'passed' if told.decision else 'not passed'} ({known}); stop" if question.decides else f"stop ({known})"
    if not told.choices:
        return f"not decided ({known})"
    best = f": {told.choices[0].name}"
    return f"go on{best} ({known}; measuring stops below {100 * told.bound:g} % {'of a wrong decision' if question.decides else 'of the height'})"


def rows(told: advice.Advice) -> list[list[str]]:
    """Returns the best choices as rows of a table, and the best one of each missile and the best test if these are not among them."""
    best = {choice.kind: k for k, choice in reversed(list(enumerate(told.choices)))}
    listed = sorted({*range(min(LISTED, len(told.choices))), *best.values()})
    return [[str(k + 1), choice.name, f"{choice.cost:g}", f"{100 * choice.loss:.1f}", f"{100 * choice.gain:.2f}"] for k, choice in
            ((k, told.choices[k]) for k in listed)]
