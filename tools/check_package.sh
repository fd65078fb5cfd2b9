#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the Debian package of a release, and tries it in a clean system of that release: installs it as root, runs the demo
# and the window as a user without rights, removes it, and looks for what is left (tests/package/clean_system.sh).
#
#     tools/check_package.sh bookworm|trixie|other [PACKAGE.deb]
#
# Without PACKAGE.deb it is made in a system of the release from a clone of the last commit, as ./setup.sh package makes it.
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
        bash -ec './setup.sh package; mkdir -p out; cp build/softfall_*.deb out/'
    package=$(echo "$place"/made/softfall_*.deb)
fi
mkdir "$place/stage"
cp "$package" "$place/stage"
cp "$root"/tests/package/* "$place/stage"
"$root/tools/in_debian.sh" --with "$place/stage" --fetch "$root/out/package-$release" "$release" \
    bash ./clean_system.sh "${package##*/}"
