# SPDX-License-Identifier: GPL-3.0-or-later
"""What guards the servers of the package: limits on connections, time and bytes, and answers that are whole or errors."""
from __future__ import annotations

import re
import socket
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

PATIENCE = 60  # s for the bytes of a request
MOST_CLIENTS = 256  # connections at a time


class Refusal(Exception):
    """A request that is answered with an error: its type, its sentence and the status of HTTP."""

    def __init__(self, kind: str, sentence: str, status: int = 400) -> None:
        super().__init__(sentence)
        self.kind, self.status = kind, status


class Server(ThreadingHTTPServer):
    """A server with at most MOST_CLIENTS connections; `program` is its name in its log."""

    daemon_threads = True
    program = "softfall"

    def __init__(self, address: tuple[str, int], handler: type[Handler]) -> None:
        super().__init__(address, handler)
        self.clients = threading.Semaphore(MOST_CLIENTS)

    def process_request(self, request: Any, client_address: Any) -> None:
        """Serves a connection by a thread of its own; closes it at once where there are too many."""
        if self.clients.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Runs in the thread."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self.clients.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Tells of a connection that failed, in one line."""
        self.log(f"{client_address[0]}: {type(sys.exc_info()[1]).__name__}: {sys.exc_info()[1]}")

    def log(self, text: str) -> None:
        """Prints a line to stderr; what a terminal would obey is spelled out."""
        sys.stderr.write(f"{self.program}: " + re.sub(r"[^ -~]", lambda found: ascii(found[0])[1:-1], text) + "\n")


class Handler(BaseHTTPRequestHandler):
    """One connection of a client. A subclass has `do_GET` and `do_POST`, and `refuse`, which answers a Refusal."""

    server: Server
    protocol_version = "HTTP/1.1"
    timeout = PATIENCE

    def log_message(self, format: str, *args: Any) -> None:
        self.server.log(f"{self.log_date_time_string()} {format % args}")

    def version_string(self) -> str:
        return self.server.program

    def handle_one_request(self) -> None:
        """Serves a request, whose bytes arrive within PATIENCE."""
        self.watch = threading.Timer(PATIENCE, self._give_up)
        self.watch.daemon = True
        self.watch.start()
        try:
            super().handle_one_request()
        finally:
            self.watch.cancel()

    def _give_up(self) -> None:
        try:
            self.connection.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass

    def send(self, body: bytes, kind: str, status: int = 200, headers: dict[str, str] | None = None) -> None:
        """Sends an answer; nothing where the client has gone."""
        try:
            self.send_response(status)
            for name, value in {"Content-Type": kind, "Content-Length": str(len(body)), **(headers or {})}.items():
                self.send_header(name, value)
            if self.close_connection:
                self.send_header("Connection", "close")
            self.end_headers()
            if self.command != "HEAD":
                self.wfile.write(body)
        except (BrokenPipeError, ConnectionResetError):
            self.close_connection = True

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        self.close_connection = True
        self.refuse(Refusal("InvalidInput", message or f"status {code}", code))

    def refuse(self, refusal: Refusal) -> None:
        """Answers a request that is refused."""
        raise NotImplementedError

    def forbid(self, sentence: str) -> Refusal:
        """Returns the Refusal of a request whose connection ends with it, unread."""
        self.close_connection = True
        return Refusal("InvalidInput", sentence, 403)

    def body(self, most: int) -> bytes:
        """Returns the bytes of a request."""
        length = self.headers.get("Content-Length", "")
        size = int(length) if re.fullmatch("[0-9]{1,9}", length) else -1
        if not 0 <= size <= most:
            self.close_connection = True
            raise Refusal("InvalidInput", f"a request needs a Content-Length from 0 to {most} bytes", 413)
        data = self.rfile.read(size)
        self.watch.cancel()
        if len(data) < size:
            self.close_connection = True
            raise Refusal("InvalidInput", f"the request ended after {len(data)} of {size} bytes")
        return data
