#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the SYNTHETIC data of this example: cushion.csv, and the lines of the drops in leap_joint.cfg, which it prints. The hidden foam has
# the loading curve that softfall-fit finds for the measured compression test of LEAP (../../foams/leap.cfg), with HU = 0.5, SHAPE = 1.4 and a
# rate factor of 0.1 that nobody measured. Blocks and drops are simulations with it, without errors of measurement.
#
#     examples/fit/joint/make_data.sh DIR
#
# Writes everything else into DIR. The programs are those in build/bin, or in $SF_BIN_DIR.
set -euo pipefail

if [ $# -ne 1 ]; then
    echo 'usage: examples/fit/joint/make_data.sh DIR' >&2
    exit 2
fi
dir=$1 here=$(dirname "${BASH_SOURCE[0]}")
bin=${SF_BIN_DIR:-$here/../../../build/bin}

mkdir -p "$dir"
"$bin/softfall-fit" compression "$here/../../foams/leap.cfg" -o "$dir/leap" --force > /dev/null
hidden=(--set "material=@$dir/leap/material.cfg" --set material.HU=0.5 --set material.SHAPE=1.4 --set material.ALPHA=1
    --set material.DAMP=0.05 --set material.rate_factor=0.1 --set "material.rate_reference=0.01 1/s"
    --set "material.rate_filter_time=0.5 ms")

# run NAME CASE [OPTION]...: a simulation with the hidden foam
run() {
    local out=$dir/$1 case_file=$2
    shift 2
    mkdir -p "$out"
    "$bin/softfall-pre" "$case_file" -o "$out/model.h5" --force "${hidden[@]}" "$@" > /dev/null
    "$bin/softfall-solve" "$out/model.h5" -o "$out/results.h5" --force > /dev/null
    "$bin/softfall-post" "$out/results.h5" -o "$out" --force > /dev/null
}

# figure NAME KEY: a number of its summary
figure() {
    sed -n "s/.*\"$2\": \([-+0-9.e]*\).*/\1/p" "$dir/$1/summary.json" | head -n 1
}

{
    echo "# SYNTHETIC cushion curve (make_data.sh): block of 50 mm, flat mass, 0.6 m"
    echo "static_stress_kPa,peak_g"
    for stress in 2 3 4.5 6 8 10; do
        # mass over the block's 25 cm2
        run "cushion-$stress" "$here/cushion-block.cfg" --set "missile.mass=$(awk "BEGIN { print $stress * 2.5 / 9.80665 }") kg"
        printf '%s,%.4g\n' "$stress" "$(figure "cushion-$stress" a_max_g)"
    done
} > "$dir/cushion.csv"
cp "$dir/cushion.csv" "$here/cushion.csv"
for speed in 3.5 4.5; do
    run "drop-v$speed" "$here/drop-v$speed.cfg"
    printf 'drop at %s m/s: a_max_g = %.4g; HIC = %.4g;\n' "$speed" "$(figure "drop-v$speed" a_max_g)" "$(figure "drop-v$speed" hic)"
done
