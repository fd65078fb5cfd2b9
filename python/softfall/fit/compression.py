# SPDX-License-Identifier: GPL-3.0-or-later
"""The file of `softfall fit compression`: compression tests of a foam, a form of its curve or a hyperfoam, cycles (docs/identification.md)."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .. import laboratory, library, settings
from ..array import Array
from ..errors import Error, InputError
from ..library import CompressionTest, Form
from ..settings import Setting
from .input import SPECIMEN, TERMS, check_solid, read_quantity, refuse_solid, start_value

FORM_KEYS = ("law", "name", "density", "tests", "DAMP", "E_range", "specimen", "toe_correction", "cycles", "curve_form", "solid_density", "start", "unknown", "rate_model",
             "rate_reference", "predict")
HYPERFOAM_KEYS = ("law", "name", "density", "tests", "DAMP", "terms", "nu")
MOST_TESTS, MOST_UNKNOWNS, MOST_CYCLES, MOST_RECORDS, MOST_NAME = 8, 12, 16, 4, 63
INVERT = ("none", "strain", "stress", "both")
FACTOR_FILTER_TIME, FACTOR_DAMP = 5e-4, 0.05  # s, -: of a material with a rate factor (ADR 20)
SLOPE_POINTS = 4  # of the slope that E begins with
SOFTER = 0.05  # more than specimens of one block scatter
TURN, RETURN, UNLOADED, LONGEST_STEP, MOST_STRAIN = 0.05, 0.25, 0.1, 20.0, 0.98  # strain of a turn; shares of the largest strain; mean steps of a pause; strain
HELD, RELAXED = 5e-4, 0.02  # strain that counts as constant, share of the stress that a relaxation takes
LEAST_LATERAL = 6


class Test(NamedTuple):
    """A test at a constant nominal rate."""

    path: str
    rate: float  # 1/s
    data: CompressionTest

    @property
    def loading(self) -> slice:
        return slice(0, self.data.loading)

    @property
    def unloading(self) -> slice:
        return slice(self.data.loading, None)

    @property
    def unloads(self) -> bool:
        return len(self.data.strain) > self.data.loading

    def scaled(self, stress: Array) -> Array:
        """Returns deviations from the measured stress over its largest value."""
        return np.asarray((stress - self.data.stress[:len(stress)]) / self.data.largest_stress)

    def path_of(self, parts: int = 1) -> tuple[Array, Array]:
        """Returns time (s) and strain from rest on, at the nominal rate; `parts` of the way between two points."""
        strain = np.concatenate([[0.0], np.maximum(0.0, self.data.strain)])
        strain = np.interp(np.arange(parts * (len(strain) - 1) + 1) / parts, np.arange(len(strain)), strain)
        time = np.concatenate([[0.0], np.cumsum(np.maximum(1e-9, np.abs(np.diff(strain))) / self.rate)])
        return time, strain


class Cycles(NamedTuple):
    """A record of several cycles of one specimen."""

    path: str
    time: Array  # s
    strain: Array
    stress: Array  # Pa
    pause: Array  # s without load before each point
    turn: list[int]  # first point, that of the largest strain of cycle 1, of the least after it, ...
    fitted: int  # cycles, from the first on
    held: Array  # bool: the stress relaxes at the reversal, which is not in the law

    @property
    def whole(self) -> int:
        return len(self.turn) // 2

    @property
    def largest(self) -> float:
        return float(self.stress.max())

    @property
    def relaxation(self) -> float:
        """The largest share of the stress that is lost at constant strain at a reversal."""
        falls = [1 - float(self.stress[last]) / float(self.stress[top]) for top in self.turn[1::2] for last in [_end_of_hold(self.strain, self.stress, top)]]
        return max(falls, default=0.0)


@dataclass
class Given:
    """What the file says."""

    path: str
    name: str
    density: float
    damp: float
    tests: list[Test]
    form: Form | None = None  # None: a hyperfoam
    start: Array = field(default_factory=lambda: np.zeros(0))  # SI
    unknown: list[str] = field(default_factory=list)
    rate: str = "none"
    predicted: list[Test] = field(default_factory=list)
    cycles: list[Cycles] = field(default_factory=list)
    terms: int = 0
    nu: float = 0.0
    lateral: tuple[Array, Array] | None = None  # axial and lateral strain while loading

    @property
    def informed(self) -> float:
        return max(test.data.largest_strain for test in self.tests)


def is_free(root: Setting) -> bool:
    """Returns whether the file asks for the free curve, the paper's fit, which softfall-fit does."""
    form = root.get("curve_form")
    return root.choice("law", ("low_density_foam", "hyperfoam")) == "low_density_foam" and (form is None or form.value == "free")


