# SPDX-License-Identifier: GPL-3.0-or-later
"""Worker processes that simulate drops in memory: `python -m softfall.worker SHARE` reads a drop from each line and answers with its figures."""
from __future__ import annotations

import concurrent.futures
import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Callable, NamedTuple

from . import memory, programs
from .errors import Error, failure
from .memory import DropFigures

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
    """A process that simulates one task at a time."""

    def __init__(self, share: str, module: str) -> None:
        package = str(Path(__file__).resolve().parent.parent)
        path = os.pathsep.join([package, *filter(None, [os.environ.get("PYTHONPATH")])])
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": path, "SF_BIN_DIR": str(programs.folder())}
        self._process = subprocess.Popen([sys.executable, "-m", module, share], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                         start_new_session=True, env=environment)

    def ask(self, task: Any) -> Answer:
        assert self._process.stdin and self._process.stdout
        try:
            self._process.stdin.write(json.dumps(task).encode() + b"\n")
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


class Pool:
    """Workers side by side; a context manager, at whose end they go."""

    def __init__(self, jobs: int, share: Path, module: str = "softfall.worker") -> None:
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
        for worker in list(self._all):
            worker.end()
        self._threads.shutdown(wait=True, cancel_futures=True)

    def _ask(self, task: Any) -> Answer:
        worker = self._free.get()
        if self._ended:
            raise failure("the study ends", 130)
        if worker is None:
            worker = _Worker(self._share, self._module)
            self._all.append(worker)
        answer: Answer | None = None
        try:
            answer = worker.ask(task)
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
    answer(lambda request: simulate(Task(*request), sys.argv[1]))
