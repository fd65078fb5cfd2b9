# SPDX-License-Identifier: GPL-3.0-or-later
"""Foam cards of LS-DYNA keyword decks: *MAT_057, 063, 083 and 177 with their curves and tables."""
from __future__ import annotations

import dataclasses
import functools
import re
from pathlib import Path
from typing import Optional

from ..errors import InputError
from .foam import MOST_CURVES, MOST_POINTS, MOST_TERMS, Curve, Foam, Term, enter, included, number, read_lines, refuse
from .units import System

KINDS = {"57": "LOW_DENSITY_FOAM", "63": "CRUSHABLE_FOAM", "83": "FU_CHANG_FOAM", "177": "HILL_FOAM"}
_MATERIAL = re.compile(rf"MAT_(?:0*({'|'.join(KINDS)})|({'|'.join(KINDS.values())}))(?:_(DAMAGE_DECAY|LOG_LOG_INTERPOLATION|PATH_DEPENDENT))?(_TITLE)?")
_CURVE = re.compile(r"DEFINE_CURVE(_TITLE)?")
_TABLE = re.compile(r"DEFINE_TABLE(_2D)?(_TITLE)?")
Card = dict[str, Optional[float]]
_UNUSED = 1e-15  # a DAMP that stands for 0, since a blank has a default


@dataclasses.dataclass
class Block:
    """A keyword with its cards; blank lines count, comments do not."""

    keyword: str
    long: bool
    file: str
    line: int
    cards: list[tuple[str, int]]

    @property
    def place(self) -> str:
        return f"{self.file}:{self.line}"


class Deck:
    """The blocks of a deck and its includes that a foam may need, in order, and the parameters."""

    def __init__(self, path: Path) -> None:
        self.folder = path.parent
        self.parameters: dict[str, str | None] = {}  # None: an expression
        self.local: dict[tuple[str, str], str | None] = {}
        self.blocks: list[Block] = []
        self.notes: list[str] = []
        self.files: list[Path] = []
        self._read(path, str(path))
        for block in self.blocks:
            if block.keyword.startswith("PARAMETER"):
                self._parameters(block)

    def _read(self, path: Path, place: str) -> None:
        enter(path, place, self.files)
        wide, block = False, None
        for line, text in enumerate(read_lines(path, place), 1):
            if text.startswith("$"):
                continue
            if not text.startswith("*"):
                if block:
                    block.cards.append((text, line))
                continue
            self._close(block)
            keyword, _, options = text[1:].strip().upper().partition(" ")
            options = options.strip().replace(" ", "")
            if keyword == "END":
                return
            if keyword == "KEYWORD":
                wide = "LONG=Y" in options or "LONG=S" in options
            if keyword.endswith(("+", "%")) and not options:
                keyword, options = keyword[:-1], keyword[-1]
            needed = keyword.startswith(("MAT_", "DEFINE_CURVE", "DEFINE_TABLE", "PARAMETER", "INCLUDE"))
            block = Block(keyword, options.startswith("+") or (wide and not options.startswith(("-", "%"))), str(path), line, []) if needed else None
        self._close(block)

    def _close(self, block: Block | None) -> None:
        if not block:
            return
        if block.keyword != "INCLUDE":
            if block.keyword.startswith("INCLUDE"):
                self.notes.append(f"{block.place}: *{block.keyword} is not followed")
            self.blocks.append(block)
            return
        name = ""
        for text, line in block.cards:
            name += text.strip()
            if name.endswith(" +"):
                name = name[:-2].rstrip()
                continue
            if name:
                self._read(included(name, self.folder, f"{block.file}:{line}"), f"{block.file}:{line}")
            name = ""

    def _parameters(self, block: Block) -> None:
        """Takes *PARAMETER cards: pairs of a name, with its type before it, and a value."""
        expression = "EXPRESSION" in block.keyword
        for text, line in block.cards:
            fields = text.split(",") if "," in text and not expression else [text[:10], text[10:]] if expression else split(text, [10] * 8, block.long)
            for name, value in zip(fields[0::2], fields[1::2]):
                name = name.strip()[1:].strip().lower()
                if not name:
                    continue
                table, key = (self.local, (block.file, name)) if "LOCAL" in block.keyword else (self.parameters, name)
                entry = None if expression else value.strip()
                if table.setdefault(key, entry) != entry:  # type: ignore[attr-defined]
                    self.notes.append(f"{block.file}:{line}: parameter {name} is defined again as {value.strip()[:20]}; its first value counts")

    def value(self, text: str, block: Block, line: int, what: str) -> float | None:
        """Returns the value of a field; None if it is blank."""
        place = f"{block.file}:{line}"
        if "\t" in text:
            raise refuse(place, f"{what} has a tab: fields are found by columns; put blanks or commas in its place")
        text = text.strip()
        found = re.fullmatch(r"(-?)&(\S+)", text)
        if found:
            name = found[2].lower()
            entry = self.local.get((block.file, name), self.parameters.get(name, ""))
            if not entry:
                raise refuse(place, f"the parameter {name} of {what} is {'an expression; give its value by *PARAMETER' if entry is None else 'not defined in this deck'}")
            return number(entry, place, f"parameter {name}") * (-1 if found[1] else 1)
        return number(text, place, what) if text else None

    def card(self, block: Block, index: int, names: str) -> Card:
        """Returns the fields of a card by their names; a card that is not there is blank."""
        text, line = block.cards[index] if index < len(block.cards) else ("", block.line)
        keys = names.split()
        fields = split(text, [10] * len(keys), block.long)
        return {key: self.value(field, block, line, key) for key, field in zip(keys, fields + [""] * len(keys))}


