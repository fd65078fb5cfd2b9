# SPDX-License-Identifier: GPL-3.0-or-later
"""The foam of a card of another solver, in SI units, and the rules by which it becomes a foam of softfall."""
from __future__ import annotations

import dataclasses
import itertools
import re
from bisect import bisect_right
from pathlib import Path
from typing import Callable, Sequence

from ..errors import InputError
from .units import Figures, System

MOST_BYTES, MOST_POINTS, MOST_CURVES, MOST_TERMS, MOST_FILES = 50_000_000, 20_000, 64, 6, 200
LEAST_POINTS = 4  # of a curve, as of softfall-pre
FAR = 2.0  # ratio of E and the first slope that is told
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[ed][-+]?\d+|[-+]\d+)?", re.IGNORECASE)


@dataclasses.dataclass
class Curve:
    """A compression curve: strain and nominal stress (Pa), compression positive."""

    strain: list[float]
    stress: list[float]
    rate: float | None = None  # 1/s; None: the card gives none
    place: str = ""  # file:line
    told: str = ""  # how it was read

    def turn(self) -> None:
        """Changes the sign of strain and stress, and the order of the points."""
        points = sorted((-a, -b) for a, b in zip(self.strain, self.stress))
        self.strain, self.stress = [a for a, _ in points], [b for _, b in points]


@dataclasses.dataclass
class Term:
    """A term of a hyperfoam; it has nu or beta."""

    mu: float  # Pa
    alpha: float
    nu: float | None
    beta: float | None = None


@dataclasses.dataclass
class Foam:
    """A foam of a card. A reader fills it in the units of its deck; `take` puts it into SI units."""

    key: str  # what --material takes: the number, or the name
    name: str
    card: str  # such as *MAT_LOW_DENSITY_FOAM
    place: str  # file:line
    density: float = 0.0  # kg/m3
    values: dict[str, float] = dataclasses.field(default_factory=dict)  # keys of material.cfg, in SI units
    curves: list[Curve] = dataclasses.field(default_factory=list)
    terms: list[Term] = dataclasses.field(default_factory=list)
    notes: list[str] = dataclasses.field(default_factory=list)  # sentences for the user
    unloading: list[Curve] = dataclasses.field(default_factory=list)
    fill: Callable[[], None] = lambda: None  # reads the rest of the card
    units: System | None = None  # that the deck declares

    @property
    def law(self) -> str:
        return "hyperfoam" if self.terms else "low_density_foam"

    def note(self, text: str) -> None:
        if text not in self.notes:
            self.notes.append(text)

    def drop(self, field: str, value: float | str | None, instead: str, unless: Sequence[float | str] = (0.0,)) -> None:
        """Tells of a field that softfall has no use for, unless it is blank or has a value that changes nothing."""
        if value is not None and value not in unless:
            self.note(f"{field} = {f'{value:g}' if isinstance(value, float) else value} is not used: {instead}")

    def figures(self) -> Figures:
        """Returns what the units of the deck are known by."""
        if self.terms:
            return Figures(self.density, sum(abs(term.mu) for term in self.terms) / 5, 0.0, "(a tenth of twice the shear modulus)")
        slowest = min(self.curves, key=lambda curve: curve.rate or 0)
        side = max(slowest.strain, key=abs, default=0.0)
        points = sorted((abs(a), abs(b)) for a, b in zip(slowest.strain, slowest.stress) if a * side > 0)
        stress = interpolate([a for a, _ in points], [b for _, b in points], 0.5 * abs(side)) if points else 0.0
        return Figures(self.density, stress, self.values.get("E", 0.0))

    def take(self, units: System) -> None:
        """Multiplies everything by the units of the deck."""
        self.density *= units.density
        for key in self.values:
            self.values[key] *= {"E": units.stress, "ED": units.stress, "tension_cutoff": units.stress, "BETA1": 1 / units.time, "rate_filter_time": units.time}.get(key, 1)
        if len(self.curves) > 1:
            rates = [curve.rate or 0.0 for curve in self.curves]
            self.note(f"rates are in the deck's time: {', '.join(f'{rate:g}' for rate in rates)} are {', '.join(f'{rate / units.time:g}' for rate in rates)} 1/s")
        for curve in self.curves + self.unloading:
            curve.stress = [units.stress * value for value in curve.stress]
            curve.rate = None if curve.rate is None else curve.rate / units.time
        for term in self.terms:
            term.mu *= units.stress


