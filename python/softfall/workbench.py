# SPDX-License-Identifier: GPL-3.0-or-later
"""The server of the workbench: a page on loopback with a case as a form, its drops and their curves. share/workbench is the page."""
from __future__ import annotations

import hmac
import json
import math
import re
import threading
from pathlib import Path
from typing import Any, Callable
from urllib.parse import parse_qs, unquote, urlsplit

import numpy as np

from . import form, library, output, programs, web
from .case import Case
from .curves import STANDARD_GRAVITY
from .drop import Drop
from .errors import Error, InputError, NumericError
from .web import Refusal
from .workbench_drops import Worker, thin

MOST_BYTES, MOST_FILE = 1 << 20, 1 << 26  # of a request, of a measured file
MOST_RUNS = 60  # earlier ones in the list
MOST_STEPS = 4000  # points of the curve of a run at work
KINDS = {".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css", ".png": "image/png", ".svg": "image/svg+xml"}
POLICY = ("default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
          "frame-ancestors 'none'")
OWN_PAGE = "sandbox allow-scripts allow-downloads allow-popups"  # pages of a drop may not ask the server for anything
FIGURES = ("a_max_g", "a_max_time_ms", "hic", "hic_t1_ms", "hic_t2_ms", "max_indentation_mm", "max_local_strain", "v0_m_s", "v_rebound_m_s", "missile_mass_kg",
           "thickness_mm", "peak_stress_kPa", "prescribed_motion")


def page_folder() -> Path:
    """Returns the folder of the page."""
    folder = programs.folder().parent / "share/softfall/workbench"
    if not (folder / "index.html").is_file():
        raise Error(f"there is no page in {folder}: install softfall whole, or build it (./setup.sh build)", 3)
    return folder


class Job:
    """A run of the case: at work, or the last one."""

    def __init__(self, number: int, values: dict[str, str]) -> None:
        self.number, self.values = number, values  # as texts of the form
        self.state, self.what, self.share, self.left, self.error = "running", "building the model", 0.0, None, ""
        self.id: str | None = None
        self.warnings: list[str] = []
        self.points: list[list[float]] = []

    def told(self) -> dict[str, Any]:
        """Returns what the page shows of it."""
        return dict(vars(self))

    def step(self, step: dict[str, Any]) -> None:
        """Takes progress of the worker."""
        if "point" in step:
            self.points = [*(self.points if len(self.points) < MOST_STEPS else self.points[::2]), step["point"]]
        else:
            self.what, self.share, self.left = step["what"], step["share"], step["left"]


