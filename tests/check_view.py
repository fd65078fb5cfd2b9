# SPDX-License-Identifier: GPL-3.0-or-later
"""Uses a view.html as a user does, in headless Chromium: check_view.py PAGE PICKS SIZE...

Each SIZE is WIDTHxHEIGHT of a window; below 700 it is a phone's. Prints what went wrong and exits with 1. Writes into PICKS a
line for each node that a click told: time of the frame (s), field, node, value and its error (SI), place and its error (m)."""
import os
import sys
import tempfile
import time
import zlib

import browse

failures = []


def expect(true, what):
    if not true:
        failures.append(what)


def readout(page):
    return page.value("({...document.getElementById('readout').dataset})")


def overlaps(page):
    """Pairs of elements with texts or controls of which one covers the other, and what sticks out of the window."""
    return page.value("""(() => {
      document.getElementById('panel').scrollTop = 0;
      scrollTo(0, 0);
      const seen = [...document.querySelectorAll('h1, p, button, select, input, output, label, #scene, #curve')].filter(e => e.offsetWidth && getComputedStyle(e).visibility === 'visible');
      const out = [], name = e => e.id || e.textContent.slice(0, 20);
      for (const a of seen) {
        const p = a.getBoundingClientRect();
        if (p.right > innerWidth + 1 || p.left < -1) out.push(name(a) + ' sticks out');
        if (a.scrollWidth > a.clientWidth + 1 && a.clientWidth && a.tagName !== 'INPUT' && a.id !== 'scene') out.push(name(a) + ' is cut');
        for (const b of seen) {
          if (a === b || a.contains(b) || b.contains(a)) continue;
          const q = b.getBoundingClientRect(), w = Math.min(p.right, q.right) - Math.max(p.left, q.left), h = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
          if (w > 1 && h > 1) out.push(name(a) + ' covers ' + name(b));
        }
      }
      return out;
    })()""")


def pick_around(page, picks):
    """Clicks at places of the picture; returns how many nodes were told."""
    told = 0
    for across, down in ((0.5, 0.64), (0.3, 0.55), (0.66, 0.58)):
        page.click(*page.centre_of("overlay", across, down))
        r = readout(page)
        if r["node"]:
            told += 1
            picks.append("\t".join([r["time"], r["field"], r["node"], r["value"], r["error"], r["place"].replace(",", "\t"), r["within"]]))
    return told


def use_time(page):
    last = int(page.value("document.getElementById('time').max"))
    page.click(*page.centre_of("time"))
    page.key("Home")
    expect(readout(page)["frame"] == "0", "Home does not show the first frame")
    page.key("ArrowRight")
    expect(readout(page)["frame"] == str(min(1, last)), "an arrow does not move the slider")
    page.key("End")
    expect(readout(page)["frame"] == str(last), "End does not show the last frame")
    shown = page.value("document.getElementById('now').textContent")
    expect(shown == "%.2f ms" % (1e3 * float(readout(page)["time"])), "the time beside the slider is " + shown)
    if last == 0:
        return
    page.click(*page.centre_of("play"))
    page.wait_for("document.getElementById('readout').dataset.frame !== '%d'" % last, 20)
    page.click(*page.centre_of("play"))
    at = readout(page)["frame"]
    time.sleep(0.6)
    expect(readout(page)["frame"] == at, "Pause does not stop it")
    page.click(*page.centre_of("curve", 0.2))
    early = int(readout(page)["frame"])
    page.click(*page.centre_of("curve", 0.8))
    expect(int(readout(page)["frame"]) > early, "a click on the curve does not choose the time")


def save_picture(page):
    with tempfile.TemporaryDirectory() as folder:
        page.call("Page.setDownloadBehavior", behavior="allow", downloadPath=folder)
        page.click(*page.centre_of("picture"))
        end, data = time.monotonic() + 30, b""
        while not data.endswith(b"IEND\xaeB`\x82") and time.monotonic() < end:  # the browser makes an empty file first
            time.sleep(0.1)
            for name in [n for n in os.listdir(folder) if n.endswith(".png")]:
                with open(os.path.join(folder, name), "rb") as f:
                    data = f.read()
        expect(data, "no picture was saved")
        expect(data[:8] == b"\x89PNG\r\n\x1a\n" and count_colours(data) > 20, "the picture that was saved is empty")


def count_colours(png):
    """Different filtered rows' bytes do; a white picture has two or three."""
    at, packed = 8, b""
    while at < len(png):
        length = int.from_bytes(png[at:at + 4], "big")
        if png[at + 4:at + 8] == b"IDAT":
            packed += png[at + 8:at + 8 + length]
        at += length + 12
    return len(set(zlib.decompress(packed)))


def use(path, width, height, picks):
    page = browse.Page(path, width, height, phone=width < 700)
    try:
        expect(page.value("getComputedStyle(document.getElementById('message')).display") == "none", "there is no picture")
        clash = overlaps(page)
        expect(not clash, "%dx%d: %s" % (width, height, clash))
        use_time(page)
        page.choose("time", page.value("String(Math.floor(document.getElementById('time').max / 2))"))
        told = 0
        for field in range(page.value("document.getElementById('field').options.length")):
            page.choose("field", str(field))
            told += pick_around(page, picks)
        page.choose("field", "0")
        for cut in ("0", "1", "2", "-1"):
            page.choose("cut", cut)
            told += pick_around(page, picks)
        page.choose("flip", None)
        page.choose("cut", "1")
        page.choose("whole", None)
        page.choose("lines", None)
        page.choose("missile", None)
        page.click(*page.centre_of("reset"))
        told += pick_around(page, picks)
        before = readout(page)["place"]
        page.drag(*page.centre_of("overlay"), 60, 25)
        expect(readout(page)["place"] == before, "a drag picks a node")
        expect(told > 3, "only %d clicks told a node" % told)
        save_picture(page)
        clash = overlaps(page)
        expect(not clash, "%dx%d: %s" % (width, height, clash))
        expect(len(page.requests) == 1, "it asks for %s" % page.requests[1:])
        expect(not page.errors, "errors: %s" % page.errors)
    finally:
        page.close()


def main():
    picks = []
    for size in sys.argv[3:]:
        use(sys.argv[1], *map(int, size.split("x")), picks)
    with open(sys.argv[2], "w") as out:
        out.write("".join(line + "\n" for line in picks))
    print("\n".join(failures))
    sys.exit(1 if failures else 0)


main()
