# SPDX-License-Identifier: GPL-3.0-or-later
"""The file of a fit: start material, forms of the curve, unknown parameters with their priors, drops and tests that were measured, drops to predict."""
from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Container, NamedTuple

import numpy as np

from .. import laboratory, library, memory, output as output_files, record, settings
from ..array import Array
from ..errors import Error, InputError
from ..settings import Setting

MOST_UNKNOWNS, MOST_DROPS, MOST_MODELS, MOST_TESTS = 20, 24, 16, 8
KEYS = ("name", "title", "material", "curve_form", "solid_density", "start", "unknown", "drops", "predict", "forms", "seed", "posterior", "compressions", "cushions",
        "coarse_set", "mount", "mount_frequency_sd", "mount_damping_sd", "coupling", "coupling_sd")
CHAIN = ("mount_frequency", "mount_damping", "coupling")
TERMS = {"none": (), "factor": ("factor",), "maxwell": ("maxwell",), "both": ("factor", "maxwell")}
SAMPLE_STEP, SAMPLE_LEVEL, MOST_SAMPLES = 0.5e-3, 0.05, 200  # s, share of the peak, of a measured curve
COPY = 1e-3  # of the peak: curves that differ by less are one
STRAIN_STEP, SPREAD, LOW_STRESS = 0.05, 0.01, 0.02  # of a compression test: between points, over which each is a mean; share of the largest stress in the scatter
SPECIMEN = ("side", "width", "diameter", "area", "thickness")
TOE_WITHIN, TOE_OVER, TOE_POINTS, MOST_TOE = 0.15, 0.01, 5, 0.1  # strain in which the steepest part is looked for, over which, by how many points; the most that goes
ENERGIES = 6  # points of a curve of the stress-energy method
GIVEN_SOLID = (300.0, 20000.0)  # kg/m3, of solids that foams are made of


class Kind(NamedTuple):
    """A number that may be measured of a drop, as the accelerometer reads it, filtered with CFC 1000."""

    key: str  # of the file of a fit
    stem: str  # of files
    error: str  # of response_error
    suffix: str
    name: str
    unit: str
    sd: float  # of the logarithm, where the file does not state it
    model_sd: float  # of the logarithm, of the model's error at kappa = 1
    digits: int
    always: bool  # in reports, measured or not
    above: bool  # a foam that collapses counts as above every value

    @property
    def heading(self) -> str:
        return f"{self.name} ({self.unit})" if self.unit else self.name


KINDS = (
    Kind("a_max_g", "a_max", "a_max", "_g", "a_max", "g", 0.02, 0.01, 1, True, True),
    Kind("HIC", "hic", "HIC", "", "HIC", "", 0.04, 0.02, 0, True, True),
    Kind("HIC_window_ms", "hic_window", "HIC_window", "_ms", "HIC window", "ms", 0.03, 0.02, 2, True, False),
    Kind("v_rebound_m_s", "v_rebound", "v_rebound", "_m_s", "rebound speed", "m/s", 0.03, 0.02, 3, False, False),
    Kind("contact_time_ms", "contact_time", "contact_time", "_ms", "contact time", "ms", 0.03, 0.02, 2, False, False))


class Curve(NamedTuple):
    """A measured curve from contact on, filtered with a channel class (0: as it is in the file)."""

    path: str
    time: Array  # s after contact
    value: Array  # g
    peak: float
    sd: float  # over the peak
    channel_class: float
    words: str


@dataclass
class Drop:
    """A drop that was measured, or is to be predicted."""

    name: str
    case: Path
    number: int  # in the case's series; 0: there is none
    predicted: bool
    value: dict[str, float] = field(default_factory=dict)  # by Kind.key
    sd: dict[str, float] = field(default_factory=dict)
    speed_sd: float = 0.0
    curve: Curve | None = None
    speed: float = 0.0  # m/s, of the case
    series: int = 1  # drops of the case


class Compression(NamedTuple):
    """A compression test at the points that are fitted."""

    name: str
    rate: float  # 1/s
    strain: Array  # loading, then unloading
    stress: Array  # Pa
    loading: int
    turn: float  # largest strain
    sd: Array  # Pa
    words: str


