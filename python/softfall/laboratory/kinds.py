# SPDX-License-Identifier: GPL-3.0-or-later
"""The kinds of tables: which roles a heading must hold, and which columns are taken for them."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Sequence

from . import headings
from .headings import Column, Role, fits, sort_out
from .tables import Choice
from .units import parse_scale

PHRASES = {"time": ("a time", "ms"), "acceleration": ("an acceleration", "g"), "ratio": ("a strain (% or 1)", "%"), "pressure": ("a stress", "kPa"),
           "length": ("a length", "mm"), "force": ("a force", "N"), "speed": ("a speed", "m/s")}
FORMULAS = {"a true (logarithmic) strain": "the nominal one is 1 - exp(-true strain)",
            "a true stress": "the nominal one is true stress x present area / first area, the same for a foam without lateral strain"}


@dataclass(frozen=True)
class Options:
    """What the user says of a file; `spell` writes an option as the user types it."""

    kind: str | None = None
    column: tuple[str, ...] = ()  # headings of columns to take
    columns: tuple[str, ...] = ()  # headings of the axes of an accelerometer
    lateral: str | None = None
    heading: str | None = None
    units: tuple[str, ...] = ()
    scale: tuple[str, ...] = ()
    rate: str | None = None
    specimen: str | None = None
    cycle: str | None = None
    sheet: str | None = None
    side: str | None = None
    width: str | None = None
    diameter: str | None = None
    area: str | None = None
    thickness: str | None = None
    invert: str | None = None
    stated_at: int = 0  # the line that states the rate, which the user has not given
    spell: Callable[[str, str], str] = lambda option, value: f'--{option} "{value}"'


def _wanted(role: Role) -> str:
    phrase, unit = PHRASES[role.quantity]
    name = role.label.capitalize() if role.key not in ("strain", "stress") else role.key.capitalize()
    return f'{role.label}, such as "{name} ({unit})"'


def problem_of(role: Role, other: Sequence[tuple[Column, str]], unfit: Sequence[Column], o: Options, columns: Sequence[Column] = ()) -> str:
    """Returns why no column has the role; of `columns` one with a unit of its kind may be it."""
    near = [(column, fits(column, role, True)) for column in columns if column.unit(role.quantity)] if not (other or unfit) else []
    able = next((column for column, what in near if what == ""), None)
    other = other or [(column, what) for column, what in near if what and able is None]
    if other:
        column, what = other[0]
        formula = f": {FORMULAS[what]}" if what in FORMULAS else ""
        return f'"{column.heading}" is {what}, not {f"the {role.label}" if role.is_pressing else PHRASES[role.quantity][0]}{formula}'
    if not unfit:
        return f"the heading has no column of {_wanted(role)}" + (f'; if "{able.heading}" is one, name it with {o.spell("column", able.heading)}' if able else "")
    column = unfit[0]
    phrase, unit = PHRASES[role.quantity]
    written = next((text for _, text in column.titles if text), "") or column.below or column.above
    if written:
        return f'the heading has no column of {_wanted(role)}: "{column.heading}" is in "{written.strip("()[]<>")}", which is not a unit of {phrase}'
    given = ",".join([*("" for _ in range(column.place)), unit])
    return (f'the heading has no column of {_wanted(role)}: "{column.heading}" names no unit (write "{column.heading} ({unit})", or the unit in the next line, '
            f"or give it with {o.spell('units', given)})")


def pick(columns: Sequence[Column], role: Role, o: Options, several: bool = False) -> tuple[list[Column], str, bool]:
    """Returns the columns of a role, why there are none or too many, and whether the heading seems to hold the role."""
    scaled = any(parse_scale(text)[0] == role.quantity for text in o.scale)
    named = [column for column in columns if any(column.is_called(name) for name in (o.columns or o.column))]
    chosen = [column for column in named if fits(column, role, True, scaled) == ""]
    if chosen:
        return (chosen, "", True) if several or len(chosen) == 1 else ([], f'two columns are called "{chosen[0].heading}"', True)
    having, other, unfit = sort_out([column for column in columns if column not in named], role, scaled)
    others = [column for column in named if fits(column, headings.TIME, True) != ""]
    if role is headings.ACCELERATION and others:
        having, other = [], [(column, what) for column in named if (what := fits(column, role, True, scaled))]
        unfit = others
    if not having:
        return [], problem_of(role, other, unfit, o, [column for column in columns if column not in named]), bool(other or unfit)
    wrong = next((column for column in having if column.contradiction(role.quantity)), None)
    if wrong is not None and (several or len(having) == 1):
        return [], _contradiction(wrong), True
    if len(having) > 1 and o.specimen and o.specimen.isdigit():
        if not 1 <= int(o.specimen) <= len(having):
            return [], f"specimen {o.specimen} was asked for; the heading has columns of {len(having)}", True
        return [having[int(o.specimen) - 1]], "", True
    if len(having) > 1 and not several:
        return [], two(role, having, o), True
    return having, "", True


def two(role: Role, having: Sequence[Column], o: Options) -> str:
    """Returns the sentence about two columns that could be one quantity."""
    first, second = having[0].heading, having[1].heading
    how = f"name one with {o.spell('column', first)}, or " if first != second else ""
    return f'two {role.key.replace("_", " ")} columns ("{first}" and "{second}"): {how}choose a specimen with {o.spell("specimen", "1")}'


def _pair(first: Role, second: Role, several: bool = False) -> Callable[[Sequence[Column], Options], Choice]:
    def choose(columns: Sequence[Column], o: Options) -> Choice:
        one, problem, seen = pick(columns, first, o)
        two_, other_problem, other_seen = pick(columns, second, o, several)
        if one and two_ and one[0] in two_:
            two_, other_seen = [column for column in two_ if column is not one[0]], len(two_) > 1
        return Choice({first.key: one, second.key: two_}, problem or other_problem, seen + other_seen)
    return choose


def _time(columns: Sequence[Column], o: Options, values: Sequence[Column]) -> tuple[list[Column], str, bool]:
    """Returns the times of the samples, of several first the one that is named, or nearest before the first value, as each channel may have its own."""
    named = [column for column in columns if any(column.is_called(name) for name in o.column) and fits(column, headings.TIME, True) == ""]
    having, other, unfit = sort_out(columns, headings.TIME)
    wrong = next((column for column in having if column.contradiction("time")), None)
    if wrong is not None:
        return [], _contradiction(wrong), True
    if named or having:
        before = [column for column in having if values and column.place < values[0].place]
        if o.specimen and o.specimen.isdigit() and len(having) > 1:
            before = [having[min(len(having), max(1, int(o.specimen))) - 1]]
        return list(dict.fromkeys([*named, *before[-1:], *having])), "", True
    bare = [column for column in unfit if not any(text for _, text in column.titles) and not column.below and not column.above]
    if bare:
        return bare, "", True  # times of day, or times whose unit follows from the file's rate
    return [], problem_of(headings.TIME, other, unfit, o), bool(other or unfit)


def _contradiction(column: Column) -> str:
    return f'the heading "{column.heading}" and the line below it ("{column.below}") give different units'


def _acceleration(columns: Sequence[Column], o: Options) -> Choice:
    values, problem, seen = pick(columns, headings.ACCELERATION, o, several=o.specimen is None)
    times, time_problem, time_seen = _time(columns, o, values)
    apart = [time for time in times if len(values) > 1 and values[0].place < time.place < values[-1].place]
    if apart:
        problem, values = two(headings.ACCELERATION, values, o) + ", as each has its own time", []
    if o.columns and values:
        missing = next((name for name in o.columns if not any(column.is_called(name) for column in values)), None)
        problem = f'the heading has no column of an acceleration called "{missing}"' if missing else problem
        values = [column for name in o.columns for column in values if column.is_called(name)]
    if o.rate and not times:
        time_problem, time_seen = "", True
    twice = any(column in values for column in times)  # one cell that holds all of the line
    problem = problem or time_problem or (problem_of(headings.TIME, [], [], o) if twice else "")
    return Choice({"time": times, "acceleration": values}, problem, 1 if twice else seen + time_seen)


COMPRESSION = ((headings.STRAIN, headings.STRESS), (headings.DISPLACEMENT, headings.FORCE), (headings.STRAIN, headings.FORCE),
               (headings.DISPLACEMENT, headings.STRESS), (headings.GAP, headings.FORCE), (headings.GAP, headings.STRESS))


def _compression(columns: Sequence[Column], o: Options) -> Choice:
    picked = {role.key: pick(columns, role, o) for role in (headings.STRAIN, headings.STRESS, headings.DISPLACEMENT, headings.FORCE, headings.GAP)}
    first, second = next(((a, b) for a, b in COMPRESSION if picked[a.key][0] and picked[b.key][0]),
                         next(((a, b) for a, b in COMPRESSION[:2] if picked[a.key][2] and picked[b.key][2]),
                              next(((a, b) for a, b in COMPRESSION[:5] if picked[a.key][2] and picked[b.key][2]),
                                   next(((a, b) for a, b in COMPRESSION[:2] if picked[a.key][2] or picked[b.key][2]), COMPRESSION[0]))))
    problems = [picked[role.key][1] for role in (first, second) if picked[role.key][1]]
    choice = Choice({role.key: picked[role.key][0] for role in (first, second)}, "; ".join(problems), sum(picked[role.key][2] for role in (first, second)))
    taken = [column for found in choice.columns.values() for column in found]
    choice.found = min(choice.found, len(set(taken))) if len(taken) == 2 else choice.found
    lateral, _, _ = sort_out([column for column in columns if column not in taken], headings.LATERAL)
    named = [column for column in columns if o.lateral and column.is_called(o.lateral)]
    if o.lateral and not (len(named) == 1 and named[0].unit("ratio")):
        choice.problem = choice.problem or f'the heading has no lateral strain called "{o.lateral}"'
    if named or len(lateral) == 1:
        choice.columns["lateral_strain"] = named or lateral
    times, _, _ = sort_out(columns, headings.TIME)
    if len(times) == 1:
        choice.columns["time"] = times
    return choice


KINDS: dict[str, Callable[[Sequence[Column], Options], Choice]] = {
    "acceleration": _acceleration, "compression": _compression, "motion": _pair(headings.TIME, headings.DISPLACEMENT),
    "lateral": _pair(headings.STRAIN, headings.LATERAL),
    "rig": _pair(headings.HEIGHT, headings.SPEED), "cushion": _pair(headings.STATIC_STRESS, headings.PEAK)}
USUAL = ("acceleration", "compression")  # kinds that a file is looked through for; the others are asked for
ROLES = {role.key: role for role in (headings.TIME, headings.ACCELERATION, headings.STRAIN, headings.STRESS, headings.DISPLACEMENT, headings.FORCE, headings.GAP,
                                     headings.LATERAL, headings.HEIGHT, headings.SPEED, headings.STATIC_STRESS, headings.PEAK)}
