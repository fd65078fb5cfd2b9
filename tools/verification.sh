#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes chapters of docs/verification.md anew from the sections that their studies write into the build folder; the others stay.
#   tools/verification.sh                   runs all studies of the page (more than an hour)
#   tools/verification.sh NAME...           runs these; a new one gets a chapter at the end
#   tools/verification.sh --ran [NAME...]   runs nothing: takes the sections that the last tests of the build folder left
set -euo pipefail
cd "$(dirname "$0")/.."

build=${BUILD_DIR:-build}
ran=no
[ "${1:-}" != --ran ] || { ran=yes; shift; }
[ $# -gt 0 ] || set -- $(sed -n 's|.*`build/verify/study_\(.*\) DIR`$|\1|p' docs/verification.md)
export SF_BIN_DIR="$PWD/$build/bin" SF_SOURCE_DIR="$PWD"
[ -x build-debug/bin/softfall-post ] && export SF_DEBUG_BIN_DIR="$PWD/build-debug/bin" # reproducibility compares

mkdir -p "$build/verification"
failed=""
for name in "$@"; do
    [ -x "$build/verify/study_$name" ] || { echo "no study $name in $build: build first" >&2; exit 1; }
    [ $ran = no ] || continue
    program="$build/verify/study_$name"
    echo "== $name"
    status=0
    "$program" "$build/verification" | tail -n 1 || status=$?
    [ $status -eq 0 ] || [ $status -eq 77 ] || failed="$failed $name" # 77: the independent code is not installed
done
tools/verification_page.py "${@/#/$build/verification/}"
[ -z "$failed" ] || { echo "failed:$failed" >&2; exit 1; }