class Cushion(NamedTuple):
    """A curve of peak deceleration over static stress."""

    name: str
    thickness: float  # m
    height: float  # m
    stress: Array  # Pa
    peak: Array  # g
    sd: float


class Unknown(NamedTuple):
    """An unknown parameter, with a prior of its logarithm around its start value."""

    name: str
    start: float  # SI
    sd: float
    low: float
    high: float


@dataclass
class Model:
    """A form of the curve with its terms of the rate, its start values and its unknowns."""

    label: str
    form: library.Form
    start: Array
    unknown: list[Unknown]
    terms: tuple[str, ...]


@dataclass
class Input:
    """What the file of a fit says."""

    path: Path
    name: str
    title: str
    material: Path
    solid_density: float
    drops: list[Drop]
    compressions: list[Compression]
    cushions: list[Cushion]
    chain: list[float]
    chain_sd: list[float]
    coarse: list[str]
    seed: int
    posterior: bool
    models: list[Model]

    @property
    def measured(self) -> list[Drop]:
        return [drop for drop in self.drops if not drop.predicted]


def read_quantity(group: Setting, name: str, unit: str, low: float = 0.0, default: float | None = None) -> float:
    """Returns a quantity above a bound, in SI units; without a default it is required."""
    found = group.get(name)
    if found is None and default is not None:
        return default
    found = found or group.member(name)
    if found.kind != "text":
        found.refuse(f'{name} must be a text with a unit, such as "{_EXAMPLES[unit]}"')
    try:
        value, kind = library.quantity(str(found.value))
    except InputError as error:
        found.refuse(f"{name}: {error}")
    if kind != unit:
        found.refuse(f'{name}: "{found.value}" is not {_EXAMPLES[unit]!r} or the like')
    if not value > low:
        found.refuse(f"{name}: {found.value} is not above {low:g}")
    return value


_EXAMPLES = {"m": "50 mm", "m2": "25 cm2", "N": "2 N", "s-1": "10 1/min", "kg m-3": "940 kg/m3", "Pa": "101 kPa", "s": "0.5 ms", "Pa s": "100 Pa s", "m s-1": "5 mm/min"}


# ---- drops

def _curve(group: Setting, name: str) -> Curve | None:
    word = group.choice("curve_filter", ("1000", "600", "180", "60", "none"))
    given = [key for key in ("curve_sd", "curve_filter", "curve_column", "curve_columns", "curve_invert", "curve_zero") if group.get(key)]
    if not group.get("curve"):
        return group.member(given[0]).refuse(f"{given[0]} is given, but no curve") if given else None
    path, sd = group.file("curve"), group.number("curve_sd", 1e-4, 1, 0.03)
    options: dict[str, Any] = {"filter": word, "invert": group.flag("curve_invert", False), "zero": group.flag("curve_zero", False)}
    options |= {key: group.text(f"curve_{key}") for key in ("column", "columns") if group.get(f"curve_{key}")}
    try:
        read = record.read_record(path, **options)
        contact = library.reading(np.ascontiguousarray(read.time), np.ascontiguousarray(read.deceleration), (0.0, 0.5, 0.0), 1000.0)[1]
    except Error as error:
        group.member("curve").refuse(f"{error}")
    if str(read.verdict) == library.GRADES[2]:
        group.member("curve").refuse(f"{path}: a foam cannot be fitted to this record: {'; '.join(read.verdict.remarks)}")
    peak = float(np.max(read.deceleration))
    time = np.arange(1, int((read.time[-1] - contact) / SAMPLE_STEP) + 1) * SAMPLE_STEP
    value = np.interp(contact + time, read.time, read.deceleration)
    keep = np.flatnonzero(value >= SAMPLE_LEVEL * peak)[:MOST_SAMPLES]
    return Curve(str(path), time[keep], value[keep], peak, sd, 0.0 if word == "none" else float(word), read.interpretation)


