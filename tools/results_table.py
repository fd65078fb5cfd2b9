# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the figures of some runs as a Markdown table, read from DIR/summary.json.

    python3 tools/results_table.py [--into FILE.md] DIR...

With --into it instead replaces the table in that file that begins with "| drop |". Runs with a prescribed motion are no
drops and have no row. Brackets beside a_max and HIC give the measured values of the same thickness and speed, if
examples/data/penta2018_table2_70mm.csv has them.
"""
import csv
import json
import os
import sys

MEASURED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../examples/data/penta2018_table2_70mm.csv")
HEAD = ("drop", "a_max (g)", "HIC", "HIC window (ms)", "rebound (m/s)", "energy error (%)", "largest local strain",
        "nodes", "steps")


def read_measured():
    """{(thickness in mm, speed in m/s): (a_max, HIC)}"""
    with open(MEASURED) as stream:
        rows = csv.DictReader(line for line in stream if not line.startswith("#"))
        return {(float(row["thickness_mm"]), float(row["v_test_m_s"])): (row["a_max_real_g"], row["HIC_real"])
                for row in rows}


def read_summary(directory):
    try:
        with open(os.path.join(directory, "summary.json")) as stream:
            return json.load(stream)
    except OSError as problem:
        sys.exit("results_table: %s: run tools/run_examples.sh first" % problem)


def row_of(directory, s, measured):
    real = measured.get((s["thickness_mm"], s["v0_m_s"]))
    brackets = [" (%s)" % value for value in real] if real else ["", ""]

    def show(form, *keys):
        return "none" if any(s[key] is None for key in keys) else form % tuple(s[key] for key in keys)

    return (os.path.basename(os.path.normpath(directory)), show("%.1f", "a_max_g") + brackets[0],
            show("%.0f", "hic") + brackets[1], show("%.2f to %.2f", "hic_t1_ms", "hic_t2_ms"),
            show("%.2f", "v_rebound_m_s"), "%.4f" % (100 * s["energy_error"]), show("%.3f", "max_local_strain"),
            "%d" % s["nodes"], "%d" % s["steps"])


def replace_table(path, table):
    with open(path) as stream:
        lines = stream.read().split("\n")
    start = table[0].split(" | ")[0]
    begin = next((k for k, line in enumerate(lines) if line.startswith(start + " |")), None)
    if begin is None:
        sys.exit('results_table: %s has no line that begins with "%s |"' % (path, start))
    end = next(k for k in range(begin, len(lines)) if not lines[k].startswith("|"))
    with open(path, "w") as stream:
        stream.write("\n".join(lines[:begin] + table + lines[end:]))


def main():
    arguments = sys.argv[1:]
    into = None
    if arguments[:1] == ["--into"]:
        into, arguments = arguments[1], arguments[2:]
    if not arguments:
        sys.exit(__doc__)
    measured = read_measured()
    summaries = [(name, read_summary(name)) for name in arguments]
    rows = [HEAD, ["---"] + ["---:"] * (len(HEAD) - 1)]
    rows += [row_of(name, s, measured) for name, s in summaries if not s.get("prescribed_motion")]
    table = ["| " + " | ".join(row) + " |" for row in rows]
    if into:
        replace_table(into, table)
    else:
        print("\n".join(table))


if __name__ == "__main__":
    main()
