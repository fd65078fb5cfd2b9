#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Checks predicted rows of softfall-sweep against their drops: runs each plan of examples/accuracy with the accuracy that
# it asks for, then simulates all of its rows, and prints how many intervals hold the drop and how large the errors are
# (docs/performance.md, "Predicted rows").
#
#     tools/accuracy_study.sh ROWS [PLAN...]     2000 rows: a drop of about one second of a core each; plans: their
#                                                names without .cfg, default all
#     SF_SPACING=17.5 tools/accuracy_study.sh ROWS [PLAN...]     the same on nodes of 17.5 mm (30 mm outside) in place of
#                                                10 mm, in a third of the time: to compare ways to predict
#     SF_MATERIAL=leap tools/accuracy_study.sh ROWS pad          with another foam, by the name of its file in
#                                                examples/materials
#     SF_COARSE=25.0 tools/accuracy_study.sh ROWS [PLAN...]      with coarse drops on nodes of 25 mm (40 mm outside)
#     SF_TIME=90m tools/accuracy_study.sh ROWS [PLAN...]         stops to simulate the rows of a plan after that time, and
#                                                compares those that were reached
#
# Folders out/accuracy-PLAN keep the drops, and begin with OUT in place of "out" with SF_OUT=OUT. The programs are those in
# build/bin, or in $SF_BIN_DIR.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -ge 1 ] && [[ $1 =~ ^[0-9]+$ ]] || { echo 'usage: tools/accuracy_study.sh ROWS [PLAN...]' >&2 && exit 2; }
rows=$1
shift
[ $# -gt 0 ] || set -- $(cd examples/accuracy && ls ./*.cfg | sed 's,^\./,,; s,\.cfg$,,')
out=${SF_OUT:-out}
folders=()
mkdir -p "$out"
for plan in "$@"; do
    folder=$out/accuracy-$plan${SF_MATERIAL:+-$SF_MATERIAL}${SF_COARSE:+-coarse}
    folders+=("$folder")
    sed -e "s/count = 2000/count = $rows/" -e "s,\"\.\./,\"$PWD/examples/,g" "examples/accuracy/$plan.cfg" >"$folder.cfg"
    [ -z "${SF_SPACING:-}" ] || sed -i -e "s/fine_spacing=10.0/fine_spacing=$SF_SPACING/" \
        -e "s/outer_spacing=20.0/outer_spacing=30.0\", \"pad.mesh_error_limit=1/" "$folder.cfg"
    [ -z "${SF_MATERIAL:-}" ] || sed -i "s,^set = \[,&\"material=@$PWD/examples/materials/$SF_MATERIAL.cfg\"\, ," "$folder.cfg"
    [ -z "${SF_COARSE:-}" ] || printf 'coarse = ["geometry.parameters.fine_spacing=%s", %s];\n' "$SF_COARSE" \
        '"geometry.parameters.outer_spacing=40.0", "pad.mesh_error_limit=1"' >>"$folder.cfg"
    sed -e 's/ accuracy = [0-9.]*;//g' -e '/^coarse = /d' "$folder.cfg" >"$folder-all.cfg"
    "${SF_BIN_DIR:-build/bin}/softfall-sweep" "$folder.cfg" -o "$folder" >"$folder.log"
    cp "$folder/runs.csv" "$folder-predicted.csv"
    ${SF_TIME:+timeout -s INT "$SF_TIME"} "${SF_BIN_DIR:-build/bin}/softfall-sweep" "$folder-all.cfg" -o "$folder" \
        >"$folder-all.log" || [ $? -eq 124 ]
done
exec python3 - "${folders[@]}" <<'PYTHON'
import csv
import math
import pathlib
import sys


def read(path):
    with open(path, newline="") as stream:
        return list(csv.DictReader(stream))


def usable(row):
    return row["run_status"] == "done" and row["grade"] != "do not use"


print("| plan | rows | simulated | left open (of those compared usable) | figure | predicted and compared "
      "| intervals that hold | largest error | rms error |")
print("|---|---:|---:|---:|---|---:|---:|---:|---:|")
for folder in sys.argv[1:]:
    plan = folder.split("/accuracy-")[-1]
    rows, drops = read(f"{folder}-predicted.csv"), read(f"{folder}/runs.csv")
    simulated = sum(row["run_status"] in ("done", "failed") for row in rows)
    coarse = pathlib.Path(folder, "coarse/runs.csv")
    coarse = f", and {sum(row['run_status'] == 'done' for row in read(coarse))} coarse ones" if coarse.exists() else ""
    lows = [name for name in rows[0] if name.endswith("_low")]
    left = [drop for row, drop in zip(rows, drops) if row["run_status"] == "open"]
    told = [drop for drop in left if drop["run_status"] != "open"]
    lost = sum(usable(drop) and all(drop[low[: -len("_low")]] for low in lows) for drop in told)
    for low in lows:
        figure = low[: -len("_low")]
        errors, held, wrong = [], 0, 0
        for row, drop in zip(rows, drops):
            if row["run_status"] != "predicted" or drop["run_status"] == "open":
                continue
            if not usable(drop) or not drop[figure]:
                wrong += 1
                continue
            value = float(drop[figure])
            errors.append(float(row[figure]) / value - 1)
            held += float(row[low]) <= value <= float(row[figure + "_high"])
        if not errors:
            sys.exit(f"{folder}: no predicted row was simulated: give more time (SF_TIME)")
        rms = math.sqrt(sum(e * e for e in errors) / len(errors))
        note = f" ({wrong} have none that may be used)" if wrong else ""
        print(f"| {plan} | {len(rows)} | {simulated} ({100 * simulated / len(rows):.1f} %){coarse} | {len(left)} ({lost} of {len(told)}) | {figure} "
              f"| {len(errors)}{note} | {100 * held / len(errors):.1f} % | {100 * max(map(abs, errors)):.2f} % "
              f"| {100 * rms:.2f} % |")
PYTHON
