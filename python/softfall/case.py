# SPDX-License-Identifier: GPL-3.0-or-later
"""A case file with values of one's own, and its drop."""
from __future__ import annotations

import contextlib
import fcntl
import hashlib
import os
import re
import shutil
import tempfile
import warnings
from pathlib import Path
from typing import Any, Callable, Iterator, Mapping, MutableMapping, NamedTuple

import h5py
import numpy as np

from . import laboratory, library, output as output_files, programs
from .drop import Drop, as_str, later_results
from .errors import Error, InputError, NumericError, SoftfallWarning, find, path_of

RUNS = "softfall-runs"  # the folder of runs without a name
WARNINGS = "warnings.txt"  # what softfall-pre warned of, told again when the drop is found
FAILED = "failed.txt"  # in the folder of a drop: the sentence with which its solution failed
ENDED = ("finished", "rebound")  # states of a whole run
_LINE = re.compile(r'(\S+)\s+("(?:[^"\\]|\\.)*"|\[[^]]*\]|\([^)]*\)|\{[^}]*\}|\S+)')
_MEMBER = re.compile(r'([\w-]+) = ("(?:[^"\\]|\\.)*"|[^;]+);')
_STEPS = re.compile(r"^typical run time .* for about (\d+) steps", re.MULTILINE)
_FILE = re.compile(r"^\S*\b(file|missile_file|curves?|motion)\s")  # lines of the list of parameters whose values are paths
_PROGRESS = re.compile(r"t\s+([\d.]+) / \S+ ms\s+step\s+(\d+)\s+dt\s+([\d.]+) us\s+(?:a|force)\s+(-?[\d.]+) (g|N)"
                       r"\s+indentation\s+(-?[\d.]+) mm\s+compression (-?[\d.]+)\s+energy ([-+][\d.]+) %")


class Step(NamedTuple):
    """Progress of a drop, rounded as softfall-solve prints it; `drop.history` has every step with all digits."""

    time: float  # s
    step: int
    time_step: float  # s
    load: float  # g: the deceleration; N: the contact force of a prescribed motion
    indentation: float  # m
    compression: float  # the largest, 1 - smallest stretch
    energy_error: float  # relative
    steps: int = 0  # of the whole drop, as softfall-pre expects them (to a factor of 2); 0: it does not say


def as_text(value: Any) -> str:
    """Returns a value as --set takes it.

    >>> as_text(True), as_text(0.5), as_text(np.float64(2)), as_text("5.2 m/s"), as_text([1, 2.5]), as_text(["1 ms", "2 ms"])
    ('true', '0.5', '2.0', '5.2 m/s', '[1, 2.5]', '["1 ms", "2 ms"]')
    """
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value) if isinstance(os.fspath(value), str) else os.fsdecode(value)
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(f'"{item}"' if isinstance(item, str) else as_text(item) for item in value) + "]"
    raise TypeError(f"a value is a text, a number, True or False, or a list of them, not {type(value).__name__}")


def _as_value(text: str) -> Any:
    """Returns a value of the list of parameters as a Python value; lists and groups stay texts."""
    if text.startswith('"'):
        return re.sub(r"\\(.)", r"\1", text[1:-1])
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return {"true": True, "false": False, "(absent)": None}.get(text, text)


def _cleaned(advice: laboratory.Advice, sentence: str) -> dict[str, str]:
    """Returns the values of a case with a clean table in place of a file, by the keys of the configuration file that the sentence names."""
    named = re.search(r"\(named at (.+):\d+\)", sentence)
    if not named or not Path(named[1]).is_file():
        return {}
    folder, group, found = Path(named[1]).parent, "material", {}
    text = Path(named[1]).read_text(encoding="utf-8", errors="replace")
    for name, key, value in re.findall(r'(\w+)\s*[=:]\s*\{|\b(curves?|motion)\s*=\s*("[^"]*"|\([^)]*\))', text):
        group = name or group
        if key and advice.stands_in(value, folder):
            place = group if group in ("material", "missile") else f"materials.{group}"
            found[f"{place}.{key}"] = advice.clean() if value.startswith('"') else advice.swap(value, folder)
    return found


