# SPDX-License-Identifier: GPL-3.0-or-later
"""A drop as a plain function of numbers, for SciPy, OpenTURNS, Dakota and the like."""
from __future__ import annotations

import math
import os
import re
from typing import Any, Mapping, Sequence

import numpy as np

from . import library
from .case import Case
from .drop import Drop
from .errors import Error, InputError, NumericError, find, missing
from .run_keys import defined, includes


class Function:
    """A function f(x) -> y of a case; `function` makes it.

    `inputs` are pairs of key and unit, `outputs` the keys of the figures. It may be called by several threads.
    """

    def __init__(self, case: Case, inputs: Sequence[str] | Mapping[str, str], outputs: str | Sequence[str],
                 threads: int | None = None, unusable: str = "raise") -> None:
        if unusable not in ("raise", "nan"):
            raise InputError(f'unusable: {unusable!r} is neither "raise" nor "nan"')
        names = [f"{key} [{unit}]" for key, unit in inputs.items()] if isinstance(inputs, Mapping) else \
            [inputs] if isinstance(inputs, str) else list(inputs)
        self.case, self.threads, self.unusable = case.copy(), threads, unusable
        self.inputs = [_input(self.case, name) for name in names]
        self.scalar = isinstance(outputs, str)
        self.outputs = [outputs] if isinstance(outputs, str) else list(outputs)
        if not self.inputs or not self.outputs:
            raise InputError("a function needs one input and one output at least")
        self._known: dict[tuple[Any, ...], Drop | NumericError] = {}

    def is_known(self, x: Any, values: Mapping[str, Any] | None = None) -> bool:
        """Returns whether the drop at x has been computed by this function."""
        return tuple(sorted(self._at(x, values).overrides.items())) in self._known

    def _at(self, x: Any, values: Mapping[str, Any] | None) -> Case:
        """Returns the case at x."""
        point = np.atleast_1d(np.asarray(x, dtype=float))
        if point.shape != (len(self.inputs),):
            raise InputError(f"x has the shape {point.shape}; {len(self.inputs)} numbers are expected: "
                             f"{', '.join(key for key, _ in self.inputs)}")
        if not np.isfinite(point).all():
            raise InputError(f"x is {point.tolist()}: not all of it is finite")
        case = self.case.copy()
        case.update({**(values or {}), **{key: f"{number!r} {unit}" if unit else number
                                          for (key, unit), number in zip(self.inputs, point.tolist())}})
        case.require_single("a function")
        return case

    def drop(self, x: Any, values: Mapping[str, Any] | None = None) -> Drop:
        """Returns the drop at x, a number for each input; `values`: further values of the case."""
        case = self._at(x, values)
        name = tuple(sorted(case.overrides.items()))
        if name not in self._known:
            try:
                self._known[name] = case.run(threads=self.threads)
            except NumericError as error:
                self._known[name] = error
        known = self._known[name]
        if isinstance(known, NumericError):
            raise known
        return known

    def evaluate(self, x: Any, values: Mapping[str, Any] | None = None) -> list[float]:
        """Returns the outputs at one x as a list."""
        try:
            drop = self.drop(x, values)
            figures, verdict = drop.figures, drop.verdict
            unknown = [key for key in self.outputs if key not in figures or isinstance(figures[key], str)]
            if unknown:
                raise missing("figure with a number", unknown[0], (key for key in figures if not isinstance(figures[key], str)))
            if verdict == "do not use":
                raise NumericError(f"the drop at {np.asarray(x).tolist()} is not to be used: {'; '.join(verdict.remarks)}", 5)
        except NumericError:
            if self.unusable == "nan":
                return [math.nan] * len(self.outputs)
            raise
        found = [float(figures[key]) for key in self.outputs]
        if self.unusable == "raise" and not all(map(math.isfinite, found)):
            raise Error(f"the drop at {np.asarray(x).tolist()} does not define "
                        f"{', '.join(key for key, value in zip(self.outputs, found) if not math.isfinite(value))}", 5)
        return found

    def __call__(self, x: Any, values: Mapping[str, Any] | None = None) -> Any:
        """Returns the outputs at x: a float if `outputs` was one text, else an array; of a matrix of points a row for each."""
        if np.ndim(x) == 2:
            return np.array([self(row, values) for row in x])
        found = self.evaluate(x, values)
        return found[0] if self.scalar else np.array(found)


def _input(case: Case, name: str) -> tuple[str, str]:
    """Returns key and unit of "key [unit]"; KeyError if the case has no such key (a parameter of a geometry may not be given)."""
    found = re.fullmatch(r"\s*([\w.-]+)\s*(?:\[\s*([^]]*?)\s*\])?\s*", name)
    if not found:
        raise InputError(f'"{name}" is no input such as "missile.velocity [m/s]"')
    key, unit = found[1], found[2] or ""
    if re.match(r"geometry\.(missile_)?parameters\.", key):
        known = set(case) | defined(case)
        if key not in known and not includes(case) and any(name.startswith(key.rpartition(".")[0] + ".") for name in known):
            raise missing("parameter of the geometry", key, sorted(name for name in known if ".parameters." in name or ".missile_parameters." in name))
        if unit:
            raise InputError(f'"{name}": {key} is a number without a unit, in that of its geometry')
        return key, unit
    value = find(case, "key of the case", key)
    if isinstance(value, bool) or not isinstance(value, (int, float, str, type(None))):
        raise InputError(f'"{name}": {key} = {value!r} is no number that could be an input')
    _check_unit(name, key, value, unit)
    return key, unit


def _check_unit(name: str, key: str, value: int | float | str | None, unit: str) -> None:
    """Refuses an input that is no number, or has a unit of another kind than the value of the case."""
    if isinstance(value, (int, float)):
        if unit:
            raise InputError(f'"{name}": {key} = {value!r} is a number without a unit: leave [{unit}] out')
        return
    kind = library.quantity(f"1 {unit}")[1] if unit else ""
    try:
        own = library.quantity(value)[1] if value is not None else kind
    except InputError:
        raise InputError(f'"{name}": {key} = {value!r} is no number that could be an input') from None
    if own != kind:
        raise InputError(f'"{name}": {key} = {value!r} has a unit of another kind: write "{key} [{value.partition(" ")[2] if value else own}]"')


def function(case: Case | str | os.PathLike[str], inputs: Sequence[str] | Mapping[str, str], outputs: str | Sequence[str], threads: int | None = None,
             unusable: str = "raise") -> Function:
    """Returns f(x) -> y: a drop of the case, or of a case file, with the inputs at x, and figures of it.

    `inputs`: keys with their unit, ["missile.velocity [m/s]", "geometry.parameters.thickness"]; `outputs`: keys of figures, or one
    key for a function that returns a float. A drop is computed once for each x, also in later processes (`softfall-runs/`).
    `unusable`: a drop that fails, or that is not to be used, raises NumericError ("raise"), or gives NaN ("nan").
    """
    return Function(case if isinstance(case, Case) else Case(case), inputs, outputs, threads, unusable)
