# SPDX-License-Identifier: GPL-3.0-or-later
"""Headings of laboratories' tables: which column is which quantity, and which one is another quantity of the same unit."""
from __future__ import annotations

import functools
import re
from dataclasses import dataclass, field
from typing import Sequence

from .units import SCALED, factor, plain


@dataclass(frozen=True)
class Role:
    """What a column may be: `words` stand in its heading ("*" for letters), `others` name what it is with other words ("": no other)."""

    key: str
    label: str
    quantity: str
    words: str
    others: tuple[tuple[str, str], ...] = ()
    by_unit: bool = False  # a unit of the quantity is enough
    exact: tuple[tuple[str, str], ...] = ()  # headings without brackets, and their units
    unnamed: tuple[tuple[str, str], ...] = ()  # what a column that has the unit alone is with other words

    @property
    def is_pressing(self) -> bool:
        """True of the two quantities of a curve, whose other quantities are named even without the words of the role."""
        return self.key in ("strain", "stress")


_SCATTER = ("sd|std|stdev|deviation|*abweichung|error|*fehler|uncertainty|*unsicherheit|scatter|cov|variance", "a scatter")
_ACROSS = "lateral*|transvers*|quer*|radial*|width|breite*|poisson*|hoop|circumferential|diamet*"
_WORK = ("energy|energie|energía|energia|énergie|work|toughness|resilience", "an energy")
_EPS, _SIGMA = "(?:eps|epsilon|ε|strain) ?", "(?:sig|sigma|σ|stress) ?"  # with an index, such as eps_p
_STRAINS = (
    (f"plast*|inelast*|bleibend*|permanent*|compression set|residual|recover*|peeq|pe[123]{{2}}|{_EPS}(?:p|pl|eqpl|inel)", "a plastic (permanent) strain"),
    (f"true|log|logarithm*|ln|hencky|natural|wahre*|vraie|verdadera|vera|le[123]{{2}}|{_EPS}(?:t|tr|ln|h)", "a true (logarithmic) strain"),
    (f"volum*|vol|dilat*|bulk|{_EPS}(?:v|vv|kk)", "a volumetric strain"), ("shear*|scher*|schub*|gamma|γ|cisaillement|cortante|taglio", "a shear strain"),
    ("tens*|zug|zugdehnung|elong*|traction|tracción|trazione|pull", "a tensile strain"), ("stretch*|streckung|lambda|λ", "a stretch (nominal strain = 1 - stretch)"),
    (_ACROSS, "a lateral strain"), ("*rate|rates|speed|velocity|*geschwindigkeit|vitesse|velocidad|velocità", "a strain rate"), _WORK,
    ("mu|μ|µ|rho|rho0|ρ|ρ0|density|*dichte", "a compression of the volume, mu = density / first density - 1"),
    ("green|lagrang*|almansi|equivalent|effective|mises|vergleichs*", "a strain of another measure"), ("thermal|creep", "a strain of another cause"), _SCATTER)
_STRESSES = (
    (f"plast*|yield*|flow|flie*|streckgrenze|fluencia|snervamento|sy|fy|rp0|rp02|yld|sigy|{_SIGMA}(?:y|ys|f|0)", "a yield stress"),
    (f"true|cauchy|kirchhoff|wahre*|vraie|verdadera|vera|s(?:11|22|33)|{_SIGMA}(?:t|tr)", "a true stress"),
    ("hydro*|volum*", "a hydrostatic pressure"), ("shear*|scher*|schub*|tau|τ|cisaillement|cortante|taglio", "a shear stress"),
    ("tensile|tension|zug|zugspannung|traction|tracción|trazione", "a tensile stress"), (_ACROSS + "|confin*|wall", "a lateral stress"),
    ("mises|equivalent|effective|deviator*|vergleichs*|piola|pk2", "a stress of another measure"), _WORK, ("*rate|rates", "a stress rate"),
    ("*modul*|stiffness|tangent|secant|young*|*steifigkeit|module|rigidez", "a modulus"), ("quasi static", ""),
    ("static|residual|thermal", "a stress of another test"), _SCATTER)
_TENSILE = "tens*|zug*|elong*|traction|tracción|trazione|pull|dehnweg"
_LENGTHS = ((_TENSILE, "a tensile displacement"), (_ACROSS, "a lateral displacement"), ("*rate|speed|velocity", "a speed"), _SCATTER)
_FORCES = ((_TENSILE + "|tension", "a tensile force"), (_ACROSS + "|shear*|friction|reibung*|side", "a lateral force"), ("preload|prestress|limit|vorkraft|trigger", "a set value"), _SCATTER)
_ACCELERATIONS = (("limit|threshold|trigger|grenz*", "a set value"), ("angular|*winkel*|rotation*", "an angular acceleration"), _SCATTER)

_WAYS = ("displacement|displ|disp|extension|crosshead|traverse*|position|pos|travel|stroke|deformation|deflection|deflexion|compression|compressive|indentation|"
         "penetration|*weg|*verformung|*stauchung|desplazamiento|déplacement|spostamento|compresión|compressione|durchbiegung")

