# SPDX-License-Identifier: GPL-3.0-or-later
"""The values of `softfall run`: short keys, heights of fall, and lengths for the plain numbers of a geometry."""
from __future__ import annotations

import difflib
import math
import re
from pathlib import Path
from typing import Iterable, Mapping, NamedTuple

from . import laboratory, library
from .case import Case
from .curves import STANDARD_GRAVITY
from .errors import Error, InputError, failure

FALL = ("height", "rig")  # words that set missile.velocity
SPEED = "missile.velocity"
_PARAMETERS = (("geometry.file", "geometry.parameters"), ("geometry.missile_file", "geometry.missile_parameters"), ("support.file", "support.parameters"))
_DEFINED = re.compile(r'DefineConstant\s*\[((?:[^]"]|"[^"]*")*)\]\s*;')
_COMMENT = re.compile(r'("[^"\n]*")|//[^\n]*|/\*.*?\*/', re.DOTALL)
_CONSTANT = re.compile(r'(\w+)\s*=\s*\{((?:[^{}"]|"[^"]*"|\{[^{}]*\})*)\}|(\w+)\s*(?:=\s*([^,{]+))?')


class Constant(NamedTuple):
    """A parameter that a geometry defines: its default and what its DefineConstant says of it, as texts ("" if nothing)."""

    default: str
    label: str
    low: str
    high: str
    choices: tuple[str, ...]


def split(texts: Iterable[str]) -> dict[str, str]:
    """Returns the values of a command line by their keys.

    >>> split(["thickness=60", "missile.mass=5 kg"])
    {'thickness': '60', 'missile.mass': '5 kg'}
    """
    values: dict[str, str] = {}
    for text in texts:
        name, equal, value = text.partition("=")
        if not equal and not values:
            raise failure(f"unexpected '{text}': one case at a time, then KEY=VALUE, such as thickness=60", 64)
        if not equal:
            last, start = list(values.items())[-1]
            raise failure(f"unexpected '{text}': quote values that contain blanks: {last}=\"{start} {text}\"", 64)
        if name.strip() in values:
            raise InputError(f"{name.strip()} is given twice: {values[name.strip()]} and {value}")
        if not value.strip():
            raise InputError(f"{name}= has no value; give one, such as thickness=60")
        values[name.strip()] = value.strip()
    return values


def _constant(attributes: str) -> Constant:
    """Returns what stands between the braces of a constant, or its plain value."""
    bare = re.sub(r'"[^"]*"', "", attributes)
    name = re.search(r'Name\s*"([^"]*)"', attributes)
    low, high = (found[1] if (found := re.search(rf"\b{word}\s+([-+.\deE]+)", bare)) else "" for word in ("Min", "Max"))
    choices = re.search(r"\bChoices\s*\{([^}]*)\}", bare)
    return Constant(bare.partition(",")[0].strip(), re.sub(r"^.*/\s*\d*\s*", "", name[1]) if name else "", low, high,
                    tuple(value.partition("=")[0].strip() for value in choices[1].split(",")) if choices else ())


def constants(case: Case) -> dict[str, Constant]:
    """Returns the parameters that the geometries of a case define, by their keys, as far as their files can be read."""
    found: dict[str, Constant] = {}
    for file, group in _PARAMETERS:
        path = case.path.parent / str(case.get(file) or "")
        if path.is_file() and path.suffix == ".geo":
            for block in _DEFINED.findall(_COMMENT.sub(r"\1", path.read_text(encoding="utf-8", errors="replace"))):
                for braced, inside, plain, value in _CONSTANT.findall(block):
                    found[f"{group}.{braced or plain}"] = _constant(inside or value)
    return found


def defined(case: Case) -> set[str]:
    """Returns the keys of those parameters."""
    return set(constants(case))


def includes(case: Case) -> bool:
    """Returns whether a geometry of the case reads other files, whose parameters `defined` does not see."""
    paths = [case.path.parent / str(case.get(file) or "") for file, _ in _PARAMETERS]
    return any(path.is_file() and re.search(r"^\s*(Include|Merge)\b", path.read_text(encoding="utf-8", errors="replace"), re.MULTILINE) for path in paths)


def find_key(case: Case, name: str) -> str:
    """Returns the key of a case that ends with `name`; an unknown or ambiguous name is an InputError that says what was meant."""
    known = set(case) | defined(case)
    groups = {key.rpartition(".")[0] for key in known}
    if name in known or name in groups:
        return name
    ends = sorted(key for key in known if key.endswith(f".{name}"))
    likely = [key for key in ends if key not in case or case[key] is not None]  # absent ones belong to groups that the case lacks
    if len(ends) == 1 or len(likely) == 1:
        return (likely or ends)[0]
    if ends:
        raise InputError(f"'{name}' is the end of several keys: {', '.join(likely or ends)}; write one of them in full")
    head, _, _ = name.rpartition(".")
    if head in groups:  # the reader of the case has a sentence for it, which lists the keys of the group
        return name
    words = {key.rpartition(".")[2].lower(): key.rpartition(".")[2] for key in known} | {key.lower(): key for key in known} | {word: word for word in FALL}
    near = difflib.get_close_matches(name.lower(), words, 1)
    hint = f"; did you mean '{words[near[0]]}'?" if near else "; `softfall run --keys CASE` lists them"
    raise InputError(f"unknown key '{name}'{hint}")


