#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# clean_system.sh PACKAGE.deb: as root in a clean Debian (tools/check_package.sh starts it there): installs the package and
# python3-softfall beside it, uses them as a user without rights, removes them, and looks for what is left.
set -euo pipefail
package=$PWD/$1 python=$(echo "$PWD"/python3-softfall_*.deb)
stage=$PWD
mkdir -p out
export DEBIAN_FRONTEND=noninteractive

fail() {
    printf 'clean_system: %s\n' "$*" >&2
    exit 1
}

said() {
    printf '%4d s  %s\n' "$SECONDS" "$*"
}

# quietly COMMAND...: what it prints is shown only if it fails.
quietly() {
    "$@" >"$stage/out/log" 2>&1 || { tail -n 30 "$stage/out/log" >&2 && fail "failed: $*"; }
}

# as_user COMMAND...: in the folder /home/drop/empty.
as_user() {
    (cd /home/drop/empty && setpriv --reuid=drop --regid=drop --init-groups \
        env HOME=/home/drop USER=drop PATH=/usr/local/bin:/usr/bin:/bin "$@")
}

installed_packages() {
    dpkg-query -W -f '${Package} ${db:Status-Abbrev}\n' | sort
}

# (grep -q would end a pipe early, which counts as a failure here.) The tools of this test are there before, so that what the package brings and leaves is seen.
quietly apt-get update
quietly apt-get install -y --no-install-recommends shared-mime-info desktop-file-utils man-db
useradd --create-home drop
install -d -o drop -g drop /home/drop/empty
installed_packages >out/packages-before
said "clean system with the tools of this test"

quietly apt-get install -y --no-install-recommends "$package" "$python"
dpkg-query -L softfall python3-softfall | sed '/^$/d' | sort -u >out/files
said "installed: $(dpkg-query -W -f '${Version}, ${Installed-Size} kB' softfall), with $(installed_packages | comm -13 out/packages-before - | wc -l) packages"
! grep -vE '^/(\.|usr($|/))' out/files || fail "it has files outside /usr"
# softfall-protocol is another name of "softfall protocol".
for name in $(sed -n 's|^/usr/bin/||p' out/files); do
    as_user "$name" --version | grep "^${name/-/[ -]} [0-9]" >/dev/null || fail "$name does not start"
    as_user man -w "$name" >/dev/null || fail "$name has no manual page"
done
ldconfig -p | grep 'libsoftfall\.so' >/dev/null || fail "ld.so does not find libsoftfall"
desktop-file-validate /usr/share/applications/softfall*.desktop
for pattern in case.cfg '*.softfall.cfg'; do
    grep -qF ":application/x-softfall-case:$pattern" /usr/share/mime/globs2 || fail "$pattern is no case file"
done
grep -q 'application/x-softfall-case=softfall' /usr/share/applications/mimeinfo.cache || fail "no program opens a case file"
said "programs start, manual pages, library and file type are known"

# README's case of one's own, from an empty folder.
case=/home/drop/empty/my-pad/case.cfg
as_user softfall-new my-pad --from eva50-v4.5 >out/demo.txt
as_user softfall-pre "$case" -o model.h5 >>out/demo.txt
as_user softfall-solve model.h5 -o results.h5 >>out/demo.txt
as_user softfall-post results.h5 -o out >>out/demo.txt
for name in summary.json acceleration.csv pad.xdmf; do
    [ -s "/home/drop/empty/out/$name" ] || fail "the demo did not write $name"
done
grep -q '"grade": "valid' /home/drop/empty/out/summary.json || fail "the demo is not valid: $(cat out/demo.txt)"
said "demo: $(grep -m1 "^ *a_max " out/demo.txt)"

# The same drop from Python: the run is another one, the figures are the same; then softfall-serve, which a client asks.
cat >/tmp/drop.py <<'TEXT'
import json, sys
import softfall
drop = softfall.Case(sys.argv[1]).run(threads=2)
drop.plot().figure.savefig("plot.png")
theirs = json.load(open("out/summary.json"))
different = [key for key in drop.figures if theirs[key] is not None and drop.figures[key] != theirs[key]]
assert set(different) <= {"wall_s", "threads"} and drop.report().exists(), different
print(softfall.version(), drop.verdict, drop.figures["hic"])
TEXT
as_user env MPLBACKEND=agg python3 -W ignore /tmp/drop.py "$case" >out/python.txt 2>&1 || fail "Python: $(tail -n 5 out/python.txt)"
cat >/tmp/serve <<'TEXT'
softfall-serve "$1" --input="missile.velocity [m/s]" --output=hic --port=0 >serve.txt 2>serve.log &
program=$!
for second in $(seq 60); do
    sleep 1
    ! [ -s serve.txt ] || break
done
python3 - "$(sed 's/.* at //' serve.txt)/Evaluate" <<'ASK'
import sys, urllib.request
print(urllib.request.urlopen(sys.argv[1], b'{"name": "drop", "input": [[4.5]]}', timeout=600).read().decode())
ASK
kill -TERM $program
wait $program
TEXT
as_user sh /tmp/serve "$case" >>out/python.txt 2>&1 || fail "softfall-serve: $(tail -n 5 out/python.txt /home/drop/empty/serve.log)"
grep -q '{"output"' out/python.txt || fail "softfall-serve answers: $(tail -n 1 out/python.txt)"
said "Python: $(xargs <out/python.txt)"

# The workbench: its page comes by the printed address, and it ends when told to.
cat >/tmp/look <<'TEXT'
softfall open "$1" --no-browser >open.txt 2>&1 &
program=$!
for second in $(seq 60); do
    sleep 1
    ! grep -q http open.txt || break
done
python3 -c 'import sys, urllib.request as web; print(web.build_opener(web.HTTPCookieProcessor()).open(sys.argv[1], timeout=60).read().decode())' \
    "$(grep -o 'http[^ ]*' open.txt)" >page.html
kill -TERM $program
wait $program
TEXT
as_user sh /tmp/look "$case" || fail "softfall open: $(tail -n 5 /home/drop/empty/open.txt)"
grep -q '<script' /home/drop/empty/page.html || fail "softfall open has no page: $(head -n 3 /home/drop/empty/page.html)"
as_user softfall-pre /usr/share/softfall/examples/compression/case.cfg -o example.h5 >>out/demo.txt # from where it is
[ -z "$(find /usr/share/softfall -newer out/files -print -quit)" ] || fail "something was written into /usr/share/softfall"
said "workbench: $(stat -c %s /home/drop/empty/page.html) bytes of page"

# Removed, nothing of it is left; nor are the packages that it brought.
quietly apt-get purge -y softfall python3-softfall
while read -r path; do
    [ -d "$path" ] && dpkg-query -S "$path" >/dev/null 2>&1 && continue
    [ ! -e "$path" ] && [ ! -L "$path" ] || fail "$path is left after the removal"
done <out/files
left=$(find / -xdev \( -path /proc -o -path /softfall -o -path /home/drop -o -path /var/log \) -prune -o -iname '*softfall*' -print)
[ -z "$left" ] || fail "left after the removal: $left"
! grep -rqs softfall /usr/share/mime /usr/share/applications /etc || fail "the removed package is still named in /usr/share or /etc"
! ldconfig -p | grep softfall || fail "ld.so still knows the library"
# (Recommendations of this test's own tools would keep some.)
quietly apt-get autoremove --purge -y -o APT::AutoRemove::RecommendsImportant=false -o APT::AutoRemove::SuggestsImportant=false
installed_packages | diff out/packages-before - >out/packages-left || fail "packages are left: $(cat out/packages-left)"
said "removed, and nothing is left"
