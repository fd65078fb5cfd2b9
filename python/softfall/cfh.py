# SPDX-License-Identifier: GPL-3.0-or-later
"""Critical fall heights: where a_max or HIC first reaches its limit, by a search on simulated drops that are kept by content (docs/cfh.md).

A search holds the limit between two drops, one below it and one above, until these are close; the height is read between them.
"""
from __future__ import annotations

import collections
import concurrent.futures
import math
import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Callable, Generator, Mapping, NamedTuple, Sequence

import numpy as np
from scipy.interpolate import BarycentricInterpolator, PchipInterpolator
from scipy.optimize import brentq

from . import memory
from .campaign import ANVIL
from .curves import STANDARD_GRAVITY
from .errors import Error, failure
from .library import GRADES
from .progress import duration
from .store import Entry, Store
from .worker import OF_THE_MACHINE, Answer, Pool, Task

CRITERIA, FIGURES, UNITS = ("a_max", "HIC"), ("a_max_g", "hic"), (" g", "")
LOWEST, GREATEST = 0.01, 100.0  # m, heights that are simulated
MOST_DROPS = 24  # of a search
FIRST_SLOPE, FIRST_GAP = 1.2, 0.5  # d ln(a_max) / d ln(height), and ln of the ratio of the first two heights, before drops tell
OVERSHOOT, LARGEST_STEP = 1.1, 0.8  # of a step to the limit; the latter of ln(height)
FAILED_GAP = 0.02  # ln(height) between the highest drop that can be used and one that cannot, where a search ends
APART = 0.02  # ln(height) from one drop of a cubic to the next
MAX_FALL = 0.02  # of a figure between two heights; less is the scatter of single runs
HIC_POWER = 2.5  # of the deceleration
STRAIN_MARGIN = 0.02  # beyond the data of the foam: worth a note
ENDINGS = {"list": "every height of the list was simulated", "enough": "two drops hold the limit between them, closer than the tolerance",
           "max": "no limit is reached up to the greatest height allowed (--max-height)", "min": "a limit is exceeded down to 1 cm",
           "collapsed": "no limit is reached up to the height at which the simulation fails, reaches the anvil or is not to be used",
           "cap": f"the search has simulated {MOST_DROPS} drops"}


def speed_of(height: float) -> float:
    """Returns the speed of free fall, m/s.

    >>> round(speed_of(1.0), 4)
    4.4287
    """
    return math.sqrt(2 * STANDARD_GRAVITY * height)


class Point(NamedTuple):
    """A drop, or a series, from a height of free fall (m)."""

    height: float
    value: tuple[float, float]  # a_max (g) and HIC; NaN: the drop cannot be used
    least: tuple[float, float] = (0.0, 0.0)  # what is certain of them if it cannot be used
    grade: str = "valid"
    note: str = ""
    on_anvil: bool = False
    figures: Mapping[str, float] = {}

    @property
    def failed(self) -> bool:
        return math.isnan(self.value[0])

    def excess(self, limits: Sequence[float]) -> float:
        """Returns ln of the largest figure over its limit; inf: it cannot be used, but exceeds a limit all the same; NaN: it tells nothing."""
        if self.failed:
            return math.inf if self.on_anvil or any(least >= limit for least, limit in zip(self.least, limits)) else math.nan
        return max(math.log(value / limit) for value, limit in zip(self.value, limits))


class Crossing(NamedTuple):
    """Where a criterion reaches its limit (m), between the heights of two drops."""

    state: str
    height: float = math.nan
    below: float = math.nan
    above: float = math.nan


@dataclass(frozen=True)
class Result:
    """What the drops of a search say: `height` (m) if the verdict is "found"; `exceeding` is the lowest drop without figures that exceeds a limit."""

    verdict: str
    deciding: int = -1
    crossings: tuple[Crossing, ...] = (Crossing("not determined"),) * 2
    lowest: float = math.nan
    highest: float = math.nan
    exceeding: Point | None = None
    problem: str = ""

    @property
    def height(self) -> float:
        return self.crossings[self.deciding].height if self.verdict == "found" else math.nan


