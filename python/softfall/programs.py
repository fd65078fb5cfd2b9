# SPDX-License-Identifier: GPL-3.0-or-later
"""The programs of softfall as children: where they are, how they are started, and what they say."""
from __future__ import annotations

import contextlib
import math
import os
import pty
import re
import shutil
import signal
import subprocess
import tempfile
import threading
import time
import warnings
from pathlib import Path
from typing import Callable, Iterator, Mapping, Sequence

from .errors import Error, SoftfallWarning, failure

_HERE = Path(__file__).resolve().parent
_running: set[subprocess.Popen[bytes]] = set()
_lock = threading.Lock()
_ending = threading.Event()
_limit = threading.local()  # `end`: of the time of this thread's programs, on the monotonic clock


def folder() -> Path:
    """Returns the folder of the programs: $SF_BIN_DIR, else that beside this package (a build or an installed tree), else on PATH."""
    given = os.environ.get("SF_BIN_DIR")
    if given:
        if not os.access(Path(given) / "softfall-solve", os.X_OK):
            raise Error(f"SF_BIN_DIR is {given}, and there is no program softfall-solve in it", 3)
        return Path(given).absolute()
    for place in ((_HERE / "../../build/bin").resolve(), (_HERE / "../../../../bin").resolve()):
        if os.access(place / "softfall-solve", os.X_OK):
            return place
    found = shutil.which("softfall-solve")
    if not found:
        raise Error("the program softfall-solve is found neither beside the Python package nor on PATH: install softfall, "
                    "build it (./setup.sh build), or set SF_BIN_DIR to the folder of its programs", 3)
    return Path(found).absolute().parent


def stop_all() -> None:
    """Ends all programs that run after their present step, with a checkpoint, waits for them, and starts no other one."""
    with _lock:
        _ending.set()
        children = list(_running)
    for child in children:
        _signal(child, signal.SIGINT)
    for child in children:
        child.wait()


def _signal(child: subprocess.Popen[bytes], number: int) -> None:
    try:
        os.killpg(child.pid, number)  # a child leads its own group, which has its helpers, too
    except ProcessLookupError:
        pass


def _lines(stream: int) -> Iterator[str]:
    """Yields the lines of a file descriptor; a carriage return ends one, too, as in the progress of softfall-solve."""
    rest = b""
    while True:
        try:
            piece = os.read(stream, 65536)
        except OSError:  # a pseudo-terminal whose other end is closed
            piece = b""
        *whole, rest = re.split(rb"[\r\n]+", rest + piece)
        yield from (line.decode(errors="replace") for line in whole if line)
        if not piece:
            if rest:
                yield rest.decode(errors="replace")
            return


def _wait(child: subprocess.Popen[bytes]) -> None:
    """Waits for a child that is to end; a second Ctrl-C kills it."""
    try:
        child.wait()
    except BaseException:
        _signal(child, signal.SIGKILL)
        child.wait()
        raise


def _sentences(program: str, errors: str, heard: list[str]) -> str:
    """Passes a program's warnings on, also to a list, and returns the sentence of its failure."""
    said = [re.sub(rf"^(\S*/)?{program}: ", "", line).strip() for line in errors.splitlines() if line.strip()]
    other = []
    for sentence in said:
        if sentence.startswith("warning: "):
            heard.append(f"{program}: {sentence[9:]}")
            warnings.warn(heard[-1], SoftfallWarning, stacklevel=4)
        elif not sentence.startswith(("note: ", "Try `")):
            other.append(sentence)
    return " ".join(other)


def run(name: str, arguments: Sequence[str], *, threads: int | None = None, terminal: bool = False, keep: Sequence[int] = (),
        on_line: Callable[[str], object] | None = None, heard: list[str] | None = None) -> str:
    """Runs softfall-`name` and returns what it printed; a failure is an exception with the program's sentence.

    `terminal`: the program tells its progress as to a terminal; `keep`: file descriptors that it inherits; `heard` takes its warnings. An exception here,
    such as that of Ctrl-C or of `on_line`, ends the program cleanly before it goes on to the caller.
    """
    program = f"softfall-{name}"
    environment = dict(os.environ) if threads is None else {**os.environ, "OMP_NUM_THREADS": str(threads)}
    ours, theirs = pty.openpty() if terminal else os.pipe()
    printed = []
    with tempfile.TemporaryFile() as errors:
        try:
            child = subprocess.Popen([str(folder() / program), *arguments], stdin=subprocess.DEVNULL, stdout=theirs, stderr=errors,
                                     start_new_session=True, env=environment, pass_fds=keep)
        except OSError as error:
            os.close(ours)
            raise Error(f"{program} cannot be started: {error.strerror}", 3) from error
        finally:
            os.close(theirs)
        watch = _Watch(child)
        try:
            with _lock:
                _running.add(child)
                if _ending.is_set():
                    raise failure(f"{program} is not run any more: the process ends", 130)
            for line in _lines(ours):
                printed.append(line)
                if on_line:
                    on_line(line)
            child.wait()
        except BaseException:
            _signal(child, signal.SIGINT)
            _wait(child)
            raise
        finally:
            watch.cancel()
            with _lock:
                _running.discard(child)
            os.close(ours)
        errors.seek(0)
        sentence = _sentences(program, errors.read().decode(errors="replace"), [] if heard is None else heard)
    code = child.returncode
    if watch.over and code:
        raise Error(f"{program} was ended, as the drop took longer than its time limit", 5)
    if code < 0:
        raise Error(f"{program} was ended by signal {-code} ({signal.Signals(-code).name})", 128 - code)
    if code in (130, 143):
        raise failure(f"{program} was interrupted; the same call again resumes it", 130)
    if code:
        raise failure(f"{program}: {sentence or f'failed with exit code {code}'}", code)
    return "\n".join(printed)


@contextlib.contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Ends the programs that this thread runs in the block after so many seconds: an Error."""
    _limit.end = time.monotonic() + seconds
    try:
        yield
    finally:
        del _limit.end


class _Watch:
    """Ends a child when the time of its thread is over."""

    def __init__(self, child: subprocess.Popen[bytes]) -> None:
        self.over = False
        left = getattr(_limit, "end", math.inf) - time.monotonic()
        self._timer = threading.Timer(max(left, 0), self._end, (child,)) if left < math.inf else None
        if self._timer:
            self._timer.daemon = True
            self._timer.start()

    def _end(self, child: subprocess.Popen[bytes]) -> None:
        self.over = True
        _signal(child, signal.SIGINT)

    def cancel(self) -> None:
        if self._timer:
            self._timer.cancel()


def options(given: Mapping[str, object]) -> list[str]:
    """Returns the options of a program: `jobs=2, force=True, limit_g=160` gives --jobs=2 --force --limit-g=160.

    >>> options({"jobs": 2, "force": True, "limit_g": 160.5, "retry": False, "film": None})
    ['--jobs=2', '--force', '--limit-g=160.5']
    """
    chosen = {name.replace("_", "-"): value for name, value in given.items() if value is not None and value is not False}
    return [f"--{name}" if value is True else f"--{name}={value}" for name, value in chosen.items()]
