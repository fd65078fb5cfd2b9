# SPDX-License-Identifier: GPL-3.0-or-later
"""Drops of foams for a fit: kept by content, simulated by processes side by side, on three meshes.

A case whose drop is one of a body of revolution on a plate is simulated on the section of its pad, with its spacing; a search takes a coarser mesh of it. Of another case
it takes the section or a coarser mesh, too, where there is one: what the case's own drop says beyond these is a ratio, which changes little from foam to foam and is found
anew when the search has ended.
"""
from __future__ import annotations

import concurrent.futures
import hashlib
import json
import math
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable, Iterable, NamedTuple, Sequence

import numpy as np

from .. import memory
from ..array import Array
from ..errors import Error, InputError, failure
from ..library import GRADES
from ..memory import DropFigures
from ..progress import duration
from ..store import Store
from ..worker import OF_THE_MACHINE, Answer, Pool
from . import work
from .input import KINDS, Drop, Input, Model
from .work import Task

OWN, SECTION, COARSE = "own", "section", "coarse"  # meshes, from that which is told to the cheapest
COARSER = (2.0, 1.5)  # times the spacing, the first that the geometry takes
GRID = [round(0.25e-3 * k, 8) for k in range(161)]  # s after contact, of curves that are shown
_SECTION = ["geometry.model=axisymmetric", "pad.mesh_error_limit=1e6"]


class Outcome(NamedTuple):
    """A drop that has ended: its numbers, or why there are none."""

    figures: dict[str, float]
    grade: int
    verdict: str
    failure: str  # "": none

    def get(self, key: str) -> float:
        value = self.figures.get(key, math.nan)
        return math.nan if value is None else value

    def logs(self) -> Array:
        """Returns ln of the numbers of KINDS; NaN: not defined."""
        values = np.array([self.get(kind.key) for kind in KINDS])
        return np.where(values > 0, np.log(np.where(values > 0, values, 1.0)), math.nan)

    def by_chain(self) -> Array:
        """Returns ln of the numbers of KINDS over those without the accelerometer's chain; 0 where it has none."""
        return np.array([math.log(self.get(kind.key) / self.figures[f"raw_{kind.key}"]) if self.figures.get(f"raw_{kind.key}") else 0.0 for kind in KINDS])

    def shown(self) -> Array:
        """Returns the curve (g) at the times of GRID, of a drop on its own mesh."""
        count = sum(key.startswith("sample_") for key in self.figures)
        return self.samples(count)[count - len(GRID):]

    def samples(self, count: int) -> Array:
        return np.array([self.get(f"sample_{k}") for k in range(count)])


class Wanted(NamedTuple):
    """A drop of a foam on a mesh."""

    drop: Drop
    mesh: str
    model: Model
    values: Array  # of its form
    speed: float  # factor
    chain: list[float]
    bend: Sequence[float] = ()  # of the curve, at BENDS


def _twelve_digits(values: Iterable[float]) -> list[float]:
    return [float(f"{value:.12g}") for value in values]