def _drop(group: Setting, predicted: bool, before: list[Drop]) -> Drop:
    keys = ["name", "case", "drop"]
    if not predicted:
        keys += [key for kind in KINDS for key in (kind.key, f"{kind.error}_sd")]
        keys += ["HIC_window_resolution_ms", "speed_sd", "curve", "curve_sd", "curve_filter", "curve_column", "curve_columns", "curve_invert", "curve_zero"]
    group.names(keys)
    name = group.text("name", f"drop-{len(before) + 1}")
    if not re.fullmatch(r"[\w.-]{1,63}", name, re.ASCII):
        group.refuse(f'the name "{name[:80]}" begins file names: use up to 63 letters, digits, dots, dashes')
    if any(drop.name == name for drop in before):
        group.refuse(f'two drops are called "{name}"')
    made = Drop(name, group.file("case"), int(group.number("drop", 1, 100, 0, whole=True)), predicted)
    if predicted:
        return made
    for kind in KINDS:
        if group.get(kind.key):
            made.value[kind.key] = group.number(kind.key, 1e-3, 1e7)
            made.sd[kind.key] = group.number(f"{kind.error}_sd", 1e-4, 1, kind.sd)
        elif group.get(f"{kind.error}_sd"):
            group.member(f"{kind.error}_sd").refuse(f"{kind.error}_sd is given, but no {kind.key}")
    if group.get("HIC_window_resolution_ms"):
        if "HIC_window_ms" not in made.value:
            group.member("HIC_window_resolution_ms").refuse("HIC_window_resolution_ms is given, but no HIC_window_ms")
        window = made.value["HIC_window_ms"]
        step = group.number("HIC_window_resolution_ms", 1e-3, window)  # both ends are uniform over a step
        made.sd["HIC_window_ms"] = math.hypot(made.sd["HIC_window_ms"] if group.get("HIC_window_sd") else 0.0, step / math.sqrt(6) / window)
    made.speed_sd = group.number("speed_sd", 0, 0.2, 0.0)
    made.curve = _curve(group, name)
    if not made.value and not made.curve:
        group.refuse(f'the drop "{name}" has no a_max_g, no HIC, nothing else measured and no curve')
    _refuse_twice(group, made, before)
    return made


def _is_same_curve(a: Curve | None, b: Curve | None) -> bool:
    if not a or not b:
        return a is b
    count = min(len(a.value), len(b.value))
    return 2 * count > max(len(a.value), len(b.value)) and bool(np.max(np.abs(a.value[:count] - b.value[:count])) <= COPY * max(a.peak, b.peak))


def _refuse_twice(group: Setting, made: Drop, before: list[Drop]) -> None:
    """Refuses the same data twice: a drop would weigh more than it tells, and would foretell itself where it is left out."""
    for one in before:
        same = one.case.parent.resolve() == made.case.parent.resolve() and one.case.read_bytes() == made.case.read_bytes()
        if same and one.number == made.number and one.value == made.value and _is_same_curve(one.curve, made.curve):
            group.refuse(f'the drop "{made.name}" has the case and every measured value of "{one.name}": give the same data once (of drops that were repeated, the mean)')
        if made.curve and one.curve and _is_same_curve(one.curve, made.curve):
            group.refuse(f'the curve of the drop "{made.name}" is that of "{one.name}", sample by sample: a curve was measured in one drop')


def _check_case(drop: Drop, material: Path) -> None:
    """Reads the case of a drop with the start material, and takes its speed and its series."""
    try:
        with memory.Inputs(str(drop.case), [f"material=@{material}"]) as inputs:
            drop.series, alike = len(inputs.counted()), inputs.is_alike()
        listing = library.case_parameters(str(drop.case), [f"material=@{material}"])
    except Error as error:
        raise InputError(f'the drop "{drop.name}": {error}') from None
    found = {line.split()[0]: line for line in listing.splitlines()}
    speed = re.match(r'missile\.velocity +"[^"]*" +(\S+)', found.get("missile.velocity", ""))
    wrong = "the case has no series: leave out its key drop" if drop.number and drop.series == 1 else \
        f"its key drop, {drop.number}, is larger than series.drops = {drop.series}" if drop.number > drop.series else \
        "the case has a series: say which of them it is by its number, such as drop = 2" if drop.series > 1 and not drop.number else \
        "softfall fit takes a series whose drops have one missile, speed and place" if drop.series > 1 and not alike else \
        "the missile's motion is prescribed: it is no drop" if not speed else \
        "softfall fit fits a foam at one temperature: give its material the curve of that temperature as `curve`, and leave out pad.temperature" \
        if found.get("pad.temperature", "").endswith(" given") and "(absent)" not in found["pad.temperature"] else ""
    if wrong:
        raise InputError(f'the drop "{drop.name}": {drop.case}: {wrong}')
    assert speed
    drop.speed = float(speed[1])