def split(text: str, widths: list[int], long: bool) -> list[str]:
    """Returns the fields of a card: between commas, or by columns."""
    if "," in text:
        return text.split(",")
    widths = [20] * len(widths) if long else widths
    return [text[sum(widths[:k]):sum(widths[:k + 1])] for k in range(len(widths))]


# ---- curves and tables ----

def _curve(deck: Deck, block: Block, rate: float | None = None) -> Curve:
    first = 1 if "_TITLE" in block.keyword else 0
    head = deck.card(block, first, "LCID SIDR SFA SFO OFFA OFFO DATTYP LCINT")
    made = Curve([], [], rate, block.place)
    for k in range(first + 1, len(block.cards)):
        text, line = block.cards[k]
        if not text.strip() and not any(text.strip() for text, _ in block.cards[k:]):
            break
        a, o = (deck.value(field, block, line, what) or 0.0 for field, what in zip(split(text, [20, 20], block.long) + ["", ""], ("abscissa", "ordinate")))
        made.strain.append((head["SFA"] or 1.0) * (a + (head["OFFA"] or 0.0)))
        made.stress.append((head["SFO"] or 1.0) * (o + (head["OFFO"] or 0.0)))
        if len(made.strain) > MOST_POINTS:
            raise refuse(block.place, f"the curve has more than {MOST_POINTS} points")
    if not made.strain:
        raise refuse(block.place, "the curve has no points")
    if any(head[name] for name in ("SFA", "SFO", "OFFA", "OFFO")):
        made.told = f"strain = {head['SFA'] or 1:g} (a + {head['OFFA'] or 0:g}), stress = {head['SFO'] or 1:g} (o + {head['OFFO'] or 0:g}) in the deck's units, the scale on the offset, too"
    return made


def _find(deck: Deck, ident: float, pattern: re.Pattern[str]) -> int | None:
    """Returns the place among the blocks of a curve or table with this number."""
    for k, block in enumerate(deck.blocks):
        if pattern.fullmatch(block.keyword):
            first = 1 if "_TITLE" in block.keyword else 0
            text, line = block.cards[first] if first < len(block.cards) else ("", block.line)
            if deck.value(split(text, [10], block.long)[0], block, line, "number") == ident:
                return k
    return None


