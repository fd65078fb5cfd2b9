# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall-serve as a client of UM-Bridge sees it."""
import concurrent.futures
import http.client
import json
import os
import signal
import socket
import subprocess
import time
import urllib.error
import urllib.request

import pytest

import softfall
from conftest import BIN, command_here


class Service:
    """softfall-serve as a program, with the requests of a client."""

    def __init__(self, *options):
        with open("serve.log", "a") as log:
            self.program = subprocess.Popen([str(BIN / "softfall-serve"), "pad/case.cfg", "--port=0", *options], stdout=subprocess.PIPE,
                                            stderr=log, text=True)
        line = self.program.stdout.readline()
        assert " is at http://127.0.0.1:" in line, line
        self.url = line.split()[-1]

    def ask(self, path, request=None):
        """Returns status and answer."""
        data = None if request is None else json.dumps(request).encode() if not isinstance(request, bytes) else request
        try:
            with urllib.request.urlopen(urllib.request.Request(self.url + path, data), timeout=600) as answer:
                return answer.status, json.loads(answer.read())
        except urllib.error.HTTPError as error:
            return error.code, json.loads(error.read())

    def evaluate(self, *x, **more):
        return self.ask("/Evaluate", {"name": "drop", "input": [list(x)], "config": {}, **more})

    def end(self, number=signal.SIGTERM):
        self.program.send_signal(number)
        return self.program.wait(timeout=60)


@pytest.fixture(scope="module")
def service(place):
    os.chdir(place)
    made = Service("--input=missile.velocity [m/s]", "--input=geometry.parameters.thickness", "--output=a_max_g", "--output=hic",
                   "--option=missile.mass", "--jobs=2", "--threads=1")
    yield made
    assert made.end(signal.SIGINT) == 0


def test_the_protocol(service, drop):
    assert service.ask("/Info") == (200, {"protocolVersion": 1.0, "models": ["drop"]})
    assert service.ask("/InputSizes", {"name": "drop", "config": {}}) == (200, {"inputSizes": [2]})
    assert service.ask("/OutputSizes", {"name": "drop", "config": {}}) == (200, {"outputSizes": [2]})
    support = {"Evaluate": True, "Gradient": False, "ApplyJacobian": False, "ApplyHessian": False}
    assert service.ask("/ModelInfo", {"name": "drop"}) == (200, {"support": support})
    assert service.evaluate(4.5, 50) == (200, {"output": [[drop.figures["a_max_g"], drop.figures["hic"]]]})
    status, heavy = service.evaluate(4.5, 50, config={"missile.mass": "5 kg"})
    assert status == 200 and heavy["output"][0][1] > drop.figures["hic"]


@pytest.mark.parametrize("path, request_, kind, sentence", [
    ("/Evaluate", {"name": "drop", "input": [[4.5]]}, "InvalidInput", "sizes [1], expected are [2]"),
    ("/Evaluate", {"name": "drop", "input": [[4.5, 50], [1]]}, "InvalidInput", "sizes [2, 1], expected are [2]"),
    ("/Evaluate", {"name": "drop", "input": [4.5, 50]}, "InvalidInput", "expected are [2]"),
    ("/Evaluate", {"name": "drop"}, "InvalidInput", "expected are [2]"),
    ("/Evaluate", {"name": "drop", "input": [["4.5", 50]]}, "InvalidInput", "no finite number"),
    ("/Evaluate", {"name": "drop", "input": [[True, 50]]}, "InvalidInput", "no finite number"),
    ("/Evaluate", {"name": "drop", "input": [[float("nan"), 50]]}, "InvalidInput", "no finite number"),
    ("/Evaluate", {"name": "drop", "input": [[-4.5, 50]]}, "InvalidInput", "out of bounds"),
    ("/Evaluate", {"name": "drop", "input": [[30, 50]]}, "InvalidOutput", "anvil"),
    ("/Evaluate", {"name": "drop", "input": [[4.5, 50]], "config": {"geometry.file": "/etc/passwd"}}, "InvalidInput", "its keys may be"),
    ("/Evaluate", {"name": "drop", "input": [[4.5, 50]], "config": {"missile.mass": "6 m"}}, "InvalidInput", "expected a mass"),
    ("/Evaluate", {"name": "drop", "input": [[4.5, 50]], "config": {"missile.mass": None}}, "InvalidInput", "a value is a text"),
    ("/Evaluate", {"name": "drop", "input": [[4.5, 50]], "config": [1]}, "InvalidInput", "config is"),
    ("/Evaluate", {"name": "fall", "input": [[4.5, 50]]}, "ModelNotFound", 'there is no model "fall"'),
    ("/Evaluate", b"{", "InvalidInput", "no JSON"),
    ("/Evaluate", b"[1]", "InvalidInput", "no JSON object"),
    ("/Evaluate", b"[" * 100000, "InvalidInput", "no JSON"),
    ("/Gradient", {"name": "drop", "input": [[4.5, 50]]}, "UnsupportedFeature", "/Gradient is not served"),
    ("/Nothing", {}, "InvalidInput", "/Nothing is not served"),
    ("/Evaluate", None, "InvalidInput", "GET /Info is"),
])
def test_errors_are_objects(service, path, request_, kind, sentence):
    status, answer = service.ask(path, request_)
    assert status >= 400 and answer["error"]["type"] == kind and sentence in answer["error"]["message"]
    assert service.ask("/Info")[0] == 200