# ---- compression tests and cushion curves

def _name(group: Setting, usual: str, number: int) -> str:
    text = group.text("name", f"{usual} {number}")
    return text if len(text) < 64 else group.refuse(f'the name "{text[:80]}" is longer than 63 characters')


def _compression(group: Setting, number: int) -> Compression:
    group.names(("name", "file", "rate", "specimen", "toe_correction", "invert", "sd", "cycle"))
    name, path = _name(group, "compression", number), group.file("file")
    rate, sd = read_quantity(group, "rate", "s-1"), group.number("sd", 1e-4, 1, 0.05)
    options = {"cycle": group.text("cycle")} if group.get("cycle") else {}
    if group.get("specimen"):
        specimen = group.member("specimen")
        specimen.names(SPECIMEN)
        options |= {key: specimen.text(key) for key in SPECIMEN if specimen.get(key)}
    invert = group.choice("invert", ("none", "strain", "stress", "both"))
    try:
        reading = laboratory.read(path, kind="compression", **options, **({"invert": invert} if invert != "none" else {}))
    except Error as error:
        group.member("file").refuse(str(error))
    strain, stress = _as_test(group, reading.frame)
    top = int(np.argmax(strain))
    if group.flag("toe_correction", False):
        strain = strain - _toe(group, strain[:top + 1], stress[:top + 1])
    first = strain[0] + SPREAD if strain[0] > SPREAD else 0.0
    whole = STRAIN_STEP * np.arange(1, math.floor((strain[top] - SPREAD) / STRAIN_STEP + 1e-9) + 1)  # clear of the turn
    grid = np.concatenate([[STRAIN_STEP / 2], whole])
    grid = grid[grid >= first]
    back = whole[whole > strain[-1] + SPREAD + 1e-9][::-1] if len(strain) - top > 2 else whole[:0]
    loading, unloading = _means(strain[:top + 1], stress[:top + 1], grid), _means(strain[top:], stress[top:], back)
    if len(grid) < 2:
        group.refuse(f"{path}: fewer than two points of loading, {STRAIN_STEP} apart in strain")
    scale = float(stress.max())
    values = np.concatenate([loading, unloading])
    return Compression(name, rate, np.concatenate([grid, back]), values, len(grid), float(strain[top]), sd * np.hypot(values, LOW_STRESS * scale), reading.words)


def _means(strain: Array, stress: Array, at: Array) -> Array:
    """Returns means of a branch over a little strain on each side."""
    order = np.argsort(strain, kind="stable")
    return np.asarray(np.mean([np.interp(at + SPREAD * k / 4, strain[order], stress[order]) for k in range(-4, 5)], axis=0)) if len(at) else at


def _toe(group: Setting, strain: Array, stress: Array) -> float:
    """Returns where the steepest part of loading, a line over 1 % strain, meets zero stress."""
    best, zero = 0.0, 0.0
    for start in strain[strain < TOE_WITHIN]:
        part = (strain >= start) & (strain <= start + TOE_OVER)
        if part.sum() >= TOE_POINTS:
            slope, at = np.polyfit(strain[part], stress[part], 1)
            best, zero = max((best, zero), (float(slope), float(-at / slope) if slope > 0 else 0.0))
    if not best > 0:
        group.member("toe_correction").refuse(f"toe_correction needs {TOE_POINTS} points over 1 % strain below {TOE_WITHIN:g}, on which the stress rises")
    return zero if zero <= MOST_TOE else group.member("toe_correction").refuse(f"the toe would take {100 * zero:.1f} % strain; at most {100 * MOST_TOE:g} % may go")


