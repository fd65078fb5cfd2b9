# SPDX-License-Identifier: GPL-3.0-or-later
"""Units as laboratories write them in headings: what the programs know (docs/case.md, "Units"), and the spellings of machines and loggers."""
from __future__ import annotations

import functools
import re

from .. import library
from ..curves import STANDARD_GRAVITY
from ..errors import Error, InputError

SCALED = ("acceleration", "force", "length", "pressure")  # quantities of which a channel may be in volts or counts
SI = {"time": "s", "acceleration": "m s-2", "force": "N", "length": "m", "pressure": "Pa", "speed": "m s-1", "voltage": "V", "area": "m2",
      "strain rate": "s-1"}
_ACCELERATION = {r"(?i:g(?:n|0|_n|['’]?s|ee|ees)?)": STANDARD_GRAVITY, r"m[gG]|milli-?g": STANDARD_GRAVITY / 1e3}
_RATIO = {r"(?i:%|percent|pct|prozent|% ?strain)": 0.01, r"(?i:1|-|–|—|strain|fraction|dimensionless|unitless)": 1.0,
          r"(?i:[uµ](?:ε|e|str|strain)|micro-?strain)": 1e-6, r"(?i:mε|m?illi-?strain|mstrain|‰)": 1e-3}
_COUNT = r"(?i:(?:[\d.e+-]+ ?[^ \d]{1,8} ?/ ?)?(?:adc[ _-]?)?(?:counts?|cnts?|codes?|digits?|lsbs?|bits?)|adc|raw)"
_SPELLINGS = {  # of a whole unit, or of the time below a slash
    "time": {r"(?i:s|secs?|sek|sekunden|seg|seconds?)": "s", r"(?i:ms|m ?secs?|m ?sek|millisecs?|milliseconds?)": "ms",
             r"(?i:[uµ]s|[uµ]secs?|microsecs?|microseconds?)": "us", r"(?i:ns|nsecs?)": "ns"},
    "acceleration": {r"([mck]?m|in|ft)[ .·*]?s(?:ec)?(?:\^?-2|⁻²)": r"\1/s2", r"([mck]?m)(?:s2|ss|ps2|ps²)": r"\1/s2", r"(.*)/sec(.*)": r"\1/s\2"},
    "force": {r"(?i:lbs?\.?|lbs?f)": "lbf", r"KN": "kN", r"(?i:kp)": "kgf"},
    "pressure": {r"K[Pp][aA]|kpa|kPA": "kPa", r"M[Pp][aA]": "MPa", r"(?i:lbs?f?/(?:in|sq\.? ?in)(?:2|²|\^2|))": "psi", r"(?i:psi)": "psi"},
    "length": {r'(?i:inch(?:es)?|in|")': "in", r"M[mM]": "mm", r"(?i:mils?)": "mil"},
}


def plain(text: str) -> str:
    """Returns the text of a unit without brackets around it, and with one sign for each of minus, micro and power."""
    text = text.strip().strip('"').strip()
    while len(text) > 1 and text[0] + text[-1] in ("()", "[]", "<>", "{}"):
        text = text[1:-1].strip()
    return text.replace("−", "-").replace("μ", "µ").replace("**", "^").rstrip(".")


@functools.lru_cache(maxsize=None)
def factor(text: str, quantity: str) -> float | None:
    """Returns the size of a unit in SI (of a ratio 1, of counts 1), or None if the text is no unit of the quantity.

    >>> factor("ms", "time"), factor("(mSec)", "time"), factor("N", "length")
    (0.001, 0.001, None)
    >>> factor("ms-2", "acceleration"), factor("g's", "acceleration"), factor("µm/m", "ratio")
    (1.0, 9.80665, 1e-06)
    """
    text = plain(text)
    if not text or len(text) > 31:
        return None
    if quantity == "count":
        return 1.0 if re.fullmatch(_COUNT, text) else None
    if quantity == "ratio":
        return _ratio(text)
    known = _ACCELERATION if quantity == "acceleration" else {}
    for pattern, value in known.items():
        if re.fullmatch(pattern, text):
            return value
    for pattern, spelling in _SPELLINGS.get(quantity, {}).items():
        if re.fullmatch(pattern, text):
            text = re.sub(f"^(?:{pattern})$", spelling, text)
            break
    size, kind = _size(text)
    return size if kind == SI[quantity] else None


@functools.lru_cache(maxsize=None)
def _size(text: str) -> tuple[float, str]:
    """Returns the size of a unit that the programs know, and the SI unit of its kind; "" of another text."""
    if not re.fullmatch(r"(?:1 ?/ ?)?[(]*[A-Za-zµ]{1,12}[-A-Za-zµ0-9/*^.·²³⁻() ]*", text):
        return 0.0, ""
    try:
        return library.quantity(f"1 {text}")
    except InputError:
        return 0.0, ""


def _ratio(text: str) -> float | None:
    for pattern, value in _RATIO.items():
        if re.fullmatch(pattern, text):
            return value
    above, slash, below = text.partition("/")
    sizes = factor(above, "length") if slash else None, factor(below, "length") if slash else None
    return float(f"{sizes[0] / sizes[1]:.12g}") if sizes[0] and sizes[1] else None


_EXAMPLES = {"length": 'a length, such as "50 mm"', "area": 'an area, such as "25 cm2"', "speed": 'a speed, such as "3.4 m/s"'}


def quantity(text: str, kind: str, where: str) -> float:
    """Returns a quantity such as "50 mm" in SI; InputError names the place."""
    try:
        value, unit = library.quantity(text)
    except Error as error:
        raise InputError(f'{where}: {error}; expected {_EXAMPLES.get(kind, f"a {kind}")}') from None
    if unit != SI[kind]:
        raise InputError(f'{where}: "{text}" is no {kind}; expected {_EXAMPLES.get(kind, f"a {kind}")}')
    return value


def parse_scale(text: str) -> tuple[str, str, float]:
    """Returns the quantity, the kind of channel and the SI value of one of its units: of "10 mV/g", "5 kN/V" or "0.0122 g/count".

    >>> parse_scale("10 mV/g")
    ('acceleration', 'voltage', 980.665)
    """
    found = re.match(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*)", text)
    number, unit = (float(found[1]), found[2].strip()) if found else (0.0, "")
    for slash in re.finditer("/", unit):
        above, below = unit[:slash.start()], unit[slash.end():]
        for kind in ("voltage", "count"):
            for name in SCALED:
                size, channel = factor(above, name), factor(below, kind)
                other, channel_above = factor(below, name), factor(above, kind)
                value = number * size / channel if size and channel else other / (number * channel_above) if other and channel_above and number else None
                if value is not None and value <= 0:
                    raise InputError(f'the scale "{text}" is not above 0')
                if value is not None:
                    return name, kind, float(f"{value:.15g}")
    raise InputError(f'"{text}" is no scale of a channel: write for example "10 mV/g", "0.102 mV/(m/s2)", "5 kN/V" or "0.0122 g/count"')
