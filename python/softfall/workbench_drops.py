# SPDX-License-Identifier: GPL-3.0-or-later
"""The process behind a page: it runs drops and reads measured files, so that a crash or a long run leaves the page as it is.

`python3 -m softfall.workbench_drops` takes requests as lines of JSON and answers each with lines of JSON: {"began": true}, {"step": ...} while it is at work, then
{"answer": ...} or {"error": sentence}. SIGINT ends the request at work, the end of its input the process; a drop then ends with a checkpoint.
"""
from __future__ import annotations

import json
import math
import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path
from typing import Any, Callable

import numpy as np

from . import curves, form, library, memory, record, run_command, run_keys
from .case import Case, Step
from .errors import Error, InputError, NumericError
from .progress import Bar

SPACING = {"coarse": 0.01, "fine": 0.005}  # m, of the axisymmetric drops that answer while a slider moves, and when it rests
LIVE_FIGURES = ("a_max_g", "hic", "hic_t1_ms", "hic_t2_ms", "max_indentation_mm", "v_rebound_m_s")
THICKNESS = (0.7, 1.4)  # bounds of a thickness over that of the model whose mesh is scaled to it
MOST_MODELS = 8
MOST_POINTS = 400  # of a curve of an answer
STARTS_WITHIN = 30.0  # s, a request that is to be stopped
_INTERRUPT = {signal.SIGINT}


def thin(time: Any, value: Any) -> dict[str, list[float]]:
    """Returns a curve with few of its points, its largest and smallest among them: time in ms, deceleration in g."""
    if not len(time):
        return {"t": [], "g": []}
    chosen = np.unique(np.concatenate([np.linspace(0, len(time) - 1, min(len(time), MOST_POINTS)).astype(int), [np.argmax(value), np.argmin(value)]]))
    return {"t": np.round(1e3 * np.asarray(time)[chosen], 4).tolist(), "g": np.round(np.asarray(value)[chosen], 3).tolist()}


class Live:
    """Axisymmetric drops in memory: models are built once for each mesh, and varied."""

    def __init__(self) -> None:
        self._models: dict[tuple[Any, ...], memory.Model] = {}

    def answer(self, path: str, values: dict[str, str], mesh: str) -> dict[str, Any]:
        """Returns figures and curve of the drop of a case with texts of the form, on one of the meshes of SPACING."""
        began = time.monotonic()
        case = Case(path, {**form.as_case(path, values), "geometry.model": "axisymmetric", "pad.mesh_error_limit": "1e6"})
        case.require_single("a live answer")
        if case["missile.motion"] is not None:
            raise InputError("the missile has a prescribed motion: a live answer needs one that falls")
        unit, spacing = form.length_unit(case), self._value(case, "fine_spacing")
        factor = SPACING[mesh] / (spacing * unit) if spacing else (2 if mesh == "coarse" else 1) * float(case["geometry.spacing_factor"])
        overrides = {**case.overrides, "geometry.spacing_factor": f"{min(10.0, max(0.1, factor)):.9g}"}
        texts = [f"{key}={text}" for key, text in overrides.items()]
        thickness = self._value(case, "thickness") * unit
        before = len(self._models)
        model, thickness = self._model(case, overrides, thickness)
        figures, seconds, acceleration = model.drop(path, texts, thickness, own_foam=not form.has_layers(case))
        filtered = curves.cfc(seconds, acceleration / curves.STANDARD_GRAVITY)
        return {"figures": {key: figures[key] if math.isfinite(figures[key]) else None for key in LIVE_FIGURES}, "curve": thin(seconds, filtered),
                "mesh": mesh, "spacing_mm": 1e3 * SPACING[mesh] if spacing else None, "nodes": model.nodes, "built": len(self._models) != before, "seconds": round(time.monotonic() - began, 3)}

    @staticmethod
    def _value(case: Case, name: str) -> float:
        """Returns the value of a parameter of the pad's geometry in its unit; 0: it has none of that name."""
        key = f"geometry.parameters.{name}"
        value = case.get(key)
        constant = run_keys.constants(case).get(key)
        try:
            return float(value if value is not None else constant.default if constant else 0)
        except ValueError:
            return 0.0

    def _model(self, case: Case, overrides: dict[str, str], thickness: float) -> tuple[memory.Model, float]:
        """Returns a model of the mesh of a case, and the thickness to scale it to, 0: none, as where the parameter is not that of the pad."""
        varied = ("missile.velocity", "missile.mass", "geometry.parameters.thickness")
        foam = () if form.has_layers(case) else ("material.", "pad.stress_factor")  # varied, too
        rest = tuple(sorted((key, text) for key, text in overrides.items() if key not in varied and not key.startswith(foam)))
        files = tuple((case.path.parent / str(case.get(key) or "")).stat().st_mtime_ns for key in ("geometry.file", "geometry.missile_file"))
        content = library.case_hash(str(case.path), [f"{key}={text}" for key, text in rest])  # of included files, too
        name = (case.path, case.path.stat().st_mtime_ns, (*files, content), rest)
        for known, model in self._models.items():
            if known[:4] == name and (THICKNESS[0] <= thickness / model.thickness <= THICKNESS[1] if known[5] else thickness == known[4]):
                return model, thickness if known[5] else 0
        while len(self._models) >= MOST_MODELS:
            del self._models[next(iter(self._models))]
        made = memory.Model(str(case.path), [f"{key}={text}" for key, text in overrides.items()])
        is_of_pad = thickness > 0 and math.isclose(made.thickness, thickness, rel_tol=1e-6)
        self._models[(*name, thickness, is_of_pad)] = made
        return made, thickness if is_of_pad else 0


