#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs gcc -fanalyzer, clang-tidy (.clang-tidy) and cppcheck over src/.   tools/static_analysis.sh [BUILD] [TOOL...]
# Prints every finding that tools/static_analysis.txt does not explain, and fails if there is one; reports explanations
# that are no longer needed. BUILD (default build) is a configured folder; TOOLs: gcc, clang-tidy, cppcheck (default: all).
set -Eeuo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:-build}
shift || true
tools=("${@:-gcc clang-tidy cppcheck}")
[ -f "$build/compile_commands.json" ] || {
    echo "static_analysis.sh: $build is not a configured build folder" >&2
    exit 2
}
raw=$(mktemp)
trap 'rm -f "$raw"' EXIT
trap 'echo "static_analysis.sh: a tool failed" >&2' ERR

# Each function prints findings as "tool file class", one per line, without line numbers.
run_gcc() {
    local file
    for file in $(find src -name "*.c" | sort); do
        # shellcheck disable=SC2046 # words are wanted
        gcc -std=c17 -O2 -D_GNU_SOURCE -Isrc -Iinclude -I"$build/generated" $(pkg-config --cflags hdf5 gsl libconfig) \
            -I/usr/include/suitesparse -fopenmp -fanalyzer -c "$file" -o /dev/null
    done 2>&1 | sed -nE 's/^([^ :]+):[0-9]+:[0-9]+: warning: .*\[-W(analyzer-[a-z-]+)\]$/gcc \1 \2/p'
}

# Without the kernels for several processors, because clang 14 does not accept their attributes together. One process per
# file, because with several files clang-tidy 14 reports every va_list after the first file as uninitialised.
run_clang-tidy() {
    local file
    for file in $(find src -name "*.c" | sort); do
        clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option --extra-arg=-USF_DISPATCH "$file" 2>/dev/null ||
            true # an error is a line as well
    done | sed -nE "s#^$PWD/([^ :]+):[0-9]+:[0-9]+: (warning|error): .*\[([a-zA-Z.,-]+)\]\$#clang-tidy \1 \3#p"
}

run_cppcheck() {
    cppcheck --std=c11 --language=c --enable=warning,performance,portability -D_GNU_SOURCE -I src -I include -I "$build/generated" -q \
        --template='cppcheck {file} {id}' src 2>&1 | grep '^cppcheck ' || true
}

for tool in ${tools[*]}; do
    "run_$tool" >>"$raw"
done
sort -u "$raw" -o "$raw"
explained=$(grep -E "^($(tr ' ' '|' <<<"${tools[*]}")) " tools/static_analysis.txt | cut -d' ' -f1-3 | sort -u)
unexplained=$(comm -23 "$raw" - <<<"$explained")
printf '%d kinds of findings, %d not explained\n' "$(wc -l <"$raw")" "$(grep -c . <<<"$unexplained" || true)"
comm -13 "$raw" - <<<"$explained" | sed 's/^/no longer found: /'
[ -z "$unexplained" ] || {
    printf '%s\n' "$unexplained"
    exit 1
}
