#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the seeds of the fuzzers of model.h5 and results.h5 again: run it after a change of either format.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bin=$PWD/${BUILD_DIR:-build}/bin corpus=$PWD/tests/fuzz/corpus
folder=/tmp/softfall-seeds # a fixed name, as the provenance holds it
rm -rf "$folder"
mkdir "$folder"
trap 'rm -rf "$folder"' EXIT
cp -r examples geo "$folder"
cd "$folder"
"$bin/softfall-pre" -o m.h5 --set geometry.parameters.spacing=25 --set 'solver.end_time=0.2 ms' examples/compression/case.cfg >/dev/null
"$bin/softfall-solve" m.h5 -o r.h5 -t 1 --no-checkpoint >/dev/null 2>&1
"$bin/softfall-pre" -o h.h5 --set geometry.parameters.spacing=25 examples/compression/vn600.cfg >/dev/null
"$bin/softfall-pre" -o l.h5 --set 'geometry.parameters={side=50.0; zone_side=50.0; lower=25.0; upper=25.0; cover=25.0; fine_spacing=25.0; quarter=1;}' \
    --set pad.mesh_error_limit=10 --set 'pad.sliding_interfaces=["cover/upper"]' --set 'solver.end_time=0.2 ms' examples/layers/case.cfg >/dev/null 2>&1
"$bin/softfall-solve" l.h5 -o lr.h5 -t 1 --no-checkpoint >/dev/null 2>&1
"$bin/softfall-pre" -o interface.h5 --set 'geometry.parameters={side=50.0; zone_side=50.0; lower=25.0; upper=25.0; cover=25.0; fine_spacing=25.0; quarter=1;}' \
    --set pad.mesh_error_limit=10 --set 'interfaces.a.between=["cover", "upper"]' --set interfaces.a.kind=loose --set interfaces.a.friction=0.3 \
    --set 'solver.end_time=0.2 ms' examples/layers/case.cfg >/dev/null 2>&1
"$bin/softfall-pre" -o rest.h5 --set geometry.parameters.spacing=25 --set 'solver.end_time=0.2 ms' --set pad.base=resting examples/compression/case.cfg >/dev/null
"$bin/softfall-pre" -o skin.h5 --set geometry.parameters.spacing=25 --set 'solver.end_time=0.2 ms' --set pad.self_contact=on examples/compression/case.cfg >/dev/null
"$bin/softfall-pre" -o support.h5 --set geometry.parameters.spacing=25 --set 'solver.end_time=0.2 ms' --set 'pad.fixed=[]' \
    --set 'supports.a.file="../../geo/slab.geo"' --set 'supports.a.parameters={side=80.0; element_size=40.0;}' \
    --set 'supports.b.plane=[0.0, 0.0, 1.0]' --set 'supports.b.friction=0.1' \
    --set 'membrane.faces=["top"]' --set membrane.E='1 MPa' --set membrane.thickness='1 mm' --set membrane.density='1000 kg/m3' \
    examples/compression/case.cfg >/dev/null
cp support.h5 "$corpus/model/support.h5"
cp m.h5 "$corpus/model/cube.h5"
cp skin.h5 "$corpus/model/skin.h5"
cp l.h5 "$corpus/model/layers.h5"
cp interface.h5 "$corpus/model/interface.h5"
cp lr.h5 "$corpus/results/layers.h5"
cp h.h5 "$corpus/model/hyperfoam.h5"
cp rest.h5 "$corpus/model/resting.h5"
cp r.h5 "$corpus/results/cube.h5"
