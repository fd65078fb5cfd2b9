# SPDX-License-Identifier: GPL-3.0-or-later
"""Foam cards of OpenRadioss starter decks: /MAT/LAW70, LAW90 and LAW62 with functions, tables and units."""
from __future__ import annotations

import dataclasses
import functools
import math
from pathlib import Path

from ..errors import InputError
from .foam import MOST_CURVES, MOST_POINTS, MOST_TERMS, Curve, Foam, Term, enter, included, number, read_lines, refuse, whole
from .units import LENGTH, MASS, TIME, System

LAWS = {"LAW70": 70, "FOAM_TAB": 70, "LAW90": 90, "LAW62": 62, "VISC_HYP": 62}


@dataclasses.dataclass
class Block:
    """An option /A/B/1 and its lines; comments are left out."""

    words: list[str]
    place: str
    rows: list[tuple[str, str]]

    def fields(self, index: int, names: str, widths: str) -> dict[str, float]:
        """Returns the fields of a line by names and widths; a blank one, or a line that is not there, is 0."""
        text, place = self.rows[index] if index < len(self.rows) else ("", self.place)
        made, at = {}, 0
        for name, width in zip(names.split(), map(int, widths.split())):
            field = text[at:at + width].strip()
            made[name], at = number(field, place, name) if field else 0.0, at + width
        return made


def _blocks(path: Path, folder: Path, place: str, made: list[Block], files: list[Path]) -> list[Block]:
    enter(path, place, files)
    for line, text in enumerate(read_lines(path, place), 1):
        here = f"{path}:{line}"
        if text.lower().startswith("#include"):
            _blocks(included(text[8:].strip(), folder, here), folder, here, made, files)
        elif text.startswith("#") or text.startswith("$"):
            continue
        elif text.startswith("/"):
            words = text[1:].split("/")
            if words[0].upper() == "END":
                break
            made.append(Block([word.strip().upper() for word in words], here, []))
        elif made:
            made[-1].rows.append((text, here))
    return made


def _units(row: tuple[str, str]) -> System | None:
    """Returns the units of a line of codes such as kg, mm and ms, or of numbers in SI units."""
    text, place = row
    codes, found = [text[k:k + 20].strip() for k in (0, 20, 40)], []
    for code, table in zip(codes, (MASS, LENGTH, TIME)):
        value = table.get("t" if code == "Mg" else code.lower(), 0.0) or (number(code, place, "the unit") if code[:1] in set("0123456789.") and code else 0.0)
        if code and not value > 0:
            raise refuse(place, f"{code[:20]!r} is no unit; a deck has units such as kg mm ms")
        found.append(value)
    return System("-".join((codes[1], codes[2], codes[0])), *found) if all(codes) else None


class Deck:
    """The options of a deck by their kind."""

    def __init__(self, path: Path) -> None:
        self.blocks = _blocks(path, path.parent, str(path), [], [])

    def find(self, kind: str, ident: str) -> Block | None:
        return next((block for block in self.blocks if block.words[0] == kind and block.words[-1 if kind == "TABLE" else 1:][:1] == [ident]), None)

    def units(self, block: Block) -> System | None:
        """Returns the units of an option: those of its /UNIT, or of /BEGIN."""
        if len(block.words) > 3 and block.words[3].isdigit() and block.words[3] != "0":
            unit = self.find("UNIT", block.words[3])
            if unit is None:
                raise refuse(block.place, f"the deck has no /UNIT/{block.words[3]}")
            return _units(unit.rows[1]) if len(unit.rows) > 1 else None
        begin = next((other for other in self.blocks if other.words[0] == "BEGIN" and len(other.rows) > 2), None)
        return _units(begin.rows[2]) if begin else None

    def function(self, ident: float, place: str, scale: float = 1.0, depth: int = 0) -> list[Curve]:
        """Returns the function, or the functions of a table, whose parameters become rates."""
        name = f"{ident:.0f}"
        for kind in ("FUNCT", "FUNCT_SMOOTH", "TABLE"):
            block = self.find(kind, name)
            if block and kind == "TABLE" and block.words[1] == "1" and depth == 0:
                made = []
                for k in range(2, min(len(block.rows), MOST_CURVES + 2)):
                    row = block.fields(k, "fct - A - Fscale", "10 10 20 40 20")
                    curves = self.function(row["fct"], block.rows[k][1], scale * (row["Fscale"] or 1.0), 1) if row["fct"] else []
                    for curve in curves:
                        curve.rate = row["A"]
                    made += curves
                if made:
                    return made
            elif block and kind != "TABLE":
                return [self._points(block, kind == "FUNCT_SMOOTH", scale)]
        moved = " (/MOVE_FUNCT is not read)" if self.find("MOVE_FUNCT", name) else ""
        raise refuse(place, f"function {name}: the deck has no /FUNCT, /FUNCT_SMOOTH or /TABLE/1 of this number{moved}; add the file that defines it by #include")

    def _points(self, block: Block, smooth: bool, scale: float) -> Curve:
        if self.find("MOVE_FUNCT", block.words[1]):
            raise refuse(block.place, f"/MOVE_FUNCT/{block.words[1]} changes this function and is not read; put its scales and shifts into the points")
        head = block.fields(1, "ax fy sx sy", "20 20 20 20") if smooth else {"ax": 1.0, "fy": 1.0, "sx": 0.0, "sy": 0.0}
        curve = Curve([], [], None, block.place)
        for k in range(2 if smooth else 1, len(block.rows)):
            if block.rows[k][0].strip():
                point = block.fields(k, "X Y", "20 20")
                curve.strain.append((head["ax"] or 1.0) * point["X"] + head["sx"])
                curve.stress.append(scale * ((head["fy"] or 1.0) * point["Y"] + head["sy"]))
        if not 0 < len(curve.strain) <= MOST_POINTS:
            raise refuse(block.place, f"the function has {len(curve.strain)} points; it must have 2 to {MOST_POINTS}")
        return curve


