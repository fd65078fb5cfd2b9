#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the verification studies and assembles docs/verification.md from their output.
#   tools/verification.sh            all studies (more than an hour; the sections state the time of the longest)
#   tools/verification.sh NAME...    only these; the sections of the others stay as they are
#   tools/verification.sh --ran [NAME...]   runs nothing: takes the sections that the last tests of the build folder left
set -euo pipefail
cd "$(dirname "$0")/.."

order="exactness wave mms material time_step contact layers base missile calculix hyperfoam mesh sensitivity reproducibility identification"
build=${BUILD_DIR:-build}
sections=docs/images/verification
ran=no
[ "${1:-}" != --ran ] || { ran=yes; shift; }
[ $# -gt 0 ] || set -- $order
mkdir -p "$sections"
export SF_BIN_DIR="$PWD/$build/bin" SF_SOURCE_DIR="$PWD"
[ -x build-debug/bin/softfall-post ] && export SF_DEBUG_BIN_DIR="$PWD/build-debug/bin" # reproducibility compares

failed=""
for name in "$@"; do
    program="$build/verify/study_$name"
    [ -x "$program" ] || { echo "no study $name in $build: build first" >&2; exit 1; }
    echo "== $name"
    if [ $ran = yes ]; then
        cp "$build/verification/$name".md "$sections/"
        find "$build/verification" -name "$name-*.png" -exec cp {} "$sections/" ';'
        continue
    fi
    status=0
    "$program" "$sections" >"$sections/$name.log" || status=$?
    tail -n 1 "$sections/$name.log"
    rm "$sections/$name.log"
    if [ $status -eq 77 ]; then
        echo "skipped: the independent code is not installed"
    elif [ $status -ne 0 ]; then
        failed="$failed $name"
    fi
done

{
    cat <<'TEXT'
# Verification

Does softfall solve the equations that [theory.md](theory.md) states? Yes, to rounding where an identity holds, with the expected order where a discretisation converges, and within stated bounds against closed forms and CalculiX.
Each study of `verify/` fails if it misses one of its bounds: all have passed. Whether the equations describe a pad is the question of [validation.md](validation.md).

    tools/verification.sh            # runs all studies and writes this page, or: tools/verification.sh NAME...
    tools/verification.sh --ran      # takes what the last ./setup.sh test and ./setup.sh slow of this tree left

`ctest --test-dir build -L verify` runs the short studies, with `-L slow` the long ones. Bold is measured, its bound stands in brackets; of more than two checks the two nearest to their bounds are shown. The sections
in `docs/images/verification` have all of them, and all tables. Wall times depend on the machine; all other figures repeat to the last digit on one machine. The row of the Debug build needs `build-debug`.

TEXT
    written=()
    for name in $order; do
        [ ! -f "$sections/$name.md" ] || written+=("$sections/$name.md")
    done
    tools/verification_page.py "${written[@]}"
} >docs/verification.md.partial
mv docs/verification.md.partial docs/verification.md
echo "written: docs/verification.md"
[ -z "$failed" ] || { echo "failed:$failed" >&2; exit 1; }
