# SPDX-License-Identifier: GPL-3.0-or-later
"""A protocol: which drops a test has, what is read from them, and how its result is stated (docs/protocols.md)."""
from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Mapping, Sequence

from . import library, programs
from .curves import STANDARD_GRAVITY
from .errors import InputError
from .output import read_toml

KINDS = ("pass", "critical height", "cushion curve")
CAUTION = "softfall indicates; it certifies nothing."
_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "ft": 0.3048, "in": 0.0254}


@dataclass(frozen=True)
class Clause:
    """What a standard says: `of` is the group of the protocol that rests on it; `needs`, what it asks for at least, by the words of NEEDS."""

    of: str
    text: str
    source: str
    confirmed: bool
    needs: Mapping[str, int] = field(default_factory=dict)


NEEDS = {"positions": "positions", "conditions": "conditions", "heights": "heights at each position", "drops": "drops on one spot", "masses": "masses"}


@dataclass(frozen=True)
class Figure:
    """A figure: `factor` times one of summary.json plus `offset`, the limit to stay below (None: it is reported alone) and a least
    window of HIC (s; 0: none)."""

    key: str
    limit: float | None
    least_window: float = 0.0
    name: str = ""
    factor: float = 1.0
    offset: float = 0.0

    @property
    def label(self) -> str:
        """Its name in tables: the key unless the protocol has another one."""
        return self.name or self.key

    def of(self, value: float) -> float:
        """Returns the figure of the value in summary.json."""
        return self.factor * value + self.offset

    def value_of(self, figure: float) -> float:
        """Returns the value in summary.json of a figure."""
        return (figure - self.offset) / self.factor


@dataclass(frozen=True)
class Condition:
    """A state of the sample, such as a temperature, and the keys of the case that set it."""

    name: str
    keys: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Position:
    """An impact point of the sample; `at` in m, or None: where the case has it."""

    name: str
    at: tuple[float, float] | None = None


@dataclass(frozen=True)
class Missile:
    """Another missile, a drop of which may be advised: the keys of the case that it sets, and what a drop costs."""

    name: str
    keys: Mapping[str, Any]
    cost: float


@dataclass(frozen=True)
class CompressionTest:
    """A compression test that may be advised: its strain rate (1/s), what it costs, and the standard deviation of ln(stress)."""

    rate: float
    cost: float
    error: float


DROP_COST, MISSILE_COST = 1.0, 2.0  # defaults: a drop is the unit, and the missile is exchanged for the other drop
TEST_ERROR = 0.04  # specimens of one foam scatter by that
TESTS = (CompressionTest(0.01, 3.0, TEST_ERROR), CompressionTest(10.0, 6.0, TEST_ERROR))  # of a testing machine, of a servo-hydraulic one


@dataclass(frozen=True)
class Protocol:
    """A protocol as its file has it. Lengths in m."""

    name: str
    path: Path
    title: str
    standard: str
    kind: str
    missile: Mapping[str, Any]  # keys of the case
    filter: float
    conditions: tuple[Condition, ...]
    positions: tuple[Position, ...]
    heights: tuple[float, ...]  # empty: they are searched for
    masses: tuple[str, ...]  # of a cushion curve
    count: int  # drops on one spot
    interval: str
    counted: tuple[int, ...]
    rounding: float  # m, of a critical height, downwards; 0: none
    area: float  # m2, of the platen of a cushion curve
    figures: tuple[Figure, ...]
    clauses: tuple[Clause, ...]
    drop_cost: float = DROP_COST  # of --advise, as the next two
    others: tuple[Missile, ...] = ()
    tests: tuple[CompressionTest, ...] = TESTS

    def limit_of(self, key: str) -> float | None:
        """Returns the least limit of a value in summary.json, over all figures that are made of it; None: there is none."""
        return min((f.value_of(f.limit) for f in self.figures if f.key == key and f.limit is not None), default=None)

    @property
    def unconfirmed(self) -> list[Clause]:
        """The clauses that were not read at a source."""
        return [clause for clause in self.clauses if not clause.confirmed]


