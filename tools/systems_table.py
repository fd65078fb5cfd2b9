# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints a table that compares the same drops computed on two systems, each a folder of DIR/NAME/summary.json.

    python3 tools/systems_table.py FIRST SECOND

FIRST and SECOND have the names of the releases. Exit code 1 if a_max or HIC of a drop differs by more than 0.5 %.
"""
import glob
import os
import sys

from results_table import read_summary

LIMIT_PERCENT = 0.5


def percent(a, b):
    return 100 * (b - a) / a


def main():
    arguments = sys.argv[1:]
    if len(arguments) != 2:
        sys.exit(__doc__)
    first, second = arguments
    names = [os.path.basename(os.path.normpath(a)) for a in arguments]
    head = ("drop on two systems", "nodes, %s" % names[0], "nodes, %s" % names[1], "a_max (g), %s" % names[0],
            "a_max (g), %s" % names[1], "difference (%)", "HIC, %s" % names[0], "HIC, %s" % names[1], "difference (%)")
    rows, worst = [head, ["---"] + ["---:"] * (len(head) - 1)], 0.0
    for path in sorted(glob.glob(os.path.join(first, "*", "summary.json"))):
        drop = os.path.basename(os.path.dirname(path))
        a, b = read_summary(os.path.join(first, drop)), read_summary(os.path.join(second, drop))
        if a.get("prescribed_motion"):
            continue
        if None in (a["a_max_g"], a["hic"], b["a_max_g"], b["hic"]):
            sys.exit("systems_table: %s has no a_max or HIC on one of the systems" % drop)
        change = [percent(a[key], b[key]) for key in ("a_max_g", "hic")]
        worst = max([worst] + [abs(c) for c in change])
        rows.append((drop, "%d" % a["nodes"], "%d" % b["nodes"], "%.3f" % a["a_max_g"], "%.3f" % b["a_max_g"],
                     "%+.3f" % change[0], "%.2f" % a["hic"], "%.2f" % b["hic"], "%+.3f" % change[1]))
    if len(rows) == 2:
        sys.exit("systems_table: no drop in %s: run tools/compare_systems.sh first" % first)
    print("\n".join("| " + " | ".join(row) + " |" for row in rows))
    if not worst <= LIMIT_PERCENT:
        sys.exit("systems_table: a figure differs by %.2f %%, more than %g %%" % (worst, LIMIT_PERCENT))


main()
