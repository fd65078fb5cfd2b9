# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of the package, read and written as the C programs do (src/io/plain_file.h, replace.h): plain ones, whole at any instant."""
from __future__ import annotations

import contextlib
import csv
import fcntl
import io
import os
import re
import secrets
import shutil
import stat
import tempfile
import tomllib
from pathlib import Path
from typing import Any, Iterable, Iterator, NoReturn, Sequence

from .errors import Error, InputError


MOST_TEXT = 1 << 28  # bytes of a text that somebody would write


def read(path: str | os.PathLike[str], most: int = MOST_TEXT) -> bytes:
    """Returns the content of a plain file; InputError for a pipe, a device, a folder, and a file that is too large. It never waits."""
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY)
    except ValueError:
        raise InputError(f"{os.fspath(path)!r} is no name of a file") from None
    except OSError as error:
        raise InputError(f"{os.fspath(path)} cannot be read: {error.strerror}") from None
    with os.fdopen(handle, "rb", closefd=True) if stat.S_ISREG(os.fstat(handle).st_mode) else _refused(handle, path) as stream:
        data = stream.read(most + 1)
    if len(data) > most:
        raise InputError(f"{os.fspath(path)} is larger than {most / 1e6:.3g} MB")
    return data


def _refused(handle: int, path: str | os.PathLike[str]) -> NoReturn:
    os.close(handle)
    raise InputError(f"{os.fspath(path)} is not a plain file")