def speed(height: float) -> float:
    """Returns the speed (m/s) of a free fall from a height (m).

    >>> round(speed(1.0), 4)
    4.4287
    """
    return math.sqrt(2 * STANDARD_GRAVITY * height)


def length(text: Any, where: str) -> float:
    """Returns a length such as "1.5 m" in m; InputError names the place.

    >>> length("900 mm", "x"), length("1.5m", "x")
    (0.9, 1.5)
    """
    parts = re.sub(r"(?<=[\d.])(?=[a-z])", " ", text).split() if isinstance(text, str) else []
    try:
        value = float(parts[0]) * _UNITS[parts[1]] if len(parts) == 2 else math.nan
    except (ValueError, KeyError):
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f'{where}: {text!r} is no length; it is a text with a number and one of {", ".join(_UNITS)}, such as "1.5 m"')
    return value


_MASSES = {"kg": 1.0, "g": 1e-3, "lb": 0.45359237}


def kilograms(text: str, where: str = "mass") -> float:
    """Returns a mass such as "1500 g" in kg; InputError names the place.

    >>> kilograms("1500 g"), kilograms("2kg")
    (1.5, 2.0)
    """
    number, unit = re.fullmatch(r"(.*?) *([a-z]+)", _quantity(text, tuple(_MASSES), where).strip()).groups()  # type: ignore[union-attr]
    return float(number) * _MASSES[unit]


def same(a: float, b: float) -> bool:
    """Returns whether two numbers that may have been written in other units are one."""
    return math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12)


def _differ(values: Sequence[float]) -> bool:
    return not any(same(a, b) for k, a in enumerate(values) for b in values[:k])


def strain_rate(text: Any, where: str) -> float:
    """Returns a strain rate such as "0.01 1/s" in 1/s; InputError names the place.

    >>> strain_rate("10 1/s", "x"), strain_rate("6 1/min", "x")
    (10.0, 0.1)
    """
    found = re.fullmatch(r"\s*([\d.]+(?:e[+-]?\d+)?) *(1/s|s-1|1/min|1/h)\s*", text) if isinstance(text, str) else None
    try:
        value = float(found.group(1)) / {"1/s": 1, "s-1": 1, "1/min": 60, "1/h": 3600}[found.group(2)] if found else 0.0
    except ValueError:
        value = 0.0
    if not 0 < value <= 1e6:
        raise InputError(f'{where}: {text!r} is no strain rate up to 1e6 1/s; it is a text with a number above 0 and 1/s, 1/min or 1/h, such as "0.01 1/s"')
    return value


MOST = 1e15  # of a number in a protocol


class _Group:
    """A table of the file; a key that is none of `known`, a text such as "a, b and c", is refused."""

    def __init__(self, where: str, table: Any, known: str) -> None:
        if not isinstance(table, dict):
            raise InputError(f"{where}: a table is expected")
        for key in table:
            if key not in re.split(", | and ", known):
                raise InputError(f"{where}: there is no key {key!r}; there are {known}")
        self.where, self.left = where, dict(table)

    def take(self, key: str, kind: type | tuple[type, ...], default: Any = ...) -> Any:
        """Returns the value of a key; without a default it must be there."""
        if key not in self.left:
            if default is ...:
                raise InputError(f"{self.where}: {'the group [' + key + ']' if kind is dict else key} is missing")
            return default
        value = self.left.pop(key)
        if isinstance(value, bool) or not isinstance(value, kind):
            kinds = kind if isinstance(kind, tuple) else (kind,)
            words = {str: "a text", int: "a whole number", float: "a number", list: "a list", dict: "a table"}
            expected = "a number without a unit" if float in kinds else " or ".join(words[k] for k in kinds)
            raise InputError(f"{self.where}: {key} = {value!r} is not {expected}")
        if isinstance(value, (int, float)) and not abs(value) <= MOST:
            raise InputError(f"{self.where}: {key} is not a finite number, or beyond {MOST:g}")
        return value


def folder() -> Path:
    """Returns the folder of the protocols that come with softfall."""
    return programs.folder().parent / "share/softfall/protocols"


def names() -> list[str]:
    """Returns the names of the protocols that come with softfall."""
    return sorted(path.stem for path in folder().glob("*.toml"))


