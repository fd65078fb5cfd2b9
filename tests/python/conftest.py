# SPDX-License-Identifier: GPL-3.0-or-later
"""A coarse case in a folder of its own, and its drop."""
import base64
import contextlib
import io
import os
import pathlib
import signal
import subprocess
import sys
import warnings

import pytest

import matplotlib
matplotlib.use("agg")
import softfall  # noqa: E402
from softfall import command, worker  # noqa: E402

BIN = pathlib.Path(os.environ["SF_BIN_DIR"])


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: takes long; runs under SF_SLOW=1, in the entry NAME_slow of ctest")
    config.addinivalue_line("markers", "drawn: looks at pictures, which are blank in the other tests that run in this process")


def pytest_collection_modifyitems(config, items):
    """Leaves the slow tests out, or under SF_SLOW=1 all others."""
    chosen = [item for item in items if (item.get_closest_marker("slow") is not None) == (os.environ.get("SF_SLOW") == "1")]
    config.hook.pytest_deselected(items=[item for item in items if item not in chosen])
    items[:] = chosen


def program(name, *arguments, cwd):
    """Runs a program as a user does, and returns what it prints."""
    return subprocess.run([str(BIN / f"softfall-{name}"), *map(str, arguments)], cwd=cwd, check=True, capture_output=True, text=True).stdout


def command_here(*words):
    """Runs `softfall WORD...` within this process, whose Python has its modules already, and returns what a process of its own would."""
    words = [str(word) for word in words]
    out, err, handler, argv = io.StringIO(), io.StringIO(), signal.getsignal(signal.SIGTERM), sys.argv
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        warnings.resetwarnings()
        for kind in (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning):  # as Python begins
            warnings.simplefilter("ignore", kind)
        try:
            sys.argv = ["softfall", *words]
            code = command.main(words)
        except SystemExit as end:
            code = end.code
        finally:
            sys.argv = argv
            signal.signal(signal.SIGTERM, handler)
    return subprocess.CompletedProcess(words, code, out.getvalue(), err.getvalue())


@pytest.fixture(scope="session")
def place(tmp_path_factory):
    """A folder with pad/case.cfg: nodes 25 mm apart, which take part of a second."""
    folder = tmp_path_factory.mktemp("drops")
    program("new", "pad", "--from", "eva50-v4.5", "--set", "geometry.parameters.fine_spacing=25", "--set",
            "geometry.parameters.outer_spacing=40", "--set", "geometry.missile_parameters.element_size=20", "--set",
            "pad.mesh_error_limit=1.0", cwd=folder)
    return folder


@pytest.fixture(scope="session", autouse=True)
def workers():
    """A worker of one test serves the next ones."""
    with worker.kept():
        yield


@pytest.fixture(autouse=True)
def here(place, monkeypatch):
    """Every test runs in that folder, without the warnings about the coarse mesh."""
    monkeypatch.chdir(place)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=softfall.SoftfallWarning)
        yield place


BLANK = {"png": base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="),
         "svg": b'<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"></svg>'}


@pytest.fixture(autouse=True)
def blank(request, monkeypatch):
    """Pages have blank pictures, as drawing them takes longer than a drop, but in tests that are marked as drawn."""
    def save(figure, target, format=None, **_):
        data = BLANK[format or pathlib.Path(target).suffix[1:]]
        if isinstance(target, (str, os.PathLike)):
            pathlib.Path(target).write_bytes(data)
        else:
            target.write(data.decode() if isinstance(target, io.TextIOBase) else data)
    if not request.node.get_closest_marker("drawn"):
        monkeypatch.setattr("matplotlib.figure.Figure.savefig", save)


@pytest.fixture
def case(here):
    return softfall.Case("pad/case.cfg")


@pytest.fixture
def slow(case):
    """The case with finer nodes: a second or two, long enough to be ended in between."""
    case.update({"geometry.parameters.fine_spacing": 12.5, "geometry.parameters.outer_spacing": 25.0})
    return case


@pytest.fixture
def drop(case):
    return case.run()  # found again after the first time
