# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws of a foam's posterior as softfall-fit drop writes them: the stress that each has in a compression test at a rate."""
from __future__ import annotations

import csv
import math
import re
from pathlib import Path
from typing import Sequence

import numpy as np

from .errors import InputError
from .protocol import strain_rate

_RATED = re.compile(r'\{\s*rate\s*=\s*"([^"]+)"\s*;\s*file\s*=\s*"([^"]+)"\s*;?\s*\}')


def _value(text: str, key: str) -> str:
    """Returns the value of a key of a material file, "" if it is absent."""
    found = re.search(rf'^\s*{key}\s*=\s*"?([^";\n]+)"?\s*;', text, re.M)
    return found.group(1).strip() if found else ""


def _curve(path: Path, strains: Sequence[float]) -> np.ndarray:
    """Returns the stress of a curve of softfall-fit at strains; InputError: it has another heading, or ends before them."""
    with open(path, newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(line for line in stream if not line.startswith("#")))
    if len(rows) < 3 or rows[0][0].strip() != "strain" or float(rows[-1][0]) < max(strains):
        raise InputError(f"{path} has no column strain first, or ends before {max(strains):g}")
    table = np.array([row[:2] for row in rows[1:]], float)
    return np.interp(strains, table[:, 0], table[:, 1])


def _stress(path: Path, rate: float, strains: Sequence[float]) -> np.ndarray:
    """Returns the stress of a draw in slow loading at a rate (1/s), by the laws of docs/theory.md: (O4), or curves at several rates."""
    text = path.read_text(encoding="utf-8")
    for key, what in (("ED", "a Maxwell branch"), ("eta", "a Kelvin viscosity")):
        if float((_value(text, key) or "0").split()[0]) != 0:
            raise InputError(f"{path} has {what}, of which the stress in a compression test is not computed")
    if curve := _value(text, "curve"):
        factor, reference = float(_value(text, "rate_factor") or 0), strain_rate(_value(text, "rate_reference") or "0.01 1/s", str(path))
        return _curve(path.parent / curve, strains) * (1 + factor * max(0.0, math.log10(rate / reference)))
    rated = [(strain_rate(rate_text, str(path)), file) for rate_text, file in _RATED.findall(text)]
    if not rated:
        raise InputError(f"{path} has neither a curve nor curves at rates as files")
    stress = np.maximum.accumulate([_curve(path.parent / file, strains) for _, file in rated])  # a faster curve is at least as high
    at = np.log([each for each, _ in rated])
    return np.array([np.interp(math.log(rate), at, column) for column in stress.T])


def test_stresses(folder: Path, rate: float, strains: Sequence[float]) -> np.ndarray:
    """Returns the stress [draws][strains] of each draw-NNN.cfg in a compression test at a rate (1/s). InputError: it is not known."""
    paths = sorted(folder.glob("draw-*.cfg"), key=lambda path: int(re.sub(r"\D", "", path.stem) or 0))
    return np.array([_stress(path, rate, strains) for path in paths])