def refuse(place: str, sentence: str) -> InputError:
    return InputError(f"{place}: {sentence}")


def number(text: str, place: str, what: str) -> float:
    """Reads a number as Fortran does: 1.5, 1.5E-3, 1.5D-3 and 1.5-3."""
    text = text.strip()
    if not _NUMBER.fullmatch(text):
        raise refuse(place, f"{what} is {text[:40]!r}, which is no number: fields are found by columns or commas")
    value = float(re.sub(r"(?<=[\d.])([-+])", r"e\1", text.lower().replace("d", "e")))
    if not abs(value) <= 1e100:
        raise refuse(place, f"{what} is {text[:40]}, beyond 1e100")
    return value


def whole(value: float | None, place: str, what: str, most: int) -> int:
    """Returns a count of the card."""
    if value is None or value != int(value) or not 0 <= value <= most:
        raise refuse(place, f"{what} is {value if value is not None else 'blank'}; it must be a whole number up to {most}")
    return int(value)


def read_lines(path: Path, place: str = "") -> list[str]:
    """Returns the lines of a text file, which must be a plain one of moderate size."""
    where = place or str(path)
    try:
        if not path.is_file():
            raise refuse(where, f"{path} is no file" if path.exists() else f"there is no file {path}")
        if path.stat().st_size > MOST_BYTES:
            raise refuse(where, f"{path} has more than {MOST_BYTES // 1_000_000} MB; cut the material and its curves out of it")
        text = path.read_bytes().decode("utf-8-sig", errors="replace")
    except OSError as error:
        raise refuse(where, f"{path} cannot be read: {error.strerror}") from None
    if "-----BEGIN PGP" in text:
        raise refuse(where, f"{path} has an encrypted part; ask its supplier for the curves")
    return [line.rstrip() for line in re.split(r"\r\n|\r|\n", text.rstrip())]


def included(name: str, folder: Path, place: str) -> Path:
    """Returns the path of an include file: within the folder of the deck, and no link."""
    parts = Path(name.replace("\\", "/")).parts
    if not parts or Path(name).is_absolute() or ".." in parts or ":" in name or "\0" in name:
        raise refuse(place, f"the include {name[:80]!r} leads out of the folder of the deck; copy the file beside it")
    path = folder
    for part in parts:
        path = path / part
        try:
            if path.is_symlink():
                raise refuse(place, f"the include {name[:80]!r} is or passes a link; copy the file beside the deck")
        except OSError as error:
            raise refuse(place, f"the include {name[:80]!r} cannot be read: {error.strerror}") from None
    return path


def enter(path: Path, place: str, files: list[Path]) -> None:
    """Counts a file of a deck, which must not be read twice."""
    if path in files or len(files) >= MOST_FILES:
        raise refuse(place, f"the include {path.name} is read twice; leave one out" if path in files else f"the deck includes more than {MOST_FILES} files")
    files.append(path)


def interpolate(x: Sequence[float], y: Sequence[float], at: float) -> float:
    """Returns the value of a polygon, constant beyond its ends; x ascends."""
    k = bisect_right(x, at)
    if k in (0, len(x)):
        return y[0] if k == 0 else y[-1]
    return y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / (x[k] - x[k - 1])