def find(name: str) -> Path:
    """Returns the file of a protocol: a path that ends with .toml, or a name."""
    if name.endswith(".toml"):
        return Path(name)
    path = folder() / f"{name}.toml"
    if not path.exists():
        raise InputError(f"there is no protocol {name!r}; there are {', '.join(names())}, or the path of a file NAME.toml")
    return path


def read(name: str) -> Protocol:
    """Reads and checks a protocol. A mistake is an InputError that names file, group and key."""
    path = find(name)
    top = _Group(str(path), read_toml(path), "title, standard, missile, drops, figure, result, clause and advice")
    title, standard = top.take("title", str), top.take("standard", str)
    missile = _Group(f"{path}: missile", top.take("missile", dict), "geometry, parameters, mass, keys and filter")
    drops = _Group(f"{path}: drops", top.take("drops", dict), "conditions, positions, heights, masses, area, count, interval and counted")
    result = _Group(f"{path}: result", top.take("result", dict), "kind and rounding")
    kind = result.take("kind", str)
    if kind not in KINDS:
        raise InputError(f"{path}: result: kind {kind!r} is none of {', '.join(KINDS)}")
    rounding = result.take("rounding", str, None)
    advice = _Group(f"{path}: advice", top.take("advice", dict, {}), "drop_cost, missiles and tests")
    figures = tuple(_figure(path, k, table) for k, table in enumerate(top.take("figure", list), 1))
    clauses = tuple(_clause(path, k, table) for k, table in enumerate(top.take("clause", list), 1))
    made = Protocol(
        name=path.stem, path=path, title=title, standard=standard, kind=kind, missile=_missile(path, missile),
        filter=_filter(path, missile), **_drops(path, drops, kind), figures=figures, clauses=clauses, **_advice(path, advice),
        rounding=length(rounding, f"{path}: result: rounding") if rounding else 0.0)
    _check(made)
    return made


def _figure(path: Path, number: int, table: Any) -> Figure:
    group = _Group(f"{path}: figure {number}", table, "key, limit, least_window_ms, name, factor and offset")
    window = group.take("least_window_ms", (int, float), 0)
    limit = group.take("limit", (int, float), None)
    factor, offset = (float(group.take(key, (int, float), default)) for key, default in (("factor", 1), ("offset", 0)))
    if factor < 1 / MOST:
        raise InputError(f"{group.where}: factor {factor:g} is not above {1 / MOST:g}")
    if limit is not None and (limit - offset) / factor <= 0:
        raise InputError(f"{group.where}: limit {limit:g} is not above {offset:g}, which the figure has at a value of 0")
    key = group.take("key", str)
    if key != key.lower() and key.lower() in library.RECORD_FIGURES:
        raise InputError(f'{group.where}: there is no figure key = "{key}"; it is "{key.lower()}"')
    if window < 0 or window > 0 and key != "hic":
        raise InputError(f"{group.where}: least_window_ms = {window:g} of {key}: a least window is above 0, and belongs to hic")
    return Figure(key, None if limit is None else float(limit), 1e-3 * window, group.take("name", str, ""), factor, offset)


def _clause(path: Path, number: int, table: Any) -> Clause:
    group = _Group(f"{path}: clause {number}", table, "of, text, source, status and needs")
    of, text, source, status = (group.take(key, str) for key in ("of", "text", "source", "status"))
    if not source.strip():
        raise InputError(f"{group.where}: source is empty: say where the clause was read, or that it is from memory")
    if status not in ("confirmed", "unconfirmed"):
        raise InputError(f"{group.where}: status {status!r} is neither confirmed nor unconfirmed")
    asked = _Group(f"{group.where}: needs", group.take("needs", dict, {}), f"{', '.join(list(NEEDS)[:-1])} and {list(NEEDS)[-1]}")
    needs = {key: asked.take(key, int) for key in NEEDS if key in asked.left}
    for key, least in needs.items():
        if not 1 <= least <= 1000:
            raise InputError(f"{asked.where}: {key} = {least} is not a number from 1 to 1000")
    return Clause(of, text, source, status == "confirmed", needs)


