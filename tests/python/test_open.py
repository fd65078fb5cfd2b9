# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall open: the server as a stranger meets it, and the page as a user does, in headless Chromium."""
import http.client
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import pytest

import softfall
from conftest import BIN
from softfall import form, run_keys, workbench_drops

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import browse  # noqa: E402


class Service:
    """`softfall open` as a program, and requests to it."""

    def __init__(self, *options):
        self.program = subprocess.Popen([str(BIN / "softfall"), "open", "pad", "--no-browser", "--threads=1", *options], stdout=subprocess.PIPE, text=True,
                                        env={**os.environ, "OMP_NUM_THREADS": "1"})
        text = self.program.stdout.readline() + self.program.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/\?token=(\S+)", text)
        assert found, text
        self.number = 0  # of the last run that was waited for
        self.address, self.port, self.token = found[0], int(found[1]), found[2]

    def ask(self, method, path, body=None, **headers):
        """Returns status, headers and content; with the cookie unless another one is given."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        given = {"Cookie": f"softfall-{self.port}={self.token}", **{name.replace("_", "-"): text for name, text in headers.items()}}
        connection.request(method, path, body, {name: text for name, text in given.items() if text is not None})
        answer = connection.getresponse()
        return answer.status, dict(answer.getheaders()), answer.read()

    def post(self, word, **request):
        status, _, content = self.ask("POST", f"/api/{word}", json.dumps(request))
        return status, json.loads(content)

    def wait(self, state, seconds=120):
        """Waits until a new run is in a state."""
        end = time.monotonic() + seconds
        while (job := self.post("state")[1]["job"]) is None or job["state"] != state or job["number"] <= self.number:
            assert time.monotonic() < end, job
            time.sleep(0.05)
        self.number = job["number"]
        return job

    def end(self, number=signal.SIGTERM):
        self.program.send_signal(number)
        return self.program.wait(timeout=60)


@pytest.fixture(scope="module")
def service(place):
    os.chdir(place)
    made = Service()
    yield made
    if made.program.poll() is None:
        assert made.end() == 0


@pytest.fixture(scope="module")
def page(service):
    if not shutil.which("chromium"):
        assert os.environ.get("SF_NO_SKIP") != "1"
        pytest.skip("chromium is missing (packages.txt)")
    made = browse.Page(service.address, 1400, 1000)
    made.wait_for("document.querySelectorAll('.field').length > 20 && document.getElementById('live-note').textContent")
    yield made
    made.close()


def text(page, identifier):
    return page.value(f"document.getElementById('{identifier}').textContent")


# ---- the server ----

def test_strangers_are_refused(service):
    assert service.ask("GET", "/")[0] == 200
    for headers in ({"Cookie": None}, {"Cookie": f"softfall-{service.port}=guess"}, {"Host": "page.example"}, {"Host": f"page.example:{service.port}"},
                    {"Host": f"127.0.0.1:{service.port + 1}"}, {"Origin": "http://page.example"}, {"Origin": "null"}, {"Origin": f"http://localhost:{service.port + 1}"}):
        for method, path in (("GET", "/"), ("GET", "/main.js"), ("POST", "/api/state"), ("POST", "/api/run")):
            assert service.ask(method, path, "{}" if method == "POST" else None, **headers)[0] == 403, (headers, path)
    own = f"http://127.0.0.1:{service.port}"
    assert service.ask("POST", "/api/state", "{}", Origin=own)[0] == 200
    status, headers, _ = service.ask("GET", f"/?token={service.token}", Cookie=None)
    assert status == 303 and headers["Location"] == "/" and "HttpOnly; SameSite=Lax" in headers["Set-Cookie"]
    assert service.ask("GET", "/?token=guess", Cookie=None)[0] == 403


def test_only_pages_and_drops_are_served(service, drop):
    name = drop.results.parent.name
    drop.report()
    status, headers, _ = service.ask("GET", f"/runs/{name}/report.html")
    assert status == 200 and headers["Content-Security-Policy"].startswith("sandbox")
    assert service.ask("GET", "/three.module.min.js")[0] == 200
    for path in ("/../../../etc/passwd", "/%2e%2e/README.md", f"/runs/{name}/summary.json", f"/runs/{name}/..%2fresults.h5", "/runs/../pad/case.cfg", "/runs/latest/report.html",
                 "/runs/.open.html/report.html", "/scene/..", "/.open.html", "/nothing.html", "/main.js/"):
        assert service.ask("GET", path)[0] in (400, 404), path
    for body in ("{", "[1]", "[" * 100000, '{"values": 3}', '{"values": {"a b": "1"}}', '{"values": {"missile.mass": 3}}'):
        assert service.ask("POST", "/api/check", body)[0] == 400, body
    assert service.ask("POST", "/api/nothing", "{}")[0] == 404
    assert service.ask("POST", "/api/drop", '{"id": "../pad"}')[0] == 400
    for folder in ("../out", "/tmp/out", "", "a/../b"):
        assert service.post("save", folder=folder)[0] == 400
    assert service.ask("PUT", "/", "{}")[0] == 501


def test_the_door_is_for_its_owner_alone(service):
    door = pathlib.Path("softfall-runs/.open.html")
    assert door.stat().st_mode & 0o077 == 0 and service.address in door.read_text()


def test_every_wrong_value_has_its_sentence(case):
    values, wrong = form.judge(case, {"missile.mass": "6 m", "missile.velocity": "-4 m/s", "geometry.parameters.thickness": "5 cm", "pad.friction": "", "kernel.stabilisation": "0.2"})
    assert set(wrong) == {"missile.mass", "missile.velocity", "pad.friction"} and "expected a mass" in wrong["missile.mass"]
    assert values["geometry.parameters.thickness"] == "50" and values["kernel.stabilisation"] == "0.2"
    _, wrong = form.judge(case, {"material.ED": "2 MPa", "material.BETA1": "4000 1/s", "missile.gap": "1 kg"})
    assert set(wrong) == {"missile.gap"}
    assert form.judge(case, {}) == ({}, {})


def test_fields_have_bounds_and_help(case):
    fields = {field["key"]: field for field in form.fields(case)}
    assert fields["missile.velocity"]["value"] == "4.5 m/s" and "a speed" in fields["missile.velocity"]["kind"]
    assert fields["geometry.parameters.thickness"]["kind"] == "number, from 10 to 200" and fields["geometry.parameters.quarter"]["choices"] == ["0", "1"]
    assert fields["geometry.model"]["choices"] == ["solid", "axisymmetric"] and all(field["kind"] for field in fields.values())
    assert [slider["key"] for slider in form.sliders(case)] == ["geometry.parameters.thickness", "missile.velocity", "missile.mass", "pad.stress_factor"]
    assert run_keys.constants(softfall.example("tile-feet"))["geometry.parameters.foot"].high == "200"


def test_a_live_answer_is_that_of_the_section(case):
    live = workbench_drops.Live()
    values = {"missile.velocity": "4.2 m/s", "missile.mass": "5 kg", "pad.stress_factor": "1.1", "geometry.parameters.thickness": "55"}
    told = live.answer(str(case.path), values, "coarse")
    built = softfall.Case(case.path, {**values, "geometry.model": "axisymmetric", "geometry.parameters.fine_spacing": "10", "geometry.parameters.outer_spacing": "16"}).run().figures
    assert told["figures"]["a_max_g"] == pytest.approx(built["a_max_g"], rel=1e-6) and told["figures"]["hic"] == pytest.approx(built["hic"], rel=1e-6)
    assert max(told["curve"]["g"]) == pytest.approx(told["figures"]["a_max_g"], rel=1e-3)
    layered = live.answer(str(BIN.parent / "share/softfall/examples/layers/case.cfg"), {"missile.velocity": "4 m/s"}, "coarse")
    assert layered["figures"]["a_max_g"] > 0 and [s["key"] for s in form.sliders(softfall.example("layers"))] == ["missile.velocity", "missile.mass"]
    thicker = live.answer(str(case.path), {**values, "geometry.parameters.thickness": "58"}, "coarse")  # by the same model
    assert thicker["figures"]["a_max_g"] < told["figures"]["a_max_g"] and len(live._models) == 2
    with pytest.raises(softfall.InputError, match="missile"):
        live.answer(str(case.path), {"missile.direction": "[0.0, 0.5, -0.8]"}, "coarse")


def test_a_worker_that_dies_is_started_again(service, case):
    made = workbench_drops.Worker()
    request = {"do": "live", "path": str(case.path), "values": {}, "mesh": "coarse"}
    first = made.ask(request)["figures"]
    made._child.kill()
    made._child.wait()
    assert made.ask(request)["figures"] == first
    made.close()
    assert made._child.returncode is not None


# ---- the page ----

def test_the_first_run(page, service):
    assert text(page, "verdict") in ("live answer", "valid", "valid with remarks", "do not use")
    page.write("field-missile.velocity", "4.4 m/s")
    page.wait_for("document.getElementById('verdict').textContent === 'live answer'")
    page.press("run")
    job = service.wait("done")
    page.wait_for(f"document.getElementById('report').getAttribute('href') === 'runs/{job['id']}/report.html'")
    page.wait_for("!document.getElementById('controls').hidden")
    figures = service.post("drop", id=job["id"])[1]["figures"]
    assert job["values"] == {"missile.velocity": "4.4 m/s"} and figures["v0_m_s"] == 4.4
    assert float(text(page, "a_max")) == pytest.approx(figures["a_max_g"], rel=1e-3) and float(text(page, "hic")) == pytest.approx(figures["hic"], rel=1e-3)
    assert page.value("document.querySelectorAll('#chart polyline').length") == 1


def test_the_drop_in_three_dimensions(page):
    page.click(*page.centre_of("scene"))
    page.value("document.getElementById('scene').focus()")
    page.key("Home")
    assert text(page, "now") == "0.00 ms"
    page.key("ArrowRight")
    assert page.value("document.getElementById('time').value") == "1"
    page.key(" ")
    page.wait_for("document.getElementById('time').value !== '1'")
    page.key(" ")
    at = page.value("document.getElementById('time').value")
    time.sleep(0.5)
    assert page.value("document.getElementById('time').value") == at
    drawn = "(() => { const c = document.querySelector('#scene canvas'), d = document.createElement('canvas'); d.width = d.height = 60; const x = d.getContext('2d'); " \
            "x.drawImage(c, 0, 0, 60, 60); return new Set(Array.from(new Uint32Array(x.getImageData(0, 0, 60, 60).data.buffer))).size; })()"
    assert page.value(drawn) > 100  # colours
    page.drag(*page.centre_of("scene"), 60, 20)
    for box in ("cut", "mesh", "missile"):
        page.value(f"document.getElementById('{box}').click()")
        page.settle()
        assert page.value(drawn) > 50
    page.value("document.getElementById('reset').click()")


def test_wrong_values_are_marked_beside_their_fields(page):
    page.write("field-missile.mass", "6 m")
    page.write("field-pad.friction", "11")
    page.wait_for("document.querySelectorAll('[aria-invalid=true]').length === 2 && document.getElementById('run').disabled")
    assert "expected a mass" in text(page, "field-missile.mass-wrong") and "11 is out of bounds" in text(page, "field-pad.friction-wrong")
    assert "field-missile.mass-wrong" in page.value("document.getElementById('field-missile.mass').getAttribute('aria-describedby')")
    page.write("field-missile.mass", "4.6 kg")
    page.write("field-pad.friction", "0.5")
    page.wait_for("document.querySelectorAll('[aria-invalid=true]').length === 0 && !document.getElementById('run').disabled")


def test_a_slider_answers_live(page, service):
    page.value("document.getElementById('slider-geometry.parameters.thickness').focus()")
    before = page.value("document.getElementById('field-geometry.parameters.thickness').value")
    for _ in range(5):
        page.key("ArrowRight")
    page.wait_for("document.getElementById('verdict').textContent === 'live answer' && document.getElementById('origin').textContent.startsWith('5 mm')")
    after = page.value("document.getElementById('field-geometry.parameters.thickness').value")
    assert float(after) > float(before)
    told = service.post("live", mesh="fine", values={"missile.velocity": page.value("document.getElementById('field-missile.velocity').value"), "geometry.parameters.thickness": after})[1]
    page.wait_for(f"Math.abs(document.getElementById('a_max').textContent / {told['figures']['a_max_g']} - 1) < 1e-3")  # of the last place, not of one before
    assert page.value("document.querySelectorAll('#chart polyline').length") >= 1  # and that of a drop, if one is shown
    page.write("field-geometry.parameters.thickness", before)


def test_a_measured_file_lies_beside_the_drop(page):
    lines = "".join(f"{0.1 * k:.1f},{max(0.0, 90 - 0.9 * (0.1 * k - 20) ** 2):.3f}\\n" for k in range(400))
    page.value("(() => { const d = new DataTransfer(); d.items.add(new File(['time_ms,acceleration_g\\n%s'], 'lab 1.csv')); "
               "document.body.dispatchEvent(new DragEvent('drop', {dataTransfer: d, bubbles: true, cancelable: true})); })()" % lines)
    page.wait_for("document.getElementById('key').textContent.includes('measured: lab 1.csv')")
    assert "lab 1.csv: valid" in text(page, "measured-note") and "90" in page.value("document.querySelector('#runs tbody tr').textContent")
    page.value("(() => { const d = new DataTransfer(); d.items.add(new File(['no,numbers\\nat,all\\n'], 'bad.csv')); "
               "document.body.dispatchEvent(new DragEvent('drop', {dataTransfer: d, bubbles: true, cancelable: true})); })()")
    page.wait_for("document.getElementById('measured-note').textContent.startsWith('bad.csv')")
    assert tempfile.gettempdir() not in text(page, "measured-note")
    page.value("document.querySelector('#runs tbody button').click()")
    page.wait_for("!document.getElementById('key').textContent.includes('measured')")


def test_a_run_can_be_stopped_and_goes_on(page, service):
    page.write("field-geometry.parameters.fine_spacing", "8")
    page.wait_for("!document.getElementById('run').disabled")
    page.press("run")
    page.wait_for("!document.getElementById('stop').hidden && document.getElementById('what').textContent.startsWith('solving')")
    page.wait_for("document.querySelector('#chart polyline')?.getAttribute('points').split(' ').length > 2")
    page.press("stop")
    assert service.wait("stopped")["id"] is None
    page.wait_for("document.getElementById('run').textContent === 'Go on'")
    page.write("field-geometry.parameters.fine_spacing", "20")
    page.wait_for("!document.getElementById('run').disabled")


def test_two_tabs_show_one_run(page, service):
    first = page.session
    second = page.tab(390, 844, phone=True)
    page.open(service.address)
    page.wait_for("document.querySelectorAll('.field').length > 20")
    page.write("field-missile.velocity", "4.3 m/s")
    page.wait_for("!document.getElementById('run').disabled")
    page.press("run")
    job = service.wait("done")
    for session in (second, first):
        page.session = session
        page.wait_for(f"document.getElementById('report').getAttribute('href') === 'runs/{job['id']}/report.html'")
    page.session = second
    assert page.value("document.documentElement.scrollWidth <= innerWidth")  # of a phone
    page.call("Page.close")
    page.session = first


def test_a_file_that_is_edited_is_taken_over(page, service):
    page.value("document.querySelector('#runs tbody button:not(:disabled)')?.click()")
    curve = next(pathlib.Path("pad").rglob("eva35.csv"))
    before = curve.read_text()
    try:
        curve.write_text(re.sub(r"(?m)^(0\.5\d*),.*\n", "", before, count=1))
        page.wait_for("document.getElementById('banner').textContent.includes('has changed')")
        page.wait_for("!/^(valid|do not use)/.test(document.getElementById('verdict').textContent) || document.getElementById('origin').textContent.includes('other values')")
    finally:
        curve.write_text(before)
    page.wait_for("document.getElementById('banner').textContent.includes('has changed')")


def test_the_case_is_saved(page):
    page.write("folder", "saved")
    page.key("Enter")
    page.wait_for("document.getElementById('saved').textContent.startsWith('Saved')")
    assert softfall.Case("saved/case.cfg")["missile.velocity"] == "4.4 m/s"


def test_every_control_has_a_name_and_the_keyboard_reaches_it(page, service):
    assert page.value("[...document.querySelectorAll('button, input, select, a, summary')].filter(e => !e.hidden && !(e.labels?.length || e.textContent.trim() || "
                      "e.getAttribute('aria-label') || e.title)).map(e => e.outerHTML)") == []
    page.open(service.address)
    page.wait_for("document.querySelectorAll('.field').length > 20 && document.getElementById('live-note').textContent")
    seen = set()
    for _ in range(12):
        page.key("Tab")
        seen.add(page.value("document.activeElement.id || document.activeElement.tagName"))
    assert {"run", "slider-missile.velocity", "find", "field-missile.velocity"} <= seen


@pytest.mark.parametrize("events", [50, pytest.param(1000, marks=pytest.mark.slow)])
def test_random_events_leave_page_and_server_whole(page, service, events):
    dice = random.Random(68)
    words = ["", "1", "-3", "5 mm", "4.5 m/s", "nan", "1e999", "\"", "<b>x</b>", "@/etc/passwd", "µ", "0.7"]
    ids = page.value("[...document.querySelectorAll('input[type=text]')].map(e => e.id)")
    sliders = page.value("[...document.querySelectorAll('input[type=range]')].map(e => e.id)")
    for _ in range(events):
        kind = dice.choice(["click", "click", "key", "write", "slide", "drag", "wheel"])
        x, y = dice.uniform(5, 1380), dice.uniform(5, 990)
        if kind == "click":
            if page.value(f"!document.elementFromPoint({x}, {y})?.closest('#report, #measure')"):
                page.click(x, y)
        elif kind == "key":
            page.key(dice.choice(["ArrowRight", "ArrowLeft", "Home", "End", "Tab", " "]))
        elif kind == "write":
            page.write(dice.choice(ids), dice.choice(words))
        elif kind == "slide":
            page.choose(dice.choice(sliders), str(dice.uniform(0, 60)))
        elif kind == "drag":
            page.drag(x, y, dice.uniform(-80, 80), dice.uniform(-80, 80))
        else:
            page.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=dice.choice([-200, 200]))
    service.post("stop")
    end = time.monotonic() + 120
    while (job := service.post("state")[1]["job"]) and job["state"] in ("running", "stopping"):
        assert time.monotonic() < end
        time.sleep(0.1)
    page.value("sessionStorage.clear()")
    page.open(service.address)
    page.wait_for("document.querySelectorAll('.field').length > 20")
    assert softfall.Case("pad/case.cfg").overrides == {}
    assert [error for error in page.errors if "400" not in error] == []  # refused values


def test_a_server_that_was_killed_comes_back(page, service):
    page.write("field-missile.velocity", "4.1 m/s")
    page.wait_for("!document.getElementById('run').disabled")
    service.end(signal.SIGKILL)
    page.wait_for("document.getElementById('banner').textContent.includes('does not answer')")
    again = Service()
    try:
        assert again.address == service.address  # the same door
        page.wait_for("document.getElementById('banner').hidden")
        assert page.value("document.getElementById('field-missile.velocity').value") == "4.1 m/s"
        other = Service("--output=others")
        assert other.port != again.port and other.token != again.token
        assert other.end() == 0
        assert page.value("fetch('api/state', {method: 'POST', body: '{}'}).then(r => r.status)") == 200
    finally:
        assert again.end() == 0
