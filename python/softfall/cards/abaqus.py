# SPDX-License-Identifier: GPL-3.0-or-later
"""Foam cards of Abaqus and CalculiX input files: *HYPERFOAM, *LOW DENSITY FOAM and their *UNIAXIAL TEST DATA."""
from __future__ import annotations

import dataclasses
import functools
import re
from pathlib import Path

from ..errors import InputError
from .foam import MOST_POINTS, MOST_TERMS, Curve, Foam, Term, enter, included, number, read_lines, refuse
from .units import System


@dataclasses.dataclass
class Block:
    """A keyword, its parameters in lower case, and its data lines."""

    keyword: str
    options: dict[str, str]
    place: str
    rows: list[tuple[list[str], str]]

    def numbers(self) -> list[tuple[list[float], str]]:
        return [([number(text, place, f"value {k} of *{self.keyword}") if text.strip() else 0.0 for k, text in enumerate(_stripped(row), 1)], place) for row, place in self.rows]


def _stripped(row: list[str]) -> list[str]:
    """Returns the fields of a data line, without the empty one after a last comma."""
    return row[:-1] if row and not row[-1].strip() else row


def _blocks(path: Path, folder: Path, place: str, made: list[Block], files: list[Path]) -> list[Block]:
    """Returns the blocks of a file and its includes; a keyword line that ends with a comma goes on."""
    enter(path, place, files)
    lines = iter(enumerate(read_lines(path, place), 1))
    for line, text in lines:
        if text.startswith("**") or not text.strip():
            continue
        if not text.startswith("*"):
            if made:
                made[-1].rows.append((text.split(","), f"{path}:{line}"))
            continue
        while text.endswith(","):
            text += next(lines, (0, ""))[1] or " "
        keyword, *parts = re.findall(r'(?:[^,"]|"[^"]*"?)+', text[1:]) or [""]
        options = {name.strip().replace(" ", "").lower(): value.strip().strip('"') for name, _, value in (part.partition("=") for part in parts)}
        made.append(Block(keyword.replace(" ", "").upper(), options, f"{path}:{line}", []))
        if made[-1].keyword == "INCLUDE":
            _blocks(included(options.get("input", ""), folder, made[-1].place), folder, made[-1].place, made, files)
    return made


def _tests(foam: Foam, blocks: list[Block], has_rates: bool) -> None:
    """Takes *UNIAXIAL TEST DATA: stress, strain and, of a low density foam, rate, below 0 of unloading."""
    tests = [block for block in blocks if block.keyword == "UNIAXIALTESTDATA"]
    for block in blocks:
        if block.keyword.endswith("TESTDATA") and block not in tests:
            foam.note(f"*{block.keyword} at {block.place} is not used: a curve of uniaxial compression is")
    for block in tests:
        rows = block.numbers()
        if len(rows) > MOST_POINTS:
            raise refuse(block.place, f"the test has more than {MOST_POINTS} points")
        if block.options.get("direction", "").lower() == "tension":
            slopes = [row[0] / row[1] for row, _ in rows if len(row) > 1 and row[1] > 0]
            if slopes:
                foam.values["E"] = slopes[0]
            foam.note(f"tension at {block.place} is not used but for its first slope, which is E")
            continue
        by_rate: dict[float | None, Curve] = {}
        for row, place in rows:
            if len(row) < 2:
                raise refuse(place, "a point of the test needs stress and strain")
            rate = row[2] if has_rates and len(row) > 2 else None
            curve = by_rate.setdefault(rate, Curve([], [], rate, place))
            curve.stress.append(row[0])
            curve.strain.append(row[1])
            if not has_rates and len(row) > 2 and row[2]:
                foam.note("the lateral strain of the test is not used: the curve becomes a low_density_foam, which has none; softfall fit compression fits a hyperfoam to both")
        for curve in by_rate.values():
            if not has_rates and min(curve.strain) >= 0:
                raise refuse(block.place, "the test of the hyperfoam has no compression, which is negative in it; give a test of compression")
            if not has_rates:
                curve.turn()
            (foam.unloading if curve.rate is not None and curve.rate < 0 else foam.curves).append(curve)
    if len(foam.unloading) > 1:
        foam.note(f"of {len(foam.unloading)} unloading rates the slowest is used")


