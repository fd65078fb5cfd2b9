# SPDX-License-Identifier: GPL-3.0-or-later
"""One progress bar over the steps of a drop: a line of up to 80 columns on a terminal, a few plain lines in a log."""
from __future__ import annotations

import shutil
import sys
import time
from typing import TextIO

from .case import Step

WIDTH = 79  # columns of the line at most
_QUIET = 10  # s between two plain lines of one step of the work
_MESH, _SOLVED = 0.1, 0.92  # shares of the whole after which the model is built, and the drop is solved
_UNTIL_PEAK = 0.55  # share of the time steps of a usual drop before the peak
_ENDING = 2.4  # time of the rebound over that of the peak, of usual drops


def duration(seconds: float) -> str:
    """Returns a time that is left in words.

    >>> duration(7.2), duration(100), duration(4000)
    ('7 s', '1 min 40 s', '1 h 6 min')
    """
    whole = max(1, round(seconds))
    if whole < 60:
        return f"{whole} s"
    return f"{whole // 60} min {whole % 60} s" if whole < 3600 else f"{whole // 3600} h {whole % 3600 // 60} min"


class Bar:
    """Shows what is done, the percent and the time left. The percent never falls."""

    def __init__(self, stream: TextIO | None = None, quiet: bool = False) -> None:
        self._stream = stream or sys.stderr
        self._quiet, self._terminal = quiet, self._stream.isatty()
        self._what, self._share, self._last, self._drawn = "", 0.0, 0.0, False

    def show(self, what: str, share: float, left: float | None = None, detail: str = "") -> None:
        """Shows the work at hand, the share of the whole that is done, and the seconds that are left."""
        self._share = max(self._share, min(1.0, share))
        rest = f"{100 * self._share:3.0f} %" + (f", about {duration(left)} left" if left is not None else "")
        now = time.monotonic()
        if self._quiet:
            return
        if self._terminal:
            columns = min(WIDTH, shutil.get_terminal_size().columns - 1)
            room = max(0, min(30, columns - len(what + detail) - len(rest) - 4))
            full = round(room * self._share)
            line = f"{what}{detail} [{'#' * full}{'.' * (room - full)}] {rest}"[:columns]
            self._stream.write(f"\r{line:<{columns}}")
            self._drawn = True
        elif what != self._what or now - self._last >= _QUIET:
            self._stream.write(f"{what}{detail}: {rest.strip()}\n")
            self._last = now
        self._what = what
        self._stream.flush()

    def clear(self) -> None:
        """Takes the line from the terminal, so that something else can be printed."""
        if self._drawn:
            self._stream.write(f"\r{'':{min(WIDTH, shutil.get_terminal_size().columns - 1)}}\r")
            self._stream.flush()
            self._drawn = False


class DropProgress:
    """The progress of one drop, or of a series, from its steps: the rebound ends it before the end time."""

    def __init__(self, bar: Bar, end_time: float, drops: int = 1, moves_freely: bool = True) -> None:
        self._bar, self._end, self._drops, self._free = bar, end_time, max(1, drops), moves_freely
        self._start = self._began = time.monotonic()
        self._number, self._time, self._peak, self._peak_time, self._longest = 1, -1.0, 0.0, 0.0, 0.0

    def __call__(self, step: Step) -> None:
        """Takes a step of the solver."""
        if self._time < 0:
            self._began = time.monotonic()
        elif step.time < self._time:  # the next drop of a series
            self._number, self._peak, self._peak_time, self._longest = self._number + 1, 0.0, 0.0, 0.0
        self._time, self._longest = step.time, max(self._longest, step.time_step)
        if abs(step.load) > self._peak:
            self._peak, self._peak_time = abs(step.load), step.time
        share = (self._number - 1 + self._share(step)) / self._drops
        spent, model = time.monotonic() - self._began, self._began - self._start
        left = spent * (1 - share) / share + 0.5 * model if share > 0.02 else None
        what = f"solving drop {self._number} of {self._drops}" if self._drops > 1 else "solving the drop"
        self._bar.show(what, _MESH + (_SOLVED - _MESH) * share, left, f", {1e3 * step.time:4.1f} ms")

    def _share(self, step: Step) -> float:
        """Returns the share of the drop that is done, by time steps: they shrink towards the peak, and grow again."""
        if not self._free:
            return step.time / self._end
        if step.time < 1.2 * self._peak_time or not self._peak:
            return min(_UNTIL_PEAK, max(step.step / step.steps if step.steps else 0.0, step.time / self._end))
        ahead = max(0.0, min(self._end, _ENDING * self._peak_time) - step.time) / self._longest
        return step.step / (step.step + ahead + 1)

    def begin(self) -> None:
        """Shows that the model is built."""
        self._bar.show("building the model", 0)

    def figures(self) -> None:
        """Shows that the figures and the pages are made."""
        self._bar.show("figures and report", _SOLVED)
