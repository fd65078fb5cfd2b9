#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs one case through the three programs; the files of an earlier run in DIR are replaced.
#
#     tools/run_case.sh CASE DIR [OPTION OF softfall-pre, e.g. --set missile.velocity="5.2 m/s"]...
#
# Writes model.h5, results.h5, the output of softfall-post, its printed lines (report.txt) and, where the Python package can run, the page
# report.html into DIR. The programs are those in build/bin, or in $SF_BIN_DIR.
set -euo pipefail

# Waiting threads do not spin: with spinning, a drop beside other busy programs took six times as long.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

if [ $# -lt 2 ]; then
    echo 'usage: tools/run_case.sh CASE DIR [--set GROUP.KEY=VALUE]...' >&2
    exit 2
fi
case_file=$1 dir=$2
shift 2
bin=${SF_BIN_DIR:-$(dirname "${BASH_SOURCE[0]}")/../build/bin}
if [ ! -x "$bin/softfall-pre" ]; then
    echo "run_case.sh: no programs in $bin: run ./setup.sh build first" >&2
    exit 1
fi
mkdir -p "$dir"
rm -f "$dir/report.txt" # exists only beside the results of a complete run
"$bin/softfall-pre" "$case_file" -o "$dir/model.h5" --force "$@"
echo
"$bin/softfall-solve" "$dir/model.h5" -o "$dir/results.h5" --force
echo
"$bin/softfall-post" "$dir/results.h5" -o "$dir" --force | tee "$dir/report.part"
if [ ! -x "$bin/softfall" ] || ! "$bin/softfall" report "$dir" 2>"$dir/report.part.log"; then
    echo "No report.html: $(cat "$dir/report.part.log" 2>/dev/null || echo "there is no $bin/softfall")"
fi
rm -f "$dir/report.part.log"
mv "$dir/report.part" "$dir/report.txt"