TIME = Role("time", "time", "time", "time|t|*zeit|temps|tiempo|tempo|*stamp|elapsed|date|datum|datetime|fecha|data ora", (("*rate|interval|delay|pre|post|pretrigger", "no time of a sample"),),
            exact=(("time_s", "s"), ("time_ms", "ms"), ("time_us", "us")))
ACCELERATION = Role("acceleration", "acceleration", "acceleration",
                    "acceleration|deceleration|accel*|acc|a|*beschleunigung|*verzögerung|accélération|aceleración|accelerazione|decel*", _ACCELERATIONS, True,
                    (("acceleration_g", "g"), ("acceleration_m_s2", "m/s2"), ("acceleration_km_s2", "km/s2")),
                    (("mass|weight|masse|gewicht|poids|peso|massa", "a mass"),))
STRAIN = Role("strain", "nominal strain in compression", "ratio",
              "strain|eps|epsilon|ε|*dehnung|*stauchung|déformation|deformación|deformazione|" + _WAYS, _STRAINS,
              exact=(("strain", "1"), ("strain_percent", "%")))
STRESS = Role("stress", "nominal stress in compression", "pressure",
              "stress|sigma|σ|*spannung|contrainte|tensión|esfuerzo|sforzo|tensione|pressure|druck", _STRESSES, True,
              (("stress_Pa", "Pa"), ("stress_kPa", "kPa"), ("stress_MPa", "MPa")))
LATERAL = Role("lateral_strain", "lateral strain", "ratio", _ACROSS, tuple(other for other in _STRAINS if other[0] != _ACROSS),
               exact=(("lateral_strain", "1"), ("lateral_strain_percent", "%"), ("transverse_strain", "1"), ("transverse_strain_percent", "%")))
DISPLACEMENT = Role("displacement", "displacement", "length", _WAYS, _LENGTHS, exact=(("displacement_m", "m"), ("displacement_mm", "mm")))
GAP = Role("gap", "gap of the platens", "length", "gap|*spalt|*abstand|separation|distance|height|*höhe|thickness|dicke|entrefer|distancia|distanza|hauteur|altura|altezza",
           _LENGTHS)
FORCE = Role("force", "force", "force", "force|load|f|*kraft|*last|fuerza|carga|forza|carico|charge", _FORCES, True, (("force_N", "N"), ("force_kN", "kN")))
HEIGHT = Role("height", "height", "length", "height|h|*höhe|*hoehe|hauteur|altura|altezza", exact=(("height_m", "m"), ("h_m", "m"), ("h_m_m", "m")))
SPEED = Role("speed", "speed", "speed", "speed|velocity|v|*geschwindigkeit|vitesse|velocidad|velocità", (), True,
             exact=(("speed_m_s", "m/s"), ("v_test_m_s", "m/s")))
STATIC_STRESS = Role("static_stress", "static stress", "pressure", "static*|stress|load*|pressure|*spannung|*belastung", (), True,
                     (("static_stress_Pa", "Pa"), ("static_stress_kPa", "kPa")))
PEAK = Role("peak", "peak deceleration", "acceleration", "peak|deceleration|acceleration|*beschleunigung|*verzögerung|g", (), True, (("peak_g", "g"), ("G", "g")))


_TITLE = re.compile(r"(?i)\b(?:true|cauchy|hencky|log(?:arithmic)?|plastic|volumetric|yield|shear|wahre|plastische)[ -](?:strain|stress|dehnung|spannung)")


def other_title(line: str) -> str:
    """Returns what a line without numbers says that the curve below it is, if that is no nominal stress or strain.

    >>> other_title("# True stress - true strain curve"), other_title("Yield stress: 12 kPa"), other_title("nominal, from true stress")
    ('True stress', '', '')
    """
    found = None if re.search(r"(?i)\d|nominal|engineering|technisch", line) else _TITLE.search(line)
    return found[0] if found else ""


@functools.lru_cache(maxsize=None)
def _pattern(words: str) -> re.Pattern[str]:
    return re.compile(r"(?:^| )(?:" + words.replace("*", r"[^ ]*") + r")(?= |$)")


