# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the rows of a plan through a store of drops: what is there is found by its content, the rest is simulated by workers."""
from __future__ import annotations

import collections
import concurrent.futures
import math
import re
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Iterable

import numpy as np

from . import library, memory, output as output_files, programs, rows_command
from .array import Array
from .errors import Error, InputError
from .library import GRADES
from .memory import DropFigures
from .plan import RATIO, Plan
from .progress import duration
from .store import Entry, Store
from .worker import OF_THE_MACHINE, Answer, Pool, Task

ANVIL = "the missile reached the anvil"
WRITE_INTERVAL = 20.0  # s between two writings of runs.csv
REFINED = ("a_max_g", "hic", "max_indentation_mm", "v_rebound_m_s")


def csv_text(text: str) -> str:
    """Returns a text for a cell, which no spreadsheet takes for a formula.

    >>> csv_text("=1+1"), csv_text("-3.5"), csv_text("-a")
    ("'=1+1", '-3.5', "'-a")
    """
    text = re.sub(r"[\r\n]", " ", text)
    is_number = re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text)
    return f"'{text}" if text[:1] in ("=", "+", "-", "@", "\t") and not is_number else text


@dataclass
class Row:
    """A row of the plan: its key, or why it has none, and what the store has of it."""

    key: str = ""
    counted: list[bool] = field(default_factory=lambda: [True])
    state: str = "open"  # open, done or failed
    message: str = ""
    drops: list[DropFigures] = field(default_factory=list)
    judged: DropFigures | None = None

    def take(self, entry: Entry | None) -> None:
        """Takes what the store has of it."""
        if self.key:
            self.state, self.message, self.drops, self.judged = "open", "", [], None
        if entry is None or entry.state not in ("done", "failed"):
            return
        self.state, self.message = entry.state, entry.message
        if entry.state == "done":
            self.drops = entry.drops
            self.judged = memory.judge(entry.drops, self.counted)
            self.judged = self.judged._replace(figures={key: memory.nine_digits(value) for key, value in self.judged.figures.items()})
            self.message = self.judged.verdict if self.judged.grade else ""

    @property
    def is_usable(self) -> bool:
        return self.judged is not None and GRADES[self.judged.grade] != "do not use"

    def value(self, figure: str) -> float:
        """Returns a figure if the row can be used, else NaN."""
        return self.judged.figures[figure] if self.judged and self.is_usable else math.nan


@dataclass
class Table:
    """The rows of a plan with their states; `coarse` those of the second mesh."""

    plan: Plan
    rows: list[Row]
    coarse: list[Row] = field(default_factory=list)

    def count(self, state: str) -> int:
        return sum(row.state == state for row in self.rows)

    def values(self, figure: str) -> Array:
        return np.array([row.value(figure) for row in self.rows])

    def refined(self, k: int) -> tuple[list[tuple[float, float]], str]:
        """Returns value and error of each of REFINED of a row for ever finer meshes, and why one has none."""
        fine, coarse = self.rows[k], self.coarse[k]
        if not (fine.is_usable and coarse.is_usable):
            bad = coarse if fine.is_usable else fine
            return [(math.nan, math.nan)] * len(REFINED), f"{'its coarse' if fine.is_usable else 'its'} drop: {bad.message or 'not simulated'}"
        assert fine.judged and coarse.judged
        found, notes = [], []
        a, b = fine.judged.figures, coarse.judged.figures
        for key in REFINED:
            try:
                found.append(library.refine(a[key], b[key], RATIO, a["cells"] / b["cells"]))
            except Error as error:
                found.append((math.nan, math.nan))
                notes.append(f"{key}: {error}")
        return found, "; ".join(notes)

    def write(self, path: Path) -> None:
        """Writes runs.csv."""
        keys = list(memory.figure_keys())
        place = keys.index("touched")  # how the run ended, a text, stands before it
        heading = ["id", *(factor.heading for factor in self.plan.factors), "run_status", "grade", "message", "folder", *keys[:place], "status", *keys[place:]]
        if self.coarse:
            heading += [name for key in REFINED for name in (f"{key}_refined", f"{key}_refined_error")] + ["refined_note"]
        rows: list[list[Any]] = [[csv_text(word) for word in heading]]
        for k, row in enumerate(self.rows):
            cells = [str(k + 1), *(csv_text(factor.text(self.plan.value(f, k))) for f, factor in enumerate(self.plan.factors)), row.state,
                     GRADES[row.judged.grade] if row.judged else "", csv_text(row.message), ""]
            figures = [_cell(row.judged.figures[key]) if row.judged else "" for key in keys]
            cells += [*figures[:place], csv_text(row.judged.status) if row.judged else "", *figures[place:]]
            if self.coarse:
                pairs, note = self.refined(k)
                cells += [_cell(value) for pair in pairs for value in pair] + [csv_text(note)]
            rows.append(cells)
        output_files.write(path, output_files.table(rows))

    def write_drops(self, path: Path) -> None:
        """Writes drops.csv: each drop of the rows that are done."""
        keys = list(memory.figure_keys())
        place = keys.index("touched")
        rows: list[list[Any]] = [["id", "drop", "counted", "grade", *keys[:place], "status", *keys[place:]]]
        for k, row in enumerate(self.rows):
            for number, (drop, counts) in enumerate(zip(row.drops, row.counted), 1):
                figures = [_cell(drop.figures[key]) for key in keys]
                rows.append([k + 1, number, "yes" if counts else "no", GRADES[drop.grade], *figures[:place], csv_text(drop.status), *figures[place:]])
        output_files.write(path, output_files.table(rows))


