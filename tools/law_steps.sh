#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What rate factor, Maxwell branch, DAMP and ALPHA cost and do in a drop (docs/performance.md, "The law"):
#     tools/law_steps.sh [spacing in mm, 5.0] [case, eva50-v4.5]
# Columns: a_max and HIC filtered, a_max unfiltered, largest local strain, steps, processor seconds, stabilisation's part of the energy.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bin=$PWD/${BUILD_DIR:-build}/bin spacing=${1:-5.0} case=${2:-eva50-v4.5}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# s0 (1 - exp(-(E - p0) e / s0)) + p0 x + B x^m with x = e / (1 - e)
awk 'BEGIN { print "strain,stress_kPa"; for (i = 0; i <= 400; i++) { e = 0.9 * i / 400; x = e / (1 - e);
    printf "%.9g,%.9g\n", e, 60 * (1 - exp(-(413.6 - 60) * e / 60)) + 60 * x + 20 * x^2.5 } }' >"$folder/curve.csv"

drop() { # name, then --set arguments
    local name=$1
    shift
    "$bin/softfall-pre" "examples/$case/case.cfg" -o "$folder/m.h5" --force --set geometry.parameters.fine_spacing="$spacing" "$@" >"$folder/log" 2>&1 || { cat "$folder/log" >&2; exit 1; }
    local seconds
    TIMEFORMAT=%U
    seconds=$({ time "$bin/softfall-solve" "$folder/m.h5" -o "$folder/r.h5" --force -t 1 >"$folder/log" 2>&1; } 2>&1)
    "$bin/softfall-post" "$folder/r.h5" -o "$folder/out" --force >/dev/null 2>&1
    python3 - "$folder" "$name" "$seconds" <<'P'
import json, re, sys
s = json.load(open(sys.argv[1] + "/out/summary.json"))
steps = re.search(r"after (\d+) steps", open(sys.argv[1] + "/log").read()).group(1)
print("%-34s %7.2f g %7.1f  unfiltered %7.2f g  strain %.3f  %5s steps %6s s  stabilisation %.3f %%" % (sys.argv[2], s["a_max_g"],
      s["hic"], s["a_max_raw_g"], s["max_local_strain"], steps, sys.argv[3], 100 * s["stabilisation_energy_fraction"]))
P
}

gas() { # name, DAMP, ALPHA, further keys: the gas curve above
    printf 'density = "35 kg/m3"; E = "0.4136 MPa"; curve = "curve.csv"; HU = 0.01;\nDAMP = %s; ALPHA = %s; %s\n' "$2" "$3" "$4" >"$folder/foam.cfg"
    drop "$1" --set material=@"$folder/foam.cfg"
}

for damp in 0.35 0.1 0.05 0.0; do
    drop "first form, DAMP $damp" --set material=@tests/materials/eva35_first.cfg --set material.DAMP=$damp
done
maxwell='ED = "5.2 MPa"; BETA1 = "5000 1/s";' rate='rate_factor = 0.15; rate_reference = "1 1/s";'
slow="$rate rate_filter_time = \"0.5 ms\";"
for damp in 0.35 0.1 0.05 0.0; do
    gas "gas, factor, 0.1 ms, DAMP $damp" $damp 1.0 "$rate"
    gas "gas, factor, 0.5 ms, DAMP $damp" $damp 1.0 "$slow"
    gas "gas, no rate, DAMP $damp" $damp 1.0 ""
done
gas "gas, Maxwell, DAMP 0.05" 0.05 1.0 "$maxwell"
gas "gas, both, 0.5 ms, DAMP 0.05" 0.05 1.0 "$slow $maxwell"
for alpha in 0.5 0.3 0.1; do
    gas "gas, factor, 0.5 ms, ALPHA $alpha" 0.05 $alpha "$slow"
done
