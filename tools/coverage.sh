#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Counts the lines of src/ that the tests execute, by room and in total; fails below 90 %. Needs the package gcovr.
#   tools/coverage.sh [CTEST OPTION]...     runs the tests that are not slow (-R, -E, ... restrict them), then counts
#   tools/coverage.sh --report              counts without a new run; --report FILE... lists the lines of FILEs not executed
# The room mesher is not counted: its confined process cannot write the counts.
# Only lines that report a failed allocation or a failed library (SF_ERR_MEMORY, SF_ERR_LIBRARY) are excluded.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build-coverage
left_out='.*\bSF_ERR_(MEMORY|LIBRARY)\b'

count() {
    gcovr "$build" --root . --exclude-lines-by-pattern "$left_out" "$@"
}

if [ "${1:-}" = --report ]; then
    shift
    for file in "$@"; do
        count --filter "$file"
    done
    [ $# -eq 0 ] || exit 0
else
    [ -f "$build/build.ninja" ] || cmake --preset coverage
    cmake --build "$build"
    find "$build" -name '*.gcda' -delete
    OMP_NUM_THREADS=1 ctest --test-dir "$build" --output-on-failure --no-tests=error -LE slow "$@"
fi

count --filter src/ --csv | awk -F, '
    NR > 1 { split($1, part, "/"); lines[part[2]] += $2; run[part[2]] += $3 }
    function row(name, n, m) { printf "| %-8s | %6d | %6d | %6.1f |\n", name, n, m, 100 * m / n }
    END {
        print "| room     |  lines |    run |      % |\n|---|---:|---:|---:|"
        count = split("core case io pre solver post campaign fit", order, " ")
        for (k = 1; k <= count; k++) {
            row(order[k], lines[order[k]], run[order[k]])
            all += lines[order[k]]
            executed += run[order[k]]
        }
        row("total", all, executed)
        exit executed < 0.9 * all
    }'
