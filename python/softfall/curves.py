# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves with units, and the two functions of every crash laboratory: HIC and the channel frequency classes."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from . import library
from .array import Array
from .errors import InputError

STANDARD_GRAVITY = 9.80665  # m/s2


class Column(np.ndarray[Any, Any]):
    """An array with `units` (UDUNITS spelling) and `description`. What is computed from it is a plain array.

    >>> a = column([1.0, 2.0, 3.0], "m s-2")
    >>> a[1:].units, type(2 * a).__name__
    ('m s-2', 'ndarray')
    """

    units: str
    description: str

    def __array_finalize__(self, source: Any) -> None:
        self.units = getattr(source, "units", "")
        self.description = getattr(source, "description", "")

    def __array_wrap__(self, out: Any, context: Any = None, return_scalar: bool = False) -> Any:
        plain = np.asarray(out)
        return plain[()] if plain.ndim == 0 else plain


def column(values: Any, units: str, description: str = "") -> Column:
    """Returns the values as a Column."""
    made = np.asarray(values).view(Column)
    made.units, made.description = units, description
    return made


class Hic(float):
    """A head injury criterion (g^2.5 s): a float with its window `t1` to `t2` in s."""

    t1: float
    t2: float


def _curve(time: Any, values: Any) -> tuple[Array, Array]:
    """Returns both as arrays of double; InputError unless they are a curve over seconds."""
    try:
        t, a = (np.ascontiguousarray(np.asarray(part, dtype=float)) for part in (time, values))
    except (TypeError, ValueError) as error:
        raise InputError(f"time and values must be numbers: {error}") from None
    if t.ndim != 1 or t.shape != a.shape:
        raise InputError(f"time and values must be two lists of one length: their shapes are {t.shape} and {a.shape}")
    if getattr(time, "units", "s") not in ("s", ""):
        raise InputError(f"time has the unit {time.units}, not s")
    interval = (t[-1] - t[0]) / (t.size - 1) if t.size > 1 else 0
    if interval > 0.01:
        raise InputError(f"the samples are {interval:g} s apart, more than 0.01 s: is the time in ms? It is to be in s")
    return t, a


def hic(time: Any, deceleration: Any, window: float = math.inf) -> Hic:
    """Returns the head injury criterion of a deceleration curve, as softfall-post computes it.

    `time` in s, ascending; `deceleration` in g, or a Column of `history` in m s-2, which is converted; `window` in s: the longest
    window (0.015 for HIC15). The curve is piecewise linear, and the window ends anywhere. 0 if nothing decelerates.

    100 g for 10 ms have HIC 0.01 x 100^2.5:

    >>> round(hic([0, 0.01], [100, 100]), 6)
    1000.0
    """
    t, a = _curve(time, deceleration)
    units = getattr(deceleration, "units", "")
    if units not in ("", "g", "m s-2"):
        raise InputError(f"the deceleration has the unit {units}, neither g nor m s-2")
    value, t1, t2 = library.hic(t, a / STANDARD_GRAVITY if units == "m s-2" else a, float(window))
    made = Hic(value)
    made.t1, made.t2 = t1, t2
    return made


def cfc(time: Any, values: Any, channel_class: float = 1000) -> Column:
    """Returns the curve filtered with a channel frequency class (60, 180, 600 or 1000; SAE J211-1), at the same times.

    `time` in s, ascending; the values keep their unit. As softfall-post filters a measured curve: at its own rate if that is
    uniform, else resampled.

    >>> t = [1e-4 * k for k in range(100)]
    >>> float(abs(cfc(t, [5.0] * 100, 180) - 5).max()) < 1e-12
    True
    """
    t, a = _curve(time, values)
    out = np.empty_like(a)
    library.cfc(t, a, float(channel_class), out)
    return column(out, getattr(values, "units", ""), f"CFC {channel_class:g}")
