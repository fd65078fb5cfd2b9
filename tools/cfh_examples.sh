#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Computes the critical fall heights of the 50 mm and the 70 mm pad of examples/ into out/cfh50 and out/cfh70, and prints
# the table of docs/cfh.md.
#
#     tools/cfh_examples.sh            some minutes; finished drops of an earlier call are used again
#     tools/cfh_examples.sh --docs     the same, and writes table and picture into docs/
#
# docs/validation.md has the table of the predictions, which stay as they were made (tools/compare_page.sh): it is never written;
# with --docs the table goes into a copy of that page, $PAGE (default out/validation.md, made anew and compared).
#
# The intervals come from the draws of the foam in $POSTERIOR (default out/eva35/posterior, if that is there).
# The programs are those in build/bin, or in $SF_BIN_DIR.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

case ${1:-} in
'' | --docs) ;;
*) echo 'usage: tools/cfh_examples.sh [--docs]' >&2 && exit 2 ;;
esac
mkdir -p out
posterior=${POSTERIOR:-out/eva35/posterior}
draws=()
[ -z "${POSTERIOR:-}" ] && [ ! -d "$posterior" ] || draws=(--posterior "$posterior")
for pad in 50 70; do
    "${SF_BIN_DIR:-build/bin}/softfall-cfh" "examples/eva$pad-v4.5/case.cfg" -o "out/cfh$pad" --force \
        --rig examples/data/penta2018_table2_70mm.csv ${draws[@]+"${draws[@]}"} >&2
done
[ "${1:-}" != --docs ] || cp out/cfh50/cfh.png docs/images/cfh_eva50.png
page=${PAGE:-out/validation.md}
[ "${1:-}" != --docs ] || [ -n "${PAGE:-}" ] || cp docs/validation.md "$page"
python3 - "${1:-}" "$page" <<'PYTHON'
import json
import sys

HEAD = ("pad (mm)", "decides", "as simulated: free fall (m)", "on the rig (m)", "a_max = 200 g at (m)", "HIC = 1000 at (m)",
        "median and 95 % interval: free fall (m)", "the foam alone (m)", "on the rig, with g_eff (m)", "drops",
        "largest rms residual (%)", "local strain at the next point above")


def row_of(pad):
    with open("out/cfh%d/cfh.json" % pad) as stream:
        found = json.load(stream)
    height, (a_max, hic) = found["critical_fall_height"], found["criteria"]
    above = [p for p in found["points"] if not p["failed"] and height["height_m"] and p["height_m"] >= height["height_m"]]

    def show(entry, key, digits=3):
        return entry.get("state", "-") if entry[key] is None else "%.*f" % (digits, entry[key])

    def interval(entry, key):
        if entry.get(key + "_median_m") is None:
            return "-"
        low, middle, high = (entry[key + suffix] for suffix in ("_low_m", "_median_m", "_high_m"))
        return "%.2f (%s to %s)" % (middle, "open" if low is None else "%.2f" % low, "open" if high is None else "%.2f" % high)

    return ("%d" % pad, height["deciding"] or height["verdict"], show(height, "height_m"), show(height, "rig_height_m", 2),
            show(a_max, "height_m"), show(hic, "height_m"), interval(height, "height"), interval(found["posterior"], "foam"),
            interval(height, "rig_height"), "%d" % len(found["points"]),
            "%.2f" % (100 * max(c["fit"]["rms_residual"] or 0 for c in (a_max, hic))),
            "%.3f" % above[0]["max_local_strain"] if above else "-")


rows = [HEAD, ["---:", "---"] + ["---:"] * (len(HEAD) - 2), row_of(50), row_of(70)]
table = ["| " + " | ".join(row) + " |" for row in rows]
print("\n".join(table))
if sys.argv[1] == "--docs":
    for path in ("docs/cfh.md", sys.argv[2]):
        with open(path) as stream:
            lines = stream.read().split("\n")
        begin = next(k for k, line in enumerate(lines) if line.startswith("| %s |" % HEAD[0]))
        with open(path, "w") as stream:
            stream.write("\n".join(lines[:begin] + table + lines[begin + len(rows):]))
PYTHON
[ "${1:-}" != --docs ] || [ -n "${PAGE:-}" ] || tools/compare_page.sh docs/validation.md "$page"
