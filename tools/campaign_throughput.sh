#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tools/campaign_throughput.sh [DROPS]: DROPS (1000) coarse quarter drops (10 mm core) of one pad at different speeds by
# softfall-sweep, with --jobs 1 and with --jobs 2, one thread each. Prints drops per hour, their ratio, what a drop costs beside
# softfall-pre and softfall-solve (the same programs with the same shared mesh started by this script, up to 20 drops), the
# largest memory of any process, files and room on the disk; and says whether both have the same figures. For docs/performance.md.
set -euo pipefail

drops=${1:-1000}
root=$(cd "$(dirname "$0")/.." && pwd)
bin=${SF_BIN_DIR:-$root/build/bin}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
export OMP_NUM_THREADS=1
coarse=(geometry.parameters.fine_spacing=10 geometry.parameters.outer_spacing=20 pad.mesh_error_limit=1)
cat >plan.cfg <<END
case = "$root/examples/eva50-v4.5/case.cfg";
set = ["${coarse[0]}", "${coarse[1]}", "${coarse[2]}"];
factors = ( { key = "missile.velocity"; from = "3.5 m/s"; to = "5.5 m/s"; count = $drops; } );
END

# Seconds of wall time of softfall-sweep with $1 jobs into out$1.
sweep() {
    /usr/bin/time -f "%e %M" -o "time$1" "$bin/softfall-sweep" plan.cfg -o "out$1" --jobs "$1" >"log$1" 2>&1 ||
        { cat "log$1"; exit 1; }
}
sweep 1
sweep 2

# The programs alone: what a drop of the campaign starts, the mesh and the domains made already.
some=$((drops < 20 ? drops : 20))
set_options=(--set 'output.fields=["displacement"]' --set "output.frame_interval=1000 s")
for value in "${coarse[@]}"; do set_options+=(--set "$value"); done
mkdir alone
start=$(date +%s%N)
for k in $(seq "$some"); do
    speed=$(awk -v k="$k" -v n="$drops" -v m="$some" 'BEGIN { printf "%.9g", 3.5 + 2 * (m > 1 ? (k - 1) / (m - 1) : 0) }')
    "$bin/softfall-pre" "$root/examples/eva50-v4.5/case.cfg" -o alone/m.h5 -f --share out1/runs/shared \
        "${set_options[@]}" --set "missile.velocity=$speed m/s" >/dev/null 2>&1
    "$bin/softfall-solve" alone/m.h5 -o alone/r.h5 -f -t 1 >/dev/null 2>&1
done
alone=$(($(date +%s%N) - start))

same=$(python3 - <<'END'
import csv
tables = []
for name in ("out1", "out2"):
    with open(f"{name}/runs.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        for key in ("wall_s", "threads"):
            row.pop(key)
    tables.append(rows)
print("the same figures" if tables[0] == tables[1] else "DIFFERENT FIGURES")
END
)
read -r one memory_one <time1
read -r two memory_two <time2
awk -v n="$drops" -v one="$one" -v two="$two" -v m1="$memory_one" -v m2="$memory_two" -v alone="$alone" -v some="$some" \
    -v same="$same" 'BEGIN {
    printf "%d drops: %.0f drops per hour with one job, %.0f with two: ratio %.3f; %s\n", n, 3600 * n / one, 3600 * n / two, one / two, same
    printf "a drop takes %.1f ms with one job, its programs alone %.1f ms (mean of %d): %.1f ms beside them\n",
        1e3 * one / n, alone / some / 1e6, some, 1e3 * one / n - alone / some / 1e6
    printf "largest process: %.0f and %.0f MB\n", m1 / 1e3, m2 / 1e3 }'
printf 'files of a campaign: %s, %s\n' "$(find out2 -type f | wc -l)" "$(du -sh out2 | cut -f1)"