def curves_of(deck: Deck, ident: float | None, what: str, place: str) -> list[Curve]:
    """Returns the curve of this number, or those of the table by their rates."""
    if not ident:
        raise refuse(place, f"{what} is blank: the card names no curve")
    at = _find(deck, ident, _CURVE)
    if at is not None:
        return [_curve(deck, deck.blocks[at])]
    at = _find(deck, ident, _TABLE)
    if at is None:
        other = [block for block in deck.blocks if block.keyword.startswith("DEFINE_") and not _CURVE.fullmatch(block.keyword) and not _TABLE.fullmatch(block.keyword)]
        raise refuse(place, f"{what} = {ident:g}: the deck has no *DEFINE_CURVE or *DEFINE_TABLE of this number" +
                     (f"; *{other[0].keyword} at {other[0].place} is not read" if other else "; add the file that defines it by *INCLUDE"))
    table = deck.blocks[at]
    first = 1 if "_TITLE" in table.keyword else 0
    head = deck.card(table, first, "TBID SFA OFFA")
    rows = [row for row in table.cards[first + 1:] if row[0].strip()]
    if not 0 < len(rows) <= MOST_CURVES:
        raise refuse(table.place, f"the table has {len(rows)} values; it must have 1 to {MOST_CURVES}")
    followers = iter([block for block in deck.blocks[at + 1:] if _CURVE.fullmatch(block.keyword)])
    made = []
    for text, line in rows:
        fields = split(text, [20, 20], table.long) + ["", ""]
        rate = (head["SFA"] or 1.0) * ((deck.value(fields[0], table, line, "value") or 0.0) + (head["OFFA"] or 0.0))
        if "_2D" in table.keyword:
            made += curves_of(deck, deck.value(fields[1], table, line, "LCID"), "LCID", f"{table.file}:{line}")[:1]
        else:
            block = next(followers, None)
            if block is None:
                raise refuse(f"{table.file}:{line}", f"the table has {len(rows)} values, and fewer curves follow it")
            made.append(_curve(deck, block))
        made[-1].rate = rate
    return made


# ---- materials ----

_NOT_USED = {
    "BETA": "no creep of unloading; material.memory.recovery is for pauses between drops", "BVFLAG": "softfall has no bulk viscosity", "REF": "the reference geometry is the mesh",
    "KCON": "softfall derives its time step and its contact from the law (older manuals of MAT_083 have ED there, without its decay)", "K": "contact follows from the law",
    "PR": "the law low_density_foam has no lateral strain", "TFLAG": "tension follows E, not the curves", "PVID": "no curve of the pressure over the volume",
    "SRAF": "the rate passes a low pass of rate_filter_time", "MINR": "all rates of the table act", "MAXR": "all rates of the table act", "PDOPT": "there is no such option",
    "RIULD": "unloading acts on the slowest curve, and the overstress of the rate fades with rate_filter_time", "LCSR": "no factor of the rate; rate_factor is softfall's",
    "BETAT": "no decay of damage; material.memory.recovery is for pauses between drops", "BETAC": "no decay of damage; material.memory.recovery is for pauses between drops",
    "R": "no Mullins effect by it; material.memory is softfall's", "M": "no Mullins effect by it; material.memory is softfall's",
    **{name: "the curves of the table are taken" for name in ("D0", "N0", "N1", "N2", "N3", "C0", "C1", "C2", "C3", "C4", "C5", "AIJ", "SIJ")}}