# ---- tests

def _specimen(holder: Setting, usual: tuple[float, float]) -> tuple[float, float]:
    """Returns area (m2) and thickness (m), 0 where they are not said."""
    group = holder.get("specimen")
    if group is None:
        return usual
    if group.kind != "group":
        group.refuse('specimen must be a group { side = "50 mm"; thickness = "50 mm"; }')
    group.names(SPECIMEN)
    side, width, diameter, thickness = (read_quantity(group, key, "m", default=0.0) for key in ("side", "width", "diameter", "thickness"))
    area = read_quantity(group, "area", "m2", default=0.0)
    if (side > 0) + (diameter > 0) + (area > 0) > 1 or (width > 0 and not side > 0):
        group.refuse("specimen: give side (with width, if the face is no square), diameter or area")
    return side * (width or side) or 0.25 * math.pi * diameter ** 2 or area, thickness


def _rate(entry: Setting, thickness: float) -> float:
    """Returns a strain rate, given as one or as the crosshead's speed."""
    found = entry.member("rate")
    try:
        speed, unit = library.quantity(str(found.value)) if found.kind == "text" else (0.0, "")
    except InputError:
        unit = ""
    if unit != "m s-1":
        return read_quantity(entry, "rate", "s-1")
    if not (speed > 0 and thickness > 0):
        found.refuse(f"rate: \"{found.value}\" is a speed; it must be above 0 and needs the thickness of the specimen, such as specimen = {{ thickness = \"50 mm\"; }}")
    return speed / thickness


def _read(entry: Setting, rate: float, specimen: tuple[float, float], toe: bool) -> Test:
    area, thickness = specimen
    force = read_quantity(entry, "contact_force", "N", default=0.0)
    if force > 0 and not area > 0:
        entry.member("contact_force").refuse("contact_force is given: the test must have force and displacement of a specimen with an area")
    path, invert = entry.file("file"), INVERT.index(entry.choice("invert", INVERT))
    cycle = entry.text("cycle") if entry.get("cycle") else ""
    try:
        return Test(str(path), rate, library.read_compression(str(path), rate, area, thickness, toe, invert, force, cycle))
    except Error as error:
        raise type(error)(f"{error} (named at {entry.place})", error.code) from None


def _tests(root: Setting, key: str) -> list[Test]:
    specimen, toe = _specimen(root, (0.0, 0.0)), root.flag("toe_correction", False)
    made = []
    for entry in root.groups(key, MOST_TESTS):
        entry.names(("file", "rate", "specimen", "cycle", "contact_force", "toe_correction", "invert"))
        own = _specimen(entry, specimen)
        made.append(_read(entry, _rate(entry, own[1]), own, entry.flag("toe_correction", toe)))
        same = next((one for one in made[:-1] if key == "tests" and np.array_equal(one.data.strain, made[-1].data.strain) and np.array_equal(one.data.stress, made[-1].data.stress)), None)
        if same:  # it would say that the rate has no effect, or that nothing scatters
            entry.member("file").refuse(f"the points of {made[-1].path} are those of {same.path}: give the same data once")
    return sorted(made, key=lambda test: test.rate)


def _check_order(tests: list[Test]) -> None:
    """Refuses a test that is softer than one at a lower rate: the rates are exchanged, or the foams are different ones."""
    for slow, fast in zip(tests, tests[1:]):
        strain = min(slow.data.largest_strain, fast.data.largest_strain) * np.linspace(0.1, 0.9, 32)
        logs = [np.log(np.maximum(1e-9, np.interp(strain, t.data.strain[t.loading], t.data.stress[t.loading]))) for t in (fast, slow)]
        softer = -math.expm1(float(np.mean(logs[0] - logs[1])))
        if fast.rate > slow.rate and softer > SOFTER:
            raise InputError(f"{fast.path} at {fast.rate:g} 1/s is softer than {slow.path} at {slow.rate:g} 1/s, by {100 * softer:.3g} % on the mean over its loading: are the rates "
                             "exchanged? The stress of a foam does not fall with the rate")