def raw(service, text):
    """Sends bytes and returns the first line of the answer."""
    with socket.create_connection(service.url.split("//")[1].split(":"), timeout=60) as connection:
        connection.sendall(text)
        return connection.makefile("rb").readline().decode()


def test_what_no_client_sends_is_refused(service):
    assert " 413 " in raw(service, b"POST /Evaluate HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999\r\n\r\n")
    assert " 413 " in raw(service, b"POST /Evaluate HTTP/1.1\r\nHost: localhost\r\n\r\n")
    assert " 413 " in raw(service, b"POST /Evaluate HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n")
    assert " 403 " in raw(service, b"POST /Evaluate HTTP/1.1\r\nHost: localhost\r\nOrigin: http://page\r\nContent-Length: 2\r\n\r\n{}")
    assert " 501 " in raw(service, b"PUT /Evaluate HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\n{}")
    assert "Bad request syntax" in raw(service, b"nonsense\r\n\r\n")
    assert service.ask("/Info")[0] == 200


def test_a_request_for_another_host_is_refused(service):
    """A page in a browser reaches this machine by a name of its own."""
    for host in (b"page.example", b"page.example:80", b"", b"127.0.0.1.page.example"):
        assert " 403 " in raw(service, b"GET /Info HTTP/1.1\r\nHost: " + host + b"\r\n\r\n")
    for host in (b"localhost:9", b"127.0.0.1", b"[::1]:80"):
        assert " 200 " in raw(service, b"GET /Info HTTP/1.1\r\nHost: " + host + b"\r\n\r\n")


def test_numbers_beyond_all_bounds_are_refused(service):
    for number in ("1" + "0" * 400, "-1" + "0" * 400, "1e400", "1" * 5000):
        status, answer = service.ask("/Evaluate", b'{"name": "drop", "input": [[' + number.encode() + b", 50]]}")
        assert status == 400 and len(json.dumps(answer)) < 1000, answer
    status, answer = service.ask("/Evaluate", b'{"name": "drop", "input": [[4.5, 50]], "config": {"missile.mass": ' + b"[" * 800 + b"]" * 800 + b"}}")
    assert status == 400


def test_the_log_has_no_orders_to_a_terminal(service):
    raw(service, b"GET /\x1b[31m\x9b HTTP/1.1\r\nHost: localhost\r\n\r\n")
    assert service.ask("/Info")[0] == 200
    with open("serve.log", "rb") as log:
        assert b"\x1b" not in log.read()


def test_a_drop_that_is_known_waits_for_nobody(here, drop):
    service = Service("--input=missile.velocity [m/s]", "--output=hic", "--unusable=nan", "--threads=1")
    first = service.evaluate(4.5)
    body = json.dumps({"name": "drop", "input": [[4.4321]]}).encode()
    with socket.create_connection(service.url.split("//")[1].split(":")) as other:
        other.sendall(b"POST /Evaluate HTTP/1.1\r\nHost: localhost\r\nContent-Length: %d\r\n\r\n" % len(body) + body)
        assert service.evaluate(4.5) == first
    assert service.evaluate(30) == (200, {"output": [[None]]})
    service.end()


@pytest.mark.parametrize("option, said", [("--host=", "--host is empty"), ("--time-limit=nan", "--time-limit nan"), ("--time-limit=0", "--time-limit 0")])
def test_a_server_for_everybody_is_not_started_by_mistake(here, option, said):
    made = command_here("serve", "pad/case.cfg", "--port=0", "--input=missile.velocity [m/s]", "--output=hic", option)
    assert made.returncode in (2, 64) and said in made.stderr and made.stderr.count("\n") <= 2


