# SPDX-License-Identifier: GPL-3.0-or-later
"""Consistent unit systems of decks: read from a name, declared by the deck, or found from density and stresses."""
from __future__ import annotations

import re
from typing import NamedTuple

from ..errors import InputError

_INCH, _FOOT, _POUND, _POUND_FORCE = 0.0254, 0.3048, 0.45359237, 4.4482216152605
LENGTH = {"m": 1.0, "dm": 0.1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": _INCH, "inch": _INCH, "ft": _FOOT}
TIME = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "mus": 1e-6}
MASS = {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "ton": 1e3, "tonne": 1e3, "slinch": _POUND_FORCE / _INCH, "slug": _POUND_FORCE / _FOOT, "lb": _POUND}
STRESS = {"pa": 1.0, "kpa": 1e3, "mpa": 1e6, "gpa": 1e9, "mbar": 1e11, "bar": 1e5, "psi": _POUND_FORCE / _INCH ** 2, "psf": _POUND_FORCE / _FOOT ** 2}
FORCE = {"n": 1.0, "kn": 1e3, "mn": 1e6, "lbf": _POUND_FORCE}
FOAM_DENSITY, FOAM_STRESS, FOAM_RATIO = (5.0, 1500.0), (1e3, 5e7), (20.0, 5e4)  # kg/m3, Pa halfway along the curve, that over the density
ANY_DENSITY = 1.0, 3000.0  # kg/m3, of any foam or rubber


class Figures(NamedTuple):
    """What units are known by, in those of the deck."""

    density: float
    stress: float
    modulus: float  # E; 0: there is none
    what: str = "halfway along the curve"  # the stress is


class System(NamedTuple):
    """Units of a deck in SI units."""

    name: str
    mass: float
    length: float
    time: float

    @property
    def stress(self) -> float:
        return self.mass / self.length / self.time ** 2

    @property
    def density(self) -> float:
        return self.mass / self.length ** 3

    def suits(self, card: Figures) -> bool:
        """True if density and stress are those of a foam."""
        density, stress = card.density * self.density, card.stress * self.stress
        return all(low <= value <= high for value, (low, high) in ((density, FOAM_DENSITY), (stress, FOAM_STRESS), (stress / max(density, 1e-99), FOAM_RATIO)))

    def meaning(self, card: Figures) -> str:
        """Returns what the numbers of the card mean in these units."""
        modulus = f"E {1e-3 * card.modulus * self.stress:.4g} kPa, " if card.modulus else ""
        return f"density {card.density * self.density:.4g} kg/m3, {modulus}stress {1e-3 * card.stress * self.stress:.3g} kPa {card.what}"


def parse(name: str) -> System:
    """Returns the system of a name such as mm-ms-kg-GPa or mm-s-N: length, time, and one of mass, stress and force.

    >>> system = parse("mm-s-t-MPa")
    >>> system.mass, system.length, round(system.stress)
    (1000.0, 0.001, 1000000)
    """
    found: dict[str, float] = {}
    for word in re.split(r"[-,_ ]+", name.strip()):
        word = "t" if word == "Mg" else word.lower()
        kinds = [kind for kind, table in (("length", LENGTH), ("time", TIME), ("mass", MASS), ("stress", STRESS), ("force", FORCE)) if word in table]
        if not kinds or kinds[0] in found:
            raise InputError(f"units {name[:60]!r}: {word!r} is {'a second ' + kinds[0] if kinds else 'no unit'}; a name is such as {', '.join(COMMON)}")
        found[kinds[0]] = {"length": LENGTH, "time": TIME, "mass": MASS, "stress": STRESS, "force": FORCE}[kinds[0]][word]
    length, time = found.get("length"), found.get("time")
    masses = [mass for mass in (found.get("mass"), found["stress"] * length * time ** 2 if "stress" in found and length and time else None,
                                found["force"] / length * time ** 2 if "force" in found and length and time else None) if mass]
    if not length or not time or not masses:
        raise InputError(f"units {name[:60]!r}: length, time, and mass, stress or force are needed, such as {', '.join(COMMON)}")
    for mass in masses:
        if not 0.999 < mass / masses[0] < 1.001:
            stress = masses[0] / length / time ** 2
            raise InputError(f"units {name[:60]!r} contradict each other: length, time and mass make a stress of {stress:.4g} Pa")
    return System(name.strip(), masses[0], length, time)


COMMON = ("mm-ms-kg-GPa", "mm-s-t-MPa", "m-s-kg-Pa", "mm-ms-g-MPa", "cm-us-g-Mbar", "mm-s-kg-kPa", "in-s-slinch-psi", "ft-s-slug-psf", "m-ms-kg-MPa", "cm-ms-g-bar",
          "cm-s-g", "m-s-t-kPa", "mm-s-g-Pa")


def find(card: Figures, given: str | None, declared: System | None) -> tuple[System, list[str]]:
    """Returns the units of a card, and how they are known: those given, those declared if they make a foam of it, or the only common ones that do."""
    systems = [parse(name) for name in COMMON]
    fitting = [system for system in systems if system.suits(card)]
    listed = "; ".join(f"--units={system.name}: {system.meaning(card)}" for system in fitting or
                       [system for system in systems if ANY_DENSITY[0] <= card.density * system.density <= ANY_DENSITY[1]] or systems[:3])
    chosen, source = (parse(given), "as given") if given is not None else (declared, "declared by the deck")
    if chosen is None and len(fitting) != 1:
        raise InputError(f"the units of the card are {'ambiguous' if fitting else 'not known'}; give them by --units. Candidates: {listed}")
    if chosen is None:
        chosen, source = fitting[0], "the only common ones that make a foam of the card"
    elif not ANY_DENSITY[0] <= card.density * chosen.density <= ANY_DENSITY[1] or not (given is not None or chosen.suits(card)):
        raise InputError(f"units {chosen.name}, {source}, make no foam of the card: {chosen.meaning(card)}. Candidates: {listed}")
    unusual = [] if chosen.suits(card) else [f"warning: in these units it is an unusual foam; candidates: {listed}"]
    return chosen, [f"units {chosen.name}, {source}: {chosen.meaning(card)}", *unusual]