def _damping(deck: Deck, foam: Foam, card: Card, fallback: float) -> None:
    """Takes TC, FAIL and DAMP; DAMP below 0 is a curve over the strain."""
    cutoff, damp = card["TC"] or 1e20, card["DAMP"]
    if cutoff < 1e19:
        foam.values["tension_cutoff"] = cutoff
    foam.drop("FAIL", card.get("FAIL"), "the stress stays at tension_cutoff; softfall has no failure" if cutoff < 1e19 else "without TC (1e20) it has no effect")
    foam.values["DAMP"] = fallback if not damp else 0.0 if 0 < damp < _UNUSED else damp
    if not damp:
        foam.note(f"DAMP is blank or 0: its default, {fallback:g}")
    elif damp < 0:
        at = _find(deck, -damp, _CURVE)
        first = _curve(deck, deck.blocks[at]).stress[0] if at is not None else -1.0
        foam.values["DAMP"] = first if 0 <= first <= 10 else fallback
        foam.note(f"DAMP = {damp:g} is the curve {-damp:g} over the strain: softfall has one number, {foam.values['DAMP']:g}, " + ("its first value" if 0 <= first <= 10 else "the default"))
    if foam.values["DAMP"] > 0:
        foam.note(f"DAMP = {foam.values['DAMP']:g}: the length in it is the spacing of the nodes in softfall; damp_length fixes it")


def _mat57(deck: Deck, foam: Foam, block: Block, first: int) -> Card:
    card = deck.card(block, first, "MID RO E LCID TC HU BETA DAMP") | deck.card(block, first + 1, "SHAPE FAIL BVFLAG ED BETA1 KCON REF")
    foam.values.update(E=card["E"] or 0.0, HU=card["HU"] or 1.0, SHAPE=card["SHAPE"] or 1.0, ALPHA=1.0)
    foam.curves = curves_of(deck, card["LCID"], "LCID", block.place)
    if len(foam.curves) > 1:
        foam.note("LCID is a table: its values are taken for strain rates")
    _damping(deck, foam, card, 0.05)
    if not card["HU"]:
        foam.note("HU is blank: 1 in MAT_057, no hysteresis")
    if card["ED"]:
        foam.values.update(ED=card["ED"], BETA1=card["BETA1"] or 1e-6)
    if card["ED"] and not card["BETA1"]:
        foam.note("BETA1 is blank: the branch ED never relaxes; 1e-6 in the deck's units is used")
    return card


def _mat83(deck: Deck, foam: Foam, block: Block, first: int) -> Card:
    card = deck.card(block, first, "MID RO E KCON TC FAIL DAMP TBID") | deck.card(block, first + 1, "BVFLAG SFLAG RFLAG TFLAG PVID SRAF REF HU")
    if "DAMAGE_DECAY" in block.keyword:
        card |= deck.card(block, first + 2, "MINR MAXR SHAPE BETAT BETAC") | deck.card(block, first + 3, "EXPON RIULD PDOPT")
    else:
        card |= deck.card(block, first + 2, "D0 N0 N1 N2 N3 C0 C1 C2") | deck.card(block, first + 3, "C3 C4 C5 AIJ SIJ MINR MAXR SHAPE") | deck.card(block, first + 4, "EXPON RIULD PDOPT")
    if "PATH_DEPENDENT" in block.keyword or not card["TBID"]:
        raise refuse(block.place, "*MAT_083 is read with a table of curves (TBID), not PATH_DEPENDENT nor by its constants D0 to C5: give the curves of some rates in a *DEFINE_TABLE")
    hu, shape, expon = card["HU"] or 0.0, card["SHAPE"] or 1.0, card["EXPON"] or 1.0
    foam.values.update(E=card["E"] or 0.0, HU=hu or 1.0, SHAPE=shape, ALPHA=expon)
    if hu == 0:
        foam.note(f"HU is {'blank' if card['HU'] is None else '0'}: unloading of MAT_083 then follows the curve of the lowest rate. HU = 1 does the same in softfall, whose elastic "
                  f"law is the slowest curve; SHAPE = {shape:g} and ALPHA = {expon:g} have no effect with it")
    foam.curves = curves_of(deck, abs(card["TBID"]), "TBID", block.place)
    if card["TBID"] < 0:
        foam.note(f"TBID = {card['TBID']:g} is negative: its amount is the table; what else LS-DYNA does then is not taken over")
    _damping(deck, foam, card, 0.05)
    foam.note(f"SFLAG = {card['SFLAG'] or 0:g}: the rates of the table are " + ("engineering strain rates, as softfall's" if card["SFLAG"] else
              "true (constant) strain rates; softfall counts engineering ones, which are lower by the stretch"))
    foam.note(f"RFLAG = {card['RFLAG'] or 0:g}, the rate of {({0: 'the first principal direction', 1: 'each principal direction'}).get(int(card['RFLAG'] or 0), 'the volume')}: "
              "softfall takes that of the most compressed direction for all three")
    return card


