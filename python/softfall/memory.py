# SPDX-License-Identifier: GPL-3.0-or-later
"""Drops in memory: from a case to the figures of its drops by the library, without a program or a file of results."""
from __future__ import annotations

import ctypes as c
import functools
import hashlib
import itertools
import json
import math
import re
from pathlib import Path
from typing import Any, NamedTuple, Sequence

import numpy as np

from . import library
from .array import Array
from .errors import Error

LEAN = ('output.fields=["displacement"]', "output.frame_interval=1000 s")  # a study keeps no fields
CHANGED = "an input has changed while the drop was simulated"
_SUMS = ("steps", "wall_s")  # figures of a series that are sums over its drops


@functools.lru_cache(maxsize=None)
def figure_keys() -> tuple[str, ...]:
    """Returns the keys of the figures that are numbers, in the order of runs.csv."""
    count = c.c_int()
    listed = _load().softfall_figures_list(None, c.byref(count))
    return tuple(listed[k].name.decode() for k in range(count.value))


class DropFigures(NamedTuple):
    """The figures of one drop, NaN where the run does not define one, and its verdict."""

    figures: dict[str, float]
    grade: int
    verdict: str
    status: str
    sure: float = 0.0  # part of a_max that is certain although the verdict is "do not use"


class Run(NamedTuple):
    """A drop, or all drops of a series on one pad; `files` is what its geometries have read, for `Inputs.has_files`."""

    drops: list[DropFigures]
    files: str


class _DropInfo(c.Structure):
    _fields_ = [("drops", c.c_int), ("counted", c.c_int), ("own", c.c_int), ("interval", c.c_double)]


class _Quantity(c.Structure):
    _fields_ = [("name", c.c_char_p), ("units", c.c_char_p), ("description", c.c_char_p), ("components", c.c_int)]


class _Options(c.Structure):
    _fields_ = [("threads", c.c_int), ("end_time", c.c_double)]


class _Description(c.Structure):
    _fields_ = [("node_count", c.c_int64), ("symmetry_factor", c.c_int64), ("thickness", c.c_double), ("missile_mass", c.c_double),
                ("missile_speed", c.c_double), ("end_time", c.c_double), ("has_prescribed_motion", c.c_int)]


class _Variant(c.Structure):
    _fields_ = [("speed", c.c_double), ("mass", c.c_double), ("thickness", c.c_double), ("material", c.c_void_p)]


@functools.lru_cache(maxsize=None)
def _load() -> c.CDLL:
    lib = library._load()
    lib.softfall_case_drop_get.restype, lib.softfall_case_drop_get.argtypes = _DropInfo, [c.c_void_p, c.c_int]
    for name in ("softfall_model_geometry_files", "softfall_figures_verdict", "softfall_figures_status"):
        function = getattr(lib, name)
        function.restype, function.argtypes = c.c_char_p, [c.c_void_p]
    lib.softfall_figures_list.restype = c.POINTER(_Quantity)
    for name in ("softfall_figures_grade", "softfall_figures_free", "softfall_drop_free", "softfall_model_free", "softfall_case_free", "softfall_text_free"):
        getattr(lib, name).argtypes = [c.c_void_p]
    lib.softfall_figures_sure.restype, lib.softfall_figures_sure.argtypes = c.c_double, [c.c_void_p]
    lib.softfall_case_data_end.restype, lib.softfall_case_data_end.argtypes = c.c_double, [c.c_void_p, c.c_int]
    lib.softfall_case_has_files.argtypes = [c.c_void_p, c.c_char_p]
    lib.softfall_drop_history.restype, lib.softfall_drop_history.argtypes = c.c_int64, [c.c_void_p, c.c_char_p, c.c_void_p]
    lib.softfall_model_describe.restype, lib.softfall_model_describe.argtypes = _Description, [c.c_void_p]
    return lib


def hold_units() -> None:
    """softfall_units_hold: for a process that reads very many cases."""
    library._call("softfall_units_hold")


def settings(path: str) -> dict[str, Any]:
    """softfall_settings_read: the settings of a file in the syntax of a case, each with name, place, kind and value."""
    text = c.c_void_p()
    with library._one_at_a_time:
        library._call("softfall_settings_read", path.encode(), c.byref(text))
    try:
        return dict(json.loads(c.string_at(text)))
    finally:
        _load().softfall_text_free(text)


