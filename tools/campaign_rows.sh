#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tools/campaign_rows.sh [ROWS]: what a plan of ROWS rows (5000) costs beside its drops. softfall-pre and softfall-solve are
# replaced by programs that only link the files of one real drop. Prints seconds and the largest memory of: the dry run; the campaign
# with these programs; the same command again, when runs.csv is there; and again when runs.csv is lost, so that every drop is looked
# at and collected anew. 2000 rows take two and a half minutes, 100000 about two
# hours, for the programs' sake. For docs/performance.md.
set -euo pipefail

rows=${1:-5000}
root=$(cd "$(dirname "$0")/.." && pwd)
bin=${SF_BIN_DIR:-$root/build/bin}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
export OMP_NUM_THREADS=1
coarse=(geometry.parameters.fine_spacing=20 geometry.parameters.outer_spacing=40 pad.mesh_error_limit=1)
set_options=(--set 'output.fields=["displacement"]' --set "output.frame_interval=1000 s")
for value in "${coarse[@]}"; do set_options+=(--set "$value"); done
"$bin/softfall-pre" "$root/examples/eva50-v4.5/case.cfg" -o model.h5 "${set_options[@]}" >/dev/null 2>&1
"$bin/softfall-solve" model.h5 -o results.h5 -t 1 >/dev/null 2>&1

# A file has at most 65,000 names on some file systems: one copy for each of 16 parts.
mkdir null
for part in 0 1 2 3 4 5 6 7 8 9 a b c d e f; do cp -p results.h5 "results-$part.h5"; done
printf '#!/bin/sh\nexec ln "%s/model.h5" "$3"\n' "$place" >null/softfall-pre
cat >null/softfall-solve <<END
#!/bin/sh
folder=\${3%/results.h5}
exec ln "$place/results-\${folder#"\${folder%?}"}.h5" "\$3"
END
chmod +x null/*
ln -s "$bin/softfall-mesh" null
export SF_BIN_DIR=$place/null

cat >plan.cfg <<END
case = "$root/examples/eva50-v4.5/case.cfg";
set = ["${coarse[0]}", "${coarse[1]}", "${coarse[2]}"];
factors = ( { sample = "sobol"; count = $rows; of = ( { key = "missile.velocity"; low = "3 m/s"; high = "6 m/s"; },
    { key = "missile.mass"; low = "3 kg"; high = "6 kg"; } ); } );
END

measure() {
    local what=$1
    shift
    /usr/bin/time -f "%e %M %U %S" -o time "$bin/softfall-sweep" plan.cfg -o out "$@" >log 2>&1 || { cat log; exit 1; }
    awk -v what="$what" '{ printf "%-46s %8.1f s, %5.0f MB (processor %.1f s)\n", what, $1, $2 / 1e3, $3 + $4 }' time
}
echo "$rows rows"
measure "dry run" --dry-run
measure "campaign, with the programs that only link"
measure "again: nothing is left to do"
rm out/runs.csv out/sweep.key
measure "again without runs.csv: every drop is looked at" --force
grep "drops simulated" log