def _hyperfoam(foam: Foam, block: Block, blocks: list[Block]) -> None:
    count = number(block.options.get("n", "1") or "1", block.place, "N")
    if count not in range(1, MOST_TERMS + 1):
        raise refuse(block.place, f"N = {count:g}; a hyperfoam has 1 to {MOST_TERMS} terms")
    n, moduli = int(count), block.options.get("moduli", "long term").lower()
    if "testdatainput" in block.options:
        _tests(foam, blocks, False)
        foam.drop("POISSON", block.options.get("poisson"), "the test becomes a low_density_foam without lateral strain", ("0", "0.", "0.0"))
        if not foam.curves:
            raise refuse(block.place, "TEST DATA INPUT without *UNIAXIAL TEST DATA of compression; give its stress and strain")
        return
    if "dependencies" in block.options:
        raise refuse(block.place, "coefficients that depend on field variables are not read; keep those of one value")
    rows, each = block.numbers(), -(-3 * n // 8)
    values = [value for row, _ in rows[:each] for value in row[:8]]
    if len(values) < 3 * n:
        raise refuse(block.place, f"*HYPERFOAM with N = {n} needs {3 * n} coefficients, eight a line: mu1, alpha1 ... mu{n}, alpha{n}, nu1 ... nu{n}; there are {len(values)}")
    if len(rows) > each:
        raise refuse(rows[each][1], "the coefficients of a second temperature are not read; keep those of one temperature")
    foam.terms = [Term(values[2 * k], values[2 * k + 1], values[2 * n + k]) for k in range(n) if values[2 * k]]
    names = [f"{what}{k}" for k in range(1, n + 1) for what in ("mu", "alpha")] + [f"nu{k}" for k in range(1, n + 1)]
    foam.note(f"coefficients are read eight a line as {' '.join(names)}" + (f"; line {each} holds {' '.join(names[8 * (each - 1):])}" if each > 1 else ""))
    if len(values) > 3 * n and values[3 * n]:
        foam.note(f"the temperature {values[3 * n]:g} of the coefficients is not used")
    prony = [other for other in blocks if other.keyword == "VISCOELASTIC"]
    share = sum(row[0] for other in prony for row, _ in other.numbers() if row and "prony" in other.options.get("time", "").lower())
    for other in prony:
        foam.note(f"*VISCOELASTIC at {other.place} is not taken over ({'; '.join(', '.join(f'{value:g}' for value in row) for row, _ in other.numbers()[:8])}): softfall has one Maxwell "
                  "branch, ED and BETA1")
    stiff = moduli.replace(" ", "").startswith("inst")
    limit = f"the stiff limit of fast loading, the long-term moduli are {1 - share:g} of it" if stiff else f"the soft limit of slow loading, the instantaneous moduli are {1 / (1 - share):g} of it" \
        if share < 1 else "the soft limit of slow loading"
    if prony or "moduli" in block.options:
        foam.note(f"MODULI = {moduli.upper()}{'' if 'moduli' in block.options else ' (default)'}: the card is {limit if share else 'taken as it is'}")


def _low_density(foam: Foam, block: Block, blocks: list[Block]) -> None:
    _tests(foam, blocks, True)
    if not foam.curves:
        raise refuse(block.place, "*LOW DENSITY FOAM without *UNIAXIAL TEST DATA, DIRECTION=COMPRESSION; give its stress, strain and rate")
    cutoff = block.options.get("tensioncutoff")
    if cutoff:
        foam.values["tension_cutoff"] = number(cutoff, block.place, "TENSION CUTOFF")
    for row, _ in block.numbers()[:1]:
        foam.note(f"mu0, mu1, alpha = {', '.join(f'{value:g}' for value in row)} are not used: softfall relaxes by rate_filter_time")
    foam.drop("FAIL", block.options.get("fail"), "the stress stays at tension_cutoff", ("no", "NO"))
    foam.drop("STRAIN RATE", block.options.get("strainrate"), "the rate is that of the most compressed direction")
    foam.drop("RATE EXTRAPOLATION", block.options.get("rateextrapolation"), "beyond the rates the nearest curve holds", ("no", "NO"))
    foam.drop("LATERAL STRAIN DATA", block.options.get("lateralstraindata"), "the law has no lateral strain", ("no", "NO"))


def read(path: Path) -> list[Foam]:
    """Returns the foams of a deck, in its units."""
    blocks, foams, groups = _blocks(path, path.parent, str(path), [], []), [], list[list[Block]]()
    for block in blocks:
        if block.keyword == "MATERIAL" or not groups:
            groups.append([])
        groups[-1].append(block)
    for group in groups:
        for block in group:
            if block.keyword not in ("HYPERFOAM", "LOWDENSITYFOAM"):
                continue
            name = group[0].options.get("name", "") if group[0].keyword == "MATERIAL" else ""
            foam = Foam(name, name, f"*{'HYPERFOAM' if block.keyword == 'HYPERFOAM' else 'LOW DENSITY FOAM'}", block.place)
            foam.values.update(HU=1.0, SHAPE=1.0, ALPHA=1.0, DAMP=0.0)
            foam.fill = functools.partial(_fill, foam, block, group)
            foams.append(foam)
    if not foams:
        raise InputError(f"{path}: there is no *HYPERFOAM and no *LOW DENSITY FOAM in it")
    return foams


def _fill(foam: Foam, block: Block, group: list[Block]) -> None:
    density = next((row for other in group if other.keyword == "DENSITY" for row, _ in other.numbers()), list[float]())
    if not density:
        raise refuse(foam.place, f"the material {foam.name} has no *DENSITY; give it one")
    foam.density = density[0]
    (_hyperfoam if block.keyword == "HYPERFOAM" else _low_density)(foam, block, group)


# ---- export ----

def write(foam: Foam, units: System) -> str:
    """Returns the foam as *HYPERFOAM, or as *LOW DENSITY FOAM."""
    head = [*(f"** {line}" for line in foam.notes), f'*MATERIAL, NAME="{foam.name}"', "*DENSITY", f"{foam.density / units.density:.10g},"]
    if foam.terms:
        values = [value for term in foam.terms for value in (term.mu / units.stress, term.alpha)] + [term.nu or 0.0 for term in foam.terms]
        return "\n".join([*head, f"*HYPERFOAM, N={len(foam.terms)}", *(", ".join(f"{value:.10g}" for value in values[k:k + 8]) for k in range(0, len(values), 8))]) + "\n"
    cutoff = foam.values.get("tension_cutoff")
    lines = [*head, "*LOW DENSITY FOAM" + (f", TENSION CUTOFF={cutoff / units.stress:.10g}" if cutoff else ""), "*UNIAXIAL TEST DATA, DIRECTION=COMPRESSION"]
    for curve in foam.curves:
        lines += [f"{b / units.stress:.10g}, {a:.10g}, {(curve.rate or 0.0) * units.time:.10g}" for a, b in zip(curve.strain, curve.stress)]
    modulus = foam.values["E"] / units.stress
    return "\n".join([*lines, "*UNIAXIAL TEST DATA, DIRECTION=TENSION", "0, 0, 0", f"{modulus:.10g}, 1, 0"]) + "\n"
