# SPDX-License-Identifier: GPL-3.0-or-later
"""Foams of softfall: material.cfg with its curves, written from a card, and read to make one."""
from __future__ import annotations

import math
import re
from pathlib import Path
from types import ModuleType

from .. import library, output as output_files
from ..errors import Error, InputError
from . import abaqus, dyna, radioss, units
from .foam import Curve, Foam, Term, choose, finish, read_lines, refuse

FORMATS = {"dyna": dyna, "abaqus": abaqus, "radioss": radioss}
# keys of material.cfg by target, and what is missing in a card without a key
SAID = {"dyna57": "E HU SHAPE DAMP ED BETA1 tension_cutoff", "dyna83": "E HU SHAPE ALPHA DAMP tension_cutoff", "dyna177": "DAMP", "radioss": "E HU SHAPE ALPHA tension_cutoff",
        "radioss62": "", "abaqus": "E tension_cutoff", "abaqushyperfoam": ""}
MISSING = {"HU": "unloading follows the curve of loading, and returns all of the energy", "SHAPE": "", "ALPHA": "unloading has another path", "DAMP": "the target has its own damping",
           "damp_length": "the target takes the length of its elements", "ED": "without the Maxwell branch fast loading is too soft", "BETA1": "", "eta": "no Kelvin viscosity",
           "memory": "later drops load along the unloading path", "shift": "the curve is that of the reference temperature", "informed_strain": "beyond it the curve is extrapolation",
           "rate_filter_time": "the target has its own filter of the rate", "densification": "beyond the table the target goes on with its last slope", "stable_to": "beyond it the terms are unstable"}


def _clean(text: str) -> str:
    return "".join(letter if letter.isprintable() else " " for letter in text)


def read_card(path: str, wanted: str | None = None, given: str | None = None, kind: str | None = None) -> Foam:
    """Returns the foam of a deck as one of softfall, in SI units, with notes for the user."""
    foam = choose((FORMATS[kind] if kind else _format(Path(path))).read(Path(path)), wanted, path)
    foam.fill()
    if not 0 < foam.density < 1e30 or not (foam.curves or foam.terms):
        raise refuse(foam.place, f"the density is {foam.density:g}; a foam needs one above 0" if foam.curves or foam.terms else "the card has no term with a modulus, and no curve")
    try:
        system, known = units.find(foam.figures(), given, foam.units)
    except InputError as error:
        raise refuse(foam.place, str(error)) from None
    foam.notes[:0] = known
    foam.take(system)
    finish(foam)
    return foam


def _format(path: Path) -> ModuleType:
    """Tells the format of a deck by its name, or by its first material."""
    by_name = {".k": dyna, ".key": dyna, ".dyn": dyna, ".inp": abaqus, ".rad": radioss}.get(path.suffix.lower())
    if by_name:
        return by_name
    for line in read_lines(path):
        for begin, module in (("*MAT_", dyna), ("*MATERIAL", abaqus), ("/MAT/", radioss)):
            if line.upper().startswith(begin):
                return module
    raise InputError(f"{path}: there is no material of LS-DYNA, Abaqus or OpenRadioss in it; name a deck .k, .inp or .rad, or give --format")


# ---- material.cfg ----

def _text(foam: Foam, stem: str, source: str) -> str:
    """Returns the text of material.cfg, its notes as comments."""
    value = foam.values
    lines = [f"# {line}" for line in (foam.name or foam.key, f"Converted by softfall foam convert from {source}", *foam.notes)]
    lines += [f'law = "{foam.law}";', f'density = "{foam.density:.12g} kg/m3";']
    if foam.curves:
        lines.append(f'E = "{1e-3 * value["E"]:.12g} kPa";')
        names = [f'"{stem}{f"-{k}" if len(foam.curves) > 1 else ""}.csv"' for k in range(1, len(foam.curves) + 1)]
        lines.append(f"curve = {names[0]};" if len(names) == 1 else "curves = (\n" + ",\n".join(
            f'    {{ rate = "{curve.rate:.12g} 1/s"; file = {name}; }}' for curve, name in zip(foam.curves, names)) + "\n);")
    lines += [f"{key} = {value[key]:.12g};" for key in ("HU", "SHAPE", "ALPHA", "DAMP", "stable_to", "informed_strain") if key in value]
    lines += [f'{key} = "{value[key] / size:.12g} {unit}";' for key, size, unit in (("ED", 1e3, "kPa"), ("BETA1", 1, "1/s"), ("tension_cutoff", 1e3, "kPa"), ("rate_filter_time", 1e-3, "ms"))
              if key in value and (key != "rate_filter_time" or len(foam.curves) > 1)]
    lines += [f'term_{k} = {{ mu = "{1e-3 * term.mu:.12g} kPa"; alpha = {term.alpha:.12g}; {"nu" if term.beta is None else "beta"} = {(term.nu if term.beta is None else term.beta) or 0:.12g}; }};'
              for k, term in enumerate(foam.terms, 1)]
    return "\n".join(map(_clean, "\n".join(lines).split("\n"))) + "\n"


