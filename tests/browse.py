# SPDX-License-Identifier: GPL-3.0-or-later
"""A page in headless Chromium, driven through the pipe of its DevTools protocol; drawing is done in software."""
import base64
import json
import os
import subprocess
import tempfile
import time

OPTIONS = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-sandbox", "--disable-gpu-compositing",
           "--remote-debugging-pipe", "--no-first-run", "--disable-dev-shm-usage", "--disable-background-networking"]


class Page:
    """Errors of the page are collected in `errors`, whatever asks for the network in `requests`."""

    def __init__(self, path, width=1440, height=900, phone=False):
        self.errors, self.requests, self.number, self.rest = [], [], 0, b""
        self.folder = tempfile.TemporaryDirectory(prefix="softfall-browser-", ignore_cleanup_errors=True)
        commands, answers = os.pipe(), os.pipe()

        def take_pipes():
            read, write = os.dup(commands[0]), os.dup(answers[1])
            os.dup2(read, 3)
            os.dup2(write, 4)

        self.browser = subprocess.Popen(["chromium", *OPTIONS, "--user-data-dir=" + self.folder.name, "about:blank"],
                                        preexec_fn=take_pipes, close_fds=False, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                        # with large pages of malloc its drawing process ends
                                        env={name: value for name, value in os.environ.items() if name != "GLIBC_TUNABLES"})
        os.close(commands[0])
        os.close(answers[1])
        self.commands, self.answers = commands[1], answers[0]
        self.tab(width, height, phone)
        self.began = time.monotonic()
        self.open(path)
        self.loaded = time.monotonic() - self.began

    def tab(self, width=1440, height=900, phone=False):
        """Makes a new tab the one that is used; returns its session, by which it is used again."""
        self.session = None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Runtime", "Log", "Page", "Network"):
            self.call(domain + ".enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=2 if phone else 1,
                  mobile=phone)
        return self.session

    def open(self, path):
        """Shows a file, or the page of an address."""
        address = path if path.startswith("http") else "file://" + os.path.abspath(path)
        self.call("Page.navigate", url=address)
        self.wait_for("document.readyState === 'complete' && location.protocol === '%s'" % address.partition("/")[0])
        self.settle()

    def message(self):
        while b"\0" not in self.rest:
            data = os.read(self.answers, 1 << 20)
            if not data:
                raise SystemExit("Chromium has ended")
            self.rest += data
        text, self.rest = self.rest.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **parameters):
        self.number += 1
        command = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            command["sessionId"] = self.session
        os.write(self.commands, json.dumps(command).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise SystemExit("%s: %s" % (method, answer["error"]))
                return answer["result"]
            self.note(answer.get("method"), answer.get("params", {}))

    def note(self, event, p):
        if event == "Runtime.exceptionThrown":
            self.errors.append(p["exceptionDetails"].get("exception", {}).get("description") or str(p["exceptionDetails"]))
        elif event == "Runtime.consoleAPICalled" and p["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(a.get("value", a.get("description"))) for a in p["args"]))
        elif event == "Log.entryAdded" and p["entry"]["level"] in ("error", "warning") and "stall due to ReadPixels" not in p["entry"]["text"]:  # of drawing in software
            self.errors.append(p["entry"]["text"])
        elif event == "Network.requestWillBeSent":
            self.requests.append(p["request"]["url"][:80])

    def value(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise SystemExit("%s: %s" % (expression, result["exceptionDetails"].get("exception", {}).get("description")))
        return result["result"].get("value")

    def wait_for(self, expression, seconds=120):
        end = time.monotonic() + seconds
        while not self.value(expression):
            if time.monotonic() > end:
                raise SystemExit("%s did not come true within %d s" % (expression, seconds))
            time.sleep(0.05)

    def settle(self):
        """Waits until the screen has shown what was drawn."""
        self.value("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => r(1))))")

    def centre_of(self, identifier, across=0.5, down=0.5):
        return self.value("(() => { const e = document.getElementById('%s'); e.scrollIntoView({block: 'nearest'}); const b = e.getBoundingClientRect(); "
                          "return [b.x + %g * b.width, b.y + %g * b.height]; })()" % (identifier, across, down))

    def press(self, identifier):
        """Clicks a button; again if it has moved, as the page above it has grown."""
        self.value("(() => { const e = document.getElementById('%s'); delete e.dataset.heard; "
                   "e.addEventListener('click', () => { e.dataset.heard = 1; }, {once: true}); })()" % identifier)
        for _ in range(5):
            self.click(*self.centre_of(identifier))
            if self.value("document.getElementById('%s').dataset.heard === '1'" % identifier):
                return
        raise SystemExit("%s hears no click" % identifier)

    def click(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1,
                      buttons=1 if kind == "mousePressed" else 0)
        self.settle()

    def drag(self, x, y, dx, dy):
        self.call("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, button="left", buttons=1, clickCount=1)
        for k in range(1, 6):
            self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + dx * k / 5, y=y + dy * k / 5, button="left", buttons=1)
        self.call("Input.dispatchMouseEvent", type="mouseReleased", x=x + dx, y=y + dy, button="left", clickCount=1)
        self.settle()

    def key(self, key):
        code = {"ArrowRight": 39, "ArrowLeft": 37, "Home": 36, "End": 35, "Tab": 9, "Enter": 13, " ": 32}[key]
        text = {"text": {"Enter": "\r", " ": " "}[key]} if key in ("Enter", " ") else {}
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code="Space" if key == " " else key, windowsVirtualKeyCode=code,
                      **(text if kind == "keyDown" else {}))
        self.settle()

    def write(self, identifier, text):
        """Types a text into a field in place of what is there."""
        self.value("(() => { const e = document.getElementById('%s'); for (let d = e; d; d = d.parentElement) if (d.tagName === 'DETAILS') d.open = true; "
                   "e.focus(); e.select(); })()" % identifier)
        self.call("Input.insertText", text=text)
        self.settle()

    def choose(self, identifier, value):
        """Gives a control its value as a user's input does."""
        self.value("(() => { const e = document.getElementById('%s'); if (e.type === 'checkbox') e.click(); else { e.value = %s; "
                   "for (const n of ['input', 'change']) e.dispatchEvent(new Event(n, {bubbles: true})); } })()"
                   % (identifier, json.dumps(value)))
        self.settle()

    def picture(self, path, whole=False):
        data = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)["data"]
        with open(path, "wb") as f:
            f.write(base64.b64decode(data))

    def close(self):
        self.browser.kill()
        self.browser.wait()
        self.folder.cleanup()