def _mat63(deck: Deck, foam: Foam, block: Block, first: int) -> Card:
    card = deck.card(block, first, "MID RO E PR LCID TC DAMP MODEL")
    if card["MODEL"]:
        raise refuse(block.place, f"MODEL = {card['MODEL']:g}: its curve is over the plastic strain; give the measured curve of compression as MODEL 0 or *MAT_057")
    foam.curves = curves_of(deck, card["LCID"], "LCID", block.place)[:1]
    foam.values.update(E=card["E"] or 0.0, HU=0.01, SHAPE=10.0, ALPHA=1.0)
    foam.note("MAT_063 unloads elastically and keeps its crush; softfall has no such set in a drop: HU = 0.01 and SHAPE = 10 return a tenth of the energy")
    foam.note("the curve is the yield stress over the volumetric strain 1 - V; with no lateral strain it is the curve of compression, elastic with E up to it")
    _damping(deck, foam, card, 0.1)
    curve, e = foam.curves[0], foam.values["E"]
    points = list(zip(curve.strain, curve.stress))
    for k, ((a0, b0), (a1, b1)) in enumerate(zip(points, points[1:])):
        if points[0][0] == 0 < points[0][1] and e * a1 >= b1 and e * (a1 - a0) > b1 - b0:  # elastic up to the yield stress
            begin = (b0 * a1 - b1 * a0) / (e * (a1 - a0) - (b1 - b0))
            points = [(0.0, 0.0), (begin, e * begin), *(point for point in points[k + 1:] if point[0] > begin)]
            curve.strain, curve.stress = [a for a, _ in points], [b for _, b in points]
            foam.note(f"the curve begins at its yield stress: the elastic line with E to a strain of {begin:.4g} is put before it")
            break
    return card


def _mat177(deck: Deck, foam: Foam, block: Block, first: int) -> Card:
    card = deck.card(block, first, "MID RO K N MU LCID FITTYPE LCSR")
    damp, beta = card["MU"] or 0.0, card["N"] or 0.0
    foam.values.update(DAMP=0.0 if damp < _UNUSED else damp, HU=1.0, SHAPE=1.0, ALPHA=1.0)
    if not card["LCID"]:
        rows = [deck.card(block, first + k, " ".join(f"{letter}{n}" for n in range(1, 9))) for k, letter in ((1, "C"), (2, "B"))]
        foam.terms = [Term(0.5 * c * b, b, None, beta) for c, b in zip(rows[0].values(), rows[1].values()) if c and b]
        foam.note("mu = C b/2, alpha = b and beta = N of each term; MU is taken for DAMP")
        if not 0 < len(foam.terms) <= MOST_TERMS:
            raise refuse(block.place, f"*MAT_177 has {len(foam.terms)} terms C and B; softfall has 1 to {MOST_TERMS}")
        return card | deck.card(block, first + 3, "R M")
    if (card["FITTYPE"] or 1) != 1:
        raise refuse(block.place, f"FITTYPE = {card['FITTYPE']:g} is no uniaxial test; give C1 to C8 and B1 to B8, or a curve of compression")
    foam.curves = curves_of(deck, card["LCID"], "LCID", block.place)[:1]
    if min(foam.curves[0].strain) < 0:
        foam.curves[0].turn()  # tension is positive
    foam.drop("N", beta, "the curve becomes a low_density_foam without lateral strain; softfall fit compression fits a hyperfoam to it")
    return card | deck.card(block, first + 1, "R M")


_READERS = {"57": _mat57, "63": _mat63, "83": _mat83, "177": _mat177}