def _functions(deck: Deck, block: Block, at: int, count: int) -> list[Curve]:
    made = []
    if count == 0 or at + count > len(block.rows):
        raise refuse(block.place, f"the card has {count} functions, and its lines end before" if count else "the card has no loading function (NL)")
    for k in range(at, at + count):
        row = block.fields(k, "fct_ID Eps_dot Fscale", "10 20 20")
        curves = deck.function(row["fct_ID"], block.rows[k][1], row["Fscale"] or 1.0)
        if len(curves) > 1 and count > 1:
            raise refuse(block.rows[k][1], "a table among several functions is not read; give a function for each rate")
        for curve in curves:
            curve.rate = curve.rate if len(curves) > 1 else row["Eps_dot"]
        made += curves
    return made


_NOT_USED = {"Emax": "softfall has no modulus that grows with the strain", "EPS_max": "softfall has no modulus that grows with the strain", "Itens": "tension follows E",
             "FAIL": "softfall has no failure", "Kcont": "contact follows from the law", "nu": "the law low_density_foam has no lateral strain", "mu_max": "eta is softfall's viscosity"}


def _tabulated(deck: Deck, foam: Foam, block: Block, law: int) -> dict[str, float]:
    """Takes LAW70 and LAW90."""
    if law == 70:
        card = block.fields(2, "E0 nu Emax EPS_max Itens", "20 20 20 20 10") | block.fields(3, "F_cut Ismooth NL NuL Iflag Shape Hys", "20 10 10 10 10 20 20") | {"Alpha": 0.0}
    else:
        card = block.fields(2, "E0 nu TFLAG FAIL Kcont Tcut", "20 20 10 10 20 20") | block.fields(3, "NL Ismooth F_cut Shape Hys Alpha", "10 10 20 20 20 20") | {"NuL": 0.0}
    loads, unloads, hys = whole(card["NL"], block.place, "NL", MOST_CURVES), whole(card["NuL"], block.place, "NuL", MOST_CURVES), abs(card["Hys"])
    foam.curves = _functions(deck, block, 4, loads)
    foam.values.update(E=card["E0"], HU=hys or 1.0, SHAPE=card["Shape"] or 1.0, ALPHA=card["Alpha"] or 1.0, DAMP=0.0)
    if law == 90 and not hys:
        foam.note("Hys is 0: unloading follows the first function, as softfall's does with HU = 1")
    elif law == 70 and card["Iflag"] == 3:
        foam.note("Iflag = 3: Hys acts on the deviator only in LAW70, on the whole stress in softfall")
    elif law == 70 and card["Iflag"] != 4 and unloads:
        foam.unloading = _functions(deck, block, 4 + loads, unloads)
    elif law == 70 and card["Iflag"] != 4:
        foam.values["HU"] = 1.0
        foam.note(f"Iflag = {card['Iflag']:g} without a function of unloading: it follows the first loading function, as softfall's does with HU = 1; Hys = {hys:g} has no effect")
    if card.get("Tcut", 0) > 0:
        foam.values["tension_cutoff"] = card["Tcut"]
    if law == 90 and card["TFLAG"] != 2:
        foam.note("TFLAG = 1 (default): tension follows the functions in LAW90, E in softfall")
    cut = card["F_cut"] or (1000.0 if law == 90 and loads > 1 else 0.0)
    if 0 < cut < 1e20:
        foam.values["rate_filter_time"] = 1 / (2 * math.pi * cut)
        foam.note(f"F_cut = {card['F_cut']:g} is not a key of softfall: rate_filter_time = 1/(2 pi {cut:g}), the time constant of the same low pass of the strain rate, stands for it")
    return card


