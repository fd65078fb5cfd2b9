# SPDX-License-Identifier: GPL-3.0-or-later
"""The times of samples: columns of time, times of day and sampling rates, which must agree with each other."""
from __future__ import annotations

import re
from typing import Sequence

import numpy as np

from ..array import Array
from ..errors import InputError
from .cells import clock, is_clock

AGREE = 0.02  # relative difference between a rate and the times
SHORT = 0.005  # share of the span that rounded times may be wrong by
UNEVEN = 0.05  # share of an interval by which even times differ
_KEY = re.compile(r"(?i)\b(?:sampl\w*|scan|daq|acquisition|abtast|mess|data)[ _-]*(?:rate|freq\w*|frequenz)\b|\bfs\b|^\W*rate\b(?=.*(?:hz|s/s|sps)\b)")
_INTERVAL = re.compile(r"(?i)\b(?:sampl\w*|scan|abtast)[ _-]*(?:interval\w*|period\w*|time)\b|\b(?:time step|delta[ _]?[tx]|dt)\b|Δt\b")
_RATE_UNIT = re.compile(r"(?i)\b(?:([km]?)(?:hz|s/s|sps|sa/s|samples/s|samples per second))\b")
_TIME_UNIT = re.compile(r"\b([mnu]?s(?:ec)?)\b|µs")
_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
_SIZES = {"": 1.0, "k": 1e3, "m": 1e6}


def parse_rate(text: str) -> float:
    """Returns a sampling rate such as "20 kHz" in Hz."""
    found = re.fullmatch(r"\s*(\d+(?:\.\d+)?(?:e[+-]?\d+)?) *(Hz|kHz|MHz|1/s)\s*", text)
    rate = float(found[1]) * {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6, "1/s": 1.0}[found[2]] if found else 0.0
    if not rate > 0:
        raise InputError(f'"{text}" is not a sampling rate: write for example "20 kHz"')
    return rate


