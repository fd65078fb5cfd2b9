#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tools/campaign_rows.sh [ROWS]: what a plan of ROWS rows (100000) costs beside its drops. One real drop is simulated; the others
# have its files (build/bench/plan_folders), as if a null program had made them. Prints seconds and the largest memory of
# softfall-sweep: the dry run; a campaign that looks at every drop and collects its figures, which is interrupted (SIGINT) on the
# way and resumed; the same command again; and again when the table is lost. Three minutes for 100000 rows. For
# docs/performance.md.
set -euo pipefail

rows=${1:-100000}
root=$(cd "$(dirname "$0")/.." && pwd)
bin=${SF_BIN_DIR:-$root/build/bin}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
export OMP_NUM_THREADS=1
export SF_BIN_DIR=$bin
limit=0 # s until SIGINT; 0: none

# plan NAME COUNT: the first COUNT rows of the Sobol' sequence.
plan() {
    cat >"$1" <<END
case = "$root/examples/eva50-v4.5/case.cfg";
set = ["geometry.parameters.fine_spacing=20.0", "geometry.parameters.outer_spacing=40.0", "pad.mesh_error_limit=9.0"];
factors = ( { sample = "sobol"; count = $2; of = ( { key = "missile.velocity"; low = "3 m/s"; high = "6 m/s"; },
    { key = "missile.mass"; low = "3 kg"; high = "6 kg"; } ); } );
END
}

measure() {
    local what=$1
    shift
    timeout -s INT "$limit" /usr/bin/time -q -f "%e %M %U %S" -o time "$bin/softfall-sweep" plan.cfg -o out --yes "$@" >log 2>&1 ||
        grep -q "interrupted; finished drops are kept" log || { cat log; exit 1; }
    awk -v what="$what" '{ printf "%-52s %8.1f s, %5.0f MB (processor %.1f s)\n", what, $1, $2 / 1e3, $3 + $4 }' time
    grep "drops simulated" log | sed 's/^/    /' || true
}

plan one.cfg 1
"$bin/softfall-sweep" one.cfg -o one >/dev/null
for part in $(seq 0 $((rows / 50000))); do
    mkdir "drop-$part"
    cp -p one/runs/drop-*/results.h5 one/runs/drop-*/figures.txt "drop-$part" # with its time, or figures.txt is not believed
done
plan plan.cfg "$rows"
mkdir out
"$root/build/bench/plan_folders" plan.cfg out drop
echo "$rows rows"
measure "dry run" --dry-run
limit=$((1 + rows / 5000)) measure "until it is interrupted"
measure "resumed"
awk -F, 'NR > 1 && $(NF > 4 ? 4 : NF) == "done" { done++ } END { print "    " done " runs are done" }' out/runs.csv
measure "again: nothing is left to do"
rm out/runs.csv out/sweep.key
measure "again without runs.csv: every drop is looked at" --force
