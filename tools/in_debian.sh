#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a command in a fresh clone of the last commit, in a fresh minimal Debian of the named release.
#
#     tools/in_debian.sh [--fetch DIR] [--with FOLDER] RELEASE COMMAND...
#     tools/in_debian.sh trixie ./setup.sh demo
#     tools/in_debian.sh --fetch out/other other ./setup.sh demo
#
# RELEASE is bookworm (12), trixie (13), or other: the one of them that this machine does not run. debootstrap installs
# the system in a temporary folder, from the mirror of this machine's apt sources, in about half a minute. The command
# runs there by chroot, as root, in the clone's folder. Afterwards the script removes the folder; with --fetch it first
# copies the clone's out/ to DIR. With --with a copy of FOLDER takes the place of the clone, and git is not installed. The
# exit code is that of the command, or 77 without root or its right to mount. Needs the packages debootstrap and git.
set -euo pipefail

fail() {
    printf 'in_debian.sh: %s\n' "$*" >&2
    exit 1
}

fetch='' with=''
while [ $# -ge 2 ]; do
    case $1 in
    --fetch) fetch=$2 ;;
    --with) with=$2 ;;
    *) break ;;
    esac
    shift 2
done
if [ $# -lt 2 ]; then
    echo 'usage: tools/in_debian.sh [--fetch DIR] [--with FOLDER] bookworm|trixie|other COMMAND...' >&2
    exit 2
fi
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
here=$(. /etc/os-release && printf '%s' "${VERSION_CODENAME:-}")
release=$1
shift
case $release in
bookworm | trixie) ;;
12) release=bookworm ;;
13) release=trixie ;;
other) [ "$here" = trixie ] && release=bookworm || release=trixie ;;
*) fail "unknown release $release; known are bookworm, trixie and other" ;;
esac
if [ "$(id -u)" -ne 0 ]; then
    echo "in_debian.sh: skipped: only root can make a Debian in a folder (debootstrap, mount, chroot)" >&2
    exit 77
fi
if ! unshare --mount --propagation private true 2>/dev/null; then
    echo "in_debian.sh: skipped: this machine, perhaps a container, permits root no mounts" >&2
    exit 77
fi
for program in debootstrap git unshare apt-get; do
    command -v "$program" >/dev/null || fail "$program is missing: apt-get install debootstrap git"
done
# The mirror of Debian's main archive that this machine uses, without the security and updates parts.
mirror=$(apt-get indextargets --format '$(ORIGIN)|$(LABEL)|$(CODENAME)|$(REPO_URI)' 'Created-By: Packages' |
    awk -F'|' '$1 == "Debian" && $2 == "Debian" && $3 ~ /^(bookworm|trixie|sid|forky)$/ && !n++ { print $4 }')
[ -n "$mirror" ] || fail "the apt sources of this machine name no Debian archive: run apt-get update"

system=$(mktemp -d "${TMPDIR:-/var/tmp}/softfall-$release-XXXXXX")
trap 'rm -rf --one-file-system "$system"' EXIT
trap 'exit 130' INT TERM
chmod 755 "$system" # the folder "/" of that system: its users pass
debootstrap --variant=minbase --include="ca-certificates$([ -n "$with" ] || printf ',git')" "$release" "$system" "$mirror" >"$system.log" 2>&1 ||
    fail "debootstrap failed; its last line: $(tail -n 1 "$system.log"); all of them: $system.log"
rm -f "$system.log"
cp /etc/resolv.conf "$system/etc/"
# Access to the archive (proxies, dates), in a file of another name than those of packages.
apt-config dump | grep -E '^Acquire::(https?::|Check-|Proxy|Retries)' >"$system/etc/apt/apt.conf.d/90access" || true
if [ -n "$with" ]; then
    cp -r "$with" "$system/softfall"
    chmod -R go+rX "$system/softfall"
    content="a copy of $with"
else
    git -c safe.directory="$root" -c safe.directory="$root/.git" clone --quiet --no-hardlinks "$root" "$system/softfall"
    [ -z "$(git -C "$root" status --porcelain --untracked-files=no)" ] ||
        echo "in_debian.sh: the clone does not contain uncommitted changes" >&2
    content="a fresh clone ($(git -C "$root" describe --always))"
fi
echo "in_debian.sh: $* in $content on Debian $release"
# The mounts are in a separate mount namespace, which ends with the command in every case.
status=0
# shellcheck disable=SC2016 # $1 and $@ belong to the inner shell
unshare --mount --propagation private bash -ec '
    system=$1
    shift
    mount -t proc proc "$system/proc"
    mount --rbind /dev "$system/dev"
    exec chroot "$system" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 \
        bash -c "cd /softfall && exec \"\$@\"" bash "$@"' bash "$system" "$@" </dev/null || status=$?
if [ -n "$fetch" ] && [ -d "$system/softfall/out" ]; then
    rm -rf "$fetch"
    mkdir -p "$fetch"
    cp -r "$system/softfall/out/." "$fetch/"
fi
exit "$status"
