#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the predictions for the 50 mm pad and the critical fall heights with the paper's measurements.

    tools/compare_prediction.py [PAGE.md]

Reads out/eva35/fit.json, out/cfh50/cfh.json and out/cfh70/cfh.json (tools/identify_examples.sh makes them) and examples/data, and
prints the tables, or writes them into a copy of docs/validation.md in place of those between `<!-- comparison -->` and `<!-- end -->`.
"""
import csv
import json
import sys

# The first form of the foam (examples/fit/eva35_drops.cfg), as it was predicted before the measurements were looked at.
FIRST = {"4.5": {"a_max_g": 93.2, "HIC": 308}, "5.2": {"a_max_g": 138.7, "HIC": 616}}
FIRST_HEIGHT = {"50": 2.05, "70": 2.98}
ROWS = (("a_max (g)", "a_max_g", "a_max_real_g", "a_max_sim_g", "%.1f"), ("HIC", "HIC", "HIC_real", "HIC_sim", "%.0f"),
        ("HIC window (ms)", "HIC_window_ms", None, None, "%.2f"))


def read(path):
    with open(path) as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("#")))


def off(value, measured):
    return "%+.1f %%" % (100 * (value / measured - 1))


def verdict(measured, low, high):
    inside = (low is not None and low <= measured) and (high is None or measured <= high)  # None: open above
    return "yes" if inside else "**no**"


def interval(form, low, high):
    return "open above" if low is None else "from " + form % low + ", open above" if high is None else (form + " to " + form) % (low, high)


def drops():
    with open("out/eva35/fit.json") as stream:
        fit = json.load(stream)
    found = {(p["drop"], p["quantity"]): p for p in fit["inference"]["predictions"]}
    yield "| drop | quantity | measured | LS-DYNA (paper) | | first form | | second form | | 95 % | holds it |"
    yield "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---|"
    for row in read("examples/data/penta2018_table2_50mm.csv"):
        speed = row["v_test_m_s"]
        for name, key, real, simulated, form in ROWS:
            p = found["eva50-v" + speed, key]
            measured = float(row[real]) if real else float(row["t_f_ms"]) - float(row["t_i_ms"])
            others = []
            for value in (float(row[simulated]) if simulated else None, FIRST[speed].get(key), p["median"]):
                others += ["–", ""] if value is None else [form % value, off(value, measured)]
            yield "| " + " | ".join(["eva50-v" + speed, name, form % measured, *others,
                                     interval(form, p["low95"], p["high95"]), verdict(measured, p["low95"], p["high95"])]) + " |"


def heights():
    yield "| pad (mm) | critical fall height on the rig, measured (m) | first form (m) | | second form (m) | | 95 % (m) | holds it |"
    yield "|---:|---:|---:|---:|---:|---:|---:|---|"
    for row in read("examples/data/penta2018_critical_heights.csv"):
        pad, measured = row["thickness_mm"], float(row["critical_height_m"])
        with open("out/cfh%s/cfh.json" % pad) as stream:
            found = json.load(stream)["critical_fall_height"]
        low, middle, high = (found["rig_height_" + suffix + "_m"] for suffix in ("low", "median", "high"))
        yield "| %s | %.3f | %.2f | %s | %.2f | %s | %.2f to %.2f | %s |" % (
            pad, measured, FIRST_HEIGHT[pad], off(FIRST_HEIGHT[pad], measured), middle, off(middle, measured), low, high,
            verdict(measured, low, high))


text = "\n".join([*drops(), "", *heights()])
if len(sys.argv) < 2:
    print(text)
else:
    with open(sys.argv[1]) as stream:
        before, rest = stream.read().split("<!-- comparison -->\n", 1)
    with open(sys.argv[1], "w") as stream:
        stream.write(before + "<!-- comparison -->\n" + text + "\n<!-- end -->" + rest.split("<!-- end -->", 1)[1])