def listed(case: Case) -> list[str]:
    """Returns the values of a case as `softfall run` takes them, by keys as short as they can be."""
    keys = [key for key in case if key.rpartition(".")[2] not in ("parameters", "missile_parameters")]
    lines = []
    for key in [*keys, *sorted(defined(case) - set(case))]:
        short = key.rpartition(".")[2]
        try:
            short = short if find_key(case, short) == key and short not in FALL else key
        except InputError:
            short = key
        value = case.get(key)
        lines.append(f"{short}={'' if value is None else value}" + (f"  ({key})" if short != key else ""))
    return [*sorted(lines), "height=  (sets missile.velocity, such as height=\"1.3 m\")"]


_UNITS = {"geometry.missile_parameters": ("geometry.missile_length_unit", "geometry.length_unit"),
          "support.parameters": ("support.length_unit", "geometry.length_unit"), "geometry.parameters": ("geometry.length_unit",)}


def is_parameter(key: str) -> bool:
    """Returns whether a key is that of a parameter of a geometry."""
    return key.rpartition(".")[0] in _UNITS


def units_of(key: str) -> tuple[str, ...]:
    """Returns the keys of the units of a geometry's parameter: the first that is given holds."""
    return _UNITS[key.rpartition(".")[0]]


def as_number(case: Case, key: str, text: str, given: Mapping[str, str]) -> str:
    """Returns the value of a geometry's parameter as the plain number that the case takes: a length is converted to the unit of its file,
    which `given`, the other values of the command line by their keys, may set."""
    unit = next(str(value) for name in units_of(key) for value in (given.get(name), case.get(name)) if value is not None).strip('"')
    try:
        float(text)
        return text
    except ValueError:
        pass
    meant = f"{key} must be a number without a unit (this geometry is in {unit}), or a length such as \"60 {unit}\""
    try:
        value, kind = library.quantity(text)
    except Error:
        value, kind = math.nan, ""
    if kind != "m":
        raise InputError(f"{meant}, not \"{text}\"")
    return f"{value / library.quantity(f'1 {unit}')[0]:.12g}"


def gravity(rig: str | None) -> tuple[float, str]:
    """Returns the acceleration of a fall, m/s2, and where it comes from: that of free fall, or of a rig with friction."""
    if rig is None:
        return STANDARD_GRAVITY, "free fall"
    if not Path(rig).exists() and re.match(r"[-+.\d]", rig):
        try:
            value, kind = library.quantity(rig)
        except InputError as error:
            raise InputError(f'rig: {error}; expected the rig\'s g_eff, such as "7.97 m/s2", or a table of heights and speeds') from None
        if kind != "m s-2" or not 0 < value <= 1.01 * STANDARD_GRAVITY:
            raise InputError(f"rig=\"{rig}\" is outside 0 to {STANDARD_GRAVITY:g} m/s2; expected the rig's g_eff, such as \"7.97 m/s2\", or a table of heights and speeds")
        return value, f"on a rig with {value:.4g} m/s2"
    frame = laboratory.read(rig, kind="rig").frame
    height, speed = (frame.iloc[:, k].to_numpy(float) for k in (0, 1))
    if len(height) < 2 or not ((height > 0) & (speed > 0)).all():
        raise InputError(f"rig={rig} has {len(height)} usable pairs of height and speed; at least 2 above 0 are needed")
    value = float((2 * height * speed**2).sum() / (4 * height**2).sum())
    if not 0 < value <= 1.06 * STANDARD_GRAVITY:
        raise InputError(f"rig={rig}: its drops are faster than free fall ({value:.4g} m/s2 in place of {STANDARD_GRAVITY:g})")
    return value, f"on the rig of {rig}, {value:.4g} m/s2"


def fall_speed(height: str, rig: str | None) -> tuple[float, str]:
    """Returns the speed (m/s) of a fall from a height, v = sqrt(2 g h), and where it comes from.

    >>> round(fall_speed("1 m", None)[0], 4), fall_speed("1 m", "8 m/s2")[0]
    (4.4287, 4.0)
    """
    try:
        value, kind = library.quantity(height)
    except Error as error:
        raise InputError(f"height must be a length, such as \"1.3 m\": {error}") from None
    if kind != "m" or not 0 < value <= 100:
        raise InputError(f"height=\"{height}\" is outside 0 to 100 m; expected a length, such as \"1.3 m\"")
    acceleration, origin = gravity(rig)
    return math.sqrt(2 * acceleration * value), origin


def resolve(case: Case, given: Mapping[str, str]) -> tuple[dict[str, str], list[str]]:
    """Returns the values of a command line as a case takes them, and a sentence for each that was understood in another way."""
    values: dict[str, str] = {}
    said = []
    keys = {name: find_key(case, name) for name in given if name not in FALL}
    whole = {key: given[name] for name, key in keys.items()}
    for name, key in keys.items():
        text = given[name]
        value = as_number(case, key, text, whole) if is_parameter(key) else text
        if key in values:
            raise InputError(f"{key} is given twice: {values[key]} and {value}")
        values[key] = value
        if (key, value) != (name, text):
            said.append(f"{key} = {value}")
    if "height" in given:
        if SPEED in values:
            raise InputError(f"height={given['height']} and {SPEED}={values[SPEED]} both set the speed: give one of them")
        speed, origin = fall_speed(given["height"], given.get("rig"))
        values[SPEED] = f"{speed:.9g} m/s"
        said.append(f"{SPEED} = {speed:.4g} m/s ({given['height']}, {origin})")
    elif "rig" in given:
        raise InputError("rig= belongs to a height: give height=\"1.3 m\" as well")
    return values, said
