#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# check_demo.sh SOURCE PROGRAMS: ./setup.sh demo in a small checkout with the programs in the folder PROGRAMS and coarser
# meshes: it prints the figures of the drop with their errors by the mesh, a second call the same ones, --force new ones.
set -euo pipefail
source=$1 programs=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

fail() {
    printf 'check_demo: %s\n' "$*" >&2
    exit 1
}

# demo LOG [OPTION]
demo() {
    (cd "$place" && ./setup.sh demo --no-install "${@:2}") >"$place/$1" 2>&1 || fail "$(cat "$place/$1")"
}

# figures LOG: a_max and HIC, and their errors by the mesh in %.
figures() {
    sed -n -E -e 's/^  (a_max|HIC)  *([0-9.]+).*/\2/p' -e 's/^  (a_max|HIC), by the mesh  *([0-9.]+) %.*/\2/p' "$place/$1"
}

cp -r "$source/setup.sh" "$source/packages.txt" "$source/CMakePresets.json" "$source/geo" "$place"
mkdir -p "$place/tools" "$place/examples/eva50-v4.5" "$place/build"
cp "$source/tools/run_case.sh" "$place/tools"
cp -r "$source/examples/materials" "$place/examples"
sed 's/fine_spacing = 5.0; outer_spacing = 10.0/fine_spacing = 10.0; outer_spacing = 20.0/' "$source/examples/eva50-v4.5/case.cfg" \
    >"$place/examples/eva50-v4.5/case.cfg"
! cmp -s "$source/examples/eva50-v4.5/case.cfg" "$place/examples/eva50-v4.5/case.cfg" || fail "the mesh is no coarser"
printf 'cmake_minimum_required(VERSION 3.25)\nproject(none LANGUAGES NONE)\nadd_custom_target(programs)\n' >"$place/CMakeLists.txt"
ln -s "$programs" "$place/build/bin"

demo first
read -r a_max hic error hic_error <<<"$(figures first | tr '\n' ' ')"
awk -v a="$a_max" -v h="$hic" -v e="$error" -v he="$hic_error" \
    'BEGIN { exit !(a > 80 && h > 200 && e > 0.1 && e < 3 && he > 0 && he < 3) }' ||
    fail "a_max $a_max g, error $error %, HIC $hic, error $hic_error %: $(cat "$place/first")"
demo second
grep -q 'are up to date' "$place/second" || fail "a second call computes: $(cat "$place/second")"
[ "$(figures second)" = "$(figures first)" ] || fail "a second call prints other figures: $(cat "$place/second")"

# From here on a run is a line of "$place/runs".
cat >"$place/tools/run_case.sh" <<'TEXT'
#!/bin/sh
echo "$1" >>runs
echo "  run $(wc -l <runs)" >"$2/report.txt"
cat "$2/report.txt"
TEXT

# run_anew LOG NUMBER [OPTION]
run_anew() {
    demo "$1" "${@:3}"
    ! grep -q 'are up to date' "$place/$1" && grep -q "run $2" "$place/$1" || fail "old figures: $(cat "$place/$1")"
}
rm "$place/out/eva50-v4.5/report.txt" # as after an interruption
run_anew interrupted 1
sed -i 's/thickness = 50.0/thickness = 55.0/' "$place/examples/eva50-v4.5/case.cfg"
run_anew changed 2
run_anew forced 3 --force
demo again
grep -q 'are up to date' "$place/again" && grep -q 'run 3' "$place/again" || fail "a repeat computes: $(cat "$place/again")"
