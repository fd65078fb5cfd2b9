#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the commands of docs/tutorial.md in an empty folder and writes what they print, and their pictures, into the page.
#
#     tools/tutorial.sh            runs in out/tutorial, which it empties
#     tools/tutorial.sh --check    writes nothing: says what the page has otherwise
#
# The programs are those in build/bin, or in $SF_BIN_DIR. tools/tutorial_page.py says how
# the page tells what is run.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case ${1:-} in
'' | --check) ;;
*) echo 'usage: tools/tutorial.sh [--check]' >&2 && exit 2 ;;
esac
bin=$(realpath "${SF_BIN_DIR:-build/bin}")
for program in new pre solve post sweep; do
    [ -x "$bin/softfall-$program" ] || { echo "tutorial.sh: there is no $bin/softfall-$program: run ./setup.sh build first" >&2 && exit 1; }
done
place=${SF_TUTORIAL_DIR:-out/tutorial}
rm -rf "$place"
mkdir -p "$place/home"
unset SF_BIN_DIR
# Python is that of the system, which has numpy and h5py.
PATH=$bin:/usr/bin:$PATH PYTHONPATH=$bin/../lib/python3/dist-packages XDG_CACHE_HOME=$(realpath "$place/home") OMP_WAIT_POLICY=passive \
    exec python3 tools/tutorial_page.py docs/tutorial.md "$place" "$@"
