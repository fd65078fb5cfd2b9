# SPDX-License-Identifier: GPL-3.0-or-later
"""Worker processes that simulate drops in memory: `python -m softfall.worker` reads a drop, and the folder of its meshes, from each line and answers with its figures."""
from __future__ import annotations

import concurrent.futures
import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any, Callable, Iterator, NamedTuple

from . import memory, programs
from .errors import Error, failure
from .memory import DropFigures

DROPS = "softfall.worker"  # simulates drops
OF_THE_MACHINE = (3, 6)  # exit codes of failures that are not the drop's own: a file, memory


class Task(NamedTuple):
    """A drop to be simulated: its inputs must still have this key."""

    key: str
    case: str
    overrides: list[str]


class Answer(NamedTuple):
    """What a worker says of a task: its drops, or the sentence and the exit code of its failure."""

    key: str
    drops: list[DropFigures]
    files: str | None
    seconds: float
    message: str = ""
    code: int = 0


def simulate(task: Task, share: str) -> Answer:
    """Simulates a task in this process."""
    start, files = time.perf_counter(), None
    try:
        with memory.Inputs(task.case, task.overrides) as inputs:
            inputs.check()
            if inputs.key() != task.key:
                raise Error(memory.CHANGED, 3)
            run = inputs.run(share)
            files = run.files
        with memory.Inputs(task.case, task.overrides) as inputs:  # what was read between the two is of this key, too
            if inputs.key() != task.key or not inputs.has_files(files):
                raise Error(memory.CHANGED, 3)
        return Answer(task.key, run.drops, files, time.perf_counter() - start)
    except Error as error:
        return Answer(task.key, [], getattr(error, "files", files), time.perf_counter() - start, str(error), error.code)


class _Worker:
    """A process that simulates one task at a time. `kind` is what it begins with: the program, the folder and the settings."""

    def __init__(self, module: str) -> None:
        self.kind = _kind(module)
        package = str(Path(__file__).resolve().parent.parent)
        path = os.pathsep.join([package, *filter(None, [os.environ.get("PYTHONPATH")])])
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": path, "SF_BIN_DIR": str(programs.folder())}
        self._process = subprocess.Popen([sys.executable, "-m", module], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                         start_new_session=True, env=environment)

    def is_alive(self) -> bool:
        return self._process.poll() is None

    def ask(self, task: Any, share: str) -> Answer:
        assert self._process.stdin and self._process.stdout
        try:
            self._process.stdin.write(json.dumps([task, share]).encode() + b"\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except OSError:
            line = b""
        if not line.endswith(b"\n"):
            code = self._process.wait()
            if code in (-signal.SIGKILL, -signal.SIGTERM):
                raise Error(f"a worker was ended by signal {-code} ({signal.Signals(-code).name}) while it simulated a drop, as for want of memory: fewer --jobs "
                            "need less; the same command goes on", 6)
            return Answer(task.key, [], None, 0.0, f"the worker crashed ({'signal' if code < 0 else 'exit code'} {abs(code)})", 7)
        key, drops, *rest = json.loads(line)
        return Answer(key, [DropFigures(*drop) for drop in drops], *rest)

    def end(self) -> None:
        with contextlib.suppress(OSError):
            self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):
                if stream:
                    stream.close()


_resting: list[_Worker] | None = None  # within `kept`
_lock = threading.Lock()  # of `_resting`: a pool has threads


def _kind(module: str) -> tuple[Any, ...]:
    return module, os.getcwd(), *sorted(item for item in os.environ.items() if item[0].startswith(("SF_", "SOFTFALL_", "OMP_")))


@contextlib.contextmanager
def kept() -> Iterator[None]:
    """Within this context a worker of drops that is free at the end of its pool serves the next one: its start takes as long as ten drops.

    Those of `softfall fit` do not, as they keep models."""
    global _resting
    if _resting is not None:
        yield
        return
    _resting = []
    try:
        yield
    finally:
        for worker in _resting:
            worker.end()
        _resting = None


def _begin(module: str) -> _Worker:
    kind = _kind(module)
    with _lock:
        found = next((worker for worker in _resting or () if worker.kind == kind), None)
        if _resting and found:
            _resting.remove(found)
    if found and not found.is_alive():
        found.end()
        found = None
    return found or _Worker(module)


class Pool:
    """Workers side by side; a context manager, at whose end they go, or rest (`kept`)."""

    def __init__(self, jobs: int, share: Path, module: str = DROPS) -> None:
        self.jobs, self._share, self._module = jobs, str(share), module
        self._free: queue.SimpleQueue[_Worker | None] = queue.SimpleQueue()
        self._all: list[_Worker] = []
        self._ended = False
        for _ in range(jobs):
            self._free.put(None)
        self._threads = concurrent.futures.ThreadPoolExecutor(jobs)

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: Any) -> None:
        self._ended = True
        free: list[_Worker] = []
        with contextlib.suppress(queue.Empty):
            while True:
                worker = self._free.get_nowait()
                free += [worker] if worker else []
        for _waiting in range(self.jobs):
            self._free.put(None)
        for worker in list(self._all):
            if _resting is not None and worker in free and self._module == DROPS:
                _resting.append(worker)
            else:
                worker.end()
        self._threads.shutdown(wait=True, cancel_futures=True)

    def _ask(self, task: Any) -> Answer:
        worker = self._free.get()
        if self._ended:
            raise failure("the study ends", 130)
        if worker is None:
            worker = _begin(self._module)
            self._all.append(worker)
        answer: Answer | None = None
        try:
            answer = worker.ask(task, self._share)
            return answer
        finally:
            broken = answer is None or answer.code == 7
            if broken:
                worker.end()
                self._all.remove(worker)
            self._free.put(None if broken else worker)

    def start(self, task: Any) -> concurrent.futures.Future[Answer]:
        """Simulates a task as soon as a worker is free."""
        return self._threads.submit(self._ask, task)


def answer(solve: Callable[[list[Any]], Answer]) -> None:
    """Answers requests until there are no more: the end of the process that asks is the end of its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what a library prints is no answer
    memory.hold_units()
    for line in sys.stdin:
        answers.write(json.dumps(solve(json.loads(line))) + "\n")
        answers.flush()


if __name__ == "__main__":
    answer(lambda request: simulate(Task(*request[0]), request[1]))
