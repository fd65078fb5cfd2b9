#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Identifies the EVA foam of the paper from its three drops on the 70 mm pad by all models of examples/fit/eva35_forms.cfg, predicts the
# drops on the 50 mm pad and the critical fall heights of both pads, writes the result as the examples' material, and the table and
# picture of docs/cfh.md. docs/validation.md has the predictions as they were made before the comparison and is never written: its
# sections by this run are in out/validation.md, and the script says where the two differ. About 15 minutes on two cores; after an interruption, run it again to
# resume. It says how long the identification took.
#
#     tools/identify_examples.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

out=out/eva35
mkdir -p out
SECONDS=0
"${SF_BIN_DIR:-build/bin}"/softfall fit examples/fit/eva35_forms.cfg -o "$out" --force || [ $? -eq 5 ] # a model that has not converged is marked in its report
echo "identified in $((SECONDS / 60)) min $((SECONDS % 60)) s"
cp "$out/eva35.cfg" "$out/eva35.csv" examples/materials/
tools/thin_posterior.py "$out/posterior" 100 examples/materials/eva35_posterior
page=out/validation.md
cp docs/validation.md "$page"
tools/report_sections.py "$out/report.html" "$page" comparison
POSTERIOR=$out/posterior tools/cfh_examples.sh --docs
tools/compare_prediction.py "$page"
echo "written: examples/materials/eva35.cfg, docs/cfh.md, $page; the picture of the fit is $out/fit.png"
tools/compare_page.sh docs/validation.md "$page"
