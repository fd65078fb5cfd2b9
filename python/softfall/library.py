# SPDX-License-Identifier: GPL-3.0-or-later
"""libsoftfall by ctypes, for what needs no file: checks of a case, HIC and filters (include/softfall/softfall.h)."""
from __future__ import annotations

import contextlib
import ctypes as c
import functools
import json
import locale
import os
import re
import threading
from typing import Any, Iterator, Mapping, NamedTuple, Sequence

import numpy as np

from . import programs
from .array import Array
from .errors import Error, InputError, failure

GRADES = ("valid", "valid with remarks", "do not use")  # of runs and records, as the library counts them
_PARAMETER = re.compile(r'material\.(\S+)\s+("(?:[^"\\]|\\.)*"|\(.*\)|\S+)\s+(.*?)\s+(given|default)$')
_NUMBER = re.compile(r"[-+]?[\d.]+(?:e[-+]?\d+)?")
_one_at_a_time = threading.Lock()  # files are read by one thread at a time


class _Failure(c.Structure):
    _fields_ = [("status", c.c_int), ("text", c.c_char * 1024)]


@functools.lru_cache(maxsize=None)
def _load() -> c.CDLL:
    """Loads the library beside the programs in use, so that checks and runs are of one build."""
    prefix = programs.folder().resolve().parent
    for pattern in ("lib/libsoftfall-build.so", "lib/*/libsoftfall-build.so", "lib64/libsoftfall-build.so"):
        for path in prefix.glob(pattern):
            library = c.CDLL(str(path))
            library.softfall_version.restype = library.softfall_revision.restype = c.c_char_p
            library.softfall_case_parameters.restype = c.c_char_p
            library.softfall_case_parameters.argtypes = library.softfall_case_free.argtypes = [c.c_void_p]
            for text in (library.softfall_record_verdict, library.softfall_record_interpretation):
                text.restype, text.argtypes = c.c_char_p, [c.c_void_p]
            library.softfall_record_curve.restype = library.softfall_material_curve.restype = c.c_int64
            library.softfall_material_parameters.restype = c.c_char_p
            library.softfall_material_parameters.argtypes = library.softfall_material_free.argtypes = [c.c_void_p]
            library.softfall_form_parameters.restype, library.softfall_form_start.restype = c.c_char_p, None
            library.softfall_form_parameters.argtypes = library.softfall_form_free.argtypes = [c.c_void_p]
            library.softfall_form_pole.restype, library.softfall_form_pole.argtypes = c.c_double, [c.c_void_p, c.POINTER(c.c_double)]
            library.softfall_form_loading.restype = library.softfall_compression_free.restype = None
            library.softfall_record_grade.argtypes = library.softfall_record_free.argtypes = [c.c_void_p]
            return library
    raise Error(f"there is no library libsoftfall-build.so in {prefix}/lib, beside the programs of {programs.folder()}", 3)


def version() -> str:
    """Returns the version and revision of the softfall in use.

    >>> version().split(".")[0]
    '1'
    """
    return f"{_load().softfall_version().decode()} ({_load().softfall_revision().decode()})"


def _call(name: str, *arguments: Any) -> None:
    """Calls a function whose last argument receives the error; raises its sentence."""
    if locale.localeconv()["decimal_point"] != ".":
        raise Error("the locale of this process has a decimal comma, with which numbers would be read wrongly: "
                    'locale.setlocale(locale.LC_NUMERIC, "C") mends it', 2)
    error = _Failure()
    if getattr(_load(), name)(*arguments, c.byref(error)) != 0:
        raise failure(error.text.decode(errors="replace"), error.status)


