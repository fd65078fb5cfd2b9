# SPDX-License-Identifier: GPL-3.0-or-later
"""A drop that was simulated: figures, history, frames, verdict, plot, report (docs/formats.md has all names)."""
from __future__ import annotations

import json
import math
import os
import sys
from pathlib import Path
from typing import Any, Iterator, Mapping, Sequence

import h5py
import numpy as np

from . import laboratory, library, output as output_files, programs
from .curves import STANDARD_GRAVITY, Column, column
from .errors import Error, InputError, find, missing, path_of


def later_results(results: Path, number: int) -> Path:
    """Returns where softfall-solve writes drop `number` of a series whose first one is `results`."""
    return results if number == 1 else results.with_name(f"{results.stem}-{number}{results.suffix}")


def as_str(value: Any) -> str:
    """Returns a text of an HDF5 file."""
    return value.decode() if isinstance(value, bytes) else str(value)


class _Named(Mapping[str, Any]):
    """A table by names, whose KeyError lists them."""

    _what = "entry"

    def __init__(self, entries: Mapping[str, Any]) -> None:
        self._entries = dict(entries)

    def __getitem__(self, key: str) -> Any:
        return find(self._entries, self._what, key)

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __repr__(self) -> str:
        return f"<{len(self)} {self._what}s: {', '.join(self)}>"


class Figures(_Named):
    """The figures of summary.json by their keys, in the units that the keys end with; NaN: the run does not define it.

    Flags are True or False, and `status` is a text.
    """

    _what = "figure"


class History(_Named):
    """The columns of the history by their names, a value for each time step, with `.units` (SI) and `.description`."""

    _what = "column"

    def __init__(self, drop: Drop) -> None:
        with drop.open() as file:
            super().__init__({name: _column(data) for name, data in file["history"].items()})


class Verdict(str):
    """The grade of a drop, a text: "valid", "valid with remarks" or "do not use".

    `checks` and `limits` are the lists of summary.json, `remarks` the findings of the checks that are not "valid".
    """

    checks: list[dict[str, Any]]
    limits: list[dict[str, Any]]
    remarks: list[str]


def _column(data: Any) -> Any:
    """Returns a dataset as an array with its unit, or a text as a text."""
    value = data[()]
    if isinstance(value, (bytes, str)):
        return as_str(value)
    return column(value, as_str(data.attrs.get("units", "1")), as_str(data.attrs.get("description", "")))


