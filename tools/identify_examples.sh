#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Identifies the EVA foam of the paper from its three measured drops, predicts the drops on the thinner pad, writes the
# result as the examples' material and the tables into docs/validation.md. About ten minutes on two cores; after an
# interruption, run it again to resume.
#
#     tools/identify_examples.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

out=out/eva35
mkdir -p out
"${SF_BIN_DIR:-build/bin}"/softfall-fit drop examples/fit/eva35_drops.cfg -o "$out" --force
cp "$out/eva35.cfg" "$out/eva35.csv" examples/materials/
cp "$out/fit.png" docs/images/eva35_fit.png
tools/report_sections.py "$out/report.html" docs/validation.md
echo "written: examples/materials/eva35.cfg, docs/validation.md"