@contextlib.contextmanager
def _case(path: str, overrides: Sequence[str]) -> Iterator[c.c_void_p]:
    """Reads and checks a case with its overrides as softfall-pre does."""
    for text in (path, *overrides):
        if "\0" in text:
            raise failure(f"{text!r} has a zero byte", 2)
    texts = (c.c_char_p * max(1, len(overrides)))(*(text.encode() for text in overrides))
    case = c.c_void_p()
    with _one_at_a_time:
        _call("softfall_case_read", path.encode(), texts, c.c_int(len(overrides)), None, c.byref(case))
        try:
            yield case
        finally:
            _load().softfall_case_free(case)


def case_parameters(path: str, overrides: Sequence[str]) -> str:
    """Returns the list of the values of a case."""
    with _case(path, overrides) as case:
        return str(_load().softfall_case_parameters(case).decode(errors="replace"))


def case_hash(path: str, overrides: Sequence[str]) -> int:
    """softfall_case_hash: equal for equal values, curves and geometry files, wherever these are."""
    value = c.c_uint64()
    with _case(path, overrides) as case:
        _call("softfall_case_hash", case, c.byref(value))
    return value.value


def case_has_geometry_of(path: str, overrides: Sequence[str], results: str) -> bool:
    """softfall_case_has_geometry_of: True if all that the geometries behind a results.h5 read is as it was."""
    with _case(path, overrides) as case:
        return bool(_load().softfall_case_has_geometry_of(case, os.fsencode(results)))


def _array(values: Any) -> Any:
    return values.ctypes.data_as(c.POINTER(c.c_double))


@functools.lru_cache(maxsize=256)
def quantity(text: str) -> tuple[float, str]:
    """softfall_units_read: a quantity in SI, and the SI unit of its kind. What was expected is for the caller to say.

    >>> quantity("10 mph")
    (4.4704, 'm s-1')
    """
    value, unit = c.c_double(), c.c_char_p()
    with _one_at_a_time:
        try:
            _call("softfall_units_read", text.encode(), c.byref(value), c.byref(unit))
        except InputError as error:  # its example is of the last kind that was tried
            raise InputError(re.sub(r'(; expected .*)?, for example ".*"$', "", str(error), flags=re.DOTALL)) from None
    return value.value, (unit.value or b"").decode()


class Material:
    """A foam of a material file: softfall_material_read, and all that it has."""

    def __init__(self, path: str, temperature: float = 0.0) -> None:
        self._handle, self._free = c.c_void_p(), _load().softfall_material_free
        if "\0" in path:
            raise failure(f"{path!r} has a zero byte", 2)
        try:
            with _one_at_a_time:
                _call("softfall_material_read", os.fsencode(path), c.c_double(temperature), c.byref(self._handle))
        except Error as error:
            raise failure(str(error).removeprefix(f"--set material=@{path}: "), error.code) from None
        self.values: dict[str, float | str] = {}  # by key within the group, in SI units or a word; without those that are absent
        self.given: set[str] = set()
        for line in _load().softfall_material_parameters(self._handle).decode(errors="replace").splitlines():
            name, text, value, origin = _PARAMETER.match(line).groups()  # type: ignore[union-attr]
            if text != "(absent)":
                number = _NUMBER.match(value)
                self.values[name] = float(number[0]) if number and name not in ("law", "curve", "curves") else text.strip('"')
            if origin == "given":
                self.given.add(name)
        self.curves: list[tuple[float, Array, Array]] = []  # rate in 1/s (0: there is one curve), strain, stress in Pa
        self._read_curves()

    def _read_curves(self) -> None:
        rate, strain, stress = c.c_double(), c.POINTER(c.c_double)(), c.POINTER(c.c_double)()
        while count := _load().softfall_material_curve(self._handle, c.c_int(len(self.curves)), c.byref(rate), c.byref(strain), c.byref(stress)):
            self.curves.append((rate.value, np.array(strain[:count]), np.array(stress[:count])))

    def __del__(self) -> None:
        if hasattr(self, "_free"):
            self._free(self._handle)

    def compress(self, time: Any, strain: Any, free_sides: bool = False) -> Array:
        """softfall_compress: nominal stress in Pa; arrays of double of one length."""
        stress: Array = np.empty_like(strain)
        _call("softfall_compress", self._handle, c.c_int(free_sides), _array(time), _array(strain), c.c_int64(strain.size), _array(stress))
        return stress

    def cycles(self, time: Any, strain: Any, pause: Any) -> Array:
        """softfall_compress_cycles: nominal stress in Pa; arrays of double of one length."""
        stress: Array = np.empty_like(strain)
        _call("softfall_compress_cycles", self._handle, _array(time), _array(strain), _array(pause), c.c_int64(strain.size), _array(stress))
        return stress

    def cushion(self, static_stress: float, thickness: float, drop_height: float) -> float:
        """softfall_cushion: peak deceleration (g) of a flat mass on a block."""
        peak = c.c_double()
        _call("softfall_cushion", self._handle, c.c_double(static_stress), c.c_double(thickness), c.c_double(drop_height), c.byref(peak))
        return peak.value


