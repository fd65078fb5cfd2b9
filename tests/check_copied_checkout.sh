#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# check_copied_checkout.sh SOURCE: a copied and a moved checkout build their own sources. A small project with setup.sh and
# the presets of SOURCE stands for a checkout; its program says which sources it was made of.
set -euo pipefail
source=$1
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

fail() {
    printf 'check_copied_checkout: %s\n' "$*" >&2
    exit 1
}

# build PLACE: what its program says then; the log in $place/log.
build() {
    (cd "$1" && ./setup.sh build --no-install) >"$place/log" 2>&1 || fail "$(cat "$place/log")"
    "$1/build/who"
}

# source_says PLACE WORD
source_says() {
    printf '#include <stdio.h>\nint main(void) { return puts("%s") < 0; }\n' "$2" >"$1/who.c"
}

mkdir "$place/first"
cp "$source/setup.sh" "$source/packages.txt" "$source/CMakePresets.json" "$place/first"
cat >"$place/first/CMakeLists.txt" <<'TEXT'
cmake_minimum_required(VERSION 3.25)
project(who LANGUAGES C)
add_executable(who who.c)
add_custom_target(programs DEPENDS who)
TEXT
source_says "$place/first" first
[ "$(build "$place/first")" = first ] || fail "the first checkout does not build"
[ "$(build "$place/first")" = first ] || fail "a second build of the first checkout fails"
! grep -q 'configured afresh' "$place/log" || fail "a checkout that stays where it is was configured afresh"

cp -a "$place/first" "$place/copy"
source_says "$place/copy" copy
source_says "$place/first" "first, changed"
[ "$(build "$place/copy")" = copy ] || fail "the copied checkout builds something else: $("$place/copy/build/who")"
[ "$(grep -c "configured for the sources in $place/first: .* afresh for those in $place/copy" "$place/log")" = 1 ] ||
    fail "the copied checkout does not say why it is configured afresh: $(cat "$place/log")"
[ "$("$place/first/build/who")" = first ] || fail "the build of the copy wrote into the first checkout"

mv "$place/copy" "$place/moved"
source_says "$place/moved" moved
[ "$(build "$place/moved")" = moved ] || fail "the moved checkout builds something else"
ln -s moved "$place/link"
build "$place/link" >/dev/null
! grep -q 'configured afresh' "$place/log" || fail "another name of the same folder was taken for a move"