# ---- cycles

def _columns(path: str, kind: str, names: tuple[str, ...]) -> list[Array]:
    """Returns columns of any file of a laboratory; InputError names the first that is missing."""
    frame = laboratory.read(path, kind=kind).frame
    missing = next((name for name in names if name not in frame), None)
    if missing:
        raise InputError(f"{path} has no column {missing}, but {', '.join(map(str, frame.columns))}")
    return [frame[name].to_numpy(float) for name in names]


def _turns(path: str, strain: Array) -> list[int]:
    """Returns turns of the strain; a loading without an unloading after it is left out."""
    turn, at, up = [0], 0, True
    for i, now in enumerate(strain):
        gain = now - strain[at] if up else strain[at] - now
        if gain > 0:
            at = i
        elif -gain > TURN:
            turn.append(at)
            up, at = not up, i
    turn = turn + [at] if not up else turn
    count = len(turn) // 2
    turn = turn[:2 * count + 1]
    if count > MOST_CYCLES:
        raise InputError(f"{path}: more than {MOST_CYCLES} cycles")
    if count < 2:
        raise InputError(f"{path}: {count} cycle of compression: memory is in the cycles after the first")
    for c in range(count):
        if strain[turn[2 * c + 2]] > RETURN * strain[turn[2 * c + 1]]:
            raise InputError(f"{path}: cycle {c + 1} returns from a strain of {strain[turn[2 * c + 1]]:g} to {strain[turn[2 * c + 2]]:g} only; it must unload below a quarter of it")
    return turn


def _end_of_hold(strain: Array, stress: Array, top: int) -> int:
    """Returns the last point at constant strain after a reversal at which the stress relaxes; the reversal itself if it does not."""
    last = top
    while last + 1 < len(strain) and abs(strain[last + 1] - strain[top]) <= HELD:
        last += 1
    return last if stress[last] < (1 - RELAXED) * stress[top] else top


