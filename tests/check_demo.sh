#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# check_demo.sh SOURCE PROGRAMS: ./setup.sh demo in a small checkout with the programs in the folder PROGRAMS and coarser
# meshes: it prints the figures of the drop and those for ever finer meshes, a second call the same ones, --force new ones.
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

# figures LOG: a_max, then a_max, HIC and their errors for ever finer meshes.
figures() {
    sed -n -e 's/^  a_max  *\([0-9.]*\) g$/\1/p' -e '/^  run .*HIC/{n;s/^ *1  *//;s/^\([0-9.]*  *[0-9.]*  *[0-9.]*  *[0-9.]*\) .*/\1/p}' "$place/$1"
}

cp -r "$source/setup.sh" "$source/packages.txt" "$source/CMakePresets.json" "$source/geo" "$place"
mkdir -p "$place/tools" "$place/examples/eva50-v4.5" "$place/build"
cp "$source/tools/run_case.sh" "$place/tools"
cp -r "$source/examples/materials" "$place/examples"
cp "$source/examples/eva50-v4.5/refine.cfg" "$place/examples/eva50-v4.5"
sed 's/fine_spacing = 5.0; outer_spacing = 10.0/fine_spacing = 10.0; outer_spacing = 20.0/' "$source/examples/eva50-v4.5/case.cfg" \
    >"$place/examples/eva50-v4.5/case.cfg"
! cmp -s "$source/examples/eva50-v4.5/case.cfg" "$place/examples/eva50-v4.5/case.cfg" || fail "the mesh is no coarser"
printf 'cmake_minimum_required(VERSION 3.25)\nproject(none LANGUAGES NONE)\nadd_custom_target(programs)\n' >"$place/CMakeLists.txt"
ln -s "$programs" "$place/build/bin"

demo first
[ "$(figures first | wc -l)" = 2 ] || fail "it does not print both meshes: $(cat "$place/first")"
read -r fine value error hic hic_error <<<"$(figures first | tr '\n' ' ')"
awk -v f="$fine" -v v="$value" -v e="$error" -v h="$hic" -v he="$hic_error" \
    'BEGIN { d = v - f; exit !(d > 0 && d < 1.02 * e + 0.01 && d > 0.98 * e - 0.01 && h > 200 && he > 0.004 * h) }' ||
    fail "$fine, and $value +- $error, HIC $hic +- $hic_error"
demo second
grep -q 'are up to date' "$place/second" || fail "a second call computes: $(cat "$place/second")"
[ "$(figures second)" = "$(figures first)" ] || fail "a second call prints other figures: $(cat "$place/second")"
rm "$place/out/eva50-v4.5/refined.txt" # as after an interruption
demo interrupted
! grep -q 'are up to date' "$place/interrupted" || fail "half a demo stands for a whole one"
sed -i 's/thickness = 50.0/thickness = 55.0/' "$place/examples/eva50-v4.5/case.cfg"
demo third
demo fourth --force
! grep -q 'are up to date' "$place/third" "$place/fourth" || fail "old figures"
[ "$(figures third)" != "$(figures first)" ] || fail "figures of another pad: $(figures third)"
[ "$(figures fourth)" = "$(figures third)" ] || fail "--force gives other figures: $(figures fourth)"