def _hyperfoam(foam: Foam, block: Block) -> dict[str, float]:
    """Takes LAW62."""
    card = block.fields(2, "Nu N M mu_max Flag_Visc Form", "20 10 10 20 10 10")
    terms, branches = whole(card["N"], block.place, "N", MOST_TERMS), whole(card["M"], block.place, "M", 50)
    at, lists = 3, list[list[float]]()
    for count in (terms, terms, branches, branches, terms):
        lists.append([value for k in range(-(-count // 5)) for value in block.fields(at + k, "1 2 3 4 5", "20 20 20 20 20").values()][:count])
        at += -(-count // 5)
    mu, alpha, gamma, theta, nu = lists
    foam.terms = [Term(m, a, n if any(nu) else card["Nu"]) for m, a, n in zip(mu, alpha, nu) if m]
    foam.values.update(HU=1.0, SHAPE=1.0, ALPHA=1.0, DAMP=0.0)
    share = sum(gamma)
    if branches:
        foam.note(f"gamma = {', '.join(f'{value:g}' for value in gamma)} and theta = {', '.join(f'{value:g}' for value in theta)} are not taken over: softfall has one Maxwell branch, ED "
                  f"and BETA1. The moduli of the card are {'long-term ones, the instantaneous ones 1/(1 - sum gamma)' if card['Form'] == 2 else 'instantaneous ones, the long-term ones 1 - sum gamma'} = "
                  f"{1 / (1 - share) if card['Form'] == 2 and share < 1 else 1 - share:g} of them")
    return card


def _fill(deck: Deck, foam: Foam, block: Block, law: int) -> None:
    foam.density = block.fields(1, "RHO_I RHO_O", "20 20")["RHO_I"]
    foam.units = deck.units(block)
    for name, value in (_hyperfoam(foam, block) if law == 62 else _tabulated(deck, foam, block, law)).items():
        if name in _NOT_USED:
            foam.drop(name, value, _NOT_USED[name])


def read(path: Path) -> list[Foam]:
    """Returns the foams of a deck, in the units of each card."""
    deck, foams, others = Deck(path), [], []
    for block in deck.blocks:
        if block.words[0] != "MAT" or len(block.words) < 3:
            continue
        law = LAWS.get(block.words[1])
        if law is None:
            others.append("/".join(["", *block.words[:3]]))
            continue
        foam = Foam(block.words[2], block.rows[0][0].strip() if block.rows else "", f"/MAT/{block.words[1]}", block.place)
        foam.fill = functools.partial(_fill, deck, foam, block, law)
        foams.append(foam)
    if not foams:
        raise InputError(f"{path}: there is no foam that softfall reads (/MAT/LAW70, LAW90, LAW62)" + (f", only {', '.join(others[:5])}" if others else ""))
    return foams


# ---- export ----

def write(foam: Foam, units: System) -> str:
    """Returns the foam as /MAT/LAW90, or as /MAT/LAW62 of a hyperfoam."""
    value = foam.values
    codes = [f"{unit:.10g}" for unit in (units.mass, units.length, units.time)]
    begin = ["#RADIOSS STARTER", "/BEGIN", foam.name.replace("/", " ")[:60].ljust(4, "_"), f"{2022:10}{0:10}", *["".join(f"{code:>20}" for code in codes)] * 2]
    head = [*begin, *(f"# {line}" for line in foam.notes)]
    density = [f"{foam.density / units.density:20.12g}"]
    if foam.terms:
        lists = ([term.mu / units.stress for term in foam.terms], [term.alpha for term in foam.terms], [term.nu or 0.0 for term in foam.terms])
        rows = ["".join(f"{number:20.12g}" for number in numbers[k:k + 5]) for numbers in lists for k in range(0, len(numbers), 5)]
        return "\n".join([*head, "/MAT/LAW62/1", foam.name[:100], *density, f"{foam.terms[0].nu or 0.0:20.12g}{len(foam.terms):10}{0:10}{0:20}{0:10}{0:10}", *rows, "/END"]) + "\n"
    cut = f"{units.time / (2 * math.pi * value['rate_filter_time']):20.12g}" if len(foam.curves) > 1 else f"{0:20}"
    lines = [*head, "/MAT/LAW90/1", foam.name[:100], "#              Rho_I", *density, "#                 E0              MAT_NU     TFLAG      FAIL               Kcont                Tcut",
             f"{value['E'] / units.stress:20.12g}{0:20}{2:10}{0:10}{0:20}{value.get('tension_cutoff', 0.0) / units.stress:20.12g}",
             "#       NL   Ismooth                Fcut               Shape                 Hys               Alpha",
             f"{len(foam.curves):10}{int(len(foam.curves) > 1):10}{cut}{value['SHAPE']:20.12g}{value['HU']:20.12g}{value['ALPHA']:20.12g}",
             *(f"{k:10}{(curve.rate or 0.0) * units.time:20.12g}{1:20}" for k, curve in enumerate(foam.curves, 1))]
    for k, curve in enumerate(foam.curves, 1):
        lines += [f"/FUNCT/{k}", f"compression{f' at {curve.rate:g} 1/s' if curve.rate else ''}", "#                  X                   Y",
                  *(f"{a:20.12g}{b / units.stress:20.12g}" for a, b in zip(curve.strain, curve.stress))]
    return "\n".join([*lines, "/END"]) + "\n"