def _cell(value: float) -> str:
    return f"{value:.9g}" if math.isfinite(value) else ""


class Campaign:
    """A plan and the folder of its store."""

    def __init__(self, plan: Plan, folder: Path, retry: bool = False, tell: Callable[[str], None] = print) -> None:
        self.plan, self.folder, self.retry, self.tell = plan, folder, retry, tell
        self.store: Store | None = None
        self.simulated = self.found = 0
        self._tasks: dict[str, Task] = {}
        self._forget: set[str] = set()  # keys of the store that are of files that have changed, or are to be done again

    def open(self) -> None:
        """Opens the store, which is made if need be."""
        self.store = self.store or Store(self.folder)

    def close(self) -> None:
        if self.store:
            self.store.close()
            self.store = None

    def look(self) -> Table:
        """Reads the inputs of all rows, and what the store has of them."""
        coarse = [self._row(k, True) for k in range(self.plan.rows)] if self.plan.refine else []
        table = Table(self.plan, [self._row(k, False) for k in range(self.plan.rows)], coarse)
        self.refresh(table)
        return table

    def _row(self, k: int, coarse: bool) -> Row:
        overrides = self.plan.overrides(k, coarse)
        try:
            with memory.Inputs(self.plan.case, overrides) as inputs:
                inputs.check()
                row = Row(inputs.key(), inputs.counted())
                entry = self.store.entries([row.key]).get(row.key) if self.store and row.key not in self._tasks else None
                kept = entry is not None and entry.files is not None and inputs.has_files(entry.files)
                if entry and entry.state in ("done", "failed") and (not kept or (self.retry and entry.state == "failed")):
                    self._forget.add(row.key)
        except InputError as error:
            return Row("", state="failed", message=str(error))
        self._tasks[row.key] = Task(row.key, self.plan.case, overrides)
        return row

    def refresh(self, table: Table) -> None:
        """Takes what the store has."""
        if not self.store:
            return
        rows = [*table.rows, *table.coarse]
        entries = self.store.entries([row.key for row in rows if row.key])
        for row in rows:
            if row.key:
                row.take(None if row.key in self._forget else entries.get(row.key))

    def open_keys(self, table: Table) -> list[str]:
        """Returns the drops that are to be simulated, each once."""
        return list(dict.fromkeys(row.key for row in [*table.rows, *table.coarse] if row.key and row.state == "open"))

    def run(self, table: Table, jobs: int) -> None:
        """Simulates the open rows, and keeps runs.csv up to date. Other processes may do the same at the same time."""
        assert self.store
        self.store.reopen(sorted(self._forget))
        self._forget.clear()
        wanted = self.open_keys(table)
        self.found = len({row.key for row in [*table.rows, *table.coarse] if row.key and row.state == "done"})
        open_keys, elsewhere = collections.deque(wanted), collections.deque[str]()
        start = written = time.monotonic()
        failed: Error | None = None
        at_work: set[concurrent.futures.Future[Answer]] = set()
        with Pool(max(1, min(jobs, len(wanted))), self.folder / "shared") as pool:
            while True:
                while failed is None and open_keys and len(at_work) < pool.jobs:
                    part = [open_keys.popleft() for _ in range(min(pool.jobs - len(at_work), len(open_keys)))]
                    taken = set(self.store.take(part, len(part)))
                    at_work |= {pool.start(self._tasks[key]) for key in part if key in taken}
                    elsewhere.extend(key for key in part if key not in taken)
                if not at_work and (failed or not elsewhere):
                    break
                done, at_work = concurrent.futures.wait(at_work, 1.0 if at_work else 0, concurrent.futures.FIRST_COMPLETED)
                for future in done:
                    failed = self._keep(future) or failed
                if elsewhere and not done:
                    self._look_elsewhere(open_keys, elsewhere, bool(at_work))
                if time.monotonic() - written > WRITE_INTERVAL:
                    self.refresh(table)
                    table.write(self.folder / "runs.csv")
                    written = time.monotonic()
                    self._progress(table, start)
        self.refresh(table)
        if failed:
            raise failed

    def run_elsewhere(self, table: Table, jobs: int, seconds: float, profile: str | None, per_job: int | None) -> None:
        """Simulates the open rows by an engine, in jobs of a block each; takes the answers of a campaign that was killed, too."""
        assert self.store
        forgotten = set(self._forget)
        self.store.reopen(sorted(forgotten))
        self._forget.clear()
        self.store.others()
        lock = self.store.begin()
        self._keep_all(answer for answer in rows_command.answers(self.folder) if answer.key not in forgotten)
        self.refresh(table)
        keys = self.open_keys(table)
        self.found = len({row.key for row in [*table.rows, *table.coarse] if row.key and row.state == "done"})
        taken = self.store.take(keys, len(keys))
        if taken:
            size = per_job or rows_command.block_size(seconds if math.isfinite(seconds) else 1.0, len(taken), jobs)
            self._keep_all(rows_command.simulate(self.folder, [self._tasks[key] for key in taken], size, jobs, profile, lock))
            self.store.give_back()
        self.refresh(table)
        left = len(self.open_keys(table))
        if left:
            raise Error(f"{left} drops were not simulated: see {self.folder / rows_command.BATCH / 'log.txt'}, what another command in this folder has begun is among them; "
                        "finished drops are kept: repeat the command", 3)

    def _keep_all(self, answers: Iterable[Answer]) -> None:
        """Keeps the answers of an engine to tasks that are not done."""
        assert self.store
        for answer in answers:
            entry = self.store.entries([answer.key]).get(answer.key)
            if entry is None or entry.state in ("open", "running"):
                self.store.finish(answer.key, answer.drops, answer.files, answer.seconds, answer.message)
                self.simulated += 1

    def _keep(self, future: concurrent.futures.Future[Answer]) -> Error | None:
        """Keeps an answer; returns a failure that is the machine's and ends the campaign: its drop stays open."""
        assert self.store
        try:
            answer = future.result()
        except Error as error:
            return error
        if answer.code in OF_THE_MACHINE:
            self.store.reopen([answer.key])
            return Error(f"{answer.message}; finished drops are kept: repeat the command", answer.code)
        self.simulated += 1
        self.store.finish(answer.key, answer.drops, answer.files, answer.seconds, answer.message)
        return None

    def _look_elsewhere(self, open_keys: collections.deque[str], elsewhere: collections.deque[str], busy: bool) -> None:
        """Looks at drops that other processes have begun: they are done, or open again as the process has died."""
        assert self.store
        self.store.others()
        entries = self.store.entries(list(elsewhere))
        open_keys.extend(key for key in elsewhere if key not in entries or entries[key].state == "open")
        still = [key for key in elsewhere if key in entries and entries[key].state == "running"]
        elsewhere.clear()
        elsewhere.extend(still)
        if still and not busy:
            time.sleep(0.2)

    def _progress(self, table: Table, start: float) -> None:
        spent, left = time.monotonic() - start, len(self.open_keys(table))
        if self.simulated:
            self.tell(f"{len(table.rows) - table.count('open')} of {len(table.rows)} runs; {spent:.0f} s so far, about {duration(spent / self.simulated * left)} to go")

    def check_unchanged(self, table: Table) -> None:
        """Raises an Error if a row no longer has the inputs that it had at the beginning."""
        self._tasks.clear()
        again = self.look()
        changed = [k + 1 for k, (old, new) in enumerate(zip(table.rows, again.rows)) if old.key != new.key or (old.state == "done" and new.state != "done")]
        if changed:
            raise Error(f"the inputs of run {changed[0]}{f' and {len(changed) - 1} more' if changed[1:] else ''} changed while the campaign ran; finished drops "
                        "are kept: repeat the command", 3)