def _fill(deck: Deck, foam: Foam, block: Block, first: int, kind: str) -> None:
    foam.notes += deck.notes
    foam.density = deck.card(block, first, "MID RO")["RO"] or 0.0
    for name, value in _READERS[kind](deck, foam, block, first).items():
        if name in _NOT_USED:
            foam.drop(name, value, _NOT_USED[name])


def read(path: Path) -> list[Foam]:
    """Returns the foams of a deck, in its units."""
    deck, foams = Deck(path), []
    for block in deck.blocks:
        found = _MATERIAL.fullmatch(block.keyword)
        if found:
            first = 1 if found[4] else 0
            text, line = block.cards[first] if first < len(block.cards) else ("", block.line)
            key = split(text, [10], block.long)[0].strip()
            ident = deck.value(key, block, line, "MID") if re.fullmatch(r"-?&.*|[\d.]+", key) else None
            foams.append(Foam(key if ident is None else f"{ident:.0f}", block.cards[0][0].strip() if first and block.cards else "", f"*{block.keyword.removesuffix('_TITLE')}", block.place))
            kind = found[1] or next(number for number, name in KINDS.items() if name == found[2])
            foams[-1].fill = functools.partial(_fill, deck, foams[-1], block, first, kind)
    if not foams:
        others = [f"*{block.keyword} at {block.place}" for block in deck.blocks if block.keyword.startswith("MAT_") and "FOAM" in block.keyword]
        raise InputError(f"{path}: there is no foam that softfall reads (*MAT_057, 063, 083, 177)" + (f", only {', '.join(others[:5])}" if others else ""))
    return foams


# ---- export ----

def _card(*values: float | int) -> str:
    """Returns a card of fields 20 columns wide."""
    return "".join(f"{value:20.12g}" for value in values)


def write(foam: Foam, units: System) -> str:
    """Returns the foam as *MAT_057, as *MAT_083 if it has curves of several rates or ALPHA, or as *MAT_177 of a hyperfoam; fields are 20 columns wide."""
    value = foam.values
    head = ["*KEYWORD", *(f"$ {line}" for line in foam.notes)]
    density, damp = foam.density / units.density, value.get("DAMP") or 1e-20
    if foam.terms:
        factors = [[2 * term.mu / term.alpha / units.stress for term in foam.terms], [term.alpha for term in foam.terms]]
        return "\n".join([*head, "*MAT_HILL_FOAM +", _card(1, density, sum(term.mu for term in foam.terms) * 2 / units.stress, foam.terms[0].beta or 0.0, damp, 0, 0, 0),
                          *(_card(*row, *[0] * (8 - len(row))) for row in factors), _card(0, 0), "*END"]) + "\n"
    modulus, cutoff = value["E"] / units.stress, value["tension_cutoff"] / units.stress if "tension_cutoff" in value else 1e20
    several = len(foam.curves) > 1 or value["ALPHA"] != 1
    if several:
        lines = ["*MAT_FU_CHANG_FOAM +", _card(1, density, modulus, 0, cutoff, 0, damp, 1), _card(0, 1, 1, 0, 0, 0, 0, 0 if value["HU"] == 1 else value["HU"]),
                 _card(*[0] * 8), _card(*[0] * 7, value["SHAPE"]), _card(value["ALPHA"], 0), "*DEFINE_TABLE_2D +", _card(1, 0, 0),
                 *(_card((curve.rate or 0.0) * units.time, k) for k, curve in enumerate(foam.curves, 2))]
    else:
        lines = ["*MAT_LOW_DENSITY_FOAM +", _card(1, density, modulus, 2, cutoff, value["HU"], 0, damp),
                 _card(value["SHAPE"], 0, 0, value["ED"] / units.stress, value["BETA1"] * units.time if value["ED"] else 0, 0, 0)]
    for k, curve in enumerate(foam.curves, 2):
        lines += ["*DEFINE_CURVE +", _card(k, 0, 1, 1, 0, 0, 0, 0), *(_card(a, b / units.stress) for a, b in zip(curve.strain, curve.stress))]
    return "\n".join([*head, *lines, "*END"]) + "\n"
