#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs examples/sweep into out/sweep, and one foam of it (20 drops) with the mesh of the case, 5 mm in the core, into
# out/sweep_fine. Prints the probability of HIC < 1000 as a table, and what 100,000 such drops take (docs/campaigns.md).
#
#     tools/sweep_example.sh           ten minutes on two idle cores; neither folder may be there
#
# The programs are those in build/bin, or in $SF_BIN_DIR.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

[ $# -eq 0 ] || { echo 'usage: tools/sweep_example.sh' >&2 && exit 2; }
for folder in out/sweep out/sweep_fine; do
    [ ! -e "$folder" ] || { echo "sweep_example: $folder is there: its drops cannot be timed, remove it" >&2 && exit 2; }
done
mkdir -p out
plan=examples/sweep/plan.cfg
fine=out/sweep_fine.cfg
sed -e '/^set = /d' -e 's/draws = 20/draws = 1/' -e "s,\"\.\./,\"$PWD/examples/," "$plan" >"$fine"
sweep() {
    /usr/bin/time -f '%e %U %S' -o "$2.time" "${SF_BIN_DIR:-build/bin}/softfall-sweep" "$1" -o "$2" >&2
}
sweep "$plan" out/sweep
sweep "$fine" out/sweep_fine
exec python3 - <<'PYTHON'
import glob
import json
import os

DROPS, CORES, PER_JOB, WAVE, STARTS = 1e5, 1000, 20, 20000, 10  # of the budget; starts of jobs per second


def read(path):
    with open(path) as stream:
        return json.load(stream)


def rows_of_map():
    hic = next(f for f in read("out/sweep/sweep.json")["figures"] if f["figure"] == "hic")
    cells = {(c["thickness"], c["speed"]): c for c in hic["probability_below_limit"]}
    thicknesses, speeds = (list(dict.fromkeys(place[k] for place in cells)) for k in (0, 1))
    yield ["thickness (mm)"] + ["%s m/s" % speed.replace(" m/s", "") for speed in speeds]
    yield ["---:"] * (1 + len(speeds))
    for thickness in thicknesses:
        row = [cells[thickness, speed] for speed in speeds]
        yield [thickness] + ["%.2f (%.2f to %.2f)" % (c["probability"], c["low"], c["high"]) for c in row]


def row_of_budget(name, folder):
    with open(folder + ".time") as stream:
        seconds = sum(map(float, stream.read().split()[1:]))
    folders = glob.glob(folder + "/runs/drop-*")
    size = sum(os.path.getsize(path) for path in glob.glob(folder + "/runs/drop-*/*"))
    drop = seconds / len(folders)
    waves, jobs = DROPS / WAVE, WAVE / PER_JOB
    return [name, "%.1f s" % drop, "%.0f h" % (DROPS * drop / 3600),
            "%.0f × %.0f s = %.1f min" % (waves, WAVE * drop / CORES, waves * WAVE * drop / CORES / 60),
            "%.0f × %.1f min" % (waves, jobs / STARTS / 60), "%.0f GB" % (DROPS * size / len(folders) / 1e9)]


def table(rows):
    return ["| " + " | ".join(row) + " |" for row in rows]


probabilities = table(rows_of_map())
budget = table([["quarter pad", "processor time of a drop", "10⁵ drops, one core", "work on %d cores" % CORES,
                 "starting the jobs", "results on disk"], ["---"] + ["---:"] * 5,
                row_of_budget("10 mm", "out/sweep"), row_of_budget("5 mm", "out/sweep_fine")])
for rows in (probabilities, budget):
    print("\n".join(rows) + "\n")
PYTHON