def curve(points: Sequence[Point], criterion: int) -> Any:
    """Returns ln(figure) over ln(height) through drops that can be used, without overshoot; beyond them it is not defined (NaN)."""
    return PchipInterpolator([math.log(p.height) for p in points], [math.log(p.value[criterion]) for p in points], extrapolate=False)


def usable(points: Sequence[Point], limits: Sequence[float]) -> tuple[list[Point], Point | None]:
    """Returns the drops that can be used below the lowest one without figures that exceeds a limit, and that one."""
    exceeding = next((p for p in points if p.excess(limits) == math.inf), None)
    return [p for p in points if not p.failed and (exceeding is None or p.height < exceeding.height)], exceeding


def _cross(points: Sequence[Point], criterion: int, limit: float) -> Crossing:
    first = next((k for k, p in enumerate(points) if p.value[criterion] >= limit), None)
    if first is None:
        return Crossing("not reached")
    if first == 0:
        return Crossing("exceeded at the lowest height")
    low, high = points[first - 1].height, points[first].height
    line = _line(points, criterion, first)
    root = brentq(lambda x: float(line(x)) - math.log(limit), math.log(low), math.log(high), xtol=1e-13) if points[first].value[criterion] > limit else math.log(high)
    return Crossing("crossed", min(max(math.exp(root), low), high), low, high)


def _line(points: Sequence[Point], criterion: int, first: int) -> Any:
    """Returns ln(figure) between the drops before and at `first`: a cubic through two drops on each side if it only rises there, else without overshoot."""
    x, y = np.log([p.height for p in points]), np.log([p.value[criterion] for p in points])
    beside = [next((k for k in order if abs(x[k] - x[end]) > APART), None) for order, end in ((range(first - 2, -1, -1), first - 1), (range(first + 1, len(points)), first))]
    chosen = [k for k in (beside[0], first - 1, first, beside[1]) if k is not None]
    cubic = BarycentricInterpolator(x[chosen], y[chosen])
    rises = np.diff(cubic(np.linspace(x[first - 1], x[first], 20))) > 0
    return cubic if rises.all() else curve(points, criterion)


def evaluate(points: Sequence[Point], limits: Sequence[float]) -> Result:
    """Returns which limit is reached first, and where.

    >>> evaluate([Point(h, (50 * h, 300 * h**2.5)) for h in (1.0, 1.5, 2.0)], (200, 1000)).verdict
    'found'
    """
    good, exceeding = usable(points, limits)
    if not good:
        return Result("below the lowest point", _exceeded(exceeding, limits), exceeding=exceeding) if exceeding else \
            Result("not determined", problem="no drop can be used: " + (points[0].note if points else "there is none"))
    found = Result("not determined", lowest=good[0].height, highest=good[-1].height, exceeding=exceeding)
    for c, name in enumerate(CRITERIA):
        values = np.array([p.value[c] for p in good])
        before = np.maximum.accumulate(values)
        k = int(np.argmin(values / before))
        if values[k] < (1 - MAX_FALL) * before[k]:
            return replace(found, problem=f"{name} falls from {before[k]:.4g} at {good[int(np.argmax(values[:k]))].height:.4g} m to {values[k]:.4g} at "
                          f"{good[k].height:.4g} m: it does not grow with the height, so no critical height can be read")
    crossings = tuple(_cross(good, c, limits[c]) for c in range(2))
    heights = [0.0 if one.state.startswith("exceeded") else one.height if one.state == "crossed" else math.inf for one in crossings]
    deciding = int(np.argmin(heights))
    if math.isinf(heights[deciding]):
        return replace(found, verdict="above the highest point", crossings=crossings)
    return replace(found, verdict="found" if heights[deciding] else "below the lowest point", deciding=deciding, crossings=crossings)


def _exceeded(point: Point | None, limits: Sequence[float]) -> int:
    return next((c for c in range(2) if point and point.least[c] >= limits[c]), -1)


