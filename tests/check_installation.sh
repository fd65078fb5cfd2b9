#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# check_installation.sh SOURCE BUILD: installs the build, moves the installed tree, and looks there: every program has a
# completion that knows its options, the programs find their files, and the desktop's files are sound. The build's
# CMakeCache.txt tells whether help2man made manual pages; the test looks at them only then.
set -euo pipefail
source=$1 build=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
prefix=$place/moved
unset SF_BIN_DIR # the programs find each other

fail() {
    printf 'check_installation: %s\n' "$*" >&2
    exit 1
}

cmake --install "$build" --prefix "$place/first" >"$place/log" || fail "$(tail -n 3 "$place/log")"
mv "$place/first" "$prefix"
share=$prefix/share

# complete PROGRAM WORD...: what bash offers in place of the last word.
complete() {
    bash -c '
        compopt() { :; }
        . "$1"
        shift
        COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
        "_${1//-/_}"
        printf "%s\n" "${COMPREPLY[@]}"' bash "$share/bash-completion/completions/$1" "$@" | sort | xargs
}

manual=$(sed -n 's/^SOFTFALL_HELP2MAN:[A-Z]*=//p' "$build/CMakeCache.txt")
[[ $manual != *NOTFOUND ]] && [ -n "$manual" ] || {
    manual=''
    echo "check_installation: this build was configured without help2man: it has no manual pages, none is looked at"
}
programs=$(find "$prefix/bin" -type f -printf '%f\n' | sort)
for name in $programs; do
    [ -f "$share/bash-completion/completions/$name" ] || fail "$name has no completion"
    "$prefix/bin/$name" --version | grep -qE "^($name|${name/-/ }) [0-9]" || fail "$name does not tell its version"
    if [ -n "$manual" ]; then
        [ -f "$share/man/man1/$name.1.gz" ] || fail "$name has no manual page"
        said=$(zcat "$share/man/man1/$name.1.gz" | grep -A1 '^\.SH NAME' | tail -n 1)
        [[ $said =~ ^"$name \\- "[A-Za-z].{15} ]] || fail "the manual page of $name says of it: $said"
    fi
done
[ "$(complete softfall-pre --ke)" = --keys ] || fail "softfall-pre --ke: $(complete softfall-pre --ke)"
[ "$(complete softfall-pre --se)" = --set= ] || fail "softfall-pre --se: $(complete softfall-pre --se)"
[ "$(complete softfall-solve --on-failure = r)" = remove ] || fail "softfall-solve --on-failure=r is not completed"
[ "$(complete softfall-fit '')" = compression ] || fail "the words of softfall-fit: $(complete softfall-fit '')"
[ "$(complete softfall-fit compression --ou)" = --output= ] || fail "softfall-fit compression --ou is not completed"
[ "$(PATH=$prefix/bin:$PATH complete softfall-new --from wal)" = wall ] || fail "the examples of softfall-new --from are not completed"
if [ -x "$prefix/bin/softfall" ]; then
    (
        cd "$share/softfall/examples/eva50-v4.5"
        PATH=$prefix/bin:$PATH
        [ "$(complete softfall ru)" = run ] || fail "softfall ru is not completed"
        [ "$(complete softfall run case.cfg zone)" = zone_side= ] || fail "softfall run case.cfg zone: $(complete softfall run case.cfg zone)"
        [ "$(complete softfall protocol en117)" = en1177 ] || fail "softfall protocol en117: $(complete softfall protocol en117)"
    ) || exit 1
fi
[ "$(cd "$share/softfall/examples/eva50-v4.5" && complete softfall-pre ca)" = case.cfg ] || fail "no files are offered"

# The programs find softfall-mesh, the geometries and examples, and share/softfall, from a folder elsewhere.
mkdir "$place/empty"
cd "$place/empty"
"$prefix/bin/softfall-pre" "$share/softfall/examples/compression/case.cfg" -o model.h5 \
    --set geometry.parameters.spacing=25 --set solver.end_time='20 ms' >pre.log 2>&1 || fail "$(cat pre.log)"
! strings -a "$prefix"/bin/* "$prefix"/libexec/softfall/* | grep -F "$build/" || fail "a program names the build folder"
cmp "$source/share/Snakefile" "$share/softfall/Snakefile"

# The links of the documents lead somewhere: to docs, examples and geo.
for link in "$share/doc/softfall/examples/eva50-v4.5/case.cfg" "$share/doc/softfall/geo/pad.geo" \
    "$share/doc/softfall/docs/case.md"; do
    [ -f "$link" ] || fail "$link is missing"
done

# The desktop's files, as far as their tools are here.
mime=$share/mime
[ -f "$mime/packages/softfall.xml" ] && [ -f "$share/icons/hicolor/scalable/apps/softfall.svg" ] ||
    fail "the file type or the icon is missing"
if command -v update-mime-database >/dev/null; then
    update-mime-database "$mime" 2>mime.log || fail "$(cat mime.log)"
    for pattern in case.cfg '*.softfall.cfg'; do
        grep -qF ":application/x-softfall-case:$pattern" "$mime/globs2" || fail "$pattern is no case file"
    done
fi
desktop=$share/applications/softfall.desktop
if [ -x "$prefix/bin/softfall" ]; then
    [ -f "$desktop" ] || fail "softfall open has no desktop entry"
    ! command -v desktop-file-validate >/dev/null || desktop-file-validate "$desktop"
    for name in $(sed -n 's/^Exec=\([^ ]*\).*/\1/p' "$desktop"); do
        [ -x "$prefix/bin/$name" ] || fail "the desktop entry starts $name, which is not installed"
    done
fi