def _as_test(group: Setting, frame: Any) -> tuple[Array, Array]:
    """Returns strain (-) and stress (Pa) of a table by its headings, up to the lowest strain after the first rise."""
    factor = {"strain": 1.0, "strain_percent": 0.01, "stress_kPa": 1e3, "stress_MPa": 1e6, "stress_Pa": 1.0, "strain (1)": 1.0, "strain (%)": 0.01, "stress (kPa)": 1e3}
    found = {name.split("_")[0].split(" ")[0]: factor[name] * frame[name].to_numpy(float) for name in frame.columns if name in factor}
    if set(found) != {"strain", "stress"}:
        group.member("file").refuse(f"the file has the columns {', '.join(map(str, frame.columns))}; a fit takes strain and stress_kPa")
    return found["strain"], found["stress"]


def _cushion(group: Setting, number: int) -> Cushion:
    group.names(("name", "file", "points", "stress_energy", "thickness", "drop_height", "sd"))
    kinds = [key for key in ("file", "points", "stress_energy") if group.get(key)]
    if len(kinds) != 1:
        group.refuse("a cushion curve is one of file, points and stress_energy")
    name, thickness, height = _name(group, "cushion", number), read_quantity(group, "thickness", "m"), read_quantity(group, "drop_height", "m")
    if kinds == ["file"]:
        path = group.file("file")
        text = output_files.read(path).decode(errors="replace")
        rows = list(csv.DictReader(line for line in text.splitlines() if line.strip() and not line.startswith("#")))
        try:
            stress, peak = (scale * np.array([float(row[key]) for row in rows]) for key, scale in (("static_stress_kPa", 1e3), ("peak_g", 1.0)))
        except (KeyError, TypeError, ValueError):
            group.member("file").refuse(f"{path} must have the columns static_stress_kPa and peak_g, with a number in every row")
        if not len(rows):
            group.member("file").refuse(f"{path} has no points")
    elif kinds == ["points"]:
        listed = group.member("points").items
        if not listed or any(len(row.items) != 2 or not all(item.is_number for item in row.items) for row in listed):
            group.member("points").refuse("points must be a list of pairs, kPa and g: points = ( [2.0, 60.0], [5.0, 55.0] )")
        pairs = np.array([[float(item.value) for item in row.items] for row in listed])
        stress, peak = 1e3 * pairs[:, 0], pairs[:, 1]
    else:
        inner = group.member("stress_energy")
        inner.names(("A", "B", "from", "to"))
        a, low, high = (read_quantity(inner, key, "Pa") for key in ("A", "from", "to"))
        b = inner.number("B", 1e-6, 10) * 1e-3  # per J/m3
        if not low < high:
            inner.refuse("from is not below to")
        energy = np.linspace(low, high, ENERGIES)
        stress = energy * thickness / height
        peak = a * np.exp(b * energy) / stress
    if not (np.all(stress > 0) and np.all(peak > 0)):
        group.refuse("static stresses and peaks must be above 0")
    return Cushion(name, thickness, height, stress, peak, group.number("sd", 1e-4, 1, 0.05))


# ---- models

def _starts(groups: list[Setting], form: library.Form, forms: list[library.Form]) -> dict[str, float]:
    """Returns start values of the groups `start`, a later one first in rank. In the first, of all models, a value may be of another form."""
    given: dict[str, float] = {}
    for holder in groups:
        group = holder.get("start")
        if group is None:
            continue
        if group.kind != "group":
            group.refuse('start must be a group: start: { p0 = "101 kPa"; }')
        for item in group.items:
            parameter = next((p for p in form.parameters if p.name == item.name), None)
            if parameter is None:
                item.refuse(f'unknown parameter "{item.name[:80]}" of the foam')
            if not parameter.used and not (holder is groups[0] and any(one.parameters[one.index[item.name]].used for one in forms)):
                item.refuse(f'start: {item.name} is not a parameter of the form "{form.curve}"')
            given[item.name] = start_value(group, parameter)
    return given