@functools.lru_cache(maxsize=None)
def programs_hash() -> str:
    """Returns a hash of what simulates a drop: the libraries, and the program that meshes."""
    folder = Path(library._load()._name).resolve().parent
    mesher = [path for top in (folder.parent, folder.parent.parent) for path in top.glob("*/softfall-mesh")] \
        + [path for top in (folder.parent, folder.parent.parent) for path in top.glob("libexec/softfall/softfall-mesh")]
    files = sorted({path.resolve() for path in folder.glob("libsoftfall*.so")} | {path.resolve() for path in mesher})
    return hashlib.sha256(b"".join(hashlib.sha256(path.read_bytes()).digest() for path in files)).hexdigest()[:16]


def _texts(overrides: Sequence[str]) -> Any:
    return (c.c_char_p * max(1, len(overrides)))(*(text.encode() for text in overrides))


class Inputs:
    """A case with its overrides as a drop of a study reads it: a context manager."""

    def __init__(self, path: str, overrides: Sequence[str]) -> None:
        self.path, self.overrides = path, [*overrides, *LEAN]

    def __enter__(self) -> Inputs:
        self._case = self._read(0)
        return self

    def __exit__(self, *_: Any) -> None:
        _load().softfall_case_free(self._case)

    def _read(self, drop: int) -> c.c_void_p:
        """Reads the case, or one drop of its series alone."""
        case, texts = c.c_void_p(), _texts(self.overrides)
        with library._one_at_a_time:
            if drop:
                library._call("softfall_case_read_drop", self.path.encode(), c.c_int(drop), texts, c.c_int(len(self.overrides)), None, c.byref(case))
            else:
                library._call("softfall_case_read", self.path.encode(), texts, c.c_int(len(self.overrides)), None, c.byref(case))
        return case

    def check(self) -> None:
        """softfall_case_check: raises InputError where the case has no place in a study."""
        library._call("softfall_case_check", self._case)

    def key(self) -> str:
        """Returns the key of the drop: equal for equal content of all inputs and programs, wherever these are."""
        value = c.c_uint64()
        library._call("softfall_case_hash", self._case, c.byref(value))
        return f"{value.value:016x}-{programs_hash()}"

    def has_files(self, files: str) -> bool:
        """True if what the geometries of an earlier drop of this case have read is as it was."""
        return bool(_load().softfall_case_has_files(self._case, files.encode()))

    def counted(self) -> list[bool]:
        """Returns of each drop of the series whether it counts."""
        first = _load().softfall_case_drop_get(self._case, 1)
        return [bool(_load().softfall_case_drop_get(self._case, k).counted) for k in range(1, first.drops + 1)]

    def is_alike(self) -> bool:
        """True if all drops of the series have the missile of the case, but for their intervals."""
        return not any(_load().softfall_case_drop_get(self._case, k).own for k in range(1, len(self.counted()) + 1))

    def intervals(self) -> list[float]:
        """Returns the pause (s) before each drop of the series; that of the first one means nothing."""
        return [float(_load().softfall_case_drop_get(self._case, k).interval) for k in range(1, len(self.counted()) + 1)]

    def build(self, share: str) -> c.c_void_p:
        """Builds the model of the first drop, which is the caller's; meshes are shared in a folder."""
        return self._build(1, share, False)

    def data_ends(self) -> list[float]:
        """Returns the strain at which the data of the foam end, of each layer."""
        ends = (float(_load().softfall_case_data_end(self._case, k)) for k in itertools.count())
        return list(itertools.takewhile(lambda end: not math.isnan(end), ends))

    def run(self, share: str, section: bool = False) -> Run:
        """Simulates the drop, or the series, on one thread; meshes are shared in a folder. A failure has `files`, if they are known.

        `section`: also runs the drops of the section, or one that is like the drop, that tell the errors by the mesh; without, a formula estimates them.
        """
        lib, models, drops, made = _load(), [], [], []
        before, files = None, None
        try:
            for number in range(1, len(self.counted()) + 1):
                info = lib.softfall_case_drop_get(self._case, number)
                if number == 1 or info.own:
                    models.append(self._build(number, share, section))
                    files = lib.softfall_model_geometry_files(models[0]).decode()
                model = models[-1] if info.own else models[0]
                drop = c.c_void_p()
                if before is None:
                    library._call("softfall_drop_create", model, c.byref(_Options(1, 0)), c.byref(drop))
                else:
                    library._call("softfall_drop_next_of", before, model, c.c_double(info.interval), c.byref(drop))
                drops.append(drop)
                library._call("softfall_drop_run", drop, None, None, None)
                made.append(_figures(drop))
                before = drop
            return Run(made, files or "")
        except Error as error:
            setattr(error, "files", files)
            raise
        finally:
            for drop in reversed(drops):
                lib.softfall_drop_free(drop)
            for model in models:
                lib.softfall_model_free(model)

    def _build(self, number: int, share: str, section: bool) -> c.c_void_p:
        model, case = c.c_void_p(), self._read(number)
        try:
            library._call("softfall_case_set_build", case, share.encode(), c.c_int(section and number == 1))
            library._call("softfall_model_build", case, None, c.byref(model))
        finally:
            _load().softfall_case_free(case)
        return model


