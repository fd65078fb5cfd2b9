#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs sanitizers and valgrind; fails at the first finding.   tools/dynamic_analysis.sh [memory] [threads] [valgrind]
#   memory    gcc's address and undefined-behaviour sanitizers, all tests that are not slow
#   threads   gcc's thread sanitizer with LLVM's OpenMP and libarcher, 3 threads: a loop with a race, which the sanitizer
#             must find, the tests of the parallel loops, and a coarse drop; even short loops run on several threads
#   valgrind  memcheck on a coarse drop through softfall-pre, -solve and -post of the default build, with the kernels for
#             AVX2 (valgrind's processor has no AVX-512); not on softfall-mesh, which has gmsh
# Packages: section analysis of packages.txt.
set -euo pipefail
place=
trap '[ -z "$place" ] || rm -rf "$place"' EXIT
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build() {
    [ -f "$1/build.ninja" ] || cmake -B "$@"
    cmake --build "$1"
}

# coarse_drop BIN [COMMAND...]: runs the three programs under a command, in a temporary folder.
coarse_drop() {
    local bin=$PWD/$1 example=$PWD/examples/eva50-v4.5/case.cfg
    shift
    place=$(mktemp -d)
    (
        cd "$place"
        set -x
        "$@" "$bin/softfall-pre" "$example" -o model.h5 --set geometry.parameters.fine_spacing=20.0 \
            --set geometry.parameters.outer_spacing=20.0 --set geometry.missile_parameters.element_size=20.0 \
            --set pad.mesh_error_limit=1
        "$@" "$bin/softfall-solve" model.h5 -o results.h5
        "$@" "$bin/softfall-post" results.h5 -o out
    ) >/dev/null
    rm -r "$place"
}

run_memory() {
    build build-sanitize --preset sanitize
    OMP_NUM_THREADS=1 ctest --test-dir build-sanitize --output-on-failure --no-tests=error -LE slow
}

run_threads() {
    local archer
    build build-threads --preset threads
    archer=$(sed -n 's/^ARCHER_LIBRARY:.*=//p' build-threads/CMakeCache.txt)
    ctest --test-dir build-threads --output-on-failure --no-tests=error \
        -R '^(threads_control|test_(domains|constraint|stabilisation|patch|kernels|failure))$'
    coarse_drop build-threads/bin env OMP_NUM_THREADS=3 OMP_WAIT_POLICY=passive OMP_TOOL_LIBRARIES="$archer" \
        TSAN_OPTIONS="ignore_noninstrumented_modules=1 halt_on_error=1 exitcode=66"
    echo "threads: nothing found"
}

run_valgrind() {
    build build --preset default
    coarse_drop build/bin env OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive valgrind --quiet --error-exitcode=99 \
        --leak-check=full --errors-for-leak-kinds=definite,indirect --show-leak-kinds=definite,indirect
    echo "valgrind: nothing found"
}

[ $# -gt 0 ] || set -- memory threads valgrind
for tool in "$@"; do
    case $tool in
    memory | threads | valgrind) "run_$tool" ;;
    *) echo "dynamic_analysis.sh: unknown word $tool" >&2 && exit 2 ;;
    esac
done
