# SPDX-License-Identifier: GPL-3.0-or-later
"""The process that simulates drops of foams for a fit: a model is built once for each case, and varied in memory."""
from __future__ import annotations

import ctypes as c
import functools
import math
import time
from typing import Any, NamedTuple

import numpy as np

from .. import library, memory, worker
from ..array import Array
from ..curves import STANDARD_GRAVITY
from ..errors import Error
from ..memory import DropFigures
from ..worker import Answer


class Task(NamedTuple):
    """A drop, or all drops of a series, of one foam: values of a form at a speed, as an instrument reads it."""

    key: str
    case: str
    overrides: list[str]
    form: tuple[str, str, float]  # start material, form of the curve, solid density
    values: list[float]
    speed: float  # m/s
    chain: list[float]
    samples: list[float]  # s after contact, of the curve
    sampled: int  # the drop of the series whose curve is read
    channel_class: float
    bend: list[float]  # ln of the stress over that of the form, at BENDS; empty: as the form


KEPT = ("a_max_scatter", "hic_scatter", "max_local_strain", "energy_error", "a_max_mesh_error")  # figures that are kept as they are
BENDS = [round(0.05 + 0.1 * k, 2) for k in range(10)]  # strains


@functools.lru_cache(maxsize=None)
def _form(material: str, curve: str, solid_density: float) -> library.Form:
    return library.Form(material, curve, solid_density)


class _Built:
    """The model of a case in memory, and the intervals of its series."""

    def __init__(self, case: str, overrides: tuple[str, ...], share: str) -> None:
        with memory.Inputs(case, overrides) as inputs:
            self.intervals = inputs.intervals()
            self.handle = inputs.build(share)
        self.info = memory._load().softfall_model_describe(self.handle)


@functools.lru_cache(maxsize=None)
def built(case: str, overrides: tuple[str, ...], share: str) -> _Built:
    """Returns the model of a case, which stays in memory."""
    return _Built(case, overrides, share)


def _history(drop: c.c_void_p) -> tuple[Array, Array]:
    """Returns time (s) and deceleration (g)."""
    columns, values = [], c.POINTER(c.c_double)()
    for name in (b"time", b"acceleration"):
        count = memory._load().softfall_drop_history(drop, name, c.byref(values))
        columns.append(np.ctypeslib.as_array(values, (count,)).copy())
    return columns[0], columns[1] / STANDARD_GRAVITY


def _read(drop: c.c_void_p, task: Task, number: int, thickness: float) -> DropFigures:
    """Returns the figures of a drop with what the fit compares: names of KINDS, the samples of the curve, the indentation over the thickness."""
    made = memory._figures(drop, (*KEPT, "a_max_g", "hic", "hic_t1_ms", "hic_t2_ms", "v_rebound_m_s", "contact_time_ms", "max_indentation_mm"))
    figures = made.figures
    seconds, raw = _history(drop)
    told = {"a_max_g": figures["a_max_g"], "HIC": figures["hic"], "HIC_window_ms": figures["hic_t2_ms"] - figures["hic_t1_ms"],
            "v_rebound_m_s": figures["v_rebound_m_s"], "contact_time_ms": math.nan}
    if math.isfinite(figures["v_rebound_m_s"]):
        told["contact_time_ms"] = 1e3 * float(seconds[min(int(np.flatnonzero(raw)[-1]) + 1, len(raw) - 1)]) - figures["contact_time_ms"]
    kept = {key: figures[key] for key in KEPT}
    told |= {f"raw_{key}": told[key] for key in ("a_max_g", "HIC", "HIC_window_ms")}
    if any(task.chain[k] > 0 for k in (0, 2)) or (task.samples and number == task.sampled):
        read = library.reading(seconds, raw, task.chain, 1000.0)[0]
        contact = library.reading(seconds, raw, task.chain, task.channel_class or 1000.0)[1]
        value, t1, t2 = library.hic(seconds, read, math.inf)
        told |= {"a_max_g": float(read.max()), "HIC": value, "HIC_window_ms": 1e3 * (t2 - t1)}
        if task.samples and number == task.sampled:
            sampled = read if task.channel_class in (0.0, 1000.0) else library.reading(seconds, raw, task.chain, task.channel_class)[0]
            told |= {f"sample_{k}": value for k, value in enumerate(np.interp(contact + np.array(task.samples), seconds, sampled, right=0.0).tolist())}
    told["strain"] = 1e-3 * figures["max_indentation_mm"] / thickness
    return DropFigures({**told, **kept}, made.grade, made.verdict, made.status, made.sure)


def simulate(task: Task, share: str) -> Answer:
    """Simulates a task in this process."""
    begin, lib, drops = time.process_time(), memory._load(), list[DropFigures]()
    variant, made = c.c_void_p(), list[c.c_void_p]()
    try:
        one, foam = built(task.case, tuple(task.overrides), share), _form(*task.form).foam(task.values)
        if task.bend:
            foam.bend(BENDS, task.bend)
        library._call("softfall_model_vary", one.handle, c.byref(memory._Variant(task.speed, 0.0, 0.0, foam.handle)), c.byref(variant))
        for number, interval in enumerate(one.intervals, 1):
            drop = c.c_void_p()
            if number == 1:
                library._call("softfall_drop_create", variant, c.byref(memory._Options(1, 0.0)), c.byref(drop))
            else:
                library._call("softfall_drop_next_of", made[-1], variant, c.c_double(interval), c.byref(drop))
            made.append(drop)
            library._call("softfall_drop_run", drop, None, None, None)
            drops.append(_read(drop, task, number, one.info.thickness))
        return Answer(task.key, drops, "", time.process_time() - begin)
    except Error as error:
        return Answer(task.key, [], "", time.process_time() - begin, str(error), error.code)
    finally:
        for drop in reversed(made):
            lib.softfall_drop_free(drop)
        lib.softfall_model_free(variant)


def main(request: list[Any]) -> Answer:
    """Answers a request of the process that asks."""
    task = Task(*request[0])
    material, curve, solid_density = task.form
    return simulate(task._replace(form=(material, curve, solid_density)), request[1])


if __name__ == "__main__":
    worker.answer(main)
