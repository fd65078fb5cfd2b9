#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs every case of examples/ into out/NAME and prints the table of results of docs/examples.md.
#
#     tools/run_examples.sh            some minutes
#     tools/run_examples.sh --table    only the table, from existing results
#     tools/run_examples.sh --page     the same, and writes it into that page
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case ${1:-} in
'' | --table | --page) ;;
*) echo 'usage: tools/run_examples.sh [--table | --page]' >&2 && exit 2 ;;
esac
directories=()
for example in examples/*; do
    [ -f "$example/case.cfg" ] || continue
    directory=out/$(basename "$example")
    directories+=("$directory")
    [ $# -gt 0 ] || tools/run_case.sh "$example/case.cfg" "$directory" >&2
done
python3 tools/results_table.py "${directories[@]}"
[ "${1:-}" != --page ] || python3 tools/results_table.py --into docs/examples.md "${directories[@]}"