def start_value(group: Setting, parameter: library.Parameter) -> float:
    """Returns the value (SI) of a parameter in a group `start`."""
    name, low, high = parameter.name, parameter.low, parameter.high
    value = read_quantity(group, name, parameter.quantity) if parameter.quantity else group.number(name, low, high)
    return value if low <= value <= high else group.member(name).refuse(f"{name} is {value:g}, outside of {low:g} to {high:g}")


def _listed(holder: Setting) -> dict[str, Setting]:
    made: dict[str, Setting] = {}
    for entry in holder.groups("unknown", MOST_UNKNOWNS) if holder.get("unknown") else []:
        entry.names(("name", "prior_sd"))
        name = entry.text("name")
        if name in made:
            entry.refuse(f"unknown: {name} is given twice")
        made[name] = entry
    return made


def refuse_solid(root: Setting, solid: float, density: float = 0.0) -> None:
    """Refuses a density of the solid (kg/m3, 0: not given) that no foam of this density (0: not known yet) is made of."""
    if solid and not GIVEN_SOLID[0] <= solid <= GIVEN_SOLID[1]:
        root.member("solid_density").refuse(f"solid_density is {solid:g} kg/m3; solids that foams are made of have {GIVEN_SOLID[0]:g} to {GIVEN_SOLID[1]:g} kg/m3")
    if solid and not density < 0.5 * solid:
        root.member("solid_density").refuse(f"solid_density is {solid:g} kg/m3, the foam's density {density:g} kg/m3: a foam is less than half solid")


def check_solid(root: Setting, own: Setting, form: library.Form, given: Container[str], listed: Container[str], solid: float) -> None:
    """Checks that the solid fraction is known in one way, where the form has one."""
    density, key = root.get("solid_density"), "curve" if own is not root else "curve_form"
    if density and own is root and not form.parameters[form.index["solid_fraction"]].used:
        density.refuse(f'solid_density is given, but curve_form = "{form.curve}" has no solid fraction; leave it out, or take gas_solid')
    if density and "solid_fraction" in given:
        density.refuse(f"the solid fraction is given twice: by solid_density, which makes it {form.density / solid:.3g}, and as solid_fraction in start")
    if form.curve == "gas_solid" and not (density or "solid_fraction" in given or "solid_fraction" in listed):
        own.refuse(f'{key} = "gas_solid" needs solid_density, the density of the solid in the cell walls, or solid_fraction among the unknown parameters')


def _model(root: Setting, own: Setting, form: library.Form, forms: list[library.Form], solid: float) -> Model:
    rate = own.choice("rate", tuple(TERMS)) if own is not root and own.get("rate") else None
    given = _starts([root] if own is root else [root, own], form, forms)
    common, special = _listed(root), _listed(own) if own is not root else {}
    listed = {**common, **special}
    for name in special:
        if name in common:
            special[name].refuse(f"unknown: {name} is given twice")
    check_solid(root, own, form, given, listed, solid)
    for name, entry in listed.items():
        if name not in form.index:
            entry.refuse(f'unknown parameter "{name[:80]}" of the foam')
        parameter = form.parameters[form.index[name]]
        if not parameter.used:
            entry.refuse(f'{name} is not a parameter of the form "{form.curve}"')
        if rate is not None and parameter.rate != "none" and parameter.rate not in TERMS[rate]:
            entry.refuse(f'{name} is of a term of the rate ({parameter.rate}) that a model with rate = "{rate}" does not have')
    if rate is not None:
        for item in (own.get("start") or own).items if own.get("start") else []:
            term = form.parameters[form.index[item.name]].rate
            if term != "none" and term not in TERMS[rate]:
                item.refuse(f'start: {item.name} is of a term of the rate ({term}) that a model with rate = "{rate}" does not have')
    names = list(listed)
    factor, maxwell = (rate is not None and term in TERMS[rate] for term in ("factor", "maxwell"))
    start = form.start(given, [*names, *(["rate_factor"] if factor else [])])
    if rate is not None and not factor:
        start[form.index["rate_factor"]] = 0.0
    if rate is not None and not maxwell:
        start[form.index["ED"]] = 0.0
    elif rate is not None and not (start[form.index["ED"]] > 0 and start[form.index["BETA1"]] > 0):
        own.refuse("a Maxwell branch needs ED and BETA1 in the start material or in start")
    if not (special if own is not root else common):
        names += [p.name for p in form.parameters if p.usual and p.name not in names] + ["ED"]
    names += ["ED", "rate_factor"] if rate is not None else []
    names = [name for name in dict.fromkeys(names) if start[form.index[name]] > 0 or name in listed]
    if len(names) > MOST_UNKNOWNS:
        own.refuse(f"{names[MOST_UNKNOWNS]} would be unknown number {MOST_UNKNOWNS + 1}; at most {MOST_UNKNOWNS} are taken")
    unknown = [_unknown(own, form, name, float(start[form.index[name]]), listed.get(name)) for name in names]
    return _checked(own, form, start, unknown)