@dataclass(frozen=True)
class Search:
    """Which heights to simulate next. That depends on the drops before alone, so a search that is repeated takes the same way."""

    limits: tuple[float, float]
    first: float  # m of free fall
    highest: float  # m of free fall
    tolerance: float  # of ln(height), between the two drops that hold the limit
    unit: float = 1.0  # m of free fall for 1 m on the scale of the user, where heights have four digits
    at_once: int = 2  # heights that are simulated side by side
    slope: float = FIRST_SLOPE
    heights: tuple[float, ...] = ()  # m of free fall: these instead of a search

    def steps(self) -> Generator[list[float], list[Point], tuple[list[Point], str]]:
        """Yields heights, is sent their drops, and returns all drops with the reason of the end."""
        points: list[Point] = []
        wanted, ending = (list(self.heights), "list") if self.heights else self.next(points)
        while wanted:
            points = sorted([*points, *(yield wanted)], key=lambda p: p.height)
            wanted, ending = ([], "list") if self.heights else self.next(points)
        return points, ending

    def next(self, points: Sequence[Point]) -> tuple[list[float], str]:
        """Returns the next heights, or none and the reason of the end."""
        if not points:
            return self._free([self.first, self.first * math.exp(FIRST_GAP)], points), ""
        if len(points) >= MOST_DROPS:
            return [], "cap"
        good, _ = usable(points, self.limits)
        over = next((p for p in points if p.excess(self.limits) >= 0), None)
        below = next((p for p in reversed(good) if p.excess(self.limits) < 0 and (over is None or p.height < over.height)), None)
        if below is None:
            return self._down(points, over)
        if over is None:
            return self._up(points, good, below)
        return self._between(points, good, below, over)

    def _free(self, heights: Sequence[float], points: Sequence[Point]) -> list[float]:
        """Returns those of the heights that are new, rounded, as many as are simulated at once."""
        wanted = [float(f"{min(max(h, LOWEST), self.highest) / self.unit:.4g}") * self.unit for h in heights]
        new = [h for k, h in enumerate(wanted) if not any(math.isclose(h, other, rel_tol=1e-6) for other in [*(p.height for p in points), *wanted[:k]])]
        return new[:self.at_once]

    def _step(self, good: Sequence[Point], at: Point) -> float:
        """Returns the step of ln(height) from a drop to its limit and a bit beyond, by the slope of the drops beside it."""
        k, slope = good.index(at), self.slope
        if len(good) > 1:
            a, b = (good[k - 1], at) if k else (at, good[1])
            slope = (b.excess(self.limits) - a.excess(self.limits)) / math.log(b.height / a.height)
        return min(max(OVERSHOOT * abs(at.excess(self.limits)) / max(slope, 0.5), 5 * self.tolerance), LARGEST_STEP)

    def _up(self, points: Sequence[Point], good: Sequence[Point], below: Point) -> tuple[list[float], str]:
        if below.height >= self.highest * (1 - 1e-6):
            return [], "max"
        step = self._step(good, below)
        failed = next((p.height for p in points if p.failed and p.height > below.height), math.inf)
        if math.log(failed / below.height) <= FAILED_GAP:
            return [], "collapsed"
        step = min(step, 0.5 * math.log(failed / below.height))
        wanted = self._free([below.height * math.exp(step * part) for part in (1, 0.5)], points)
        return wanted, "" if wanted else "collapsed"

    def _down(self, points: Sequence[Point], over: Point | None) -> tuple[list[float], str]:
        lowest = min([p for p in points if over is None or p.height <= over.height], key=lambda p: p.height)
        if lowest.height <= LOWEST * (1 + 1e-6):
            return [], "collapsed" if over is None else "min"
        good = [p for p in points if not p.failed]
        step = LARGEST_STEP if lowest.failed else self._step(good, lowest)
        wanted = self._free([lowest.height * math.exp(-step * part) for part in (1, 0.5)], points)
        return wanted, "" if wanted else "min"

    def _between(self, points: Sequence[Point], good: Sequence[Point], below: Point, over: Point) -> tuple[list[float], str]:
        """Returns heights close to the limit on both sides, in the gap between two drops where it is met."""
        inside = [p for p in points if below.height <= p.height <= over.height]
        ends = [math.log(p.height) for p in inside]
        result = evaluate(points, self.limits)
        if over.failed:  # it is met somewhere between a drop that can be used and one that cannot
            low, high = ends[0], ends[1]
            if high - low <= max(self.tolerance, FAILED_GAP):
                return [], "collapsed"
            places = [low + (high - low) / 3, high - (high - low) / 3] if self.at_once > 1 else [(low + high) / 2]
        elif result.verdict != "found":
            return [], "enough"  # the figures do not grow: evaluate says it
        else:
            at = math.log(result.height)
            k = min(max(int(np.searchsorted(ends, at)) - 1, 0), len(ends) - 2)
            low, high = ends[k], ends[k + 1]
            if high - low <= self.tolerance:
                return [], "enough"
            aside = max(0.4 * self.tolerance, 0.04 * (high - low))
            places = [at - aside, at + aside] if self.at_once > 1 or at - low > high - at else [at + aside, at - aside]
            room = 0.1 * min(self.tolerance, high - low)
            places = [min(max(x, low + room), high - room) for x in places]
        wanted = self._free([math.exp(x) for x in places], points)
        return wanted, "" if wanted else "enough"