def read_toml(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Returns the content of a TOML file; InputError names the file and what is wrong in it."""
    data = read(path)
    try:
        return tomllib.loads(data.decode("utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{os.fspath(path)}: {error}") from None
    except (RecursionError, ValueError) as error:
        raise InputError(f"{os.fspath(path)}: {'it is nested too deep' if isinstance(error, RecursionError) else error}") from None


def check(path: str | os.PathLike[str], *inputs: str | os.PathLike[str]) -> Path:
    """Returns the path of an output; InputError if it is no place for a file, or one of the inputs, however that is spelled."""
    place = Path(path)
    if "\0" in os.fspath(place) or not place.name:
        raise InputError(f"{os.fspath(path)!r} is no name of a file")
    with contextlib.suppress(OSError):
        mode = place.stat().st_mode
        if not stat.S_ISREG(mode):
            kind = "a folder" if stat.S_ISDIR(mode) else "no plain file (a pipe, a socket or a device)"
            raise InputError(f"the output {place} cannot be written: it is {kind}")
        for source in inputs:
            with contextlib.suppress(OSError):
                if "\0" not in os.fspath(source) and os.path.samefile(place, source):
                    raise InputError(f"the output {place} would replace an input, {source}: give another name")
    if place.is_symlink() and not place.exists():
        raise InputError(f"the output {place} cannot be written: it is a link to nothing")
    return place


def check_own(path: str | os.PathLike[str], mark: bytes, writer: str) -> None:
    """Refuses to replace a file in whose first lines the mark of its writer is missing; it may be absent or empty."""
    place = Path(path)
    if place.is_file() and place.stat().st_size and mark not in b"".join(read(place, 1 << 30).splitlines(keepends=True)[:3]):
        raise InputError(f"{place} was not written by {writer}, and is not replaced: give another name")


def check_page(path: Path) -> None:
    """Refuses to replace a page that is not of softfall; it may be absent or empty."""
    if path.is_file() and path.stat().st_size and b"softfall" not in read(path, 1 << 30):
        raise InputError(f"{path} is not of softfall, and is not replaced: give another directory")


def check_all(folder: Path, names: Iterable[str], inputs: Sequence[str | os.PathLike[str]]) -> None:
    """Checks the names of the outputs of a command in its folder, and that a report.html there is of softfall."""
    for name in names:
        check(folder / name, *inputs)
    check_page(folder / "report.html")


def refuse_existing(folder: Path, names: Iterable[str], force: bool) -> None:
    """Refuses a folder with files of these names; with `force` they are to be replaced."""
    there = next((name for name in names if (folder / name).exists()), None)
    if there and not force:
        raise InputError(f"{folder} already holds {there}: give another directory, or --force to replace it")


def table(rows: Iterable[Iterable[Any]]) -> str:
    """Returns rows as the text of a CSV file.

    >>> table([["a", "b"], [1, "x,y"]])
    'a,b\\n1,"x,y"\\n'
    """
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(rows)
    return stream.getvalue()


def write(path: str | os.PathLike[str], content: str | bytes, *inputs: str | os.PathLike[str]) -> None:
    """Writes a file under another name on the same file system, brings it to the disk and renames it: after a failure the earlier file remains.

    No link is followed: what has the name is replaced itself. An input is never replaced.
    """
    place = check(path, *inputs)
    _clear(place)
    partial = place.with_name(f"{place.name}.partial-{os.getpid()}-{secrets.token_hex(4)}")
    data = content.encode("utf-8", "replace") if isinstance(content, str) else content
    try:
        handle = os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
            os.replace(partial, place)
        except BaseException:
            with contextlib.suppress(OSError):
                partial.unlink()
            raise
    except OSError as error:
        raise Error(f"{place} cannot be written: {error.strerror}", 3) from None


def _clear(place: Path) -> None:
    """Removes the partial files of this name whose process has ended."""
    with contextlib.suppress(OSError):
        for entry in os.scandir(place.parent):
            found = re.fullmatch(re.escape(place.name) + r"\.partial-(\d{1,9})-[0-9a-f]{8}", entry.name)
            if found and not _lives(int(found[1])) and entry.is_file(follow_symlinks=False):
                os.unlink(entry.path)


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        pass
    return True


def open_lock(path: Path) -> int:
    """Returns the descriptor of a file to be locked, which is made if need be: not through a link, and only a plain file."""
    try:
        handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC, 0o666)
    except OSError as error:
        raise Error(f"the lock {path} cannot be opened: {error.strerror}; it is a plain file, and may be removed", 3) from None
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise Error(f"the lock {path} is no plain file: remove it", 3)
    return handle


class Scratch:
    """A temporary folder, `name`, in `place` (by default that of the system), which goes with `cleanup`, or with the next one that is made there
    after its process was killed: the process holds a lock on it."""

    def __init__(self, place: Path | None = None) -> None:
        prefix = "softfall-" if place is None else ".softfall-"
        top = Path(tempfile.gettempdir() if place is None else place)
        _clear_folders(top, prefix)
        try:
            self.name = tempfile.mkdtemp(prefix=f"{prefix}{os.getpid()}-", dir=top)
            self._lock = os.open(self.name, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        except OSError as error:
            raise Error(f"no temporary folder can be made in {top}: {error.strerror}", 3) from None
        with contextlib.suppress(OSError):
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def cleanup(self) -> None:
        """Removes the folder."""
        if self._lock >= 0:
            shutil.rmtree(self.name, ignore_errors=True)
            os.close(self._lock)
            self._lock = -1

    def __del__(self) -> None:
        if hasattr(self, "_lock"):
            self.cleanup()


@contextlib.contextmanager
def scratch(place: Path | None = None) -> Iterator[Path]:
    """Makes a temporary folder, which goes with the block."""
    made = Scratch(place)
    try:
        yield Path(made.name)
    finally:
        made.cleanup()


def _clear_folders(top: Path, prefix: str) -> None:
    """Removes the temporary folders of this user whose process was killed."""
    with contextlib.suppress(OSError):
        for entry in os.scandir(top):
            found = re.fullmatch(re.escape(prefix) + r"(\d{1,9})-\w{8}", entry.name)
            if not found or _lives(int(found[1])) or not entry.is_dir(follow_symlinks=False) or entry.stat(follow_symlinks=False).st_uid != os.getuid():
                continue
            with contextlib.suppress(OSError):
                handle = os.open(entry.path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
                try:
                    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)  # one of another machine has it
                    shutil.rmtree(entry.path, ignore_errors=True)
                finally:
                    os.close(handle)
