#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs examples/sweep into out/sweep, and one foam of the posterior (20 drops) with the mesh of the plan and with that of
# the case, 5 mm in the core, into out/sweep_coarse and out/sweep_fine. Prints the probability of HIC < 1000, what the
# coarse mesh changes, as tables; then the largest HIC of the pad of 70 mm and the
# times of the solver (docs/campaigns.md; docs/performance.md, "Checks of campaigns").
#
#     tools/sweep_example.sh           seven minutes on two idle cores; the folders must not be there
#
# The programs are those in build/bin, or in $SF_BIN_DIR.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

[ $# -eq 0 ] || { echo 'usage: tools/sweep_example.sh' >&2 && exit 2; }
for folder in out/sweep out/sweep_coarse out/sweep_fine; do
    [ ! -e "$folder" ] || { echo "sweep_example: $folder is there: remove it" >&2 && exit 2; }
done
mkdir -p out
plan=examples/sweep/plan.cfg
sed -e 's/draws = 20/draws = 1/' -e "s,\"\.\./,\"$PWD/examples/," "$plan" >out/sweep_coarse.cfg
sed -e '/^set = /d' out/sweep_coarse.cfg >out/sweep_fine.cfg
sweep() {
    "${SF_BIN_DIR:-build/bin}/softfall" sweep "$1" -o "$2" >&2
}
sweep "$plan" out/sweep
sweep out/sweep_coarse.cfg out/sweep_coarse
sweep out/sweep_fine.cfg out/sweep_fine
exec python3 - <<'PYTHON'
import csv
import json


def read(path):
    with open(path) as stream:
        return json.load(stream)


def rows_of_places(cells):
    """Rows of a table of thickness and speed; cells: the text of each (thickness, speed)."""
    thicknesses, speeds = (list(dict.fromkeys(place[k] for place in cells)) for k in (0, 1))
    yield ["thickness (mm)"] + ["%s m/s" % speed for speed in speeds]
    yield ["---:"] * (1 + len(speeds))
    for thickness in thicknesses:
        yield [thickness] + [cells[thickness, speed] for speed in speeds]


def cells_of_map():
    hic = next(f for f in read("out/sweep/sweep.json")["figures"] if f["figure"] == "hic")
    return {(c["thickness"], c["speed"]): "%.2f (%.2f to %.2f)%s" % (
        c["probability"], c["low"], c["high"], ", %d?" % c["unknown"] if c["unknown"] else "")
        for c in hic["probability_below_limit"]}


def runs(folder):
    with open(folder + "/runs.csv", newline="") as stream:
        return list(csv.DictReader(stream))


def place_of(row):
    return row["thickness"], row["speed (m/s)"]


def cells_of_mesh():
    coarse, fine = ({place_of(row): row for row in runs(folder)} for folder in ("out/sweep_coarse", "out/sweep_fine"))
    cells = {}
    for place, run in fine.items():
        both = (run, coarse[place])
        if any(r["run_status"] != "done" for r in both):
            cells[place] = "failed"
            continue
        change = ["%+.1f" % (100 * (float(coarse[place][key]) / float(run[key]) - 1)) for key in ("a_max_g", "hic")]
        unusable = any(r["grade"] == "do not use" for r in both)
        cells[place] = ", ".join(change) + (" (not to be used)" if unusable else "")
    return cells


def lines_of_runs():
    """What docs/campaigns.md says of single runs."""
    for name, folder in (("10 mm", "out/sweep"), ("5 mm", "out/sweep_fine")):
        rows = [row for row in runs(folder) if row["run_status"] == "done"]
        for speed in sorted({row["speed (m/s)"] for row in rows}, key=float):
            hic = [float(row["hic"]) for row in rows if place_of(row) == ("70", speed)]
            yield "%s mesh, pad of 70 mm at %s m/s: largest HIC %.0f of %d runs" % (name, speed, max(hic), len(hic))
        times = sorted(float(row["wall_s"]) for row in rows)
        yield "%s mesh: a solver's wall time is %.1f to %.1f s, median %.1f s" % (
            name, times[0], times[-1], times[len(times) // 2])


def table(rows):
    return ["| " + " | ".join(row) + " |" for row in rows]


probabilities = table(rows_of_places(cells_of_map()))
mesh = table(rows_of_places(cells_of_mesh()))
for rows in (probabilities, mesh, lines_of_runs()):
    print("\n".join(rows) + "\n")
PYTHON