def stated_rates(lines: Sequence[str], decimal_comma: bool) -> dict[float, int]:
    """Returns the sampling rates (Hz) that the lines above a table state, with the numbers of their lines.

    >>> stated_rates(["Sample Rate (Hz),5000,5000", "AA filter (Hz),1000", "Sampling interval: 50 us"], False)
    {5000.0: 1, 20000.0: 3}
    """
    found: dict[float, int] = {}
    for number, line in enumerate(lines, 1):
        text = re.sub(r"(?<=\d),(?=\d)", ".", line) if decimal_comma else line
        interval = _INTERVAL.search(text)
        key = interval or _KEY.search(text)
        rest = text[key.end():] if key else ""
        values = {float(value) for value in _NUMBER.findall(rest)} - {0.0}
        if len(values) != 1:
            continue
        value = values.pop()
        if interval:
            unit = _TIME_UNIT.search(rest)
            size = {"m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9}.get(unit[0][0], 1.0) if unit else 0.0
            rate = 1 / (value * size) if size else 0.0
        else:
            unit = _RATE_UNIT.search(rest)
            rate = value * (_SIZES[unit[1].lower()] if unit else 1.0)
        if rate > 0:
            found.setdefault(float(f"{rate:.9g}"), number)
    return found


def quantum(cells: Sequence[str]) -> float:
    """Returns the step in which the numbers are written: 0.01 of "1.25"."""
    steps = []
    for cell in cells:
        mantissa, _, exponent = cell.lower().partition("e")
        decimals = len(mantissa.replace(",", ".").partition(".")[2])
        steps.append(10.0 ** (int(exponent or 0) - decimals))
    return max(steps) if any("e" in cell.lower() for cell in cells) else min(steps)


class Times:
    """The instants of samples (s): `of` the table's column, or by a rate; `words` says which."""

    def __init__(self, path: str, lines: Sequence[int], index: Array, spell_rate: str) -> None:
        self.path, self.lines, self.index, self.spell_rate = path, lines, index, spell_rate
        self.words = ""

    def by_rate(self, rate: float, begin: float = 0.0) -> Array:
        """Returns even times from the numbers of the samples."""
        even: Array = begin + (self.index - self.index[0] if begin else self.index) / rate
        return even

    def by_clock(self, cells: Sequence[str], rate: float | None, stated: dict[float, int]) -> Array:
        """Returns times of day from the first on; those that are written too coarsely need a rate."""
        time = clock(cells, self.path, self.lines)
        return self.checked(time - time[0], min(10.0 ** -len(re.sub(r".*:\d\d[.,:]?", "", cell).rstrip("APMapm. Z")) for cell in cells[:50]), rate, stated)

    def unit_of(self, number: Array, stated: dict[float, int], rate: float | None) -> tuple[str, float]:
        """Returns the unit of times without one that makes them agree with the stated rate, or ("", 0)."""
        span = number[-1] - number[0]
        for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
            for known in [rate] if rate else stated:
                if span > 0 and abs((self.index[-1] - self.index[0]) / (span * size) / known - 1) < AGREE:
                    return unit, size
        return "", 0.0

    def checked(self, time: Array, step: float, rate: float | None, stated: dict[float, int]) -> Array:
        """Returns the times, even ones where theirs are rounded; a rate that they contradict is refused."""
        span, intervals = time[-1] - time[0], self.index[-1] - self.index[0]
        if len(time) < 2:
            return time
        own = intervals / span if span > 0 else 0.0
        slack = AGREE + 2 * step / span if span > 0 else 0.0
        if rate and own and not abs(rate / own - 1) < slack:
            raise InputError(f"{self.path}: its times are those of {_hertz(own)}, not of {_hertz(rate)} as given: leave {self.spell_rate.format(_hertz(rate))} out, or give "
                             f"{self.spell_rate.format(_hertz(own))}")
        coarse = bool(np.all(np.diff(time) >= 0)) and float(np.mean(np.diff(time) <= 0)) > 0.5
        if coarse:  # the times tell the span at most
            rate = rate or (next(iter(stated)) if len(stated) == 1 else None)
            if rate is None:
                raise InputError(f"{self.path}:{self.lines[0]}: the times are written in steps of {step:g} s, too coarse for the samples: "
                                 f"give the rate of the logger, such as {self.spell_rate.format(_hertz(own) if own else '20 kHz')}")
            self.words = f"even times at {_hertz(rate)} as {f'line {stated[rate]} states' if rate in stated else 'given'}, as those in the file are rounded to {step:.3g} s"
            return self.by_rate(rate)
        wrong = {known: line for known, line in stated.items() if own and not abs(known / own - 1) < slack}
        if stated and not rate and len(wrong) == len(stated):
            known, line = next(iter(wrong.items()))
            raise InputError(f"{self.path}: line {line} states {_hertz(known)}, but the times are those of {_hertz(own)}: is the unit of the times another one? "
                             f"If they are right, give {self.spell_rate.format(_hertz(own))}")
        agreeing = rate or next((known for known in stated if known not in wrong), None)
        gaps = np.diff(time)
        even: Array = time[0] + (self.index - self.index[0]) / (agreeing or own or 1.0)
        rounded = bool(own) and bool(np.all(np.abs(time - even) <= (step if agreeing else 0.51 * step) * (1 + 1e-6) + (abs(agreeing / own - 1) * span if agreeing else 0)))
        uneven = bool(np.any(np.abs(gaps - 1 / own * np.diff(self.index)) > UNEVEN / own)) if own else True
        if rounded and uneven and (agreeing or step <= SHORT * span):
            self.words = f"even times at {_hertz(agreeing or own)}, as those in the file are rounded to {step:.3g} s"
            return even
        self._check_ascent(time, own, gaps)
        return time

    def _check_ascent(self, time: Array, own: float, gaps: Array) -> None:
        if np.all(gaps > 0):
            return
        k = int(np.argmax(gaps <= 0)) + 1
        how = f"; if the times are rounded, give the sampling rate with {self.spell_rate.format(_hertz(own))}" if own and np.all(gaps >= 0) else ""
        raise InputError(f"{self.path}:{self.lines[k]}: time {1e3 * time[k]:g} ms does not follow {1e3 * time[k - 1]:g} ms of the row before{how}")


GAP, FEW = 1.5, 0.05  # intervals of so many times the usual one are gaps, if they are so few; of more the sampling is uneven


def time_notes(time: Array) -> list[str]:
    """Returns what is odd about times (s): gaps, in which samples were lost, and times that repeat or fall.

    >>> time_notes(np.delete(np.arange(100) * 1e-3, [50, 51]))
    ['1 gap in the times, of 3 ms at 49 ms, where samples are 1 ms apart: 2 samples are lost']
    """
    steps = np.diff(time)
    usual = float(np.median(steps)) if steps.size else 0.0
    if not usual > 0:
        return []
    notes, gaps = [], np.flatnonzero(steps > GAP * usual)
    if 0 < gaps.size <= max(1, FEW * steps.size):
        k, lost = int(gaps[np.argmax(steps[gaps])]), int(np.sum(np.round(steps[gaps] / usual) - 1))
        notes.append(f"{gaps.size} gap{'s' if gaps.size > 1 else ''} in the times, {'the longest ' if gaps.size > 1 else ''}of {1e3 * steps[k]:.4g} ms at {1e3 * time[k]:.6g} ms, "
                     f"where samples are {1e3 * usual:.4g} ms apart: {lost} sample{'s are' if lost > 1 else ' is'} lost")
    back = np.flatnonzero(steps <= 0)
    if back.size:
        notes.append(f"{back.size} time{'s' if back.size > 1 else ''} not after the one before, first {1e3 * time[back[0] + 1]:.6g} ms")
    return notes


def _hertz(rate: float) -> str:
    return f"{rate / 1e3:.6g} kHz" if rate >= 1e3 else f"{rate:.6g} Hz"


def are_times_of_day(cells: Sequence[str]) -> bool:
    """True if the first cells are times of day."""
    return bool(cells) and all(map(is_clock, cells[:3]))