_TIME = re.compile(r"typical run time\s+([\d.]+) s on two cores")
_MEASURED = 10.0  # s; a drop that takes less is simulated to know its time
_FEW = 200  # rows whose time nobody needs to know before they begin


def estimate(plan: Plan, store: Store | None, asked: bool) -> tuple[float, str]:
    """Returns the processor time of a run, s, and where it comes from: finished drops, or the first row; NaN: that has no model, or nobody has asked."""
    known = store.seconds() if store else []
    if not known and not asked and plan.rows <= _FEW:
        return math.nan, ""
    if known:
        return float(np.median(known)), f"from {len(known)} finished drop{'s' if known[1:] else ''}: the median of their times"
    overrides = plan.overrides(0)
    try:
        with output_files.scratch() as scratch:
            said = programs.run("pre", [plan.case, f"--output={scratch / 'model.h5'}", "--estimate", *(f"--set={text}" for text in [*overrides, *memory.LEAN])], threads=1)
            found = _TIME.search(said)
            seconds = 2 * float(found[1]) if found else math.nan  # of two cores
            if seconds > _MEASURED:
                return seconds, "the estimate of softfall-pre for the first row, to a factor of 2; no run is finished yet"
            with memory.Inputs(plan.case, overrides) as inputs:
                task = Task(inputs.key(), plan.case, overrides)
            with Pool(1, scratch / "shared") as pool:
                pool.start(task).result()
                answer = pool.start(task).result()  # of a worker that has begun, and a mesh that is there
            if answer.message:
                return math.nan, f"the first row failed: {answer.message}"
            return answer.seconds, "that of the first row, which was simulated to know it"
    except Error as error:
        return math.nan, f"the first row has no model: {error}"