class Parameter(NamedTuple):
    """A parameter of a foam, as softfall_form_parameters has it."""

    name: str
    unit: str
    description: str
    quantity: str
    rate: str
    per_unit: float
    low: float
    high: float
    prior_sd: float
    used: bool
    usual: bool
    of_curve: bool


class Foam(Material):
    """A foam in memory, of a form's parameters."""

    def __init__(self, handle: c.c_void_p) -> None:
        self._handle, self._free = handle, _load().softfall_material_free
        self.curves = []
        self._read_curves()

    @property
    def handle(self) -> c.c_void_p:
        return self._handle

    def bend(self, strain: Any, factor: Any) -> None:
        """softfall_material_bend: multiplies the curves by exp(factor), linear between the strains."""
        at, by = np.ascontiguousarray(strain, dtype=float), np.ascontiguousarray(factor, dtype=float)
        _call("softfall_material_bend", self._handle, c.c_int64(at.size), _array(at), _array(by))
        self.curves = []
        self._read_curves()

    def write(self, folder: str, name: str, title: str, comments: str) -> None:
        """softfall_material_write: folder/name.cfg with its curves."""
        with _one_at_a_time:
            _call("softfall_material_write", self._handle, os.fsencode(folder), name.encode(), title.encode(), comments.encode())


class _Terms(c.Structure):
    _fields_ = [(name, c.c_double) for name in ("density", "damp", "hu", "shape", "unloading_alpha", "informed")] + \
        [("terms", c.c_int), *((name, c.c_double * 6) for name in ("mu", "alpha", "nu"))]


class Hyperfoam(Foam):
    """A hyperfoam in memory: softfall_hyperfoam_material. `terms`: mu (Pa), alpha and nu of each; `unloading`: HU, SHAPE, ALPHA."""

    def __init__(self, density: float, damp: float, terms: Any, unloading: Sequence[float] = (1.0, 1.0, 1.0), informed: float = 0.0) -> None:
        made = c.c_void_p()
        columns = [(c.c_double * 6)(*column) for column in zip(*terms)]
        _call("softfall_hyperfoam_material", c.byref(_Terms(density, damp, *unloading, informed, len(terms), *columns)), c.byref(made))
        super().__init__(made)

    def loading(self, strain: Any) -> tuple[Array, Array, Array]:
        """softfall_hyperfoam_loading: nominal stress (Pa), lateral strain and W (J/m3) with free sides."""
        made = [np.empty_like(strain) for _ in range(3)]
        _call("softfall_hyperfoam_loading", self._handle, _array(strain), c.c_int64(strain.size), *map(_array, made))
        return made[0], made[1], made[2]


class CompressionTest(NamedTuple):
    """A compression test as the fits take it: loading, then unloading."""

    strain: Array
    stress: Array  # Pa
    loading: int
    largest_strain: float
    largest_stress: float
    cycles: int
    dwell: int
    words: str


