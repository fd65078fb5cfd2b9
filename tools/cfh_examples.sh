#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Computes the critical fall heights of the 50 mm and the 70 mm pad of examples/ into out/cfh50 and out/cfh70, and prints
# the table of docs/cfh.md.
#
#     tools/cfh_examples.sh            some minutes; finished drops of an earlier call are used again
#     tools/cfh_examples.sh --docs     the same, and writes table and picture into docs/
#
# The programs are those in build/bin, or in $SF_BIN_DIR.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

case ${1:-} in
'' | --docs) ;;
*) echo 'usage: tools/cfh_examples.sh [--docs]' >&2 && exit 2 ;;
esac
mkdir -p out
for pad in 50 70; do
    "${SF_BIN_DIR:-build/bin}/softfall-cfh" "examples/eva$pad-v4.5/case.cfg" -o "out/cfh$pad" --force \
        --rig examples/data/penta2018_table2_70mm.csv >&2
done
[ "${1:-}" != --docs ] || cp out/cfh50/cfh.png docs/images/cfh_eva50.png
python3 - "${1:-}" <<'PYTHON'
import json
import sys

HEAD = ("pad (mm)", "decides", "critical height, free fall (m)", "on the rig (m)", "a_max = 200 g at (m)", "HIC = 1000 at (m)",
        "drops", "largest rms residual (%)", "local strain at the next point above")


def row_of(pad):
    with open("out/cfh%d/cfh.json" % pad) as stream:
        found = json.load(stream)
    height, (a_max, hic) = found["critical_fall_height"], found["criteria"]
    above = [p for p in found["points"] if not p["failed"] and height["height_m"] and p["height_m"] >= height["height_m"]]

    def show(entry, key):
        digits = 3 if key == "height" else 2
        low, middle, high = (entry[key + suffix] for suffix in ("_low_m", "_m", "_high_m"))
        return entry.get("state", "-") if middle is None else "%.*f (%.*f to %.*f)" % (digits, middle, digits, low, digits, high)

    return ("%d" % pad, height["deciding"] or height["verdict"], show(height, "height"), show(height, "rig_height"),
            show(a_max, "height"), show(hic, "height"), "%d" % len(found["points"]),
            "%.2f" % (100 * max(c["fit"]["rms_residual"] or 0 for c in (a_max, hic))),
            "%.3f" % above[0]["max_local_strain"] if above else "-")


rows = [HEAD, ["---:", "---"] + ["---:"] * (len(HEAD) - 2), row_of(50), row_of(70)]
table = ["| " + " | ".join(row) + " |" for row in rows]
print("\n".join(table))
if sys.argv[1] == "--docs":
    with open("docs/cfh.md") as stream:
        lines = stream.read().split("\n")
    begin = next(k for k, line in enumerate(lines) if line.startswith("| %s |" % HEAD[0]))
    with open("docs/cfh.md", "w") as stream:
        stream.write("\n".join(lines[:begin] + table + lines[begin + len(rows):]))
PYTHON