class Case(MutableMapping[str, Any]):
    """A case file (docs/case.md) whose values can be changed; the file stays as it is.

    Keys are those of the file, `group.key`, and `geometry.parameters.NAME` of a geometry. A value is what --set takes: a text with
    its unit, such as "5.2 m/s", a number, a bool, a list, or "@file" for a whole group. An unknown key or a wrong value is an
    InputError with the sentence of softfall-pre at once; `update` sets several values that are right only together. A relative path
    in a value begins in the present folder, one in the file in that of the file.
    """

    def __init__(self, path: str | os.PathLike[str], values: Mapping[str, Any] | None = None) -> None:
        self.path = Path(path_of(path, "a case")).absolute()
        self._overrides: dict[str, str] = {}
        self._take(dict(values or {}))

    def __repr__(self) -> str:
        return f"softfall.Case({str(self.path)!r}, {self._overrides!r})"

    @property
    def overrides(self) -> dict[str, str]:
        """The values that differ from the file, as --set takes them."""
        return dict(self._overrides)

    def copy(self) -> Case:
        """Returns a case of its own with the same values."""
        return Case(self.path, self._overrides)

    def _texts(self) -> list[str]:
        return [f"{key}={text}" for key, text in self._overrides.items()]

    def _take(self, values: Mapping[str, Any]) -> None:
        """Sets values if the case is right with them."""
        trial = dict(self._overrides)
        for key, value in values.items():
            if not isinstance(key, str) or not re.fullmatch(r"[\w.-]+", key):
                raise InputError(f"{key!r} is no key of a case, such as missile.velocity")
            trial.pop(key, None)  # of two that touch the same value, such as a group and its key, the later one counts
            trial[key] = as_text(value)
        trial, listing = self._listing(trial)
        self._overrides = trial
        self._values: dict[str, Any] = {}
        for line in listing.splitlines():
            name, text = _LINE.match(line).groups()  # type: ignore[union-attr]
            self._values[name] = _as_value(text)
            if text.startswith("{"):
                self._values.update((f"{name}.{key}", _as_value(item)) for key, item in _MEMBER.findall(text))

    def _listing(self, trial: dict[str, str]) -> tuple[dict[str, str], str]:
        """Returns values and the list of parameters with them, after `softfall read` of curves and motions in another form than the programs read."""
        try:
            return trial, library.case_parameters(str(self.path), [f"{key}={text}" for key, text in trial.items()])
        except InputError as error:
            advice, failed = laboratory.advised(error), error
        if advice is None:
            raise failed
        values = {key: advice.clean() if advice.is_file(text) else advice.swap(text, "") for key, text in trial.items() if advice.stands_in(text, "")}
        if values:
            return self._listing({**trial, **values})
        values = _cleaned(advice, str(failed))
        if not values or values.items() <= trial.items():
            raise failed
        try:
            return self._listing({**trial, **values})
        except InputError:
            raise failed from None

    def __getitem__(self, key: str) -> Any:
        """Returns the value of a key, also a default: a text with its unit, a number or a bool; None if it is absent."""
        return find(self._values, "key of the case", key)

    def __setitem__(self, key: str, value: Any) -> None:
        self._take({key: value})

    def update(self, *others: Any, **more: Any) -> None:
        """Sets several values at once; either all are right, or none is set."""
        values = dict(*others, **more)
        if values:
            self._take(values)

    def __delitem__(self, key: str) -> None:
        """Takes back a value that was set: that of the file holds again."""
        value = find(self._overrides, "value that was set", key)
        del self._overrides[key]
        try:
            self._take({})
        except Exception:
            self._overrides[key] = value
            raise

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def run(self, threads: int | None = None, on_step: Callable[[Step], object] | None = None,
            output: str | os.PathLike[str] | None = None, force: bool = False, runs: str | os.PathLike[str] = RUNS) -> Drop:
        """Simulates the drop and returns it.

        `threads`: of the solver, all processors by default; the results do not depend on it. `on_step`: called some times a second
        with a `Step`; what it raises ends the run. `output`: a folder for model.h5, results.h5 and `out/`, the files of
        softfall-post; without one, a folder below `runs` that is named after the content of the inputs, wherever these are.

        A drop that is there, of the same inputs by the same programs, is not computed again. After Ctrl-C, or an exception of
        `on_step`, the run ends with a checkpoint, and the same call resumes it. `force` computes it anew, and replaces results of
        another model in `output`. A failure of the solution is a NumericError.
        """
        if threads is not None and (isinstance(threads, bool) or not isinstance(threads, (int, np.integer)) or threads < 1):
            raise InputError(f"threads: {threads!r} is not a number from 1 on")
        if on_step is not None and not callable(on_step):
            raise InputError(f"on_step: {on_step!r} is no function")
        top = Path(runs if output is None else output).absolute()
        folder = self._folder_in(top) if output is None else top
        if output is None and not force and (found := self.find(top)):
            return found
        with _folder(top), output_files.scratch(top) as scratch:
            model = scratch / "model.h5"
            share = [f"--share={top / 'shared'}"] if output is None else []
            heard: list[str] = []
            report = programs.run("pre", [str(self.path), f"--output={model}", *share, *(f"--set={text}" for text in self._texts())],
                                  threads=threads, heard=heard)
            steps = _STEPS.search(report)
            if output is None and self._folder_in(top) != folder:
                raise InputError(f"{self.path}: an input changed while the model was built; run it again")
            with _folder(folder), locked(folder) as lock:  # the child inherits the lock: nobody else takes the folder while it runs
                if output is None and not force and (found := self.find(top)):
                    return found  # of another process, for which this one waited
                if output is None and heard:
                    output_files.write(folder / WARNINGS, "".join(f"{sentence}\n" for sentence in heard))
                how = _How(threads, on_step, int(steps[1]) if steps else 0, force, output is None, lock)
                try:
                    return _solve(model, folder, how)
                except NumericError as error:
                    if output is None:
                        output_files.write(folder / FAILED, str(error))
                    raise

    def _folder_in(self, runs: Path) -> Path:
        """Returns the folder of this drop below `runs`, named after the content of the inputs but for what geometries include."""
        said = [line for line in library.case_parameters(str(self.path), self._texts()).splitlines() if not _FILE.match(line)]
        text = "\n".join([str(library.case_hash(str(self.path), self._texts())), *said])
        key = hashlib.sha256(text.encode()).hexdigest()[:16]
        return next(iter(sorted(runs.glob(f"*-{key}"))), runs / f"{self.name()}-{key}")

    def find(self, runs: str | os.PathLike[str] = RUNS) -> Drop | None:
        """Returns the drop if it is below `runs`, of these inputs by these programs, else None; raises the NumericError with which it ended."""
        folder = self._folder_in(Path(runs).absolute())
        first = folder / "results.h5"
        state = _state(first)
        if state.get("revision") != _revision() or not _is_after_programs(first) or not library.case_has_geometry_of(str(self.path), self._texts(), str(first)):
            return None
        if (folder / FAILED).exists() and state["status"] != "interrupted":
            failed = NumericError((folder / FAILED).read_text(encoding="utf-8"), 5)
            failed.results = str(first)
            raise failed
        with h5py.File(first, "r") as file:
            drops = max(1, int(file["summary/drops"][()])) if "summary/drops" in file else 1
        for sentence in (folder / WARNINGS).read_text(encoding="utf-8").splitlines() if (folder / WARNINGS).exists() else ():
            warnings.warn(sentence, SoftfallWarning, stacklevel=3)
        ended = [_state(later_results(first, number)).get("status") in ENDED for number in range(1, drops + 1)]
        return Drop(first, folder / "out", own=True) if all(ended) else None

    def require_single(self, what: str) -> None:
        """Raises InputError if the case is a series of drops, of which `what` would have the first one alone."""
        if self["series.drops"] != 1:
            raise InputError(f"{self.path}: series.drops = {self['series.drops']}: {what} has the figures of a single drop; leave the group series "
                             "out, or take softfall.sweep, which judges a series by the drops that count")

    def name(self) -> str:
        """Returns the name of the case: that of its file, or of its folder."""
        generic = self.path.stem == "case"
        return re.sub(r"[^\w.-]", "_", self.path.parent.name if generic else self.path.stem) or "case"