def _missile(path: Path, group: _Group) -> dict[str, Any]:
    """Returns the keys of the case that the missile sets."""
    keys: dict[str, Any] = {}
    geometry = group.take("geometry", str, None)
    if geometry:
        places = [path.parent / geometry, programs.folder().parent / "share/softfall/geo" / geometry]
        file = next((place for place in places if place.exists()), None)
        if not file:
            raise InputError(f"{group.where}: the geometry {geometry} is neither beside the protocol nor in {places[1].parent}")
        keys["geometry.missile_file"] = str(file.resolve())
    for name, value in group.take("parameters", dict, {}).items():
        keys[f"geometry.missile_parameters.{name}"] = value
    weight = group.take("mass", str, None)
    if weight:
        keys["missile.mass"] = _quantity(weight, tuple(_MASSES), f"{group.where}: mass")
    keys.update(group.take("keys", dict, {}))
    if "missile.velocity" in keys:
        raise InputError(f"{group.where}: missile.velocity is that of the fall from the heights of the protocol")
    return keys


def _cost(group: _Group, key: str, default: float) -> float:
    value = float(group.take(key, (int, float), default))
    if not 0 < value < math.inf:
        raise InputError(f"{group.where}: {key} = {value:g} is not above 0")
    return value


def _advice(path: Path, group: _Group) -> dict[str, Any]:
    """Returns what --advise may rank beside drops of the protocol, and the costs."""
    others, tests, given = [], [], "tests" in group.left
    for k, table in enumerate(group.take("missiles", list, []), 1):
        one = _Group(f"{group.where}: missile {k}", table, "name, cost, geometry, parameters, mass and keys")
        name, cost = one.take("name", str).strip(), _cost(one, "cost", MISSILE_COST)
        others.append(Missile(name, _missile(path, one), cost))
        if name in ("", "drop", "test") or any(other.name == name for other in others[:-1]):
            raise InputError(f"{one.where}: name {name!r} is empty, that of another missile, or drop or test, which are no missiles")
        if not others[-1].keys:
            raise InputError(f"{one.where}: {name} has neither geometry, mass nor keys, by which it would be another missile")
    for k, table in enumerate(group.take("tests", list, []), 1):
        one = _Group(f"{group.where}: test {k}", table, "rate, cost and error")
        tests.append(CompressionTest(strain_rate(one.take("rate", str), f"{one.where}: rate"), _cost(one, "cost", TESTS[0].cost),
                                     _cost(one, "error", TEST_ERROR)))
    return {"drop_cost": _cost(group, "drop_cost", DROP_COST), "others": tuple(others), **({"tests": tuple(tests)} if given else {})}


def _filter(path: Path, group: _Group) -> float:
    value = group.take("filter", (int, float), 1000)
    if value not in (60, 180, 600, 1000):
        raise InputError(f"{group.where}: filter {value} is no channel frequency class: 60, 180, 600 or 1000")
    return float(value)


def _drops(path: Path, group: _Group, kind: str) -> dict[str, Any]:
    conditions, positions = [], []
    for k, table in enumerate(group.take("conditions", list, [{"name": "as it is"}]), 1):
        one = _Group(f"{group.where}: condition {k}", table, "name and keys")
        conditions.append(Condition(one.take("name", str), one.take("keys", dict, {})))
    for k, table in enumerate(group.take("positions", list, [{"name": "centre"}]), 1):
        one = _Group(f"{group.where}: position {k}", table, "name and at")
        name, at = one.take("name", str), one.take("at", list, None)
        if at is not None and len(at) != 2:
            raise InputError(f'{one.where}: at = {at} is not x and y: ["100 mm", "0 mm"]')
        positions.append(Position(name, None if at is None else tuple(length(part, one.where) for part in at)))  # type: ignore[arg-type]
    count = group.take("count", int, 1)
    if not 1 <= count <= 20:
        raise InputError(f"{group.where}: count = {count} is not a number of drops from 1 to 20")
    counted = tuple(group.take("counted", list, list(range(1, count + 1))))
    if not counted or any(not isinstance(k, int) or not 1 <= k <= count for k in counted):
        raise InputError(f"{group.where}: counted {list(counted)} are not drops of count = {count}")
    if len(set(counted)) < len(counted):
        raise InputError(f"{group.where}: counted {list(counted)} has a drop twice")
    area = group.take("area", str, None)
    return {"conditions": tuple(conditions), "positions": tuple(positions), "count": count, "counted": counted,
            "heights": tuple(length(text, f"{group.where}: heights") for text in group.take("heights", list, [])),
            "masses": tuple(_quantity(text, tuple(_MASSES), f"{group.where}: masses") for text in group.take("masses", list, [])),
            "interval": _quantity(group.take("interval", str, "1 s"), ("s", "min", "h"), f"{group.where}: interval") if "interval" in group.left else "",
            "area": _area(area, group.where) if area else 0.0}


