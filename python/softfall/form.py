# SPDX-License-Identifier: GPL-3.0-or-later
"""The fields of a case for a form: keys, units, bounds and help from `softfall-pre --keys` and the geometries, wrong values from the library."""
from __future__ import annotations

import functools
import os
import re
from typing import Any, Mapping

from . import library, programs, run_keys
from .case import Case
from .errors import Error, InputError

_HEADING = re.compile(r"### ([\w.]+)(?: of law (\w+))?")
_ROW = re.compile(r"\| `([\w-]+)` \| (.*?) \| (.*?) \| (.*) \|")
_FIRST = re.compile(r"^--set (?:(\S+?)=.*?: (?=\1))?", re.DOTALL)
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_QUANTITY = re.compile(r"\s*([-+]?[.\d]+(?:[eE][-+]?\d+)?)\s*(|[^\s\d.].*?)\s*")
SLIDERS = (("geometry.parameters.thickness", "Thickness", 0.7, 1.4), ("missile.velocity", "Speed", 0.5, 1.5), ("missile.mass", "Mass", 0.5, 2.0),
           ("pad.stress_factor", "Foam stress", 0.5, 2.0))  # key, name, bounds over the value of the case


@functools.lru_cache(maxsize=None)
def table() -> dict[str, tuple[str, str, str]]:
    """Returns the keys of a case with the kind and bounds of their values, their defaults and their help, as softfall-pre prints them."""
    found: dict[str, tuple[str, str, str]] = {}
    group = ""
    for line in programs.run("pre", ["--keys"]).splitlines():
        if heading := _HEADING.match(line):
            group = heading[1]
        elif row := _ROW.match(line):
            found.setdefault(f"{group}.{row[1]}", (row[2], row[3].strip("`"), row[4].replace("`", "")))
    return found


def _described(key: str) -> tuple[str, str, str]:
    """Returns the row of a key; that of a layer has the row of the material."""
    known = table()
    plain = re.sub(r"^materials\.[^.]+", "material", key)
    alike = re.sub(r"^material\.term_\d", "material.term_2", plain)
    return known.get(key) or known.get(plain) or known.get(alike) or known.get(re.sub(r"^supports?\.\d+", "support", key)) or ("", "", "")


def _text(value: Any) -> str:
    return "" if value is None else str(value).lower() if isinstance(value, bool) else f"{value:.12g}" if isinstance(value, float) else str(value)


def fields(case: Case) -> list[dict[str, Any]]:
    """Returns a field for each value of a case: its group, key, name, value, kind with bounds, help and choices."""
    made = []
    constants = run_keys.constants(case)
    for key, constant in constants.items():
        value = _text(case.get(key)) or constant.default
        unit = next(str(case[name]) for name in run_keys.units_of(key) if case.get(name) is not None)
        bounds = f"number, from {constant.low} to {constant.high}" if constant.low and constant.high else "number"
        made.append({"group": key.rpartition(".")[0], "key": key, "name": constant.label or key.rpartition(".")[2], "value": value,
                     "kind": bounds, "help": f"parameter {key.rpartition('.')[2]} of the geometry, which is in {unit}", "choices": list(constant.choices), "fallback": constant.default})
    for key, value in case.items():
        group, _, name = key.rpartition(".")
        if key in constants or name in ("parameters", "missile_parameters"):
            continue
        kind, fallback, text = _described(key)
        words = re.fullmatch(r"\w+(?:, \w+)+", kind)
        choices = kind.split(", ") if words else ["true", "false"] if kind == "true or false" else []
        made.append({"group": group, "key": key, "name": name, "value": _text(value), "kind": kind, "help": text, "choices": choices, "fallback": fallback})
    return made


def has_layers(case: Case) -> bool:
    """Returns whether the pad has several materials."""
    return any(key.startswith("materials.") for key in case)


def sliders(case: Case) -> list[dict[str, Any]]:
    """Returns the values that may be moved live: key, name, unit, value and bounds in that unit."""
    made = []
    constants = run_keys.constants(case)
    for key, name, low, high in SLIDERS:
        if has_layers(case) and key == "pad.stress_factor":
            continue  # each stress would need a model of its own
        text = _text(case.get(key)) or (constants[key].default if key in constants else "")
        found = _QUANTITY.fullmatch(text)
        if not found:
            continue
        plain = key.startswith("geometry.")
        unit = str(case["geometry.length_unit"]) if plain else found[2] or "×"
        value = float(found[1])
        made.append({"key": key, "name": name, "unit": unit, "suffix": f" {found[2]}" if found[2] else "", "value": value,
                     "low": low * value, "high": high * value})
    return made


def as_case(path: str | os.PathLike[str], texts: Mapping[str, str]) -> dict[str, str]:
    """Returns texts of the form as the case takes them: lengths for parameters of a geometry become numbers. The first wrong one is an InputError."""
    values = dict(texts)
    for key, text in texts.items():
        if not text.strip():
            raise InputError(f"{key} has no value; leave the field as the case has it, or give one")
        if run_keys.is_parameter(key) and not _NUMBER.fullmatch(text.strip()):
            values[key] = run_keys.as_number(Case(path), key, text, {})
    return values


def _wrong(case: Case, values: Mapping[str, str]) -> str:
    """Returns the sentence about values that are wrong together, "" if they are right."""
    try:
        case.copy().update(values)
    except (Error, KeyError) as error:
        return _FIRST.sub("", str(error.args[0]))
    return ""


def judge(case: Case, texts: Mapping[str, str]) -> tuple[dict[str, str], dict[str, str]]:
    """Returns the values as the case takes them, and a sentence for each that is wrong: all of them, not the first alone. The library judges."""
    values: dict[str, str] = {}
    wrong: dict[str, str] = {}
    for key, text in texts.items():
        try:
            values |= as_case(case.path, {key: text})
        except InputError as error:
            wrong[key] = str(error)
    left = {key: value for key, value in values.items() if key not in wrong}
    if not _wrong(case, left):
        return values, wrong
    right: dict[str, str] = {}
    while True:  # some are right only beside others
        more = {key: value for key, value in left.items() if not _wrong(case, {**right, key: value})}
        for key, value in more.items():
            if not _wrong(case, {**right, key: value}):
                right[key] = left.pop(key)
        if not more:
            break
    for key in list(left):
        others = {name: value for name, value in left.items() if name != key}
        if len(left) > 1 and not _wrong(case, {**right, **others}):
            left = {key: left[key]}
            break
    return values, {**wrong, **{key: _wrong(case, {**right, key: value}) or "it contradicts another value" for key, value in left.items()}}


def length_unit(case: Case) -> float:
    """Returns the unit of length of the pad's geometry in m."""
    return library.quantity(f"1 {case['geometry.length_unit']}")[0]