def _unknown(own: Setting, form: library.Form, name: str, start: float, entry: Setting | None) -> Unknown:
    p, where = form.parameters[form.index[name]], entry or own
    if not start > 0:
        where.refuse(f"{name} is 0 in the start material: give a start value, start: {{ {name} = ...; }}")
    if not p.low <= start <= p.high:
        unit = f" {p.unit}" if p.unit else ""
        where.refuse(f"{name} is unknown, and starts at {start / p.per_unit:g}{unit}; it can be sought from {p.low / p.per_unit:g} to {p.high / p.per_unit:g}")
    sd = entry.number("prior_sd", 1e-3, 10, p.prior_sd) if entry else p.prior_sd
    return Unknown(name, start, sd, p.low, p.high)


def _checked(own: Setting, form: library.Form, start: Array, unknown: list[Unknown]) -> Model:
    at = {name: float(start[k]) for name, k in form.index.items()}
    if at["rate_factor"] > 0 and form.curve == "table" and form.curves > 1:
        own.refuse(f"a rate factor cannot act on the form \"table\" of a material with {form.curves} curves at several rates; a foam has one or the other")
    if at["HU"] == 1 and (at["reload"] > 0 or at["recovery"] > 0):
        own.refuse("HU is 1, but a foam without hysteresis has nothing to remember: give it HU, SHAPE and ALPHA of the unloading, or leave out reload and recovery")
    if at["drift"] > 0 and not at["reload"] > 0:
        own.refuse("drift is the fall of reload from loading to loading: give start: { reload = 0.4; }, or leave out drift")
    try:
        form.foam(start)
    except Error as error:
        (own.get("start") or own).refuse(f"start: {error}")
    terms = tuple(word for word, name in (("rate factor", "rate_factor"), ("Maxwell branch", "ED"), ("lock-up", "locked_fraction")) if at[name] > 0)
    return Model(", ".join([form.curve, *terms]), form, start, unknown, terms)


def _chain(root: Setting) -> tuple[list[float], list[float]]:
    """Returns mount frequency (Hz) and damping and the coupling (s), 0 without, and their standard deviations."""
    values = [0.0, 0.5, 0.0]
    if root.get("mount"):
        found = re.fullmatch(r"\s*f\s*=\s*([\d.eE+-]+)\s*(k?)Hz\s*,\s*damping\s*=\s*([\d.eE+-]+)\s*", root.text("mount"))
        try:
            values[:2] = [float(found[1]) * (1e3 if found[2] else 1.0), float(found[3])] if found else [0.0, 0.0]
        except ValueError:
            values[:2] = [0.0, 0.0]
        if not (values[0] > 0 and 0 < values[1] < 1):
            root.member("mount").refuse('mount must be like "f = 420 Hz, damping = 0.05", with a damping between 0 and 1')
    if root.get("coupling"):
        values[2] = read_quantity(root, "coupling", "s")
    sd = [root.number(f"{name}_sd", 0, 0.5, 0.0) for name in CHAIN]
    for k, name in enumerate(CHAIN):
        if sd[k] > 0 and not root.get("coupling" if k == 2 else "mount"):
            root.member(f"{name}_sd").refuse(f"{name}_sd is given without {'coupling' if k == 2 else 'mount'}")
    return values, sd


