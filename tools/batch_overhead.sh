#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tools/batch_overhead.sh [DROPS]: what a batch costs beside the programs that it starts. DROPS drops (200) of the coarse
# example run by softfall-batch with softfall-pre and softfall-solve that only copy files of one real drop; then the same
# copies without softfall-batch; then a second time, when all drops are there. Milliseconds per drop.
set -euo pipefail

drops=${1:-200}
root=$(cd "$(dirname "$0")/.." && pwd)
bin=${SF_BIN_DIR:-$root/build/bin}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
coarse=(geometry.parameters.fine_spacing=20 geometry.parameters.outer_spacing=20
    geometry.missile_parameters.element_size=20 pad.mesh_error_limit=1 "solver.end_time=1 ms")
set_options=()
for value in "${coarse[@]}"; do set_options+=(--set "$value"); done
example=$root/examples/eva50-v4.5/case.cfg
"$bin/softfall-pre" "$example" -o model.h5 "${set_options[@]}" >/dev/null 2>&1
"$bin/softfall-solve" model.h5 -o results.h5 -t 1 >/dev/null

mkdir -p null runs
touch runs/.softfall-own
printf '#!/bin/sh\nexec cp "%s/model.h5" "$3"\n' "$place" >null/softfall-pre
printf '#!/bin/sh\nexec cp "%s/results.h5" "$3"\n' "$place" >null/softfall-solve
chmod +x null/*
ln -s "$bin/softfall-mesh" "$bin/softfall-batch" null

{
    printf 'softfall-manifest 1\nfolder\t%s\nruns\truns\ncount\t%d\n' "$place" "$drops"
    for k in $(seq "$drops"); do
        printf '%016d\tall\tdrop\t%s\t\t%s' 0 "$example" "material.density=35.$k kg/m3"
        printf '\t%s' "${coarse[@]}"
        printf '\n'
    done
} >runs/manifest.tsv

now() { date +%s%N; }
per_drop() { awk -v t="$1" -v n="$drops" 'BEGIN { printf "%.1f", t / n / 1e6 }'; }
batch() { SF_BIN_DIR=$place/null "$bin/softfall-batch" runs/manifest.tsv --group all >/dev/null; }

start=$(now)
batch
first=$(($(now) - start))
start=$(now)
batch
second=$(($(now) - start))
mkdir copies
start=$(now)
for k in $(seq "$drops"); do
    null/softfall-pre case -o "copies/model-$k.h5"
    null/softfall-solve model -o "copies/results-$k.h5"
done
copies=$(($(now) - start))
printf 'a drop of the batch %s ms, its copies alone %s ms, the batch by itself %s ms; when it is there %s ms\n' \
    "$(per_drop "$first")" "$(per_drop "$copies")" "$(per_drop $((first - copies)))" "$(per_drop "$second")"