@dataclass
class Bench:
    """Simulates the drops of searches side by side, and keeps each in the store of a folder by the content of its inputs."""

    case: str
    overrides: list[str]  # of all drops, without the speed
    folder: Path
    jobs: int
    retry: bool = False
    tell: Callable[[str], None] = print
    simulated: int = 0
    found: int = 0
    _entries: dict[str, Entry] = field(default_factory=dict)
    _facts: dict[str, tuple[list[float], list[bool]]] = field(default_factory=dict)

    def run(self, searches: Mapping[str, Search], materials: Mapping[str, str] | None = None) -> dict[str, tuple[list[Point], str]]:
        """Runs searches to their ends; `materials` are files of the foams of the searches, that of the case where there is none."""
        made: dict[str, tuple[list[Point], str]] = {}
        ways = {name: search.steps() for name, search in searches.items()}
        asked: dict[str, list[tuple[float, str]]] = {}
        tasks: dict[str, Task] = {}
        start = time.monotonic()
        store = Store(self.folder)
        try:
            with Pool(max(1, self.jobs), self.folder / "shared") as pool:
                queue: collections.deque[str] = collections.deque()
                at_work: set[concurrent.futures.Future[Answer]] = set()

                def ask(name: str, heights: Sequence[float]) -> None:
                    asked[name] = [(height, self._look(store, tasks, queue, height, (materials or {}).get(name))) for height in heights]

                for name, way in ways.items():
                    ask(name, next(way))
                while asked:
                    for name in [name for name, list_ in asked.items() if all(key in self._entries for _, key in list_)]:
                        points = [self._point(height, key, tasks[key]) for height, key in asked.pop(name)]
                        for point in points if len(searches) == 1 else ():
                            self.tell(f"  {point.height:.4g} m of free fall: " + (f"cannot be used: {point.note}" if point.failed else
                                                                                f"a_max {point.value[0]:.1f} g, HIC {point.value[1]:.0f}"))
                        try:
                            ask(name, ways[name].send(points))
                        except StopIteration as end:
                            made[name] = end.value
                            if len(searches) > 1 and len(made) % 20 == 0 and len(made) < len(searches):
                                spent = time.monotonic() - start
                                self.tell(f"{len(made)} of {len(searches)} foams; about {duration(spent / len(made) * (len(searches) - len(made)))} to go")
                    self._work(store, pool, tasks, queue, at_work)
        finally:
            store.close()
        return made

    def _look(self, store: Store, tasks: dict[str, Task], queue: collections.deque[str], height: float, material: str | None) -> str:
        """Returns the key of a drop, which is taken from the store, or queued."""
        own = [text for text in self.overrides if not text.startswith("material=")] if material else self.overrides
        overrides = [*([f"material=@{material}"] if material else []), *own, f"missile.velocity={speed_of(height):.12g} m/s"]
        with memory.Inputs(self.case, overrides) as inputs:
            inputs.check()
            key = inputs.key()
            if key in tasks:
                return key
            tasks[key] = Task(key, self.case, overrides)
            self._facts[key] = inputs.data_ends(), inputs.counted()
            entry = store.entries([key]).get(key)
            if entry and entry.state in ("done", "failed"):
                if entry.files is not None and inputs.has_files(entry.files) and not (self.retry and entry.state == "failed"):
                    self._entries[key] = entry
                    self.found += 1
                    return key
                store.reopen([key])
        queue.append(key)
        return key

    def _work(self, store: Store, pool: Pool, tasks: Mapping[str, Task], queue: collections.deque[str], at_work: set[concurrent.futures.Future[Answer]]) -> None:
        """Begins drops that are open, and keeps those that have ended. Another process may have begun some of them."""
        elsewhere = []
        while queue and len(at_work) < pool.jobs:
            key = queue.popleft()
            if store.take([key], 1):
                at_work.add(pool.start(tasks[key]))
                continue
            store.others()
            entry = store.entries([key])[key]
            if entry.state in ("done", "failed"):
                self._entries[key] = entry
            else:
                elsewhere.append(key)
                break
        queue.extend(elsewhere)
        if elsewhere and not at_work:
            time.sleep(0.2)
        if not at_work:
            return
        done, rest = concurrent.futures.wait(at_work, 1.0, concurrent.futures.FIRST_COMPLETED)
        at_work.intersection_update(rest)
        for answer in (future.result() for future in done):
            if answer.code in OF_THE_MACHINE:
                raise Error(f"{answer.message}; finished drops are kept: repeat the command", answer.code)
            if answer.code not in (0, 5):  # no failure of the simulation: the drop has none
                raise failure(answer.message, answer.code)
            self.simulated += 1
            store.finish(answer.key, answer.drops, answer.files, answer.seconds, answer.message)
            self._entries[answer.key] = store.entries([answer.key])[answer.key]

    def _point(self, height: float, key: str, task: Task) -> Point:
        """Returns a drop that has ended as a point of a search."""
        entry, (ends, counted) = self._entries[key], self._facts[key]
        if entry.state == "failed":
            return Point(height, (math.nan, math.nan), grade=GRADES[2], note=f"the simulation failed: {entry.message}", on_anvil=ANVIL in entry.message)
        drop = memory.judge(entry.drops, counted)
        values = (drop.figures["a_max_g"], drop.figures["hic"])
        if GRADES[drop.grade] == "do not use" or not all(value > 0 for value in values):
            least = (drop.sure * values[0], drop.sure ** HIC_POWER * values[1]) if drop.sure > 0 else (0.0, 0.0)
            note = f"{drop.verdict}" + (f"; yet a_max is at least {least[0]:.0f} g and HIC {least[1]:.0f}" if drop.sure > 0 else "")
            return Point(height, (math.nan, math.nan), least, GRADES[2], note)
        strain, end = max(one.figures["max_local_strain"] for one in entry.drops), max(ends)
        notes = ["contact had not ended at the end of the run: a_max and HIC may be too low"] * math.isnan(drop.figures["v_rebound_m_s"])
        notes += [f"largest local strain {strain:.3f}, the foam's data end at {end:.3f}: extrapolated curve"] * (strain > end + STRAIN_MARGIN)
        notes += [drop.verdict] * (drop.grade == 1)
        figures = {**drop.figures, "max_local_strain": strain, "data_end": min(ends)}
        return Point(height, values, grade=GRADES[drop.grade], note="; ".join(notes), figures=figures)