@dataclass
class Bench:
    """Simulates drops of a fit, each once."""

    given: Input
    folder: Path
    jobs: int
    tell: Callable[[str], None]
    simulated: int = 0
    found: int = 0
    seconds: float = 0.0  # of simulations of this run
    _keys: dict[tuple[str, tuple[str, ...]], str] = field(default_factory=dict)
    _meshes: dict[tuple[str, str], list[str]] = field(default_factory=dict)
    _known: dict[str, tuple[list[DropFigures], str]] = field(default_factory=dict)

    def __enter__(self) -> Bench:
        memory.hold_units()
        self._store = Store(self.folder)
        self._material = self._hash(self.given.material)
        self._pool = Pool(self.jobs, self.folder / "meshes", "softfall.fit.work").__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.__exit__()
        self._store.close()

    def _hash(self, material: Path) -> str:
        """Returns a hash of the start material: its values and its curves."""
        if not self.given.drops:
            return ""
        with memory.Inputs(str(self.given.drops[0].case), [f"material=@{material}"]) as inputs:
            return inputs.key()

    def overrides(self, drop: Drop, mesh: str) -> list[str]:
        """Returns the overrides by which a drop has a mesh: the case's own where a cheaper one does not work."""
        known = self._meshes.get((str(drop.case), mesh))
        if known is None:
            known = self._meshes[(str(drop.case), mesh)] = self._find_mesh(drop, mesh)
        return known

    def refine(self, drop: Drop, mesh: str) -> bool:
        """Gives a drop the next finer mesh in place of one on which it cannot be used; False: there is none."""
        now, section, own = (self.overrides(drop, one) for one in (mesh, SECTION, OWN))
        if now == own:
            return False
        self.set_mesh(drop, mesh, own if now == section else section)
        return True

    def set_mesh(self, drop: Drop, mesh: str, overrides: list[str]) -> None:
        self._meshes[(str(drop.case), mesh)] = overrides

    def _find_mesh(self, drop: Drop, mesh: str) -> list[str]:
        material = f"material=@{self.given.material}"
        factors = [f"geometry.spacing_factor={factor:g}" for factor in COARSER]
        cheaper: dict[str, list[list[str]]] = {OWN: [_SECTION], SECTION: [_SECTION], COARSE: [[*_SECTION, *self.given.coarse], self.given.coarse] if self.given.coarse else
                 [*([*_SECTION, one] for one in factors), _SECTION, *([one, "pad.mesh_error_limit=1e6"] for one in factors)]}
        for overrides in cheaper[mesh]:
            try:
                one = work.built(str(drop.case), (material, *overrides), str(self.folder / "meshes"))
                own = work.built(str(drop.case), (material,), str(self.folder / "meshes")) if self.given.coarse and mesh == COARSE else one
            except Error:
                continue
            alike = ((own.info.thickness, one.info.thickness), (own.info.missile_mass, one.info.missile_mass), (own.info.missile_speed, one.info.missile_speed))
            if all(math.isclose(a, b, rel_tol=0.01) for a, b in alike):
                return [material, *overrides]
            if self.given.coarse and mesh == COARSE:
                raise InputError(f"coarse_set makes another drop of {drop.name}: {1e3 * one.info.thickness:.4g} mm thick, {one.info.missile_mass:.4g} kg and "
                                 f"{one.info.missile_speed:.4g} m/s, in place of {1e3 * own.info.thickness:.4g} mm, {own.info.missile_mass:.4g} kg and "
                                 f"{own.info.missile_speed:.4g} m/s; it is for a coarser mesh of the same drop")
        return [material]

    def _task(self, one: Wanted) -> Task:
        drop, mesh, model = one.drop, one.mesh, one.model
        overrides, case = self.overrides(drop, mesh), str(drop.case)
        inputs = self._keys.get((case, tuple(overrides)))
        if inputs is None:
            with memory.Inputs(case, overrides) as read:
                inputs = self._keys[(case, tuple(overrides))] = read.key()
        samples, channel = (drop.curve.time.tolist(), drop.curve.channel_class) if drop.curve else ([], 1000.0)
        samples = [*samples, *GRID] if mesh == OWN else samples  # for the picture
        rest = ((str(self.given.material), model.form.curve, self.given.solid_density), _twelve_digits(one.values), float(f"{drop.speed * one.speed:.12g}"),
                _twelve_digits(one.chain), samples, drop.number or 1, channel, _twelve_digits(one.bend))
        key = hashlib.sha256(json.dumps([inputs, self._material, rest[0][1:], *rest[1:]]).encode()).hexdigest()[:32]
        return Task(key, case, overrides, *rest)

    def run(self, wanted: Sequence[Wanted]) -> list[Outcome]:
        """Returns the outcomes of drops. What is not known is simulated."""
        tasks = [self._task(one) for one in wanted]
        fresh = {task.key: task for task in tasks if task.key not in self._known}
        for key, entry in self._store.entries(list(fresh)).items():
            if entry.state in ("done", "failed"):
                self._known[key] = (entry.drops, entry.message)
                self.found += 1
                del fresh[key]
        begin = last = time.monotonic()
        futures = [self._pool.start(task) for task in fresh.values()]
        for done, future in enumerate(concurrent.futures.as_completed(futures), 1):
            self._keep(future.result())
            if time.monotonic() - last > 30:
                last = time.monotonic()
                self.tell(f"  {done} of {len(futures)} drops, about {duration((last - begin) / done * (len(futures) - done))} left")
        return [self._outcome(one.drop, task) for one, task in zip(wanted, tasks)]

    def _keep(self, answer: Answer) -> None:
        if answer.code in OF_THE_MACHINE:
            raise Error(f"{answer.message}; finished drops are kept: repeat the command", answer.code)
        if answer.code not in (0, 4, 5):
            raise failure(answer.message, answer.code)
        self.simulated += 1
        self.seconds += answer.seconds
        self._store.finish(answer.key, answer.drops, "", answer.seconds, answer.message)
        self._known[answer.key] = (answer.drops, answer.message)

    def _outcome(self, drop: Drop, task: Task) -> Outcome:
        drops, message = self._known[task.key]
        if message:
            return Outcome({}, 2, message, message)
        one = drops[(drop.number or 1) - 1]
        bad = one.verdict if GRADES[one.grade] == "do not use" else ""
        return Outcome(one.figures, one.grade, one.verdict, bad)