def example(name: str, values: Mapping[str, Any] | None = None) -> Case:
    """Returns the case of an example that comes with softfall, such as "eva50-v4.5"; `softfall-new --list` says what they are.

    >>> example("eva50-v4.5")["missile.velocity"]
    '4.5 m/s'
    """
    folder = programs.folder().parent / "share/softfall/examples"
    known = {path.parent.name: path for path in sorted(folder.glob("*/case.cfg"))}
    return Case(find(known, "example", name), values)


@contextlib.contextmanager
def _folder(path: Path) -> Iterator[None]:
    """Makes a folder in which the caller then writes; it goes again if nothing was written."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=path).close()
    except OSError as error:
        raise Error(f"the folder {path} cannot be written to: {error.strerror}", 3) from None
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            path.rmdir()


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[int]:
    """Takes the lock of the folder of a drop, after the process that holds it; gives its file descriptor."""
    with open(output_files.open_lock(folder / "lock")) as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            warnings.warn(f"another process runs the drop in {folder}: this one waits for it", SoftfallWarning, stacklevel=4)
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield lock.fileno()


def _is_after_programs(results: Path) -> bool:
    """False if programs without a revision of their own, of a changed tree or of none, may have been built after a run."""
    if _revision() != "unknown" and not _revision().endswith("-dirty"):
        return True
    built = [path.stat().st_mtime_ns for path in programs.folder().glob("softfall-*") if path.is_file()]
    return results.stat().st_mtime_ns > max(built, default=0)


def _revision() -> str:
    return library.version().split("(")[1].rstrip(")")


class _How(NamedTuple):
    """How a model is solved."""

    threads: int | None
    on_step: Callable[[Step], object] | None
    steps: int  # expected
    force: bool
    keyed: bool  # the folder belongs to these inputs: what is there of others was made before a file of theirs changed
    lock: int  # file descriptor


def _state(path: Path) -> dict[str, str]:
    """Returns what tells a model, or the results of one, from others: `model`, also `revision` and `status`; {} without the file."""
    if not path.exists():
        return {}
    try:
        with h5py.File(path, "r") as file:
            def text(name: str) -> str:
                return as_str(file[name][()]) if name in file else ""
            content = as_str(file.attrs["content_hash"]) if "content_hash" in file.attrs else text("provenance/model_hash")
            values = text("provenance/model/parameters") or text("provenance/parameters")
            return {"model": hashlib.sha256(f"{content} {values}".encode()).hexdigest()[:16],
                    "revision": text("provenance/git_revision"), "status": text("summary/status") or "interrupted"}
    except OSError:
        return {"model": "damaged"}


def _checkpoint(results: Path) -> Path:
    return results.with_name(results.name + ".restart")


def _solve(model: Path, folder: Path, how: _How) -> Drop:
    """Moves the model, and those of later drops of a series, into the folder and solves it there, unless that is done; resumes a run
    of it, also within a series."""
    with h5py.File(model, "r") as file:
        drops = max(1, int(file["series/count"][()]))
    files = [later_results(folder / "results.h5", number) for number in range(1, drops + 1)]
    models = [own if (own := later_results(model, number)).exists() else model for number in range(1, drops + 1)]
    ours, revision = [_state(path)["model"] for path in models], _revision()
    states, built = [_state(path) for path in files], _state(folder / "model.h5")
    strange = _checkpoint(files[0]).exists() and not built or any(state and state["model"] != own for state, own in
                                                                  zip((*states, built), (*ours, ours[0])))
    force = how.force or (strange and how.keyed)
    if strange and not force:
        raise InputError(f"{folder} holds a run of other values; force=True replaces it, another output keeps it")
    done = [state.get("status") in ENDED and state.get("revision") == revision for state in states]
    if all(done) and not force:
        return Drop(files[0], folder / "out", own=True)
    (folder / FAILED).unlink(missing_ok=True)
    for path in dict.fromkeys(models):
        shutil.move(path, folder / path.name)
    first = done.index(False) if not force else 0
    resumes = not force and _checkpoint(files[first]).exists() and states[first].get("status", "interrupted" if first == 0 else "") == "interrupted"
    if not resumes:
        for path in files[1:]:  # those of an earlier series are not of this one
            path.unlink(missing_ok=True)
            _checkpoint(path).unlink(missing_ok=True)
    where = [f"--restart={files[0]}", str(folder / "model.h5")] if resumes else [str(folder / "model.h5"), f"--output={files[0]}",
                                                                                   "--force"]

    def tell(line: str) -> None:
        found = _PROGRESS.search(line)
        if found and how.on_step:
            t, step, dt, load, _, depth, compression, energy = found.groups()
            how.on_step(Step(float(t) / 1e3, int(step), float(dt) / 1e6, float(load), float(depth) / 1e3, float(compression),
                             float(energy) / 100, how.steps))

    try:
        programs.run("solve", [*where, *([f"--threads={how.threads}"] if how.threads else [])], terminal=how.on_step is not None,
                     keep=[how.lock], on_line=tell)
    except NumericError as error:
        error.results = str(files[0]) if files[0].exists() else None
        raise
    return Drop(files[0], folder / "out", own=True)
