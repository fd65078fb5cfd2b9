#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the Debian packages of a release, and tries them in a clean system of that release: installs them as root, runs the
# demo, Python and the window as a user without rights, removes them, and looks for what is left (tests/package/clean_system.sh).
#
#     tools/check_package.sh bookworm|trixie|other [softfall_....deb]
#
# Without a package they are made in a system of the release from a clone of the last commit, as ./setup.sh package makes them.
# python3-softfall_....deb stands beside the other one.
# The window's picture and the log are kept in out/package-RELEASE. Exit code 77 without root: see tools/in_debian.sh.
set -euo pipefail
if [ $# -lt 1 ] || [ $# -gt 2 ]; then
    echo 'usage: tools/check_package.sh bookworm|trixie|other [PACKAGE.deb]' >&2
    exit 2
fi
release=$1 package=${2:-}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
[ -z "$package" ] || [ -f "$package" ] || { echo "check_package.sh: there is no file $package" >&2 && exit 1; }
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
if [ -z "$package" ]; then
    "$root/tools/in_debian.sh" --fetch "$place/made" "$release" \
        bash -ec './setup.sh package; mkdir -p out; cp build/*softfall_*.deb out/'
    package=$(echo "$place"/made/softfall_*.deb)
fi
mkdir "$place/stage"
cp "$package" "${package%/*}"/python3-softfall_*.deb "$place/stage"
cp "$root"/tests/package/* "$place/stage"
"$root/tools/in_debian.sh" --with "$place/stage" --fetch "$root/out/package-$release" "$release" \
    bash ./clean_system.sh "${package##*/}"