def write_material(foam: Foam, output: Path, source: str, force: bool = False, deck: str = "") -> list[Path]:
    """Writes OUT/material.cfg (or OUT itself if it ends with .cfg) and its curves, after softfall-pre's check of it; returns their paths.

    The files of the deck are not replaced.
    """
    inputs = {place.rpartition(":")[0] or place for place in (foam.place, *(str(curve.place) for curve in foam.curves))} | {deck}
    folder, stem = (output.parent, output.stem) if output.suffix == ".cfg" else (output, "material")
    files = {f"{stem}{f'-{k}' if len(foam.curves) > 1 else ''}.csv": f"# {_clean(foam.name or foam.key)}\n# Engineering strain and nominal stress, positive in compression"
             f"{f', at {curve.rate:.6g} per second' if curve.rate else ''}.\nstrain,stress_kPa\n" + "".join(f"{a:.12g},{1e-3 * b:.12g}\n" for a, b in zip(curve.strain, curve.stress))
             for k, curve in enumerate(foam.curves, 1)}
    for name in (f"{stem}.cfg", *files):
        output_files.check(folder / name, *inputs)
    there = [name for name in (f"{stem}.cfg", *files) if (folder / name).exists()]
    if there and not force:
        raise InputError(f"{folder / there[0]} exists already: give --force to replace it, or another --output")
    output_files.check_own(folder / f"{stem}.cfg", b"# Converted by softfall foam convert", "softfall foam convert")
    with output_files.scratch() as scratch:
        for attempt in range(2):
            files[f"{stem}.cfg"] = _text(foam, stem, source)
            for name, text in files.items():
                (scratch / name).write_text(text, encoding="utf-8")
            try:
                library.Material(str(scratch / f"{stem}.cfg"))
                break
            except Error as error:
                found = re.search(r"makes the law unstable in (.*?) from a strain of ([\d.e-]+) on", str(error))
                stable = int(98 * float(found[2])) / 100 if found else 0.0
                if attempt or stable < 0.05:
                    raise refuse(foam.place, "softfall-pre would refuse this foam: " + str(error).replace(f"{scratch}/", "")) from None
                foam.values["stable_to"] = stable
                foam.note(f"stable_to = {stable:g}: from a strain of {found[2]} on the terms are unstable in {found[1]} (Drucker's condition); softfall-post marks a run beyond it")  # type: ignore[index]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            output_files.write(folder / name, text, *inputs)
    except OSError as error:
        raise Error(f"{folder} cannot be written to: {error.strerror}", 3) from None
    return [folder / name for name in files]


# ---- export ----

def read_foam(path: str) -> Foam:
    """Returns the foam of a material file."""
    data = library.Material(path)
    values = {key: value for key, value in data.values.items() if isinstance(value, float)}
    title = next((line[1:].replace('"', "").strip()[:100] for line in output_files.read(path).decode("utf-8", "replace").splitlines() if line.startswith("#")), "")
    foam = Foam(Path(path).stem, _clean(title) or Path(path).stem, str(data.values["law"]), path, values["density"], values)
    for rate, strain, stress in data.curves:
        foam.curves.append(Curve(list(map(float, strain)), list(map(float, stress)), rate or None, path))
    for k in range(1, 7):
        if values.get(f"term_{k}.mu"):
            mu, alpha, nu, beta = (values[f"term_{k}.{key}"] for key in ("mu", "alpha", "nu", "beta"))
            foam.terms.append(Term(mu, alpha, nu if not beta else beta / (1 + 2 * beta), beta or nu / (1 - 2 * nu)))
    return foam


def export(path: str, kind: str, units_name: str) -> tuple[str, list[str]]:
    """Returns the card of a material file for another solver, and what it cannot say."""
    foam, system = read_foam(path), units.parse(units_name)
    value, listed = foam.values, list[str]()
    if foam.terms and kind == "dyna" and len({f"{term.beta:.9g}" for term in foam.terms}) > 1:
        raise InputError(f"{path}: *MAT_HILL_FOAM has one N for all terms, and the terms differ in nu; export it with --format=abaqus or --format=radioss")
    if value.get("rate_factor"):
        if foam.terms:
            listed.append(f"rate_factor = {value['rate_factor']:g}: the terms are those of {value['rate_reference']:g} 1/s")
        else:
            base, foam.curves = foam.curves[0], []
            for half in range(1 + max(6, round(2 * math.log10(1e3 / value["rate_reference"])))):
                factor = 1 + 0.5 * half * value["rate_factor"]
                foam.curves.append(Curve(base.strain, [factor * stress for stress in base.stress], value["rate_reference"] * 10 ** (0.5 * half)))
            listed.append(f"rate_factor = {value['rate_factor']:g} becomes {len(foam.curves)} curves, two a decade of the rate, from {value['rate_reference']:g} to {foam.curves[-1].rate:g} 1/s")
    if len(foam.curves) > 1:
        listed.append("between the rates most solvers interpolate over the rate, softfall over its logarithm")
    target = kind + ({"dyna": "177", "radioss": "62", "abaqus": "hyperfoam"}[kind] if foam.terms else "" if kind != "dyna" else "83" if len(foam.curves) > 1 or value["ALPHA"] != 1 else "57")
    idle = {"HU": 1.0, "SHAPE": None if value["HU"] == 1 else 0, "ALPHA": None if value["HU"] == 1 else 1.0, "BETA1": None if not value["ED"] else 0, "rate_filter_time": None if len(
        foam.curves) < 2 or kind == "radioss" else 0, "memory.recovery_start": 1.0, "stable_to": 0.9}
    for key, number in value.items():
        group = key.split(".")[0]
        if group in MISSING and key not in SAID[target].split() and idle.get(key, 0.0) not in (None, number) and (group != "memory" or value["memory.reload"]) and group != "densification":
            listed.append(f"{key} = {number:g} is not in the card{': ' if MISSING[group] else ''}{MISSING[group]}")
    if foam.curves:
        listed.append(f"densification is not in the card: {MISSING['densification']}")
    foam.notes = [_clean(f"{foam.name}; written by softfall foam export from {Path(path).name}, units {system.name}"), *map(_clean, listed)]
    return FORMATS[kind].write(foam, system), listed