def choose(foams: list[Foam], wanted: str | None, path: str) -> Foam:
    """Returns the foam of this number, name or place (file:line), or the only one."""
    same = [foam for foam in foams if wanted is None or wanted.strip().lower() in (foam.key.lower(), foam.name.lower(), foam.place.lower())]
    if len(same) == 1:
        return same[0]
    listed = "; ".join(f"{foam.key}{f' ({foam.name})' if foam.name != foam.key else ''}, {foam.card} at {foam.place}" for foam in (same or foams)[:20])
    if same:
        twice = sum(foam.key == same[0].key for foam in same) > 1
        raise refuse(path, f"{len(same)} foams are in it: {listed}. Choose one by its number, name or place, such as --material={same[0].place if twice else same[0].key!r}")
    raise refuse(path, f"there is no foam {wanted!r} in it; there are {listed}")


# ---- curves ----

def _turn(curve: Curve, told: Callable[[str], None]) -> None:
    """Makes compression positive, and cuts the tension side off."""
    low, high = min(curve.strain), max(curve.strain)
    if high <= 0 and low < 0:
        told("compression is negative in it: both signs are turned")
        curve.turn()
    elif low < 0:
        told(f"{sum(a < 0 for a in curve.strain)} points of tension, from a strain of {low:g} on, are not used: softfall takes E there, up to tension_cutoff" +
             ("" if -low < high else "; warning: they reach farther than those of compression. Is compression negative in this curve?"))
    points = [(a, b) for a, b in zip(curve.strain, curve.stress) if a >= 0]
    if points and max(b for _, b in points) <= 0 and min(b for _, b in points) < 0:
        told("its stresses are negative: their sign is turned")
        points = [(a, -b) for a, b in points]
    curve.strain, curve.stress = [a for a, _ in points], [b for _, b in points]


def _order(curve: Curve, told: Callable[[str], None]) -> None:
    """Leaves points of ascending strain below 1 and of stress that does not fall, from (0, 0) on."""
    if curve.strain and max(curve.strain) > 2:
        raise refuse(curve.place, f"the curve reaches a strain of {max(curve.strain):g}: is it in percent? Scale its abscissa by 0.01")
    points: list[tuple[float, float]] = []
    highest: list[float] = list(itertools.accumulate(curve.strain, lambda a, b: max(a, b)))
    back = [(a, b) for a, b, before in zip(curve.strain[1:], curve.stress[1:], highest) if a <= before]
    crushed = [(a, b) for a, b in zip(curve.strain, curve.stress) if a >= 1]
    for a, b in zip(curve.strain, curve.stress):
        if a < 1 and not (points and a <= points[-1][0]):
            points.append((a, b))
    for some, why in ((back, "the strain repeats or falls at"), (crushed, "a compression to nothing is meant by the strain")):
        if some:
            told(f"{why} {some[0][0]:g} ({1e-3 * some[0][1]:g} kPa): {'that point is' if len(some) == 1 else f'{len(some)} such points are'} left out")
    if len(back) > max(2, 0.1 * len(curve.strain)):
        raise refuse(curve.place, f"the strain falls at {back[0][0]:g}, and {len(back)} of {len(curve.strain)} points do not lie above all before them; leave loading alone in the curve")
    if points and points[0][0] > 0:
        told(f"it begins at a strain of {points[0][0]:g}: (0, 0) is put before it")
        points.insert(0, (0.0, 0.0))
    elif points and points[0][1] != 0:
        told(f"its stress at no strain, {1e-3 * points[0][1]:g} kPa, is taken for 0")
        points[0] = (0.0, 0.0)
    top = max(range(len(points)), key=lambda k: points[k][1], default=0)
    if points and points[-1][1] < points[top][1]:
        told(f"its stress falls from {1e-3 * points[top][1]:g} kPa at a strain of {points[top][0]:g} to its end: it is cut there")
        points = points[:top + 1]
    level: list[float] = list(itertools.accumulate((b for _, b in points), lambda a, b: max(a, b)))
    worst = max(range(len(points)), key=lambda k: level[k] - points[k][1], default=0)
    fall = level[worst] - points[worst][1] if points else 0.0
    if len(points) < 2 or level[-1] <= 0:
        raise refuse(curve.place, "the curve has no two points of compression with a stress")
    if fall > 0.5 * level[-1]:
        raise refuse(curve.place, f"the stress falls by {1e-3 * fall:g} kPa at a strain of {points[worst][0]:g}; this is no loading curve")
    if fall > 0:
        told(f"its stress falls by {1e-3 * fall:g} kPa at a strain of {points[worst][0]:g}, which no curve of softfall may: it stays level there")
    points = [(a, b) for (a, _), b in zip(points, level)]
    end = next((k for k in range(len(points) - 1, 1, -1) if level[k] > level[k - 1]), len(points) - 1)
    if end < len(points) - 1:
        told(f"it is level from a strain of {points[end][0]:g} to its end: it is cut there, since densification needs a slope to go on with")
        points = points[:end + 1]
    if len(points) < LEAST_POINTS:
        told(f"it has {len(points)} points, fewer than {LEAST_POINTS}: points between them are added")
    while len(points) < LEAST_POINTS:
        k = max(range(1, len(points)), key=lambda k: points[k][0] - points[k - 1][0])
        points.insert(k, (0.5 * (points[k - 1][0] + points[k][0]), 0.5 * (points[k - 1][1] + points[k][1])))
    curve.strain, curve.stress = [a for a, _ in points], [b for _, b in points]


