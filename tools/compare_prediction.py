#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the predictions for the 50 mm pad and the critical fall heights with the paper's measurements.

    tools/compare_prediction.py [PAGE.md]

Reads fit.json of out/eva35 (the drops on 70 mm) and, where it is there, out/eva35_four (with the drop on 50 mm at 4.5 m/s), out/cfh50/cfh.json and
out/cfh70/cfh.json (tools/identify_examples.sh makes them) and examples/data, and prints the tables, or writes them into the page in place of
those between `<!-- comparison by softfall fit -->` and `<!-- end -->`.
"""
import csv
import json
import math
import os
import sys

MARK = "<!-- comparison by softfall fit -->\n"
ROWS = (("a_max (g)", "a_max_g", "a_max_real_g", "%.1f"), ("HIC", "HIC", "HIC_real", "%.0f"), ("HIC window (ms)", "HIC_window_ms", None, "%.2f"))


def read(path):
    with open(path) as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("#")))


def predictions(folder):
    with open(f"out/{folder}/fit.json") as stream:
        return {(p["drop"], p["quantity"]): p for p in json.load(stream)["inference"]["predictions"]}


def holds(measured, p, key=""):
    return p[key + "low90"] <= measured <= (p[key + "high90"] if p[key + "high90"] is not None else math.inf)


def interval(form, p):
    if p["high90"] is None:
        return (form + ", open above") % p["low90"], "–"
    return (form + " to " + form) % (p["low90"], p["high90"]), "%.0f %%" % (100 * (p["high90"] - p["low90"]) / p["median"])


def drops():
    three, four = predictions("eva35"), predictions("eva35_four") if os.path.exists("out/eva35_four/fit.json") else None
    yield "| drop | quantity | measured | median | 90 % | width | holds it | without any one form |" + " with eva50-v4.5 in the fit: 90 % | width | holds it |" * (four is not None)
    yield "|---|---|---:|---:|---:|---:|---|---:|" + "---:|---:|---|" * (four is not None)
    for row in read("examples/data/penta2018_table2_50mm.csv"):
        drop = "eva50-v" + row["v_test_m_s"]
        for name, key, real, form in ROWS:
            p, after = three[drop, key], four.get((drop, key)) if four else None
            measured = float(row[real]) if real else float(row["t_f_ms"]) - float(row["t_i_ms"])
            without = all(holds(measured, one, "without_") for one in p["by_model"])
            cells = [drop, name, form % measured, form % p["median"], *interval(form, p), "yes" if holds(measured, p) else "**no**", "yes" if without else "no"]
            cells += [] if four is None else [*interval(form, after), "yes" if holds(measured, after) else "**no**"] if after else ["fitted", "", ""]
            yield "| " + " | ".join(cells) + " |"


def heights():
    yield "| pad (mm) | critical fall height on the rig, measured (m) | at least (95 %) | median | 95 % | holds it |"
    yield "|---:|---:|---:|---:|---:|---|"
    for row in read("examples/data/penta2018_critical_heights.csv"):
        measured = float(row["critical_height_m"])
        with open("out/cfh%s/cfh.json" % row["thickness_mm"]) as stream:
            found = json.load(stream)["critical_fall_height"]
        least, low, middle, high = (found["rig_" + key + "_m"] for key in ("at_least", "height_low", "height_median", "height_high"))
        yield "| %s | %.3f | %.2f | %.2f | %.2f to %s | %s |" % (row["thickness_mm"], measured, math.floor(100 * least) / 100, middle, low, "open" if high is None else "%.2f" % high,
                                                           "yes" if low <= measured <= (high or math.inf) else "**no**")


text = "\n".join([*drops(), "", *heights()])
if len(sys.argv) < 2:
    print(text)
else:
    with open(sys.argv[1]) as stream:
        before, rest = stream.read().split(MARK, 1)
    with open(sys.argv[1], "w") as stream:
        stream.write(before + MARK + text + "\n<!-- end -->" + rest.split("<!-- end -->", 1)[1])
