# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall serve: drops over HTTP by the protocol of UM-Bridge, for tools of uncertainty quantification (docs/python.md)."""
from __future__ import annotations

import argparse
import json
import math
import signal
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Sequence

from . import programs
from .case import Case
from .command import Parser
from .errors import Error, InputError
from .function import Function

MOST_BYTES = 1 << 20  # of a request
PATIENCE = 60  # s for the bytes of a request


class Refusal(Exception):
    """A request that is answered with an error object: its type and sentence."""

    def __init__(self, kind: str, sentence: str, status: int = 400) -> None:
        super().__init__(sentence)
        self.kind, self.status = kind, status


class Server(ThreadingHTTPServer):
    """Serves one function; `places` drops are computed at a time."""

    daemon_threads = True

    def __init__(self, address: tuple[str, int], name: str, function: Function, options: Sequence[str], jobs: int = 1) -> None:
        super().__init__(address, Handler)
        self.name, self.function, self.options = name, function, list(options)
        self.places = threading.Semaphore(jobs)

    def answer(self, path: str, request: dict[str, Any]) -> dict[str, Any]:
        """Returns the answer to a POST."""
        if path not in ("/InputSizes", "/OutputSizes", "/ModelInfo", "/Evaluate"):
            known = path in ("/Gradient", "/ApplyJacobian", "/ApplyHessian")
            raise Refusal("UnsupportedFeature" if known else "InvalidInput", f"{path} is not served", 400 if known else 404)
        if request.get("name") != self.name:
            raise Refusal("ModelNotFound", f'there is no model {json.dumps(request.get("name"))}; there is "{self.name}"')
        if path == "/ModelInfo":
            return {"support": {"Evaluate": True, "Gradient": False, "ApplyJacobian": False, "ApplyHessian": False}}
        values = request.get("config") or {}
        if not isinstance(values, dict) or set(values) - set(self.options):
            raise Refusal("InvalidInput", f"config is {json.dumps(values)}; its keys may be: {', '.join(self.options) or 'none'}")
        if path == "/InputSizes":
            return {"inputSizes": [len(self.function.inputs)]}
        if path == "/OutputSizes":
            return {"outputSizes": [len(self.function.outputs)]}
        return {"output": [self.evaluate(request.get("input"), values)]}

    def evaluate(self, given: Any, values: dict[str, Any]) -> list[float]:
        """Returns the outputs at a list of one list of numbers."""
        count = len(self.function.inputs)
        if not isinstance(given, list) or len(given) != 1 or not isinstance(given[0], list) or len(given[0]) != count:
            sizes = [len(part) if isinstance(part, list) else None for part in given] if isinstance(given, list) else given
            raise Refusal("InvalidInput", f"input has the sizes {json.dumps(sizes)}, expected are [{count}]: "
                          f"{', '.join(key for key, _ in self.function.inputs)}")
        for number in given[0]:
            if isinstance(number, bool) or not isinstance(number, (int, float)) or not math.isfinite(number):
                raise Refusal("InvalidInput", f"input holds {json.dumps(number)}, which is no finite number")
        try:
            with self.places:
                return [float(value) for value in self.function.evaluate(given[0], values)]
        except (InputError, TypeError) as error:
            raise Refusal("InvalidInput", str(error)) from error
        except (Error, KeyError) as error:
            raise Refusal("InvalidOutput", str(error.args[0]), 500) from error


class Handler(BaseHTTPRequestHandler):
    """One connection of a client."""

    server: Server
    protocol_version = "HTTP/1.1"
    timeout = PATIENCE

    def log_message(self, format: str, *args: Any) -> None:
        sys.stderr.write(f"softfall serve: {self.log_date_time_string()} {format % args}\n")

    def version_string(self) -> str:
        return "softfall serve"

    def _send(self, answer: dict[str, Any], status: int = 200) -> None:
        body = json.dumps(answer).encode()
        try:
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(body)))
            if self.close_connection:
                self.send_header("Connection", "close")
            self.end_headers()
            self.wfile.write(body)
        except (BrokenPipeError, ConnectionResetError):  # the client has gone; the drop stays in softfall-runs/
            self.close_connection = True

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        self.close_connection = True
        self._refuse(Refusal("InvalidInput", message or f"status {code}", code))

    def _refuse(self, refusal: Refusal) -> None:
        self._send({"error": {"type": refusal.kind, "message": str(refusal)}}, refusal.status)

    def _read(self) -> dict[str, Any]:
        if self.headers.get("Origin"):
            self.close_connection = True
            raise Refusal("InvalidInput", "requests of web pages (with an Origin) are not served", 403)
        try:
            size = int(self.headers.get("Content-Length", ""))
        except ValueError:
            size = -1
        if not 0 <= size <= MOST_BYTES:
            self.close_connection = True
            raise Refusal("InvalidInput", f"a request needs a Content-Length from 0 to {MOST_BYTES} bytes", 413)
        try:
            request = json.loads(self.rfile.read(size))
        except (ValueError, RecursionError) as error:
            raise Refusal("InvalidInput", f"the request is no JSON: {error}") from error
        if not isinstance(request, dict):
            raise Refusal("InvalidInput", "the request is no JSON object")
        return request

    def do_GET(self) -> None:
        if self.path == "/Info":
            self._send({"protocolVersion": 1.0, "models": [self.server.name]})
        else:
            self._refuse(Refusal("InvalidInput", f"{self.path} is not served; GET /Info is", 404))

    def do_POST(self) -> None:
        try:
            self._send(self.server.answer(self.path, self._read()))
        except Refusal as refusal:
            self._refuse(refusal)


def make(o: argparse.Namespace) -> Server:
    """Returns the server of a command line (python/softfall serve.in); a wrong one is an Error or a KeyError."""
    for name, least, most in (("port", 0, 65535), ("jobs", 1, 64)):
        if not least <= getattr(o, name) <= most:
            raise InputError(f"--{name} {getattr(o, name)} is outside {least} to {most}")
    for text in o.set:
        if "=" not in text:
            raise InputError(f"--set {text}: KEY=VALUE is expected")
    function = Function(Case(o.case, dict(text.split("=", 1) for text in o.set)), o.input, o.output, o.threads, o.unusable)
    for key in o.option:
        if key not in function.case and not key.startswith("geometry."):
            raise InputError(f"--option {key}: there is no such key of the case")
    try:
        return Server((o.host, o.port), o.name, function, o.option, o.jobs)
    except OSError as error:
        raise Error(f"cannot listen on {o.host}, port {o.port}: {error.strerror or error}", 3) from None


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