def read_cycles(path: str, fitted: int) -> Cycles:
    """Reads a record of cycles; InputError says what is wrong with it."""
    time, strain, stress = _columns(path, "compression", ("time_s", "strain", "stress_kPa"))
    stress = 1e3 * stress
    wrong = np.flatnonzero(~(strain < MOST_STRAIN) | np.concatenate([[False], ~(np.diff(time) > 0)]))
    if len(wrong):
        i = int(wrong[0])
        raise InputError(f"{path}: point {i + 1}: time {time[i]:g} s after {time[max(0, i - 1)]:g} s, strain {strain[i]:g}: time must rise, strain stay below {MOST_STRAIN:g}")
    strain = np.maximum(0.0, strain)
    turn = _turns(path, strain)
    step, low = np.diff(time, prepend=time[0]), strain <= UNLOADED * strain[turn[1]]
    rests = low & np.roll(low, 1) & (step > LONGEST_STEP * min((time[-1] - time[0]) / (len(time) - 1), 1.0))
    held = np.zeros(len(time), dtype=bool)
    for top in turn[1::2]:
        held[top + 1:_end_of_hold(strain, stress, top) + 1] = True
    return Cycles(path, time, strain, stress, np.where(rests, step, 0.0), turn, min(fitted, len(turn) // 2), held)


def _cycles(root: Setting) -> list[Cycles]:
    found = root.get("cycles")
    if found is None:
        return []
    made: list[Cycles] = []
    if found.kind not in ("group", "list"):
        found.refuse('cycles must be a group or a list of groups: cycles = { file = "cycles.csv"; };')
    for group in root.groups("cycles", MOST_RECORDS) if found.kind == "list" else [found]:
        group.names(("file", "fitted"))
        fitted, path = int(group.number("fitted", 2, MOST_CYCLES, MOST_CYCLES, whole=True)), str(group.file("file"))
        try:
            made.append(read_cycles(path, fitted))
        except Error as error:
            group.refuse(str(error))
        same = next((one for one in made[:-1] if np.array_equal(one.stress, made[-1].stress)), None)
        if same:
            group.refuse(f"cycles: the record {same.path} is given twice")
    return made


# ---- a form

def _first_slope(test: Test, range_: float) -> float:
    """Returns the slope through the origin of the first points of loading."""
    strain, stress = test.data.strain[test.loading], test.data.stress[test.loading]
    used: Array = np.cumsum(strain > 0) - (strain > 0)  # points above 0 before each one
    end = int(np.argmax((used >= SLOPE_POINTS) & (strain > range_))) or len(strain)
    return max(1e3, float(strain[:end] @ stress[:end]) / float(strain[:end] @ strain[:end]))


def _form(root: Setting, given: Given) -> None:
    word, solid = root.text("curve_form"), read_quantity(root, "solid_density", "kg m-3", default=0.0)
    try:
        form = Form(given.density, word, solid)
    except InputError:
        form = None
    if form is None or word == "table":
        root.member("curve_form").refuse(f'curve_form is "{word[:80]}"; expected free or one of gas|gas_solid|rusch|avalle|spline, but not table')
    refuse_solid(root, solid, given.density)
    own = {p.name for p in form.parameters if p.used and p.rate == "none"} & ({"E", "locked_fraction"} | {p.name for p in form.parameters if p.of_curve})
    listed = root.get("unknown")
    if listed and (listed.kind not in ("array", "list") or any(item.kind in ("group", "list", "array") for item in listed.items)):
        listed.refuse('unknown must be a list: unknown = ( "E", "s0" )')
    unknown = list(dict.fromkeys(str(item.value) for item in listed.items)) if listed else ["E", *(p.name for p in form.parameters if p.usual)]
    wrong = next((name for name in unknown if name not in own), None)
    if listed and len(unknown) > MOST_UNKNOWNS:
        listed.refuse(f"unknown has {len(unknown)} entries; at most {MOST_UNKNOWNS} are taken")
    if listed and wrong is not None:
        listed.refuse(f'unknown: "{wrong[:80]}" is neither E nor a parameter of curve_form = "{word}"')
    rate = root.choice("rate_model", tuple(TERMS))
    slowest, fastest = given.tests[0], given.tests[-1]
    if rate != "none" and fastest.rate < slowest.rate * (1 + 1e-6):
        root.member("rate_model").refuse(f'the rate model "{rate}" needs tests at two rates; there is one rate')
    factor, maxwell = (term in TERMS[rate] for term in ("factor", "maxwell"))
    if factor and not root.get("DAMP"):
        given.damp = FACTOR_DAMP
    unknown += ["rate_factor"] * factor + ["ED", "BETA1"] * maxwell
    if not unknown:
        (listed or root).refuse('unknown is empty and rate_model is "none": there is nothing to fit')
    value = {"E": _first_slope(slowest, root.number("E_range", 0.001, 0.2, 0.02)), "DAMP": given.damp, "rate_factor": 0.0, "rate_reference": _reference(root, rate, slowest, fastest),
             "ED": 0.1 * fastest.data.largest_stress if maxwell else 0.0, "BETA1": math.sqrt(slowest.rate * fastest.rate) if maxwell else 5000.0}
    start = form.start(value | ({"rate_filter_time": FACTOR_FILTER_TIME, "rate_factor": math.nan} if factor else {}), unknown)
    given.form, given.unknown, given.rate = form, unknown, rate
    _start(root, form, rate, own, start)
    group = root.get("start")
    check_solid(root, root, form, [item.name for item in group.items] if group else (), unknown, solid)
    pole = form.pole(start)
    for test in (*given.tests, *given.predicted):
        if not test.data.largest_strain < pole:
            locked = " and locked_fraction" if start[form.index["locked_fraction"]] > 0 else ""
            root.member("curve_form").refuse(f"{test.path} reaches a strain of {test.data.largest_strain:.3g}, but with solid_fraction = {start[form.index['solid_fraction']]:.3g}{locked} "
                                             f'the curve of curve_form = "{word}" ends at {pole:.3g}: it is too large')
    given.start = start


def _refuse_term(item: Setting, term: str, rate: str) -> None:
    """Refuses a value of the rate that the rate model does not have: it would be lost."""
    if term != "none" and term not in TERMS[rate]:
        item.refuse(f'{item.name} is given, but rate_model = "{rate}" has none: give rate_model = "{term}" or "both", or leave it out')


def _reference(root: Setting, rate: str, slowest: Test, fastest: Test) -> float:
    found = root.get("rate_reference")
    if found is None:
        return slowest.rate
    _refuse_term(found, "factor", rate)
    value = read_quantity(root, "rate_reference", "s-1")
    if value < 1e-9:
        found.refuse(f"rate_reference is {value:g} 1/s; it must be at least 1e-09 1/s")
    return value if value < fastest.rate else found.refuse(f"rate_reference is {value:g} 1/s, but the fastest test has {fastest.rate:g} 1/s: the rate factor would be 1 in every test; "
                                                           "give a rate below it, or leave it out")


def _start(root: Setting, form: Form, rate: str, own: set[str], start: Array) -> None:
    group = root.get("start")
    if group and group.kind != "group":
        group.refuse('start must be a group: start = { p0 = "101 kPa"; }')
    for item in group.items if group else []:
        p = next((p for p in form.parameters if p.name == item.name), None)
        if p is None or not (item.name in own or item.name in ("rate_factor", "ED", "BETA1")):
            item.refuse(f'start: "{item.name[:80]}" is neither E, a parameter of curve_form = "{form.curve}", nor rate_factor, ED or BETA1')
        _refuse_term(item, p.rate, rate)
        assert group
        start[form.index[item.name]] = start_value(group, p)


# ---- a hyperfoam

def _hyperfoam(root: Setting, given: Given) -> None:
    given.terms = int(root.number("terms", 1, 3, 2))
    if given.terms != root.number("terms", 1, 3, 2):
        root.member("terms").refuse(f"terms is {root.number('terms', 1, 3, 2):g}; it must be 1, 2 or 3")
    given.nu = root.number("nu", 0, 0.45, 0.0)
    entries = root.groups("tests", MOST_TESTS)
    if len(entries) != 1:
        root.member("tests").refuse("the hyperfoam is fitted to one test, at one rate; fit the others in files of their own, and compare nu and mu")
    entry = entries[0]
    entry.names(("file", "rate", "lateral"))
    given.tests = [_read(entry, read_quantity(entry, "rate", "s-1"), (0.0, 0.0), False)]
    if entry.get("lateral"):
        given.lateral = _lateral(entry)
    if (root.get("nu") is None) == (given.lateral is None):
        root.refuse("nu is given, and lateral strain is measured; one of them says it" if given.lateral else
                    'give the test a table of lateral strain (lateral = "FILE", which may be its own file), or nu for all terms')


def _lateral(entry: Setting) -> tuple[Array, Array]:
    """Returns axial and lateral strain up to the largest strain, ascending."""
    path = entry.file("lateral")
    try:
        axial, lateral = _columns(str(path), "lateral", ("strain", "lateral_strain"))
    except Error as error:
        entry.member("lateral").refuse(str(error))
    if np.any(axial >= 1) or np.any(np.abs(lateral) >= 1):
        entry.member("lateral").refuse(f"{path}: a strain or lateral strain is outside -1 to 1; columns in percent are named strain_percent and lateral_strain_percent")
    end = int(np.argmax(axial)) + 1
    if end < LEAST_LATERAL:
        entry.member("lateral").refuse(f"{path}: {end} points of lateral strain while loading; {LEAST_LATERAL} are needed")
    order = np.argsort(axial[:end], kind="stable")
    return axial[:end][order], lateral[:end][order]


def read(path: str) -> Given:
    """Reads and checks a file of a form or a hyperfoam with all that it names; InputError: file, line and what is wrong."""
    root = settings.read(path)
    hyperfoam = root.choice("law", ("low_density_foam", "hyperfoam")) == "hyperfoam"
    root.names(HYPERFOAM_KEYS if hyperfoam else FORM_KEYS)
    name = root.text("name", "foam")
    if len(name) > MOST_NAME or any(one in name for one in "\n\r'\\"):
        root.member("name").refuse(f"name must be a text of 1 to {MOST_NAME} characters, without ', \\ and line ends")
    given = Given(path, name, read_quantity(root, "density", "kg m-3"), root.number("DAMP", 0, 10, 0.0), [])
    if hyperfoam:
        _hyperfoam(root, given)
        return given
    given.tests = _tests(root, "tests")
    given.predicted = _tests(root, "predict") if root.get("predict") else []
    given.cycles = _cycles(root)
    _form(root, given)
    _check_order(given.tests)
    return given