class Frame:
    """One instant: the fields over the nodes as attributes with the names of docs/formats.md, and what follows.

    `time` (s), `displacement` (n, 3) m, `velocity`, `von_mises` (n,) Pa, `largest_compression`, ...; `fields` lists them. Positions are
    of the modelled part (`drop.data("model/symmetry_factor")` tells how many make the whole).
    """

    def __init__(self, drop: Drop, group: str) -> None:
        self._drop, self._group = drop, group

    def __repr__(self) -> str:
        return f"<frame at {1e3 * self.time:.3f} ms: {', '.join(self.fields)}>"

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self._drop.data(f"{self._group}/{name}")
        except KeyError:
            raise AttributeError(missing("field of this frame", name, [*self.fields, "position", "stress", "missile"]).args[0]) from None

    @property
    def time(self) -> float:
        """Time of the frame, s."""
        return float(self._drop.data(f"{self._group}/time"))

    @property
    def fields(self) -> list[str]:
        """Names of the datasets of this frame."""
        with self._drop.open() as file:
            return list(file[self._group])

    @property
    def position(self) -> Column:
        """Positions of the nodes (n, 3), m."""
        return column(self._drop.data("model/position") + self.displacement, "m", "position of the nodes")

    @property
    def stress(self) -> Column:
        """Cauchy stress of the nodes (n, 3, 3), Pa."""
        stress = self.cauchy_stress
        return column(np.reshape(stress, (-1, 3, 3)), stress.units, stress.description)

    @property
    def missile(self) -> Column:
        """Positions of the nodes of the missile's surface (m, 3), m; `drop.data("model/surface_triangle")` are its triangles."""
        w, *v = (float(part) for part in self.missile_quaternion)
        x, y, z = v
        turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                         [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                         [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
        centre = np.asarray(self._drop.data("model/missile_centre"))
        surface = np.asarray(self._drop.data("model/surface_position"))
        return column((surface - centre) @ turn.T + centre + self.missile_displacement, "m", "position of the missile's surface")


class Frames(Sequence[Frame]):
    """The frames of a drop, in their order."""

    def __init__(self, drop: Drop) -> None:
        self._drop = drop
        with drop.open() as file:
            self._names = sorted(file["frames"]) if "frames" in file else []

    def __len__(self) -> int:
        return len(self._names)

    def __getitem__(self, k: Any) -> Any:
        if isinstance(k, slice):
            return [Frame(self._drop, f"frames/{name}") for name in self._names[k]]
        try:
            return Frame(self._drop, f"frames/{self._names[k]}")
        except IndexError:
            raise IndexError(f"there is no frame {k}: the drop has {len(self)}, from 0 on") from None


class Drop:
    """A drop in a results.h5. Its files are read when they are asked for; `softfall-post` computes the figures then."""

    def __init__(self, results: str | os.PathLike[str], output: Path | None = None, own: bool = False) -> None:
        self.results = Path(results).absolute()
        self._own = output if own else None  # a folder that has files of these results alone, also half of them after a kill
        self._home = output  # of softfall-post without options
        self._shown = output  # of its last call
        self._scratch: output_files.Scratch | None = None
        self._summary: dict[str, Any] | None = None
        self._history: History | None = None
        self._file = self._identity()

    def __repr__(self) -> str:
        return f"<softfall.Drop {self} ({self.results})>"

    def __str__(self) -> str:
        """The verdict with a_max and HIC, or the sentence why there is none."""
        try:
            figures, verdict = self.figures, self.verdict
        except Error as error:
            return str(error)
        if figures["prescribed_motion"]:
            return f"{verdict}: peak stress {figures['peak_stress_kPa']:.4g} kPa"
        return f"{verdict}: a_max {figures['a_max_g']:.4g} g, HIC {figures['hic']:.4g}"

    def _identity(self) -> tuple[int, int]:
        try:
            state = self.results.stat()
        except OSError as error:
            raise Error(f"{self.results} cannot be read: {error.strerror}", 3) from None
        return state.st_ino, state.st_mtime_ns

    def open(self) -> h5py.File:
        """Returns results.h5, open for reading: `with drop.open() as file:`. Another file in its place is an Error."""
        if self._identity() != self._file:
            raise Error(f"{self.results} has been replaced since this drop was read: read_results reads the new one", 3)
        try:
            return h5py.File(self.results, "r")
        except OSError as error:
            raise Error(f"{self.results} cannot be read as results of softfall-solve: {error}", 3) from None

    def data(self, path: str) -> Any:
        """Returns a dataset of results.h5 as an array with `.units` and `.description`, such as "model/cell_node"."""
        with self.open() as file:
            group, _, name = path.strip("/").rpartition("/")
            if not isinstance(file.get(group or "/"), h5py.Group):
                raise missing("group in results.h5", group, file)
            if not isinstance(file[group or "/"].get(name), h5py.Dataset):
                raise missing(f"dataset in {group or 'results.h5'}", name, file[group or "/"])
            return _column(file[path])

    def post(self, output: str | os.PathLike[str] | None = None, **options: Any) -> dict[str, Any]:
        """Runs softfall-post with its options by their names, and returns its summary.json as a dict.

        drop.post("compared", reference="lab.csv", limit_g=160) runs `softfall-post RESULTS -o compared --reference=lab.csv
        --limit-g=160`, after `softfall read` where the file has another form, whose options are reference_scale="10 mV/g",
        reference_rate="20 kHz" and the like; without a folder its files are temporary. Figures, verdict, plot and report are of the last call. Files of other
        results in `output` are replaced only with force=True.
        """
        with self.open():
            pass
        if output is None and (options or not self._home):
            self._scratch = self._scratch or output_files.Scratch()
            output = Path(self._scratch.name) / ("with-options" if options else "out")
            if not options:
                self._home = Path(output)
        place = Path(output or self._home or "").absolute()
        if options and place == self._home:
            raise InputError(f"{place} is for the figures without options: give another output")
        chosen = {"force": place == self._own or self._kept(place) is not None, **options}
        self._run_post(place, chosen)
        self._shown, self._summary = place, json.loads((place / "summary.json").read_text(encoding="utf-8"))
        return dict(self._summary or {})

    def _run_post(self, place: Path, options: dict[str, Any]) -> None:
        """Runs softfall-post, after `softfall read` where the reference has another form than the programs read."""
        def run(chosen: dict[str, Any]) -> None:
            programs.run("post", [str(self.results), f"--output={place}", *programs.options(chosen)])
        given = {name: options[f"reference_{name}"] for name in laboratory.RECORD if f"reference_{name}" in options}
        try:
            if "reference" not in options or set(given) <= {"column", "columns"}:
                return run(options)
        except InputError as error:
            if laboratory.advised(error) is None:
                raise
        with output_files.scratch() as scratch:
            reading = laboratory.read(options["reference"], kind="acceleration", spell=lambda option, value: f'reference_{option}="{value}"', **given)
            names = [name.removesuffix(" (g)") for name in reading.frame.columns[1:]]
            chosen = {name: value for name, value in options.items() if name.removeprefix("reference_") not in given}
            chosen["reference"] = reading.write(scratch / f"{Path(options['reference']).stem}.csv")
            run({**chosen, "reference_columns": ",".join(names)} if "columns" in given else chosen)

    def _kept(self, place: Path) -> dict[str, Any] | None:
        """Returns the summary.json in a folder if it is of these results, perhaps of an earlier run of them."""
        try:
            kept = json.loads((place / "summary.json").read_text(encoding="utf-8"))
            return kept if Path(kept["results"]) == self.results or self._is_run(kept) else None
        except (OSError, ValueError, KeyError, TypeError, Error):
            return None

    def _is_run(self, kept: Mapping[str, Any]) -> bool:
        """True if a summary.json is of this very run, whose folder had another name then."""
        with self.open() as file:
            names = {"wall_s": "wall_time", "steps": "steps", "nodes": "nodes", "interactions": "interactions", "threads": "threads"}
            return all(f"summary/{name}" in file and math.isclose(kept[key], file[f"summary/{name}"][()], rel_tol=1e-8) for key, name in names.items())

    def _serves(self, kept: dict[str, Any]) -> bool:
        """True if a summary.json in the home is that of softfall-post now, without options."""
        bounds = {limit["key"]: limit["bound"] for limit in kept["verdict"]["limits"]}
        usual = kept["cfc"] == 1000 and "reference" not in kept and "," not in kept["acceleration"] and set(bounds.values()) <= {200, 1000}
        newer = (self._home or Path()).joinpath("summary.json").stat().st_mtime_ns > self.results.stat().st_mtime_ns
        whole = (self._home or Path()).joinpath("compression.csv" if kept["prescribed_motion"] else "acceleration.csv").exists() and "command_line" in kept
        return usual and whole and newer and kept["program"].split()[-1] == library.version().split()[0]

    @property
    def summary(self) -> dict[str, Any]:
        """summary.json; softfall-post is run unless its files are there already, newer than the results and by this version."""
        if self._identity() != self._file:
            self.open()
        if self._summary is None and self._home:
            kept = self._kept(self._home)
            self._summary = kept if kept and self._serves(kept) else None
        return dict(self._summary or self.post())

    @property
    def figures(self) -> Figures:
        """a_max_g, hic and all other figures of summary.json."""
        entries = {key: math.nan if value is None else value for key, value in self.summary.items()
                   if key not in ("program", "git_revision", "command_line", "results", "caution", "acceleration") and not isinstance(value, (list, dict))}
        return Figures(entries)

    @property
    def verdict(self) -> Verdict:
        """Whether the figures may be used, and why not."""
        told = self.summary["verdict"]
        made = Verdict(told["grade"])
        made.checks, made.limits = told["checks"], told["limits"]
        made.remarks = [check["finding"] for check in made.checks if check["grade"] not in ("valid", None)]
        return made

    @property
    def series(self) -> list[Drop]:
        """The drops of a series on the same pad, this first one included; one that was not run, as one before it failed, is left out."""
        with self.open() as file:
            count = int(file["summary/drops"][()]) if "summary/drops" in file else 1
        later = [later_results(self.results, number) for number in range(2, count + 1)]
        drops = [self, *(Drop(path, path.with_name(f"out-{number}"), own=self._own is not None) for number, path in enumerate(later, 2) if path.exists())]
        for before, drop in zip(drops, drops[1:]):
            if drop._pad("before") != before._pad("after"):
                raise Error(f"{drop.results} did not begin with the pad as {before.results} left it: it is of another run, or one of the two was "
                            "solved anew", 2)
        return drops

    def _pad(self, when: str) -> int | None:
        """Returns the hash of the foam's history before or after this drop; None: results of an older version do not have it."""
        with self.open() as file:
            name = f"summary/pad_{when}"
            return int(file[name][()]) if name in file else None

    @property
    def layers(self) -> list[dict[str, Any]]:
        """Figures of each layer; [] of a pad of one material."""
        return list(self.summary.get("layers") or [])

    @property
    def history(self) -> History:
        """Columns over the time steps, SI, such as `time`, `acceleration`, `indentation`."""
        if self._history is None:
            self._history = History(self)
        return self._history

    @property
    def frames(self) -> Frames:
        """The frames: `drop.frames[k].position`, `.stress`, ..."""
        return Frames(self)

    @property
    def peak(self) -> Frame:
        """The frame at the peak, which has all fields."""
        return Frame(self, "peak")

    def file(self, name: str) -> Path:
        """Returns the path of a file of softfall-post, such as "pad.xdmf" for ParaView."""
        self.summary
        path = (self._shown or Path()) / name
        if not path.exists():
            raise missing("file of softfall-post", name, sorted(entry.name for entry in path.parent.iterdir()))
        return path

    def report(self) -> Path:
        """Makes report.html, two pages to read or print, unless it is there, and returns its path; of `read_results` without `output` it lasts as the Drop."""
        from . import report
        self.summary
        return report.current(self._shown or Path(), self)

    def curve(self) -> tuple[Column, Column]:
        """Returns time (s) and deceleration (g) of the filtered curve, whose a_max and HIC the figures are."""
        table = np.loadtxt(self.file("acceleration.csv"), delimiter=",", skiprows=1)
        return column(table[:, 0] / 1e3, "s", "time"), column(table[:, 1], "g", "filtered deceleration")

    def plot(self, ax: Any = None, show: bool = False) -> Any:
        """Draws the deceleration over time with the window of HIC; of a prescribed motion stress over strain. Returns the axes.

        `show`: opens a window with it, and waits until it is closed; a notebook shows plots without it.
        """
        ax = self._draw(ax)
        if show:
            import matplotlib
            import matplotlib.pyplot as plt
            if matplotlib.get_backend().lower() == "agg":
                raise Error('there is no display for a window: drop.plot().figure.savefig("drop.png") writes the plot to a file', 3)
            plt.show()
        return ax

    def _draw(self, ax: Any) -> Any:
        figures = self.figures
        if ax is None:
            import matplotlib.pyplot as plt
            ax = plt.subplots(layout="constrained")[1]
        if figures["prescribed_motion"]:
            table = np.loadtxt(self.file("compression.csv"), delimiter=",", skiprows=1)
            ax.plot(table[:, 1], table[:, 2])
            ax.set(xlabel="indentation / thickness", ylabel="force / mean section (kPa)", title=f"verdict: {self.verdict}")
            return ax
        time, filtered = self.curve()
        raw_time, raw = self.history["time"], self.history["acceleration"]
        if not figures["free_missile"] and not figures["kinematic_acceleration"]:
            ax.plot(1e3 * raw_time, raw / STANDARD_GRAVITY, color="0.7", lw=1, label="not filtered")
        ax.plot(1e3 * time, filtered, color="C0", label=f"CFC {figures['cfc']:g}, a_max {figures['a_max_g']:.1f} g")
        if math.isfinite(figures["hic_t1_ms"]):
            ax.axvspan(figures["hic_t1_ms"], figures["hic_t2_ms"], color="C1", alpha=0.2, lw=0, label=f"HIC {figures['hic']:.0f}")
        ax.set(xlabel="time (ms)", ylabel="deceleration (g)", title=f"verdict: {self.verdict}", ylim=(min(0, filtered.min()), None))
        ax.legend()
        return ax


def read_results(path: str | os.PathLike[str], output: str | os.PathLike[str] | None = None) -> Drop:
    """Returns the drop of a results.h5, or of a folder that holds one.

    `output`: a folder for the files of softfall-post, which are used if they are there and newer; by default a temporary one.
    """
    place = Path(path_of(path, "a drop"))
    place = place / "results.h5" if place.is_dir() else place
    if not place.exists():
        raise InputError(f"there are no results {place}")
    drop = Drop(place, Path(output).absolute() if output is not None else None)
    with drop.open() as file:
        if as_str(file.attrs.get("format", "")) != "softfall-results":
            raise InputError(f"{place} is no results.h5 of softfall-solve: its format is "
                             f'"{as_str(file.attrs.get("format", "not given"))}"')
    _check_seal(place)
    return drop


def _check_seal(path: Path) -> None:
    """Refuses results that do not end with their checksum (docs/formats.md): an edit by h5py drops it, and so does a cut. softfall-post compares the checksum itself."""
    with open(path, "rb") as file:
        length = file.seek(0, os.SEEK_END)
        file.seek(max(0, length - 24))
        name, stored = file.read(8), int.from_bytes(file.read(8), sys.byteorder)
    if name != b"SFSEAL01" or stored != length - 24:
        raise Error(f"{path} does not end with its checksum: it was cut, or another program has changed it; make it anew with softfall-solve", 3)