def _quantity(text: Any, units: Sequence[str], where: str) -> str:
    """Returns a text such as "4.6 kg" if it is a number above 0 and one of the units."""
    found = re.fullmatch(r"\s*([\d.]+(?:e[+-]?\d+)?) *(\w+)\s*", text) if isinstance(text, str) else None
    try:
        if found and found.group(2) in units and 0 < float(found.group(1)) < math.inf:
            return str(text)
    except ValueError:
        pass
    raise InputError(f"{where} {text!r} is not a number above 0 with one of {', '.join(units)}")


def _area(text: str, where: str) -> float:
    """Returns an area such as "129 cm2" in m2."""
    unit = {"m2": 1.0, "cm2": 1e-4, "mm2": 1e-6}
    number, name = re.fullmatch(r"\s*(\S+?) *([a-z]+2)\s*", _quantity(text, tuple(unit), f"{where}: area")).groups()  # type: ignore[union-attr]
    return float(number) * unit[name]


def _check(p: Protocol) -> None:
    """Refuses what contradicts itself, and a group without a clause: nobody could say where its numbers are from."""
    for what, names_of in (("condition", [one.name for one in p.conditions]), ("position", [one.name for one in p.positions])):
        doubles = {name for name in names_of if names_of.count(name) > 1}
        if doubles or not names_of:
            raise InputError(f"{p.path}: drops: {'two ' + what + 's are named ' + repr(doubles.pop()) if doubles else 'no ' + what}")
    if p.kind != "critical height" and not p.heights:
        raise InputError(f"{p.path}: drops: heights is missing (only a critical height is searched for)")
    if any(not 0 < h <= 30 for h in p.heights) or not _differ(p.heights):
        raise InputError(f"{p.path}: drops: heights must differ and be above 0 and at most 30 m")
    if (p.kind == "cushion curve") != (bool(p.masses) and p.area > 0):
        raise InputError(f"{p.path}: drops: masses and area belong to a cushion curve, and it needs both")
    if not _differ([kilograms(text) for text in p.masses]):
        raise InputError(f"{p.path}: drops: masses {', '.join(p.masses)} hold one mass twice")
    for k, position in enumerate(p.positions):
        for other in p.positions[:k]:
            if position.at and other.at and all(abs(a - b) < 1e-6 for a, b in zip(position.at, other.at)):
                raise InputError(f"{p.path}: drops: the positions {other.name} and {position.name} are one point: its drops would count twice")
    if not p.figures or (p.kind != "cushion curve" and all(figure.limit is None for figure in p.figures)):
        raise InputError(f"{p.path}: a figure with a limit is missing")
    if p.kind == "critical height" and any(f.label not in ("a_max_g", "hic") for f in p.figures if f.limit is not None):
        raise InputError(f"{p.path}: a critical height has limits of a_max_g and hic alone")
    if len({figure.label for figure in p.figures}) < len(p.figures):
        raise InputError(f"{p.path}: two figures have one name")
    if p.rounding and p.kind != "critical height":
        raise InputError(f"{p.path}: result: rounding belongs to a critical height")
    groups = ("missile", "drops", "figure", "result")
    for clause in p.clauses:
        if clause.of not in groups:
            raise InputError(f"{p.path}: a clause is of {clause.of!r}, which is none of {', '.join(groups)}")
    for group in groups:
        if not any(clause.of == group for clause in p.clauses):
            raise InputError(f"{p.path}: {group} has no clause that says where it is from; add one, with status = \"unconfirmed\" if need be")
