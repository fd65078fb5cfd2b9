#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the examples on Debian 12 and on Debian 13 (tools/in_debian.sh, as root, from a fresh clone of the last commit) and
# prints a table that compares their figures.
#
#     tools/compare_systems.sh            about 15 minutes on two cores
#     tools/compare_systems.sh --table    only the table, from existing results
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case ${1:-} in
'' | --table) ;;
*) echo 'usage: tools/compare_systems.sh [--table]' >&2 && exit 2 ;;
esac
for release in bookworm trixie; do
    [ $# -gt 0 ] || tools/in_debian.sh --fetch out/systems/$release $release \
        bash -ec './setup.sh build && tools/run_examples.sh' >&2
done
python3 tools/systems_table.py out/systems/bookworm out/systems/trixie