def _coarse(root: Setting, measured: bool) -> list[str]:
    found = root.get("coarse_set")
    if found is None:
        return []
    if found.kind not in ("array", "list") or any(item.kind != "text" for item in found.items):
        found.refuse('coarse_set must be a list of texts: coarse_set = ["geometry.parameters.fine_spacing=10"]')
    wrong = next((item for item in found.items if not str(item.value).startswith(("geometry.", "pad.", "solver."))), None)
    if wrong:
        wrong.refuse(f'coarse_set: "{wrong.value[:80]}" is not a key of geometry, pad or solver: the search has a coarser mesh, and nothing else')
    if not measured:
        found.refuse("coarse_set is given, but no measured drop to simulate")
    return [str(item.value) for item in found.items]


def read(path: str) -> Input:
    """Reads and checks the file of a fit with all that it names; InputError: file, line and what is wrong."""
    root = settings.read(path)
    if root.get("tests"):
        root.member("tests").refuse(f"compression tests alone are fitted by another command: softfall fit compression {path} -o DIR")
    root.names(KEYS)
    compressions = [_compression(entry, k) for k, entry in enumerate(root.groups("compressions", MOST_TESTS) if root.get("compressions") else [], 1)]
    cushions = [_cushion(entry, k) for k, entry in enumerate(root.groups("cushions", MOST_TESTS) if root.get("cushions") else [], 1)]
    drops: list[Drop] = []
    for key in ("drops", "predict"):
        if root.get(key) or (key == "drops" and not compressions and not cushions):
            for entry in root.groups(key, MOST_DROPS):
                drops.append(_drop(entry, key == "predict", drops))
    measured = any(not drop.predicted for drop in drops)
    coarse, (chain, chain_sd) = _coarse(root, measured), _chain(root)
    name, title, material = root.text("name", "material"), root.text("title", "Identified foam"), root.file("material")
    if re.search(r"[/\"'\\\n\r]", name) or name.startswith("fit") or len(name) > 63 or len(title) > 255:
        (root.get("name") or root).refuse(f'the name "{name[:80]}" names files: up to 63 characters, no slashes or quotes, and not fit..., which other files are called')
    for drop in drops:
        _check_case(drop, material)
    solid = read_quantity(root, "solid_density", "kg m-3", 0.0, 0.0)
    refuse_solid(root, solid)
    listed = root.get("forms")
    if listed and root.get("curve_form"):
        listed.refuse("give either forms or curve_form")
    entries = root.groups("forms", MOST_MODELS) if listed else [root]
    forms = []
    for entry in entries:
        if entry is not root:
            entry.names(("curve", "rate", "start", "unknown"))
        key = "curve_form" if entry is root else "curve"
        word = entry.text(key, "gas" if entry is root else None)
        try:
            forms.append(library.Form(str(material), word, solid))
        except InputError as error:
            (entry.get(key) or entry).refuse(f"{key}: {error}")
        refuse_solid(root, solid, forms[-1].density)
    models = [_model(root, entry, form, forms, solid) for entry, form in zip(entries, forms)]
    posterior = root.flag("posterior", True)
    if len(models) > 1 and not posterior:
        root.member("posterior").refuse("several forms are compared by their posteriors: posterior must be true")
    for drop in drops:
        for model in models:
            if drop.number and not any(model.start[model.form.index[key]] > 0 for key in ("reload", "recovery")):
                root.refuse(f'the drop "{drop.name}" is of a series, but the foam of {material} remembers nothing: give it material.memory, or start: {{ reload = 0.4; }}')
    slowest = min((test.rate for test in compressions), default=math.inf)
    for model in models:  # below the slowest test the law has no effect of the rate
        reference = model.form.index["rate_reference"]
        if math.isfinite(slowest) and not model.form.start({}, [])[model.form.index["rate_factor"]] > 0:
            model.start[reference] = min(model.start[reference], slowest)
    return Input(Path(path), name, title, material, solid, drops, compressions, cushions, chain, chain_sd, coarse,
                 int(root.number("seed", 0, 1e9, 1, whole=True)), posterior, models)