class Model:
    """A model in memory, without a file, whose drops are varied."""

    def __init__(self, path: str, overrides: Sequence[str]) -> None:
        self.handle, self._free = c.c_void_p(), _load().softfall_model_free
        with library._case(path, overrides) as case:
            library._call("softfall_model_build", case, None, c.byref(self.handle))
        told = _load().softfall_model_describe(self.handle)
        self.thickness: float = told.thickness  # m
        self.nodes: int = told.node_count

    def __del__(self) -> None:
        if hasattr(self, "_free"):
            self._free(self.handle)

    def drop(self, path: str, overrides: Sequence[str], thickness: float, own_foam: bool = True) -> tuple[dict[str, float], Array, Array]:
        """Simulates the drop of a variant: speed, mass and foam are those of a case with its overrides, the thickness (m) is scaled from that of the
        model; without `own_foam`, of a pad of layers, the foams are those of the model. Returns figures, and the history of the acceleration: time in s, acceleration in m/s2."""
        lib, variant, foam, drop, values = _load(), c.c_void_p(), c.c_void_p(), c.c_void_p(), c.POINTER(c.c_double)()
        try:
            with library._case(path, overrides) as case:
                if own_foam:
                    library._call("softfall_case_material", case, c.byref(foam))
                listing = lib.softfall_case_parameters(case).decode(errors="replace")
            speed, mass = (float(found[1]) if (found := re.search(rf'^missile\.{key} +"[^"]*" +(\S+)', listing, re.MULTILINE)) else 0.0
                           for key in ("velocity", "mass"))
            library._call("softfall_model_vary", self.handle, c.byref(_Variant(speed, mass, thickness, foam)), c.byref(variant))
            library._call("softfall_drop_create", variant, c.byref(_Options(1, 0)), c.byref(drop))
            library._call("softfall_drop_run", drop, None, None, None)
            columns = []
            for name in (b"time", b"acceleration"):
                count = lib.softfall_drop_history(drop, name, c.byref(values))
                columns.append(np.array(values[:count]))
            return _figures(drop).figures, columns[0], columns[1]
        finally:
            lib.softfall_drop_free(drop)
            lib.softfall_model_free(variant)
            lib.softfall_material_free(foam)


def _figures(drop: c.c_void_p, keys: Sequence[str] = ()) -> DropFigures:
    """Returns the figures of a drop, all or some."""
    lib, figures, count, value = _load(), c.c_void_p(), c.c_int(), c.c_double()
    library._call("softfall_drop_figures", drop, c.c_double(1000), c.byref(figures))
    try:
        listed = lib.softfall_figures_list(figures, c.byref(count))
        found = dict.fromkeys(keys or [listed[k].name.decode() for k in range(count.value)], math.nan)
        for key in found:
            library._call("softfall_figure", figures, key.encode(), c.byref(value))
            found[key] = value.value
        return DropFigures(found, int(lib.softfall_figures_grade(figures)), lib.softfall_figures_verdict(figures).decode(errors="replace"),
                           lib.softfall_figures_status(figures).decode(errors="replace"), float(lib.softfall_figures_sure(figures)))
    finally:
        lib.softfall_figures_free(figures)


def judge(drops: Sequence[DropFigures], counted: Sequence[bool]) -> DropFigures:
    """Returns the figures of a series: means over the drops that count, sums of steps and time over all, the grade of the worst drop.

    >>> one, two = (DropFigures({"hic": hic, "steps": 3.0}, grade, "good", "rebound") for hic, grade in ((100.0, 0), (300.0, 1)))
    >>> judge([one, two], [False, True])
    DropFigures(figures={'hic': 300.0, 'steps': 6.0}, grade=1, verdict='drop 2: good', status='rebound', sure=0.0)
    """
    if len(drops) == 1:
        return drops[0]
    number = sum(counted)
    figures = {key: sum(drop.figures[key] for drop in drops) if key in _SUMS else
               sum(drop.figures[key] for drop, counts in zip(drops, counted) if counts) / number for key in drops[0].figures}
    worst = max(range(len(drops)), key=lambda k: (drops[k].grade, -k))
    return DropFigures(figures, drops[worst].grade, f"drop {worst + 1}: {drops[worst].verdict}", drops[-1].status, min(drop.sure for drop in drops))


def nine_digits(value: float) -> float:
    """Returns a figure with the digits of runs.csv.

    >>> nine_digits(1 / 3)
    0.333333333
    """
    return float(f"{value:.9g}") if math.isfinite(value) else math.nan
