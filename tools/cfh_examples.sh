#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Computes the critical fall heights of the 50 mm and the 70 mm pad of the paper, as axisymmetric drops with draws of the foam, into
# out/cfh50 and out/cfh70, and prints the table of docs/cfh.md.
#
#     tools/cfh_examples.sh            five minutes of processor time; finished drops of an earlier call are used again
#     tools/cfh_examples.sh --docs     the same, and writes table and picture into docs/
#
# The draws are those in $POSTERIOR (default examples/materials/eva35_posterior), the programs those in build/bin, or in $SF_BIN_DIR.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case ${1:-} in
'' | --docs) ;;
*) echo 'usage: tools/cfh_examples.sh [--docs]' >&2 && exit 2 ;;
esac
mkdir -p out
for pad in 50 70; do
    "${SF_BIN_DIR:-build/bin}/softfall" cfh examples/eva50-axisymmetric/case.cfg -o "out/cfh$pad" --force --set geometry.parameters.thickness=$pad \
        --rig examples/data/penta2018_table2_70mm.csv --posterior "${POSTERIOR:-examples/materials/eva35_posterior}" >&2
done
[ "${1:-}" != --docs ] || cp out/cfh50/cfh.png docs/images/cfh_eva50.png
python3 - "${1:-}" <<'PYTHON'
import csv
import json
import math
import sys

HEAD = ("pad (mm)", "at least (95 %), on the rig (m)", "median and 95 % interval, on the rig (m)", "measured (m)")
with open("examples/data/penta2018_critical_heights.csv") as stream:
    measured = {row["thickness_mm"]: row["critical_height_m"] for row in csv.DictReader(line for line in stream if not line.startswith("#"))}


def row_of(pad):
    with open("out/cfh%s/cfh.json" % pad) as stream:
        height = json.load(stream)["critical_fall_height"]
    # The height that is promised is rounded down, as the answer is.
    least, *interval = (height["rig_" + key + "_m"] for key in ("at_least", "height_median", "height_low", "height_high"))
    return pad, "%.2f" % (math.floor(100 * least) / 100), "%s (%s to %s)" % tuple("open" if value is None else "%.2f" % value for value in interval), measured[pad]


rows = [HEAD, ["---:"] * len(HEAD), row_of("50"), row_of("70")]
table = ["| " + " | ".join(row) + " |" for row in rows]
print("\n".join(table))
if sys.argv[1] == "--docs":
    with open("docs/cfh.md") as stream:
        lines = stream.read().split("\n")
    begin = next(k for k, line in enumerate(lines) if line.startswith("| %s |" % HEAD[0]))
    with open("docs/cfh.md", "w") as stream:
        stream.write("\n".join(lines[:begin] + table + lines[begin + len(rows):]))
PYTHON