class Workbench:
    """A case with its drops in a folder: what the page asks for, by the names of `answers`."""

    def __init__(self, path: Path, runs: str, threads: int | None) -> None:
        self.path, self.runs, self.threads = path, Path(runs).absolute(), threads
        self.job: Job | None = None
        self._lock = threading.Lock()
        self._runner, self._live = Worker(), Worker()
        self._known: dict[Path, tuple[int, dict[str, Any]]] = {}
        self._thread: threading.Thread | None = None
        self.answers: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
            "case": self.case, "check": self.check, "state": self.state, "drop": self.drop, "run": self.run, "stop": self.stop, "live": self.live, "save": self.save}

    def close(self) -> None:
        """Ends the drop at work with a checkpoint."""
        self._runner.close()
        self._live.close()
        if self._thread:
            self._thread.join(timeout=30)

    def case(self, _: dict[str, Any]) -> dict[str, Any]:
        """Returns the form."""
        case = Case(self.path)
        return {"path": str(self.path), "name": case.name(), "version": library.version().split()[0], "fields": form.fields(case), "sliders": form.sliders(case)}

    def check(self, request: dict[str, Any]) -> dict[str, Any]:
        """Returns the sentences about wrong values by their keys, and the moved values as numbers in the units of the sliders."""
        case = Case(self.path)
        values, wrong = form.judge(case, _texts(request))
        if wrong:
            return {"wrong": wrong}
        case.update(values)
        return {"wrong": {}, "found": self._found(case), "sliders": {slider["key"]: slider["value"] for slider in form.sliders(case)}}

    def _found(self, case: Case) -> str | None:
        """Returns the name of the drop of a case, also of one that failed; None: it has not been run."""
        try:
            drop = case.find(self.runs)
            return drop.results.parent.name if drop else None
        except NumericError as error:
            return Path(error.results).parent.name if error.results else None

    def _right(self, request: dict[str, Any]) -> dict[str, str]:
        values, wrong = form.judge(Case(self.path), _texts(request))
        if wrong:
            raise InputError("; ".join(wrong.values()))
        return values

    def state(self, _: dict[str, Any]) -> dict[str, Any]:
        """Returns the run at work and the drops that are there."""
        job = self.job
        return {"job": job.told() if job else None, "runs": self.list(), "changed": self._content()}

    def _content(self) -> str:
        """Returns what changes with the case, its curves and its geometries."""
        try:
            return str(library.case_hash(str(self.path), []))
        except Error as error:
            return str(error)

    def run(self, request: dict[str, Any]) -> dict[str, Any]:
        """Starts a drop of the case with values."""
        values, texts = self._right(request), _texts(request)
        with self._lock:
            if self.job and self.job.state in ("running", "stopping"):
                raise InputError("a drop is at work already: stop it, or wait for it")
            self.job = Job(self.job.number + 1 if self.job else 1, texts)
            self._thread = threading.Thread(target=self._work, args=(self.job, values), daemon=True)
            self._thread.start()
            return {"number": self.job.number}

    def _work(self, job: Job, values: dict[str, str]) -> None:
        try:
            answer = self._runner.ask({"do": "run", "path": str(self.path), "values": values, "runs": str(self.runs), "threads": self.threads}, job.step)
            job.id, job.warnings, job.error = answer.get("id"), answer.get("warnings", []), answer.get("error", "")
            state = "stopped" if answer.get("stopped") else "failed" if job.error else "done"
        except Exception as error:  # whatever it is, the page may run again
            job.error, state = str(error), "failed"
        with self._lock:
            job.state = state

    def stop(self, _: dict[str, Any]) -> dict[str, Any]:
        """Stops the run at work; the same run goes on from there."""
        with self._lock:
            job = self.job
            if not job or job.state != "running":
                return {}
            job.state = "stopping"
        self._runner.stop()
        return {}

    def live(self, request: dict[str, Any]) -> dict[str, Any]:
        """Returns figures and curve of the axisymmetric drop of the case with values."""
        mesh = "fine" if request.get("mesh") == "fine" else "coarse"
        return self._live.ask({"do": "live", "path": str(self.path), "values": _texts(request), "mesh": mesh})

    def save(self, request: dict[str, Any]) -> dict[str, Any]:
        """Makes a folder with the case and its values, which runs as it stands."""
        name = str(request.get("folder", "")).strip()
        if not re.fullmatch(r"\w[\w.-]*(/\w[\w.-]*)*", name) or ".." in name.split("/"):
            raise InputError(f'"{name}" is no name of a folder here, such as my-pad: letters, digits, dots and dashes')
        settings = [f"--set={key}={text}" for key, text in self._right(request).items()]
        programs.run("new", [name, f"--from={self.path}", *settings])
        return {"folder": str(Path(name).absolute())}

    def measured(self, name: str, data: bytes) -> dict[str, Any]:
        """Returns the curve and the figures of a measured file."""
        safe = re.sub(r"[^\w.-]", "_", Path(name).name)[-80:].lstrip(".") or "measured.csv"
        with output.scratch() as folder:
            (folder / safe).write_bytes(data)
            try:
                answer = self._live.ask({"do": "measured", "path": str(folder / safe)})
            except Error as error:
                raise InputError(str(error).replace(f"{folder}/", "")) from None
            return {"name": name, **json.loads(json.dumps(answer).replace(f"{folder}/", ""))}

    def folder(self, name: Any) -> Path:
        """Returns the folder of a drop."""
        place = self.runs / str(name)
        if not re.fullmatch(r"[\w.-]+", str(name)) or str(name).startswith(".") or place.is_symlink() or not (place / "results.h5").is_file():
            raise InputError(f"there is no drop {str(name)[:100]!r} in {self.runs}")
        return place

    def list(self) -> list[dict[str, Any]]:
        """Returns the drops that are there, the latest first."""
        found = []
        for path in self.runs.glob("*/out/summary.json"):
            try:
                if path.parents[1].is_symlink():
                    continue
                stamp = path.stat().st_mtime_ns
                if self._known.get(path, (0,))[0] != stamp:
                    told = json.loads(output.read(path))
                    short = {key: told.get(key) for key in FIGURES}
                    self._known[path] = stamp, {"id": path.parents[1].name, "when": stamp // 1000000000, "grade": told["verdict"]["grade"], **short}
                found.append(self._known[path][1])
            except (Error, OSError, ValueError, KeyError, TypeError):
                continue
        return sorted(found, key=lambda run: int(run["when"]), reverse=True)[:MOST_RUNS]

    def drop(self, request: dict[str, Any]) -> dict[str, Any]:
        """Returns verdict, figures and curve of a drop."""
        folder = self.folder(request.get("id"))
        drop = Drop(folder / "results.h5", folder / "out", own=True)
        summary, verdict = drop.summary, drop.verdict
        answer = {"id": folder.name, "grade": str(verdict), "remarks": verdict.remarks, "limits": verdict.limits,
                  "figures": {key: _finite(summary.get(key)) for key in FIGURES}, "view": (folder / "out/view.html").is_file()}
        if summary["prescribed_motion"]:
            return {**answer, "curve": {"t": [], "g": []}}
        seconds, filtered = drop.curve()
        contact = seconds >= min(0.0, float(drop.history["time"][0]))
        return {**answer, "curve": thin(np.asarray(seconds)[contact], np.asarray(filtered)[contact]), "cfc": summary["cfc"], "gravity": STANDARD_GRAVITY}

    def scene(self, name: str) -> bytes:
        """Returns the frames of a drop as softfall-post wrote them into view.html: JSON."""
        path = self.folder(name) / "out/view.html"
        text = output.read(path)
        begin = text.find(b'id="drop">')
        if begin < 0:
            raise InputError(f"there are no frames in {path}")
        return text[begin + 10:text.index(b"</script>", begin)]


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _texts(request: dict[str, Any]) -> dict[str, str]:
    """Returns the values of a request: texts by keys."""
    values = request.get("values", {})
    if not isinstance(values, dict) or not all(isinstance(text, str) and re.fullmatch(r"[\w.-]+", key) for key, text in values.items()):
        raise Refusal("InvalidInput", "values is no object of texts by the keys of the case")
    return {key: text for key, text in values.items()}


class Server(web.Server):
    """Serves the page of one workbench to whoever has its token."""

    program = "softfall open"

    def __init__(self, port: int, workbench: Workbench, token: str) -> None:
        super().__init__(("127.0.0.1", port), Handler)
        self.workbench, self.token, self.page = workbench, token, page_folder()
        self.port = int(self.server_address[1])
        self.address = f"http://127.0.0.1:{self.port}/?token={token}"
        self.names = {f"127.0.0.1:{self.port}", f"localhost:{self.port}"}
        self.cookie = f"softfall-{self.port}"


class Handler(web.Handler):
    """One connection of a browser."""

    server: Server

    def log_message(self, format: str, *args: Any) -> None:
        """Says nothing of single requests."""

    def refuse(self, refusal: Refusal) -> None:
        """Answers with a sentence."""
        self._answer({"error": str(refusal)}, refusal.status)

    def send(self, body: bytes, kind: str, status: int = 200, headers: dict[str, str] | None = None) -> None:
        """Sends an answer with the headers that keep other pages away."""
        safe = {"Content-Security-Policy": POLICY, "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cache-Control": "no-cache",
                "Cross-Origin-Resource-Policy": "same-origin"}
        super().send(body, kind, status, {**safe, **(headers or {})})

    def _answer(self, answer: dict[str, Any], status: int = 200) -> None:
        self.send(json.dumps(answer).encode(), "application/json", status)

    def _admit(self) -> bool:
        """Refuses requests for another host, from another page, and without the token; returns whether the token is in the address."""
        server = self.server
        if self.headers.get("Host", "").lower() not in server.names:
            raise self.forbid("the request is for another host than this server")
        origin = self.headers.get("Origin")
        if origin is not None and origin.lower() not in {f"http://{name}" for name in server.names}:
            raise self.forbid("requests of other pages are not served")
        given = parse_qs(urlsplit(self.path).query).get("token", [""])[0]
        cookies = dict(part.strip().partition("=")[::2] for part in self.headers.get("Cookie", "").split(";"))
        for text, in_address in ((given, True), (cookies.get(server.cookie, ""), False)):
            if hmac.compare_digest(text.encode(), server.token.encode()):
                return in_address
        raise self.forbid("the token is missing or of an earlier server: open the address that `softfall open` has printed")

    def _respond(self, work: Callable[[], None]) -> None:
        try:
            work()
        except Refusal as refusal:
            self.refuse(refusal)
        except (InputError, KeyError) as error:
            self.refuse(Refusal("InvalidInput", str(error.args[0]), 400))
        except Error as error:
            self.refuse(Refusal("Failure", str(error), 500))
        except OSError as error:
            self.refuse(Refusal("Failure", f"{error.filename}: {error.strerror}" if error.filename else str(error), 500))
        except (ArithmeticError, LookupError, RecursionError, TypeError, ValueError) as error:
            self.refuse(Refusal("InvalidInput", f"the request cannot be answered: {type(error).__name__}", 400))

    def do_GET(self) -> None:
        self._respond(self._get)

    def _get(self) -> None:
        path = unquote(urlsplit(self.path).path)
        if self._admit():
            cookie = f"{self.server.cookie}={self.server.token}; HttpOnly; SameSite=Lax; Path=/"
            self.send(b"", "text/plain", 303, {"Location": "/", "Set-Cookie": cookie})
            return
        self.watch.cancel()
        name = "index.html" if path == "/" else path[1:]
        found = re.fullmatch(r"runs/([\w.-]+)/(\w[\w.-]*\.(?:html|png|svg))", name)
        if found:
            place = self.server.workbench.folder(found[1]) / "out" / found[2]
            self._file(place, {"Content-Security-Policy": OWN_PAGE})
        elif scene := re.fullmatch(r"scene/([\w.-]+)", name):
            self.send(self.server.workbench.scene(scene[1]), "application/json")
        elif re.fullmatch(r"\w[\w.-]*", name) and Path(name).suffix in KINDS:
            self._file(self.server.page / name, {})
        else:
            raise Refusal("InvalidInput", "there is no such page", 404)

    def _file(self, place: Path, headers: dict[str, str]) -> None:
        if not place.is_file():
            raise Refusal("InvalidInput", f"there is no file {place.name}", 404)
        self.send(output.read(place), KINDS[place.suffix], 200, headers)

    def do_POST(self) -> None:
        self._respond(self._post)

    def _post(self) -> None:
        self._admit()
        address = urlsplit(self.path)
        word = address.path.removeprefix("/api/")
        if word == "measured":
            name = parse_qs(address.query).get("name", ["measured.csv"])[0]
            self._answer(self.server.workbench.measured(name, self.body(MOST_FILE)))
            return
        answer = self.server.workbench.answers.get(word)
        if answer is None:
            self.close_connection = True  # its body is not read
            raise Refusal("InvalidInput", "there is no such request", 404)
        try:
            request = json.loads(self.body(MOST_BYTES) or b"{}")
        except (ValueError, RecursionError):
            raise Refusal("InvalidInput", "the request is no JSON") from None
        if not isinstance(request, dict):
            raise Refusal("InvalidInput", "the request is no JSON object")
        self._answer(answer(request))
