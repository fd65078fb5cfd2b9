# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws of a foam's posterior as softfall-fit drop writes them: the stress that each has in a compression test at a rate."""
from __future__ import annotations

import csv
import math
import re
from pathlib import Path
from typing import Mapping, Sequence

import numpy as np

from .errors import InputError
from .protocol import strain_rate

_RATED = re.compile(r'\{\s*rate\s*=\s*"([^"]+)"\s*;\s*file\s*=\s*"([^"]+)"\s*;?\s*\}')


def _value(text: str, key: str) -> str:
    """Returns the value of a key of a material file, "" if it is absent."""
    found = re.search(rf'^\s*{key}\s*=\s*"?([^";\n]+)"?\s*;', text, re.M)
    return found.group(1).strip() if found else ""


def _curve(path: Path, strains: Sequence[float]) -> np.ndarray:
    """Returns the stress (Pa) of a curve of softfall-fit at strains; InputError: it has another heading, or ends before them."""
    with open(path, newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(line for line in stream if not line.startswith("#")))
    unit = {"stress_Pa": 1.0, "stress_kPa": 1e3, "stress_MPa": 1e6}.get(rows[0][1].strip() if rows and len(rows[0]) > 1 else "")
    if len(rows) < 3 or rows[0][0].strip() != "strain" or unit is None or float(rows[-1][0]) < max(strains):
        raise InputError(f"{path} does not begin with the columns strain and stress_kPa, or ends before a strain of {max(strains):g}")
    table = np.array([row[:2] for row in rows[1:]], float)
    return unit * np.interp(strains, table[:, 0], table[:, 1])


def _quantity(text: str, units: Mapping[str, float], where: str) -> float:
    """Returns a number with one of the units in SI; a plain 0 has none."""
    parts = text.split()
    if len(parts) == 2 and parts[1] in units:
        return float(parts[0]) * units[parts[1]]
    if parts and float(parts[0]) == 0:
        return 0.0
    raise InputError(f"{where}: {text!r} has none of the units {', '.join(units)}")


def viscous_stress(strain: np.ndarray, rate: float, modulus: float, decay: float, viscosity: float) -> np.ndarray:
    """Returns the nominal stress (Pa, of compression) of the Maxwell branch (19) and the Kelvin viscosity (20) at a constant rate of the strain (1/s).

    The stretch is 1 - rate t, and the rate of the Green strain -rate (1 - rate t), over which (19) is integrated in closed form.
    """
    time, stretch = strain / rate, 1 - strain
    passed = -np.expm1(-decay * time)
    branch = modulus * rate / decay * (passed - rate * (time - passed / decay)) if modulus > 0 else 0.0
    return stretch * (branch + viscosity * rate * stretch)


def _viscous(text: str, path: Path, rate: float, strains: Sequence[float]) -> np.ndarray:
    modulus = _quantity(_value(text, "ED") or "0", {"Pa": 1, "kPa": 1e3, "MPa": 1e6}, str(path))
    decay = strain_rate(_value(text, "BETA1") or "5000 1/s", str(path))
    return viscous_stress(np.array(strains), rate, modulus, decay, _quantity(_value(text, "eta") or "0", {"Pa s": 1}, str(path)))


def _stress(path: Path, rate: float, strains: Sequence[float]) -> np.ndarray:
    """Returns the stress (Pa) of a draw in loading at a rate (1/s), by the laws of docs/theory.md: (O4) or (22), (19) and (20)."""
    text = path.read_text(encoding="utf-8")
    viscous = _viscous(text, path, rate, strains)
    if curve := _value(text, "curve"):
        factor, reference = float(_value(text, "rate_factor") or 0), strain_rate(_value(text, "rate_reference") or "0.01 1/s", str(path))
        return _curve(path.parent / curve, strains) * (1 + factor * max(0.0, math.log10(rate / reference))) + viscous
    rated = [(strain_rate(rate_text, str(path)), file) for rate_text, file in _RATED.findall(text)]
    if not rated:
        raise InputError(f"{path} has neither a curve nor curves at rates as files")
    stress = np.maximum.accumulate([_curve(path.parent / file, strains) for _, file in rated])  # a faster curve is at least as high
    at = np.log([each for each, _ in rated])
    return np.array([np.interp(math.log(rate), at, column) for column in stress.T]) + viscous


def compression_stresses(folder: Path, rate: float, strains: Sequence[float]) -> np.ndarray:
    """Returns the stress [draws][strains] of each draw-NNN.cfg in a compression test at a rate (1/s). InputError: it is not known."""
    paths = sorted(folder.glob("draw-*.cfg"), key=lambda path: int(re.sub(r"\D", "", path.stem) or 0))
    return np.array([_stress(path, rate, strains) for path in paths])