@dataclass(eq=False)
class Column:
    """A column of a table by its heading, with the units that stand elsewhere for it."""

    place: int
    heading: str
    below: str = ""  # its cell in a row of units below the heading
    above: str = ""  # its cell in a row of units above, such as "Engineering Unit"
    given: str = ""  # the user's unit
    about: str = ""  # what rows above say of it, such as "Channel Description"
    titles: list[tuple[str, str]] = field(default_factory=list)  # (name, unit) in all ways the heading can be read

    def __post_init__(self) -> None:
        self.titles = _titles(self.heading)

    @property
    def name(self) -> str:
        """The heading without its unit."""
        return self.titles[0][0]

    def unit(self, quantity: str) -> tuple[str, str, float] | None:
        """Returns the name, unit and its size, if one of the units that the column may have is of the quantity."""
        whole = self.titles[-1][0]
        written = any(factor(unit, of) is not None for _, unit in self.titles for of in _QUANTITIES)
        ways = [(self.name, self.given), *(title for title in self.titles if title[1]), (self.name, self.below), *([] if written else [(whole, self.above)])]
        for name, unit in [*ways, (whole, whole)] if quantity == "count" else ways:
            size = factor(unit, quantity)
            if size is not None:
                return name, plain(unit), size
        return None

    def contradiction(self, quantity: str) -> str:
        """Returns the unit of the row below that differs from that of the heading, or ""."""
        own = next((size for _, unit in self.titles if (size := factor(unit, quantity)) is not None), None)
        below = factor(self.below, quantity)
        return self.below if own is not None and below is not None and abs(below - own) > 1e-9 * own and not self.given else ""

    def words(self) -> str:
        """Returns the words of the heading without its unit, and of what stands above it, with blanks between."""
        return " ".join(re.findall(r"[^\W_]+", f"{self.name} {self.about}".casefold()))

    def is_called(self, text: str) -> bool:
        """True if the text is the heading or the name without its unit."""
        return text.strip() in (self.heading, self.name, self.titles[-1][0])

    def holds(self, words: str) -> bool:
        """True if the heading holds one of the words "time|t|*zeit"."""
        return bool(_pattern(words).search(self.words()))

    def is_exactly(self, role: Role) -> str:
        """Returns the unit that the whole heading means for the role, or ""."""
        return dict(role.exact).get(self.heading, "")


def _titles(heading: str) -> list[tuple[str, str]]:
    """Returns the ways to read a heading as name and unit, the likeliest first, and last the heading itself without a unit."""
    found: list[tuple[str, str]] = []
    for match in re.finditer(r"[(\[<]((?:[^()\[\]<>]|\([^()]*\))*)[)\]>]", heading):
        found.insert(0, ((heading[:match.start()].rstrip(" /") + heading[match.end():]).strip(" _"), match.group(1)))
    bracketed = found[:1] if heading.endswith((")", "]", ">")) else []
    for sign in ("/", ",", " in ", ":"):
        name, between, unit = heading.partition(sign) if sign == "/" else heading.rpartition(sign)
        if between:
            found.append((name.strip(), unit.strip()))
    for match in re.finditer(r"(?<=[^_])_", heading):  # acc_m_s2: what follows an underscore, the next one read as a slash
        if heading[match.end():].casefold() != "strain" and heading[match.end():] != "1" or heading[:match.start()].casefold().endswith("strain"):
            found.append((heading[:match.start()], heading[match.end():].replace("_", "/", 1)))
    name, blank, unit = heading.rpartition(" ")
    if blank and re.search(r"[^\W\d]|%", unit) and unit.casefold() != "strain":
        found.append((name.strip(), unit))
    known = [title for title in found if any(factor(title[1], quantity) is not None for quantity in _QUANTITIES)]
    return [*known, *([] if known else bracketed), (heading, "")]


_ALSO_ELSEWHERE = ("a strain rate", "a stress rate", "a scatter")  # words of them stand in other columns and lines, too
_QUANTITIES = ("time", "acceleration", "force", "length", "pressure", "ratio", "speed", "count", "voltage")


def fits(column: Column, role: Role, chosen: bool = False, scaled: bool = False) -> str | None:
    """Returns "" if the column has the role, what it is instead, or None if it has nothing to do with the role.

    `chosen`: the user has named it; `scaled`: the user gives the scale of a channel in volts or counts.
    """
    if column.is_exactly(role):
        return ""
    named = chosen or column.holds(role.words)
    unit = column.unit(role.quantity)
    if unit is None and role.quantity in SCALED and (named or scaled):
        unit = column.unit("count") or column.unit("voltage")
    others = role.others if named else role.others + role.unnamed
    instead = next((what for words, what in others if column.holds(words)), "")
    if role.is_pressing:
        written = " ".join((*(text for _, text in column.titles), column.below, column.above))
        energy, per_time = re.search(r"J\b", written), re.search(r"/ ?(?:s|sec|min|h)\b|s-1|s\^-1|s⁻¹", written)
        if energy or (per_time and (named or column.holds("*rate|rates"))):
            instead = "an energy" if energy else "a strain rate"
        elif not named and instead in _ALSO_ELSEWHERE:
            instead = ""
        if instead and (unit or not written.strip() or energy or per_time):
            return instead
    if not (named or (unit and role.by_unit)):
        return None
    return instead or ("" if unit else None)


def sort_out(columns: Sequence[Column], role: Role, scaled: bool = False) -> tuple[list[Column], list[tuple[Column, str]], list[Column]]:
    """Returns the columns that have the role, those that are another quantity, and those named like it without a unit of its kind."""
    having, other, unfit = [], [], []
    for column in columns:
        what = fits(column, role, scaled=scaled)
        if what == "":
            having.append(column)
        elif what:
            other.append((column, what))
        elif column.holds(role.words):
            unfit.append(column)
    exact = [column for column in having if column.is_exactly(role)]
    named = [column for column in having if column.holds(role.words)]
    return exact or named or having, sorted(other, key=lambda entry: not entry[0].holds(role.words)), unfit
