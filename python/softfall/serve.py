# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall serve: drops over HTTP by the protocol of UM-Bridge, for tools of uncertainty quantification (docs/python.md)."""
from __future__ import annotations

import argparse
import ipaddress
import json
import math
import re
import signal
import socket
import sys
import threading
from typing import Any, Sequence

from . import programs, web
from .case import Case
from .command import Parser, values_of
from .errors import Error, InputError
from .function import Function
from .web import Refusal

MOST_BYTES = 1 << 20  # of a request
MOST_WAITING = 64  # requests that wait for a place
TIME_LIMIT = 3600.0  # s, of a drop
SHOWN = 200  # characters of a value in a sentence


def _shown(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= SHOWN else text[:SHOWN] + "..."


class Server(web.Server):
    """Serves one function; `places` drops are computed at a time."""

    program = "softfall serve"

    def __init__(self, address: tuple[str, int], name: str, function: Function, options: Sequence[str], jobs: int = 1,
                 time_limit: float = TIME_LIMIT) -> None:
        super().__init__(address, Handler)
        self.name, self.function, self.options, self.time_limit = name, function, list(options), time_limit
        self.places, self.waiting = threading.Semaphore(jobs), threading.Semaphore(MOST_WAITING + jobs)
        self.hosts = {"localhost", address[0].lower(), socket.gethostname().lower(), socket.getfqdn().lower()}

    def knows(self, host: str | None) -> bool:
        """Returns whether a request names this server: a page of another name in a browser, which a name server leads here, does not."""
        name = re.sub(r":\d*$", "", host or "").strip("[]").lower()
        try:
            ipaddress.ip_address(name)
            return True
        except ValueError:
            return name in self.hosts

    def answer(self, path: str, request: dict[str, Any]) -> dict[str, Any]:
        """Returns the answer to a POST."""
        if path not in ("/InputSizes", "/OutputSizes", "/ModelInfo", "/Evaluate"):
            known = path in ("/Gradient", "/ApplyJacobian", "/ApplyHessian")
            raise Refusal("UnsupportedFeature" if known else "InvalidInput", f"{path} is not served", 400 if known else 404)
        if request.get("name") != self.name:
            raise Refusal("ModelNotFound", f'there is no model {_shown(request.get("name"))}; there is "{self.name}"')
        if path == "/ModelInfo":
            return {"support": {"Evaluate": True, "Gradient": False, "ApplyJacobian": False, "ApplyHessian": False}}
        values = request.get("config") or {}
        if not isinstance(values, dict) or set(values) - set(self.options):
            raise Refusal("InvalidInput", f"config is {_shown(values)}; its keys may be: {', '.join(self.options) or 'none'}")
        if path == "/InputSizes":
            return {"inputSizes": [len(self.function.inputs)]}
        if path == "/OutputSizes":
            return {"outputSizes": [len(self.function.outputs)]}
        return {"output": [self.evaluate(request.get("input"), values)]}

    def evaluate(self, given: Any, values: dict[str, Any]) -> list[float | None]:
        """Returns the outputs at a list of one list of numbers; None, null of JSON, for NaN."""
        count = len(self.function.inputs)
        if not isinstance(given, list) or len(given) != 1 or not isinstance(given[0], list) or len(given[0]) != count:
            sizes = [len(part) if isinstance(part, list) else None for part in given] if isinstance(given, list) else given
            raise Refusal("InvalidInput", f"input has the sizes {_shown(sizes)}, expected are [{count}]: "
                          f"{', '.join(key for key, _ in self.function.inputs)}")
        for number in given[0]:
            if isinstance(number, bool) or not isinstance(number, (int, float)) or not abs(number) <= sys.float_info.max:
                raise Refusal("InvalidInput", f"input holds {_shown(number)}, which is no finite number")
        point = [float(number) for number in given[0]]
        try:
            found = self._found(point, values)
            return [value if math.isfinite(value) else None for value in map(float, found)]
        except (InputError, TypeError) as error:
            raise Refusal("InvalidInput", str(error)) from error
        except (Error, KeyError) as error:
            raise Refusal("InvalidOutput", str(error.args[0]), 500) from error


    def _found(self, point: list[float], values: dict[str, Any]) -> list[float]:
        """Returns the outputs at a point: at once of a drop that is known, else when there is a place for it."""
        if self.function.is_known(point, values):
            return self.function.evaluate(point, values)
        if not self.waiting.acquire(blocking=False):
            raise Refusal("InvalidOutput", f"{MOST_WAITING} requests wait for a drop already: ask again later, or start softfall serve with more --jobs", 503)
        try:
            with self.places, programs.time_limit(self.time_limit):
                return self.function.evaluate(point, values)
        finally:
            self.waiting.release()


class Handler(web.Handler):
    """One connection of a client."""

    server: Server

    def _send(self, answer: dict[str, Any], status: int = 200) -> None:
        self.send(json.dumps(answer, allow_nan=False).encode(), "application/json", status)

    def refuse(self, refusal: Refusal) -> None:
        """Answers with an error object of UM-Bridge."""
        self._send({"error": {"type": refusal.kind, "message": str(refusal)}}, refusal.status)

    def _check_host(self) -> None:
        if not self.server.knows(self.headers.get("Host")):
            raise self.forbid(f"the request is for the host {_shown(self.headers.get('Host'))}, which this server is not: name it by its address")

    def _read(self) -> dict[str, Any]:
        self._check_host()
        if self.headers.get("Origin"):
            raise self.forbid("requests of web pages (with an Origin) are not served")
        try:
            request = json.loads(self.body(MOST_BYTES))
        except (ValueError, RecursionError) as error:
            raise Refusal("InvalidInput", f"the request is no JSON: {error}") from error
        if not isinstance(request, dict):
            raise Refusal("InvalidInput", "the request is no JSON object")
        return request

    def do_GET(self) -> None:
        try:
            self._check_host()
            if self.path != "/Info":
                raise Refusal("InvalidInput", f"{_shown(self.path)} is not served; GET /Info is", 404)
            self._send({"protocolVersion": 1.0, "models": [self.server.name]})
        except Refusal as refusal:
            self.refuse(refusal)

    def do_POST(self) -> None:
        try:
            self._send(self.server.answer(self.path, self._read()))
        except Refusal as refusal:
            self.refuse(refusal)
        except (ArithmeticError, LookupError, RecursionError, TypeError, UnicodeError, ValueError) as error:
            self.refuse(Refusal("InvalidInput", f"the request cannot be answered: {type(error).__name__}: {_shown(str(error))}"))


def make(o: argparse.Namespace) -> Server:
    """Returns the server of a command line (python/softfall serve.in); a wrong one is an Error or a KeyError."""
    for name, least, most in (("port", 0, 65535), ("jobs", 1, 64)):
        if not least <= getattr(o, name) <= most:
            raise InputError(f"--{name} {getattr(o, name)} is outside {least} to {most}")
    if not o.host.strip():
        raise InputError("--host is empty, which would be every address of this machine: give 127.0.0.1, another address, or 0.0.0.0 for all of them")
    if not 0 < o.time_limit < math.inf:
        raise InputError(f"--time-limit {o.time_limit:g} is not a number of seconds above 0")
    function = Function(Case(o.case, values_of(o.set)), o.input, o.output, o.threads, o.unusable)
    for key in o.option:
        if key not in function.case and not key.startswith("geometry."):
            raise InputError(f"--option {key}: there is no such key of the case")
    try:
        return Server((o.host, o.port), o.name, function, o.option, o.jobs, o.time_limit)
    except (OSError, UnicodeError) as error:
        raise Error(f"cannot listen on {o.host}, port {o.port}: {getattr(error, 'strerror', None) or error}", 3) from None


def parser(prog: str) -> Parser:
    """Returns the command line."""
    made = Parser(prog, "[OPTION...] CASE --input=KEY... --output=FIGURE...",
                  "Serves drops of a case over HTTP by the protocol of UM-Bridge. A request gives\nvalues to the inputs, and the answer has "
                    "the figures of that drop.",
                  "It listens on this machine only unless --host says otherwise; there is no\npassword. Runs are kept in softfall-runs/ of "
               "the present folder and found there\nagain. Ctrl-C or SIGTERM ends it, and the drops that run with a checkpoint.\ndocs/python.md "
               "explains it.")
    add = made.options.add_argument
    made.add_argument("case", metavar="CASE", help=argparse.SUPPRESS)
    add("--host", metavar="NAME", default="127.0.0.1", help="address to listen on (default 127.0.0.1)")
    add("--input", metavar="KEY", action="append", required=True,
        help="a key of the case that a request gives, with its unit: \"missile.velocity [m/s]\"")
    add("--jobs", metavar="N", type=int, default=1, help="drops at a time, 64 at most (default 1)")
    add("--name", metavar="NAME", default="drop", help="name of the model (default drop)")
    add("--option", metavar="KEY", action="append", default=[],
        help="a key of the case that the config of a request may set (default: none)")
    add("--output", metavar="FIGURE", action="append", required=True, help="a figure of summary.json, such as hic")
    add("--port", metavar="N", type=int, default=4242, help="port (default 4242; 0: one that is free)")
    add("--set", metavar="KEY=VALUE", action="append", default=[], help="a value of the case, as of softfall-pre")
    add("--threads", metavar="N", type=int, help="threads of a drop (default: every processor)")
    add("--time-limit", metavar="S", type=float, default=TIME_LIMIT, help="seconds that a drop may take (default 3600)")
    add("--unusable", metavar="raise|nan", choices=["raise", "nan"], default="raise",
        help="answer to a drop that is not to be used: an error (raise, default) or NaN")
    return made


def run(o: argparse.Namespace) -> int:
    """Serves until SIGINT or SIGTERM, and returns the exit code."""
    server = make(o)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: threading.Thread(target=server.shutdown).start())
    host, port = str(server.server_address[0]), server.server_address[1]
    print(f'softfall serve: the model "{server.name}" is at http://{host}:{port}', flush=True)
    server.serve_forever()
    programs.stop_all()
    server.server_close()
    return 0