class _Source(c.Structure):
    _fields_ = [("path", c.c_char_p), ("rate", c.c_double), ("area", c.c_double), ("thickness", c.c_double), ("toe", c.c_int), ("invert", c.c_int),
                ("contact_force", c.c_double), ("cycle", c.c_char_p)]


class _Test(c.Structure):
    _fields_ = [("count", c.c_int64), ("loading", c.c_int64), ("strain", c.POINTER(c.c_double)), ("stress", c.POINTER(c.c_double)),
                ("largest_strain", c.c_double), ("largest_stress", c.c_double), ("cycles", c.c_int), ("dwell", c.c_int), ("words", c.c_char_p)]


def read_compression(path: str, rate: float, area: float, thickness: float, toe: bool, invert: int, contact_force: float, cycle: str) -> CompressionTest:
    """softfall_compression_read: rate in 1/s, area in m2 and thickness in m (0: unknown), force in N; `cycle` "": the first."""
    made = c.POINTER(_Test)()
    with _one_at_a_time:
        _call("softfall_compression_read", c.byref(_Source(os.fsencode(path), rate, area, thickness, toe, invert, contact_force, cycle.encode() or None)), c.byref(made))
    t = made.contents
    try:
        return CompressionTest(np.array(t.strain[:t.count]), np.array(t.stress[:t.count]), t.loading, t.largest_strain, t.largest_stress, t.cycles, t.dwell,
                               t.words.decode(errors="replace"))
    finally:
        _load().softfall_compression_free(made)


def fit_compression(path: str, folder: str, replace: bool) -> None:
    """softfall_fit_compression: the fit of a free curve, whose files it writes."""
    with _one_at_a_time:
        _call("softfall_fit_compression", os.fsencode(path), os.fsencode(folder), c.c_int(replace))


class Form:
    """A form of the loading curve on a start material, or on a foam of a density alone. Values are arrays in SI units, in the order of `parameters`."""

    def __init__(self, material: str | float, curve: str, solid_density: float) -> None:
        self._handle, self._free = c.c_void_p(), _load().softfall_form_free
        with _one_at_a_time:
            if isinstance(material, str):
                _call("softfall_form_read", os.fsencode(material), curve.encode(), c.c_double(solid_density), c.byref(self._handle))
            else:
                _call("softfall_form_make", c.c_double(material), curve.encode(), c.c_double(solid_density), c.byref(self._handle))
        told = json.loads(_load().softfall_form_parameters(self._handle).decode(errors="replace"))
        self.curve, self.formula, self.density, self.curves = str(told["curve"]), str(told["formula"]), float(told["density"]), int(told["curves"])
        self.parameters = [Parameter(**entry) for entry in told["parameters"]]
        self.index = {p.name: k for k, p in enumerate(self.parameters)}

    def __del__(self) -> None:
        if hasattr(self, "_free"):
            self._free(self._handle)

    def start(self, given: Mapping[str, float], unknown: Sequence[str]) -> Array:
        """softfall_form_start: values of the start material and medians of the priors, but for those that are given."""
        values = np.array([given.get(p.name, np.nan) for p in self.parameters])
        flags = (c.c_int * len(self.parameters))(*(p.name in unknown for p in self.parameters))
        made = np.empty_like(values)
        _load().softfall_form_start(self._handle, _array(values), flags, _array(made))
        return made

    def pole(self, values: Any) -> float:
        return float(_load().softfall_form_pole(self._handle, _array(values)))

    def loading(self, values: Any, rate: float, strain: Any) -> Array:
        """softfall_form_loading: nominal stress in Pa; strains ascend. `rate` 0: the curve alone."""
        stress: Array = np.empty_like(strain)
        _load().softfall_form_loading(self._handle, _array(values), c.c_double(rate), _array(strain), c.c_int64(strain.size), _array(stress))
        return stress

    def foam(self, values: Any, informed: float = 0.0) -> Foam:
        """softfall_form_material: the foam of these values; a NumericError says why they make none."""
        made, numbers = c.c_void_p(), np.ascontiguousarray(values, dtype=float)
        _call("softfall_form_material", self._handle, _array(numbers), c.c_double(informed), c.byref(made))
        return Foam(made)


