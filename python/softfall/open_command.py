# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall open: the workbench, a page in the browser with a case, its drops and their figures."""
from __future__ import annotations

import argparse
import contextlib
import os
import re
import secrets
import signal
import sys
import threading
import warnings
import webbrowser
from pathlib import Path

from .case import RUNS
from .command import Parser, say
from .errors import Error, InputError, SoftfallWarning
from .run_command import find_case
from .workbench import Server, Workbench

DOOR = ".open.html"  # in the folder of the drops, for the user alone: leads to the page, and holds port and token for the next start


def parser(prog: str) -> Parser:
    """Returns the command line."""
    made = Parser(prog, "[OPTION...] [CASE]",
                  "Opens the workbench in the browser: the values of a case as a form, its drop in\n3-D, the curves of earlier drops and of measured files beside it, sliders that\nanswer "
                  "at once where the drop is axisymmetric.",
                  "CASE is a case file, a folder with a case.cfg (default: that of the present one),\nor the name of an example. The page is served to this machine alone, and only with\nthe "
                  "token of the printed address. Ctrl-C ends it; a drop at work keeps a\ncheckpoint. Drops are those of `softfall run`.\n\nExample:\n"
                  "  softfall open pad/case.cfg")
    add = made.options.add_argument
    made.add_argument("case", metavar="CASE", nargs="?", help=argparse.SUPPRESS)
    add("--no-browser", action="store_true", help="print the address only")
    add("-o", "--output", metavar="DIR", default=RUNS, help=f"keep the drops below DIR (default: {RUNS})")
    add("--port", metavar="N", type=int, default=0, help="port (default: that of the last time, else a free one)")
    add("-t", "--threads", metavar="N", type=int, help="threads of the solver (default: all processors)")
    return made


def _last(door: Path) -> tuple[int, str]:
    """Returns port and token of the last start here, so that its page goes on; 0 and a new token if there was none."""
    with contextlib.suppress(OSError):
        handle = os.open(door, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with os.fdopen(handle, encoding="utf-8", errors="replace") as stream:
            state = os.fstat(stream.fileno())
            found = re.search(r"http://127\.0\.0\.1:(\d{1,5})/\?token=([\w-]{43})\b", stream.read(4096))
        if found and state.st_uid == os.getuid() and not state.st_mode & 0o077:
            return int(found[1]), found[2]
    return 0, secrets.token_urlsafe(32)


def _keep(door: Path, address: str) -> None:
    """Writes the door, which only its owner may read: a browser is led through it, so that no list of processes shows the token."""
    partial = door.with_name(f"{door.name}.{os.getpid()}")
    handle = os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
    with os.fdopen(handle, "w", encoding="utf-8") as stream:
        stream.write(f'<!DOCTYPE html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url={address}"><title>softfall</title>'
                     f'<a href="{address}">the workbench</a>\n')
    os.replace(partial, door)


def make(o: argparse.Namespace) -> Server:
    """Returns the server of a command line."""
    if not 0 <= o.port <= 65535:
        raise InputError(f"--port {o.port} is outside 0 to 65535")
    if o.threads is not None and o.threads < 1:
        raise InputError(f"--threads={o.threads} is not a number from 1 on")
    case, _ = find_case([o.case] if o.case else [])
    runs = Path(o.output)
    try:
        runs.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Error(f"the folder {runs} cannot be made: {error.strerror}", 3) from None
    port, token = _last(runs / DOOR)
    workbench = Workbench(case.path, o.output, o.threads)
    for number in dict.fromkeys([o.port] if o.port else [port, 0]):  # that of the last time may be in use
        try:
            server = Server(number, workbench, token if number == port or o.port else secrets.token_urlsafe(32))
            break
        except OSError as error:
            failure = error
    else:
        raise Error(f"cannot listen on 127.0.0.1, port {o.port}: {failure.strerror}; leave out --port for a free one", 3)
    try:
        _keep(runs / DOOR, server.address)
    except OSError as error:
        raise Error(f"the folder {runs} cannot be written to: {error.strerror}", 3) from None
    return server


def run(o: argparse.Namespace) -> int:
    """Serves until SIGINT or SIGTERM, and returns the exit code."""
    server = make(o)
    warnings.simplefilter("ignore", SoftfallWarning)  # the page has those of its drops
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: threading.Thread(target=server.shutdown).start())
    say(f"softfall open: {server.workbench.path} is at\n  {server.address}\nCtrl-C ends it.")
    sys.stdout.flush()
    if not o.no_browser and (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        webbrowser.open((Path(o.output) / DOOR).absolute().as_uri())
    server.serve_forever()
    server.workbench.close()
    server.server_close()
    return 0
