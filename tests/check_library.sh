#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# check_library.sh SOURCE BUILD: installs the build into a prefix of its own, builds examples/library against it with
# pkg-config and with CMake, and compares its figures with those of the installed programs, digit for digit.
set -euo pipefail
source=$1 build=$2
cc=${CC:-cc}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
prefix=$place/usr

fail() {
    printf 'check_library: %s\n' "$*" >&2
    exit 1
}

cmake --install "$build" --prefix "$prefix" >"$place/install.log" || fail "$(tail -n 3 "$place/install.log")"
lib=$(dirname "$(find "$prefix" -name libsoftfall.so)")
export PKG_CONFIG_PATH=$lib/pkgconfig LD_LIBRARY_PATH=$lib

# Each header alone, in C11 and C++.
for header in "$prefix"/include/softfall/*.h; do
    include="#include <softfall/${header##*/}>"
    "$cc" -std=c11 -pedantic -Wall -Wextra -Werror -fsyntax-only -I "$prefix/include" -x c - <<<"$include"
    if command -v c++ >/dev/null; then
        c++ -std=c++11 -pedantic -Wall -Wextra -Werror -fsyntax-only -I "$prefix/include" -x c++ - <<<"$include"
    fi
done

# libsoftfall needs no gmsh and no libconfig; neither library prints, ends the process or shows internal names.
needed=$(readelf -d "$lib/libsoftfall.so" | grep NEEDED)
case $needed in *gmsh* | *libconfig*) fail "libsoftfall.so needs: $needed" ;; esac
for name in libsoftfall libsoftfall-build; do
    if nm -D --undefined-only "$lib/$name.so" | grep -E ' (stdout|stdin|printf|puts|putchar|perror|exit|abort)(@|$)'; then
        fail "$name.so prints or ends the process"
    fi
    if nm -D --defined-only "$lib/$name.so" | awk '{ print $3 }' | grep -vE '^softfall_'; then
        fail "$name.so shows more than include/softfall declares"
    fi
done

cd "$source/examples/library"
# Word splitting of the flags is wanted.
# shellcheck disable=SC2046
"$cc" -std=c11 -Wall -Wextra -Werror drop.c -o "$place/by-pkg-config" $(pkg-config --cflags --libs softfall-build)
cmake -G Ninja -S . -B "$place/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" >"$place/cmake.log" 2>&1 &&
    cmake --build "$place/build" >>"$place/cmake.log" 2>&1 || fail "$(tail -n 5 "$place/cmake.log")"

case=$source/examples/eva50-v4.5/case.cfg
coarse=(geometry.parameters.fine_spacing=20.0 geometry.parameters.outer_spacing=20.0
    geometry.missile_parameters.element_size=20.0 pad.mesh_error_limit=1)
cd "$place"
"$prefix/bin/softfall-pre" "$case" -o model.h5 "${coarse[@]/#/--set=}" >pre.log
"$prefix/bin/softfall-solve" model.h5 -o results.h5 --threads 1 >solve.log
"$prefix/bin/softfall-post" results.h5 -o out >post.log
for program in ./by-pkg-config ./build/drop; do
    $program "$case" "${coarse[@]}" >figures.txt
    for pair in a_max:a_max_g HIC:hic; do
        ours=$(awk -v name="${pair%%:*}" '$1 == name { print $2 }' figures.txt)
        theirs=$(sed -n "s/^ *\"${pair##*:}\": \([^,]*\),*$/\1/p" out/summary.json | head -n 1)
        [ -n "$ours" ] && [ "$ours" = "$theirs" ] ||
            fail "$program: ${pair%%:*} is $ours, that of softfall-post $theirs"
    done
done
cat figures.txt