class _Instrument(c.Structure):
    _fields_ = [(name, c.c_double) for name in ("frequency", "damping", "coupling", "filter")]


def reading(time: Any, deceleration: Any, chain: Sequence[float], channel_class: float) -> tuple[Array, float]:
    """softfall_reading: the curve as an instrument reads it, and the instant of contact (s)."""
    read, contact = np.empty_like(deceleration), c.c_double()
    frequency, damping, coupling = chain
    instrument = _Instrument(frequency, damping, coupling, channel_class)
    _call("softfall_reading", _array(time), _array(deceleration), c.c_int64(time.size), c.byref(instrument), _array(read), c.byref(contact))
    return read, contact.value


def hic(time: Any, deceleration: Any, window: float) -> tuple[float, float, float]:
    """softfall_hic: value and window; arrays of double of one length."""
    found = (c.c_double * 3)()
    _call("softfall_hic", _array(time), _array(deceleration), c.c_int64(time.size), c.c_double(window), found)
    return found[0], found[1], found[2]


def cfc(time: Any, value: Any, channel_class: float, out: Any) -> None:
    """softfall_cfc: fills `out`; arrays of double of one length."""
    _call("softfall_cfc", _array(time), _array(value), c.c_int64(time.size), c.c_double(channel_class), _array(out))


def refine(fine: float, coarse: float, ratio: float, cells: float) -> tuple[float, float]:
    """softfall_refine: value and error at ever finer meshes."""
    refined = (c.c_double * 2)()
    _call("softfall_refine", c.c_double(fine), c.c_double(coarse), c.c_double(ratio), c.c_double(cells), refined)
    return refined[0], refined[1]


class RecordParts(NamedTuple):
    """What the library says of a measured record."""

    time: Array  # s
    deceleration: Array  # g
    grade: int
    verdict: str
    interpretation: str
    figures: dict[str, float]


RECORD_FIGURES = ("a_max_g", "a_max_time_ms", "hic", "hic_t1_ms", "hic_t2_ms", "hic15", "hic36", "gadd", "clip_3ms_g", "clip_3ms_cumulative_g")


class _Samples(c.Structure):
    _fields_ = [("name", c.c_char_p), ("reading", c.c_char_p), ("count", c.c_int64), ("time", c.POINTER(c.c_double)), ("axes", c.c_int),
                ("value", c.POINTER(c.c_double) * 3)]


def make_record(name: str, reading: str, time: Any, axes: Sequence[Any], options: Sequence[str]) -> RecordParts:
    """softfall_record_make, and all that it has: `time` (s) and one to three axes (g) are arrays of double of one length."""
    texts = (c.c_char_p * max(1, len(options)))(*(text.encode() for text in options))
    samples = _Samples(name.encode(), reading.encode(), time.size, _array(time), len(axes), (c.POINTER(c.c_double) * 3)(*map(_array, axes)))
    record, time, value = c.c_void_p(), c.POINTER(c.c_double)(), c.POINTER(c.c_double)()
    _call("softfall_record_make", c.byref(samples), texts, c.c_int(len(options)), c.byref(record))
    try:
        count = _load().softfall_record_curve(record, c.byref(time), c.byref(value))
        figures, number = {}, c.c_double()
        for key in RECORD_FIGURES:
            _call("softfall_record_figure", record, key.encode(), c.byref(number))
            figures[key] = number.value
        return RecordParts(np.array(time[:count]), np.array(value[:count]), _load().softfall_record_grade(record),
                           _load().softfall_record_verdict(record).decode(errors="replace"),
                           _load().softfall_record_interpretation(record).decode(errors="replace"), figures)
    finally:
        _load().softfall_record_free(record)