def _raise(slow: Curve, fast: Curve, told: Callable[[str], None]) -> None:
    """Lifts a curve to that of the next lower rate where it lies below: softfall-pre refuses stresses that fall with the rate."""
    end = min(slow.strain[-1], fast.strain[-1])
    grid = sorted({a for a in slow.strain if a <= end} | set(fast.strain))
    grid = grid[:1] + [a for a, before in zip(grid[1:], grid) if a - before > 1e-9]
    low = [interpolate(slow.strain, slow.stress, a) if a <= end else 0.0 for a in grid]
    own = [interpolate(fast.strain, fast.stress, a) for a in grid]
    worst = max(range(len(grid)), key=lambda k: low[k] - own[k])
    if low[worst] <= own[worst]:
        return
    if own[worst] < 0.5 * low[worst] and low[worst] > 0.1 * max(low):
        raise refuse(fast.place, f"at a strain of {grid[worst]:.3g} the stress falls with the rate, from {1e-3 * low[worst]:.4g} kPa at {slow.rate:g} 1/s to "
                                 f"{1e-3 * own[worst]:.4g} kPa at {fast.rate:g} 1/s: are the rates or the curves exchanged?")
    told(f"it crosses that of {slow.rate:g} 1/s, and is lifted to it where it lies below: at a strain of {grid[worst]:.3g} from {1e-3 * own[worst]:.4g} to "
         f"{1e-3 * low[worst]:.4g} kPa")
    fast.strain, fast.stress = grid, []
    for a, b in zip(low, own):
        fast.stress.append(max(a, b, fast.stress[-1] if fast.stress else 0.0))


def _rates(foam: Foam) -> None:
    """Puts the curves in the order of their rates, which must be above 0."""
    if len(foam.curves) > MOST_CURVES:
        raise refuse(foam.place, f"the foam has {len(foam.curves)} curves, more than {MOST_CURVES}")
    for curve in foam.curves:
        if (curve.rate or 0) < 0:
            raise refuse(curve.place, f"the rate {curve.rate:g} 1/s of the curve is negative; softfall takes loading only: leave the curve out")
    if len(foam.curves) == 1:
        if foam.curves[0].rate:
            foam.note(f"the curve is of {foam.curves[0].rate:g} 1/s, and softfall takes it for any rate")
        foam.curves[0].rate = None
        return
    if any(curve.rate is None for curve in foam.curves):
        raise refuse(foam.place, "the foam has several curves, and one of them has no rate")
    if [curve.rate for curve in foam.curves] != sorted(curve.rate or 0 for curve in foam.curves):
        foam.note("the rates do not ascend: the curves are put in their order")
        foam.curves.sort(key=lambda curve: curve.rate or 0)
    for slow, fast in zip(foam.curves, foam.curves[1:]):
        if slow.rate == fast.rate:
            raise refuse(fast.place, f"two curves have the rate {fast.rate:g} 1/s; leave one of them out")
    if foam.curves[0].rate == 0:
        foam.curves[0].rate = 0.1 * (foam.curves[1].rate or 0)
        foam.note(f"the rate of the first curve is 0, and softfall needs one above 0: {foam.curves[0].rate:g} 1/s is used, a tenth of the next rate")
    foam.note("between the rates softfall interpolates over the logarithm of the rate, most solvers over the rate")


