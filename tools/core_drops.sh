#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the five drops of Table 2 of Penta et al. by the programs in C alone: softfall-pre, softfall-solve and softfall-post.
#
#     tools/core_drops.sh [--spacing MM] [DIR]                 # DIR: out/core by default
#     tools/in_debian.sh bookworm bash -ec './setup.sh core && tools/core_drops.sh --no-python'   # in a system without Python
#
# Prints a_max, HIC, its window, and R² and RMSE at 0.25 and 0.50 ms over the window and a region of Table 3, against a curve:
# that of CURVES/NAME.csv if the variable names a folder of measured ones, else that of the same drop at twice the spacing.
# Each drop also has history.csv, section.csv and pad.xdmf. Exit code 1 if anything of that is missing, or a_max and HIC are
# not those of tests/reference within 2 %, as meshes of another Debian differ. --no-python: python3 must be absent.
set -euo pipefail
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bin=${SF_BIN_DIR:-build/bin} spacing='' dir=out/core

fail() {
    printf 'core_drops.sh: %s\n' "$*" >&2
    exit 1
}

while [ $# -gt 0 ]; do
    case $1 in
    --no-python) ! command -v python3 >/dev/null || fail "this system has $(command -v python3)" ;;
    --spacing) spacing=${2:?--spacing needs millimetres} && shift ;;
    *) dir=$1 ;;
    esac
    shift
done

# number FILE KEY: the first number of a key of a JSON file.
number() {
    sed -n "s/.*\"$2\": *\(-\?[0-9][0-9.e+-]*\).*/\1/p" "$1" | head -n 1
}

# drop NAME SPACING FOLDER [OPTION OF softfall-post]...
drop() {
    local name=$1 mm=$2 folder=$3
    shift 3
    mkdir -p "$folder"
    "$bin/softfall-pre" "examples/$name/case.cfg" -o "$folder/model.h5" --force --estimate --set "geometry.parameters.fine_spacing=$mm" \
        --set "geometry.parameters.outer_spacing=$((2 * mm))" --set pad.mesh_error_limit=9.0 >"$folder/log.txt" 2>&1 || fail "$(tail -n 1 "$folder/log.txt")"
    "$bin/softfall-solve" "$folder/model.h5" -o "$folder/results.h5" --force >>"$folder/log.txt" 2>&1 || fail "$(tail -n 1 "$folder/log.txt")"
    "$bin/softfall-post" "$folder/results.h5" -o "$folder/out" --force "$@" >>"$folder/log.txt" 2>&1 || fail "$(tail -n 1 "$folder/log.txt")"
}

printf '%-12s %8s %8s %16s  %-24s %s\n' drop 'a_max/g' HIC 'window/ms' 'interval: R², RMSE/g' 'region of Table 3'
for name in eva50-v4.5 eva50-v5.2 eva70-v4.5 eva70-v5.2 eva70-v6.2; do
    mm=${spacing:-5} curve=${CURVES:+$CURVES/$name.csv}
    if [ -z "$curve" ]; then
        drop "$name" $((2 * mm)) "$dir/$name-coarse"
        curve=$dir/$name-coarse/out/acceleration.csv
    fi
    drop "$name" "$mm" "$dir/$name" --reference "$curve" --reference-filter none --regions 4-12
    out=$dir/$name/out summary=$dir/$name/out/summary.json
    for file in history.csv section.csv pad.xdmf acceleration.csv; do
        [ -s "$out/$file" ] || fail "$out/$file is missing"
    done
    a_max=$(number "$summary" a_max_g) hic=$(number "$summary" hic)
    # Of each fit one line: its interval, R² and RMSE.
    fits=$(tr -d '\n' <"$summary" | sed 's/.*"fits": *\[\([^]]*\)\].*/\1/' | tr '}' '\n' |
        awk -F'[:,]' '{ i = r = e = ""; for (k = 1; k < NF; k++) { if ($k ~ /interval_ms/) i = $(k + 1); if ($k ~ /"r2"/) r = $(k + 1); if ($k ~ /rmse_g/) e = $(k + 1) }
                        if (i != "" && r != "" && e != "") printf "%g:%.4f,%.3f ", i, r, e }')
    for interval in 0.25 0.5; do
        [ "$(tr ' ' '\n' <<<"$fits" | grep -c "^$interval:")" -ge 2 ] || fail "$summary has not the R² and RMSE of the window and of the region at $interval ms: $fits"
    done
    printf '%-12s %8.2f %8.1f %7.2f to %5.2f  %s\n' "$name" "$a_max" "$hic" "$(number "$summary" hic_t1_ms)" "$(number "$summary" hic_t2_ms)" "$fits"
    [ -z "$spacing" ] || continue # the reference is of 5 mm
    for key in a_max_g hic; do
        awk -v a="$(number "$summary" $key)" -v b="$(number "tests/reference/example-$name.json" $key)" 'BEGIN { exit !(b > 0 && a > 0.98 * b && a < 1.02 * b) }' ||
            fail "$name: $key is $(number "$summary" $key); tests/reference has $(number "tests/reference/example-$name.json" $key)"
    done
done
