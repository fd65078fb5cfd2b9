# SPDX-License-Identifier: GPL-3.0-or-later
"""Two meshes for one answer: figures at a spacing and at a multiple of it give their values for ever finer meshes, with an error."""
from __future__ import annotations

import math
from typing import Any, NamedTuple, Sequence

from . import library
from .case import Case
from .drop import Drop
from .errors import InputError

SPACING_FACTOR = "geometry.spacing_factor"


class Refined(NamedTuple):
    """A figure without the error of the mesh: `value` with `error`, the distance of the finer mesh from it."""

    value: float
    error: float
    fine: float
    coarse: float


class Refinement(dict[str, Refined]):
    """Refined figures by their keys; `fine` and `coarse` are the drops."""

    def __init__(self, figures: dict[str, Refined], fine: Drop, coarse: Drop) -> None:
        super().__init__(figures)
        self.fine, self.coarse = fine, coarse


def extrapolate(fine: float, coarse: float, ratio: float = 2.0, cells: float = math.inf) -> Refined:
    """Returns the value at a spacing of zero from those at h and `ratio` h, as `softfall sweep` with `refine`. `cells`: the number of
    cells at h over that at `ratio` h, if it is known. A pair that tells no value is an InputError.

    >>> extrapolate(95.274, 93.858)
    Refined(value=96.242..., error=0.968..., fine=95.274, coarse=93.858)
    """
    return Refined(*library.refine(fine, coarse, ratio, cells), fine, coarse)


def refine(case: Case, figures: Sequence[str] = ("a_max_g", "hic"), spacings: Sequence[str] = (), ratio: float = 2.0,
           **options: Any) -> Refinement:
    """Runs the case as it is and with its spacings times `ratio`, and extrapolates the figures.

    `spacings`: the keys of the case that hold its spacings, numbers, if `geometry.spacing_factor` does not reach them: it multiplies all
    parameters of the pad's geometry with "spacing" in their names, also those that the case does not give. Keys that the case does not have
    are passed over. `options` are those of `Case.run`. Drops that are there are not run again. A drop that is "do not use" is an InputError: its figures cannot be refined.
    """
    if not 1.2 <= ratio <= 4:
        raise InputError(f"ratio: {ratio:g} is outside 1.2 to 4")
    case.require_single("a refinement")
    coarser = {key: ratio * float(case[key]) for key in spacings or [SPACING_FACTOR] if key in case and case[key] is not None}
    if not coarser:
        raise InputError(f"the case has none of the spacings {', '.join(spacings)}")
    other = case.copy()
    other.update(coarser)
    fine, coarse = case.run(**options), other.run(**options)
    made = {}
    for key in figures:
        values = fine.figures[key], coarse.figures[key]
        if not all(isinstance(value, (int, float)) and math.isfinite(value) for value in values):
            raise InputError(f"{key} is not a number in both drops: {values[0]} and {values[1]}")
        made[key] = extrapolate(*values, ratio, fine.figures["cells"] / coarse.figures["cells"])
    for name, drop in (("finer", fine), ("coarser", coarse)):
        if drop.verdict == "do not use":
            raise InputError(f"the {name} drop is not to be used: {'; '.join(drop.verdict.remarks)}")
    return Refinement(made, fine, coarse)