def unload(foam: Foam) -> None:
    """Takes HU and SHAPE from an unloading curve, by the energy that it returns (docs/theory.md, 17)."""
    load, back = foam.curves[0], min(foam.unloading, key=lambda curve: abs(curve.rate or 0))
    _turn(back, lambda _: None)
    pairs = sorted(zip(back.strain, back.stress))
    end = min(load.strain[-1], pairs[-1][0]) if pairs else 0.0
    if end <= 0:
        raise refuse(back.place, "the unloading curve has no point of compression")
    grid = [end * k / 2000 for k in range(2001)]
    energy = [sum(interpolate(x, y, a) for a in grid) for x, y in ((load.strain, load.stress), tuple(zip(*pairs)))]
    part = min(1.0, max(0.01, energy[1] / energy[0]))
    foam.values["HU"], foam.values["SHAPE"] = (2 * part - 1, 1.0) if part >= 0.55 else (0.1 * part, (1 - 0.1 * part) / (0.9 * part) - 1)
    foam.note(f"unloading follows a curve in the card, which returns {100 * part:.3g} % of the energy: HU = {foam.values['HU']:.3g} and SHAPE = {foam.values['SHAPE']:.3g} "
              "return as much, along another path; softfall fit compression fits HU, SHAPE and ALPHA to the path")


def finish(foam: Foam) -> None:
    """Makes a foam that softfall-pre takes, and tells what was changed; in SI units."""
    if not foam.curves:
        return
    _rates(foam)
    for curve in foam.curves:
        def told(text: str, curve: Curve = curve) -> None:
            foam.note(f"curve at {curve.place}{f' ({curve.rate:g} 1/s)' if curve.rate else ''}: {text}")
        if curve.told:
            told(curve.told)
        _turn(curve, told)
        _order(curve, told)
    for slow, fast in zip(foam.curves, foam.curves[1:]):
        _raise(slow, fast, lambda text: foam.note(f"curve at {fast.place} ({fast.rate:g} 1/s): {text}"))
    if foam.unloading:
        unload(foam)
    if 0 < foam.values.get("HU", 1) < 1e-6:
        foam.note(f"HU = {foam.values['HU']:g} is below the least that softfall takes: 1e-6 is used")
        foam.values["HU"] = 1e-6
    foam.values["informed_strain"] = min(0.999, min(curve.strain[-1] for curve in foam.curves))
    foam.note(f"informed_strain = {foam.values['informed_strain']:g}, where the {'shortest ' if len(foam.curves) > 1 else ''}curve ends; beyond it the law of "
              "densification extrapolates, and softfall-post marks a run")
    first = next(b / a for a, b in zip(foam.curves[0].strain, foam.curves[0].stress) if b > 0)
    if not foam.values.get("E"):
        foam.values["E"] = max(first, 1.0)
        foam.note(f"E is not given: the first slope of the slowest curve, {1e-3 * foam.values['E']:.4g} kPa, is taken")
    elif not 1 / FAR < foam.values["E"] / first < FAR:
        foam.note(f"E = {1e-3 * foam.values['E']:.4g} kPa is far from the first slope of the slowest curve, {1e-3 * first:.4g} kPa: a modulus for contact? softfall takes E for "
                  "tension and as the least stiffness of its stabilisation")