class _Progress(Bar):
    """A progress bar whose state is told as it changes."""

    def __init__(self, tell: Callable[[dict[str, Any]], None]) -> None:
        super().__init__(quiet=True)
        self._tell = tell

    def show(self, what: str, share: float, left: float | None = None, detail: str = "") -> None:
        """Tells the work at hand."""
        super().show(what, share, left, detail)
        self._tell({"what": what, "share": round(self._share, 4), "left": left})


def _plain(sentence: str) -> str:
    """Returns a sentence without the program that said it."""
    return re.sub(r"^softfall-\w+: ", "", sentence)


def _run(request: dict[str, Any], tell: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
    """Runs a drop to its pages, and returns the name of its folder."""
    def watch(step: Step) -> None:
        tell({"point": [1e3 * step.time, step.load]})

    case = Case(request["path"], request["values"])
    try:
        drop = run_command.simulate(case, request["runs"], request["threads"], _Progress(tell), watch)
        return {"id": drop.results.parent.name}
    except NumericError as error:
        return {"error": _plain(str(error)), "id": Path(error.results).parent.name if error.results else None}


def _measured(request: dict[str, Any]) -> dict[str, Any]:
    """Reads a measured file."""
    read = record.read_record(request["path"])
    figures = {key: value if math.isfinite(value) else None for key, value in read.figures.items()}
    return {"figures": figures, "curve": thin(read.time, read.deceleration), "verdict": str(read.verdict), "remarks": read.verdict.remarks,
            "interpretation": read.interpretation}


def _answer(work: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Does the work of a request, during which SIGINT is heard; it is blocked at all other times."""
    heard: list[str] = []
    try:
        while signal.sigtimedwait(_INTERRUPT, 0):  # one that came after the end of an earlier request
            pass
        with warnings.catch_warnings():
            warnings.simplefilter("always")
            warnings.showwarning = lambda message, *_, **__: heard.append(str(message))
            try:
                signal.pthread_sigmask(signal.SIG_UNBLOCK, _INTERRUPT)
                made = work()
            finally:
                signal.pthread_sigmask(signal.SIG_BLOCK, _INTERRUPT)
        return {"answer": {**made, "warnings": [_plain(sentence) for sentence in dict.fromkeys(heard)]}}
    except KeyboardInterrupt:
        return {"answer": {"stopped": True}}
    except (Error, KeyError) as error:
        return {"error": _plain(str(error.args[0]))}
    except OSError as error:
        return {"error": f"{error.filename}: {error.strerror}"}
    except Exception as error:  # the page tells of a mistake as of any failure
        return {"error": f"{type(error).__name__}: {error}; this is a mistake of softfall: report it with the case"}


def main() -> None:
    """Answers requests until the input ends."""
    signal.pthread_sigmask(signal.SIG_BLOCK, _INTERRUPT)
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what a library prints is no answer
    lines: queue.Queue[str | None] = queue.Queue()
    live = Live()

    def read() -> None:
        for line in sys.stdin:
            lines.put(line)
        lines.put(None)
        os.kill(os.getpid(), signal.SIGINT)  # nobody is left who waits for the answer

    def tell(said: dict[str, Any]) -> None:
        out.write(json.dumps(said) + "\n")
        out.flush()

    def work(request: dict[str, Any]) -> dict[str, Any]:
        if request["do"] == "live":
            return live.answer(request["path"], request["values"], request["mesh"])
        return _measured(request) if request["do"] == "measured" else _run(request, lambda step: tell({"step": step}))

    threading.Thread(target=read, daemon=True).start()
    try:
        while (line := lines.get()) is not None:
            request = json.loads(line)
            tell({"began": True})
            tell(_answer(lambda: work(request)))
    except (BrokenPipeError, KeyboardInterrupt):  # the server has gone; a thread of the library may hear SIGINT at any time
        os.dup2(os.open(os.devnull, os.O_WRONLY), out.fileno())


class Worker:
    """The process as the server sees it; it is started when it is needed, and again after it has ended."""

    def __init__(self) -> None:
        self._lock, self._began = threading.Lock(), threading.Event()
        self._child: subprocess.Popen[str] | None = None

    def ask(self, request: dict[str, Any], on_step: Callable[[dict[str, Any]], None] | None = None) -> dict[str, Any]:
        """Returns the answer; {"stopped": True} after `stop`. What the worker refuses is an Error with its sentence."""
        with self._lock:
            if self._child is None or self._child.poll() is not None:
                self._child = self._start()
            try:
                return self._converse(self._child, request, on_step)
            finally:
                self._began.clear()

    @staticmethod
    def _start() -> subprocess.Popen[str]:
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, _INTERRUPT)  # which the child inherits: it hears SIGINT when it is at work
        try:
            return subprocess.Popen([sys.executable, "-m", "softfall.workbench_drops"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                    start_new_session=True, env={**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[1])})
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)

    def _converse(self, child: subprocess.Popen[str], request: dict[str, Any], on_step: Callable[[dict[str, Any]], None] | None) -> dict[str, Any]:
        said: dict[str, Any] = {}
        try:
            assert child.stdin and child.stdout
            child.stdin.write(json.dumps(request) + "\n")
            child.stdin.flush()
            for line in child.stdout:
                said = json.loads(line)
                if "began" in said:
                    self._began.set()
                elif "step" not in said:
                    break
                elif on_step:
                    on_step(said["step"])
            else:
                raise BrokenPipeError
        except (BrokenPipeError, ValueError):
            raise Error(f"the process of the drop has ended by itself ({child.wait()}); the next request starts it again", 70) from None
        if "error" in said:
            raise InputError(said["error"])
        return dict(said["answer"])

    def stop(self) -> None:
        """Ends the request at work; a drop keeps its checkpoint."""
        child = self._child
        if self._began.wait(STARTS_WITHIN) and child and child.poll() is None:
            child.send_signal(signal.SIGINT)

    def close(self) -> None:
        """Ends the process."""
        child = self._child
        if child and child.poll() is None and child.stdin:
            child.stdin.close()
            try:
                child.wait(timeout=30)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()


if __name__ == "__main__":
    main()