def test_two_clients_at_once_and_a_hundred_requests(service, drop):
    with concurrent.futures.ThreadPoolExecutor(8) as clients:
        soft, hard, *same = clients.map(lambda speed: service.evaluate(speed, 50), [3.5, 4.5] + 6 * [3.5])
        assert soft[0] == hard[0] == 200 and hard[1]["output"][0][1] == drop.figures["hic"] > soft[1]["output"][0][1]
        assert all(answer == soft for answer in same)
        many = list(clients.map(lambda k: service.evaluate(3.5 + k % 2, 50), range(100)))
    assert all(answer == (soft, hard)[k % 2] for k, answer in enumerate(many))


def test_requests_on_one_connection(service):
    connection = http.client.HTTPConnection(service.url.split("//")[1], timeout=60)
    for _ in range(3):
        connection.request("POST", "/InputSizes", json.dumps({"name": "drop"}))
        assert json.loads(connection.getresponse().read()) == {"inputSizes": [2]}
    connection.close()


def test_a_client_that_goes_away_ends_nothing(service):
    body = json.dumps({"name": "drop", "input": [[3.9, 50]]}).encode()
    connection = socket.create_connection(service.url.split("//")[1].split(":"))
    connection.sendall(b"POST /Evaluate HTTP/1.1\r\nHost: localhost\r\nContent-Length: %d\r\n\r\n" % len(body) + body)
    connection.close()
    half = socket.create_connection(service.url.split("//")[1].split(":"))
    half.sendall(b"POST /Evaluate HTTP/1.1\r\nContent-Le")
    status, answer = service.evaluate(3.9, 50)
    assert status == 200 and answer["output"][0][1] > 0
    half.close()


@pytest.mark.parametrize("number, code", [pytest.param(signal.SIGTERM, 0, marks=pytest.mark.slow), (signal.SIGKILL, -9)])
def test_a_server_that_is_ended_in_a_drop_finds_it_again(here, slow, number, code):
    speed = 4 + 0.01 * int(number)
    options = ["--input=missile.velocity [m/s]", "--output=hic", "--threads=1", *(f"--set={key}={value}" for key, value in slow.overrides.items())]
    first = Service(*options)
    with concurrent.futures.ThreadPoolExecutor(1) as client:
        asked = client.submit(first.evaluate, speed)
        folder = here / "softfall-runs"
        end = time.monotonic() + 300
        while not [path for path in folder.glob("*/results.h5.run")] and time.monotonic() < end:
            time.sleep(0.02)
        assert first.end(number) == code
        try:
            status, answer = asked.result()
            assert status == 500 and "interrupted" in answer["error"]["message"]
        except (http.client.HTTPException, OSError):
            pass  # the connection ended with the server
    second = Service(*options)
    status, answer = second.evaluate(speed)
    assert status == 200 and second.end() == 0
    slow["missile.velocity"] = f"{speed!r} m/s"
    assert answer["output"][0][0] == slow.run().figures["hic"]


def test_wrong_command_lines_end_with_a_sentence(here):
    def says(*words):
        result = command_here("serve", *words)
        return result.returncode, result.stderr
    good = ["pad/case.cfg", "--input=missile.velocity [m/s]", "--output=hic"]
    assert says("nowhere.cfg", *good[1:]) == (2, f"softfall serve: the file {here}/nowhere.cfg cannot be read: No such file or directory\n")
    assert says(*good, "--port=99999") == (2, "softfall serve: --port 99999 is outside 0 to 65535\n")
    assert says(*good, "--jobs=0") == (2, "softfall serve: --jobs 0 is outside 1 to 64\n")
    assert says(*good, "--set=missile.mass") == (2, "softfall serve: --set missile.mass: KEY=VALUE is expected, such as missile.velocity=\"5.2 m/s\"\n")
    assert says(*good, "--option=missile.mas") == (2, "softfall serve: --option missile.mas: there is no such key of the case\n")
    assert says(good[0], "--input=missile.velocit", "--output=hic")[0] == 2 and says("pad/case.cfg")[0] == 64
    assert "cannot listen on 192.0.2.1" in says(*good, "--host=192.0.2.1")[1]
    taken = socket.create_server(("127.0.0.1", 0))
    assert "Address already in use" in says(*good, f"--port={taken.getsockname()[1]}")[1]
    assert softfall.version() in subprocess.run([str(BIN / "softfall-serve"), "--version"], capture_output=True, text=True).stdout
