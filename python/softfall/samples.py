# SPDX-License-Identifier: GPL-3.0-or-later
"""Points in the unit cube, the same for the same seed on every machine: random, Latin hypercubes, Sobol' sequences, Saltelli's samples."""
from __future__ import annotations

from typing import Any

import numpy as np

from .array import Array

METHODS = {"random": "random", "latin_hypercube": "Latin hypercube", "sobol": "Sobol' sequence", "saltelli": "Sobol' sequence, for indices"}
_RANGE = 2 ** 32


class Stream:
    """The Mersenne twister of 32 bits, with the numbers that earlier versions drew from it."""

    def __init__(self, seed: int) -> None:
        self._state = np.random.RandomState(seed if seed else 4357)

    def raw(self, count: int) -> Array:
        return self._state.randint(0, _RANGE, count, dtype=np.uint32).astype(np.int64)

    def uniform(self, count: int) -> Array:
        """Returns numbers above 0 and below 1."""
        found = np.empty(0)
        while len(found) < count:
            more = self.raw(count - len(found))
            found = np.concatenate([found, more[more > 0] / _RANGE])
        return found

    def whole(self, below: int, count: int = 1) -> Array:
        """Returns whole numbers from 0 to `below` - 1, each as likely."""
        scale, found = (_RANGE - 1) // below, np.empty(0, dtype=np.int64)
        while len(found) < count:
            more = self.raw(count - len(found)) // scale
            found = np.concatenate([found, more[more < below]])
        return found

    def shuffled(self, count: int) -> Array:
        order = np.arange(count)
        for last in range(count - 1, 0, -1):
            other = int(self.whole(last + 1)[0])
            order[last], order[other] = order[other], order[last]
        return order


def rows_of(method: str, d: int, count: int) -> int:
    """Returns the rows of a sample.

    >>> rows_of("sobol", 3, 8), rows_of("saltelli", 3, 8)
    (8, 40)
    """
    return count * (d + 2) if method == "saltelli" else count


def _sobol(d: int, count: int, seed: int) -> Array:
    """The sequence from its first point after 0 on; another seed than 1 moves it as a whole (modulo 1; doi:10.1137/0713071)."""
    from scipy.stats import qmc  # a third of a second that most commands do not need
    engine = qmc.Sobol(d, scramble=False)
    engine.fast_forward(1)
    points: Array = engine.random(count)
    if seed != 1:
        points = points + Stream(seed).uniform(d)
        points = np.where(points > 1, points - 1, np.where(points < 1, points, 0.5))
    return points


def points(method: str, d: int, count: int, seed: int) -> Any:
    """Returns the points, a row for each; of saltelli the blocks A, B, then for each coordinate A with that coordinate from B."""
    if method == "sobol":
        return _sobol(d, count, seed)
    if method == "saltelli":
        both = _sobol(2 * d, count, seed)
        a, b = both[:, :d], both[:, d:]
        mixed = [np.where(np.arange(d) == i, b, a) for i in range(d)]
        return np.concatenate([a, b, *mixed])
    stream = Stream(seed)
    if method == "random":
        return stream.uniform(count * d).reshape(count, d)
    columns = []
    for _ in range(d):
        strata = stream.shuffled(count)
        columns.append((strata + stream.uniform(count)) / count)
    return np.stack(columns, axis=1)
