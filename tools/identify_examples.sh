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
# Replaces the text between the markers <!-- name --> and <!-- end --> of the document by the report's section of that name.
awk -v report="$out/report.md" '
    BEGIN {
        while ((getline line < report) > 0) {
            if (line ~ /^## /) { name = tolower(substr(line, 4)); gsub(/ /, "-", name) }
            else if (line !~ /^!\[/) text[name] = text[name] line "\n"
        }
        for (name in text) { gsub(/^\n+|\n+$/, "", text[name]) }
    }
    /^<!-- end -->/ { inside = 0 }
    !inside { print }
    /^<!-- [a-z-]+ -->/ && $2 != "end" { print text[$2]; inside = 1 }
' docs/validation.md >docs/validation.md.partial
mv docs/validation.md.partial docs/validation.md
echo "written: examples/materials/eva35.cfg, docs/validation.md"
