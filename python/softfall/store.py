# SPDX-License-Identifier: GPL-3.0-or-later
"""The drops of a study in one SQLite file, by the content of their inputs: nothing is lost by a kill, and nothing done twice by two processes."""
from __future__ import annotations

import contextlib
import fcntl
import json
import os
import secrets
import sqlite3
from pathlib import Path
from typing import Any, Iterator, NamedTuple, Sequence

from . import output as output_files
from .errors import Error, InputError
from .memory import DropFigures

NAME, AT_WORK = "drops.sqlite", "at-work"
_APPLICATION = 0x736F6674  # "soft", in the head of the file
_TABLES = """
CREATE TABLE IF NOT EXISTS drops (key TEXT PRIMARY KEY, state TEXT NOT NULL, owner TEXT, figures TEXT, files TEXT, message TEXT, seconds REAL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS study (name TEXT PRIMARY KEY, value TEXT) WITHOUT ROWID;
"""


class Entry(NamedTuple):
    """A drop, or a series, of the store."""

    state: str  # open, running, done or failed
    drops: list[DropFigures]
    files: str | None  # what its geometries have read; None: not known, as of a drop whose model could not be built
    message: str


class Store:
    """The store of a folder. A process that works on it holds the lock of a file, so that others see when it has died."""

    def __init__(self, folder: Path) -> None:
        self._path, self._folder = folder / NAME, folder / AT_WORK
        self._lock, self._token = -1, secrets.token_hex(8)
        with self._sentence():
            folder.mkdir(parents=True, exist_ok=True)
            self._data = sqlite3.connect(self._path, timeout=120, isolation_level=None)
            if self._data.execute("PRAGMA application_id").fetchone()[0] not in (0, _APPLICATION):
                raise InputError(f"{self._path} is no store of drops: give another folder")
            self._data.execute("PRAGMA journal_mode=WAL")
            self._data.execute("PRAGMA synchronous=NORMAL")
            self._data.execute(f"PRAGMA application_id={_APPLICATION}")
            self._data.executescript(_TABLES)

    def close(self) -> None:
        """Gives back what this process had begun, and closes the file."""
        with contextlib.suppress(Error):
            self.give_back()
        self._data.close()
        for path in self._folder.glob("*"):
            if not path.suffix and path.name != self._token:
                self._lives(path.name)  # a process that was killed without a drop at work left it
        if self._lock >= 0:
            with contextlib.suppress(OSError):
                os.unlink(self._folder / self._token)  # the folder stays: another process may be about to use it
            os.close(self._lock)

    @contextlib.contextmanager
    def _sentence(self) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, OSError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise Error(f"{self._path} cannot be used: {reason}; finished drops are kept: repeat the command when that is mended", 3) from None

    @contextlib.contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        with self._sentence():
            self._data.execute("BEGIN IMMEDIATE")
            try:
                yield self._data
                self._data.execute("COMMIT")
            except BaseException:
                with contextlib.suppress(sqlite3.Error):
                    self._data.execute("ROLLBACK")
                raise

    def begin(self) -> int:
        """Takes the lock that says that this process lives, and returns its descriptor; a program that inherits it lives for it."""
        if self._lock < 0:
            with self._sentence():
                self._folder.mkdir(exist_ok=True)
                begun = self._folder / f"{self._token}.begun"  # not yet locked
                self._lock = output_files.open_lock(begun)
                fcntl.flock(self._lock, fcntl.LOCK_EX)
                begun.rename(self._folder / self._token)
        return self._lock

    def _lives(self, owner: str) -> bool:
        """True if the process with this token still holds its lock; removes the lock of a dead one."""
        path = self._folder / Path(owner).name
        try:
            handle = os.open(path, os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC)
        except OSError:
            return False
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return True
        finally:
            os.close(handle)
        with contextlib.suppress(OSError):
            path.unlink()
        return False

    def others(self) -> bool:
        """Reopens what dead processes had begun; True if a living one has drops at work."""
        with self._sentence():
            owners = [owner for owner, in self._data.execute("SELECT DISTINCT owner FROM drops WHERE state='running'") if owner != self._token]
        dead = [owner for owner in owners if not self._lives(owner)]
        if dead:
            with self._transaction() as data:
                data.executemany("UPDATE drops SET state='open', owner=NULL WHERE state='running' AND owner=?", [(owner,) for owner in dead])
        return len(dead) < len(owners)

    def entries(self, keys: Sequence[str]) -> dict[str, Entry]:
        """Returns what there is of these drops."""
        found: dict[str, Entry] = {}
        with self._sentence():
            for begin in range(0, len(keys), 500):
                part = list(keys[begin:begin + 500])
                rows = self._data.execute(f"SELECT key, state, figures, files, message FROM drops WHERE key IN ({','.join('?' * len(part))})", part)
                for key, state, figures, files, message in rows:
                    found[key] = Entry(state, [DropFigures(*drop) for drop in json.loads(figures)] if figures else [], files, message or "")
        return found

    def take(self, keys: Sequence[str], most: int) -> list[str]:
        """Takes up to `most` of these drops that are open, for this process alone."""
        self.begin()
        taken: list[str] = []
        with self._transaction() as data:
            for key in keys:
                if len(taken) == most:
                    break
                data.execute("INSERT OR IGNORE INTO drops (key, state) VALUES (?, 'open')", (key,))
                if data.execute("UPDATE drops SET state='running', owner=? WHERE key=? AND state='open'", (self._token, key)).rowcount:
                    taken.append(key)
        return taken

    def finish(self, key: str, drops: Sequence[DropFigures], files: str | None, seconds: float, message: str = "") -> None:
        """Keeps a finished drop, or with a message one that failed."""
        with self._transaction() as data:
            data.execute("INSERT OR REPLACE INTO drops (key, state, figures, files, message, seconds) VALUES (?,?,?,?,?,?)",
                         (key, "failed" if message else "done", json.dumps(drops) if drops else None, files, message, seconds))

    def give_back(self) -> None:
        """Opens what this process has taken and not finished."""
        with self._transaction() as data:
            data.execute("UPDATE drops SET state='open', owner=NULL WHERE owner=?", (self._token,))

    def reopen(self, keys: Sequence[str]) -> None:
        """Opens drops that are done or failed, to be simulated again, and those that this process has taken."""
        with self._transaction() as data:
            data.executemany("UPDATE drops SET state='open', owner=NULL, figures=NULL, files=NULL, message=NULL WHERE key=? "
                             "AND (state IN ('done', 'failed') OR owner=?)", [(key, self._token) for key in keys])

    def seconds(self) -> list[float]:
        """Returns the times of the drops that are done, s."""
        with self._sentence():
            return [value for value, in self._data.execute("SELECT seconds FROM drops WHERE state='done' AND seconds > 0")]

    def get(self, name: str) -> Any:
        """Returns a note of the study, None if there is none."""
        with self._sentence():
            row = self._data.execute("SELECT value FROM study WHERE name=?", (name,)).fetchone()
        return json.loads(row[0]) if row else None

    def put(self, name: str, value: Any) -> None:
        """Keeps a note of the study."""
        with self._transaction() as data:
            data.execute("INSERT OR REPLACE INTO study VALUES (?,?)", (name, json.dumps(value)))
