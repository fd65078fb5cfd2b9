#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs missing packages, builds, and runs the main example or the tests, or makes a package.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: ./setup.sh WORD [--force] [--no-install] [--label LABEL]

  demo     build, then run examples/eva50-v4.5 through all three programs into out/eva50-v4.5, with its report
  test     build, then run the tests (all but the slow ones)
  slow     build, then run the slow tests
  build    build only: the programs are in build/bin
  core     the same without Python, gnuplot and the window's gmsh: what a mesh, a drop, its figures and its files need
  package  build, then make the Debian packages build/softfall_VERSION-REVISION_ARCHITECTURE.deb and
           build/python3-softfall_VERSION-REVISION_all.deb and check them with lintian

    --force        demo: run the drops again even if their results are up to date
  --label LABEL  test: only the tests with this label: unit, pipeline or verify, or several joined by |
  --no-install   install nothing; list the missing packages and continue
TEXT
}

fail() {
    printf 'setup.sh: %s\n' "$*" >&2
    exit 1
}

# Packages of the named sections of packages.txt.
packages_of() {
    awk -v wanted=" $* " '
        /^# section / { name = $3; sub(/:$/, "", name); take = index(wanted, " " name " ") > 0; next }
        { sub(/#.*/, "") }
        take && NF { print $1 }' packages.txt
}

missing_packages() {
    local package installed
    # A package that dpkg does not know makes it fail; it lists the others all the same.
    # shellcheck disable=SC2046
    installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $(packages_of "$@") 2>/dev/null) || true
    for package in $(packages_of "$@"); do
        [[ $'\n'$installed$'\n' == *$'\n'"installed $package"$'\n'* ]] || printf '%s ' "$package"
    done
}

# install_packages SECTION...: apt-get runs only if something is missing.
install_packages() {
    local missing as_root=() log
    if ! command -v dpkg-query >/dev/null; then
        echo "This is not Debian: no packages are installed; packages.txt lists those needed."
        return
    fi
    missing=$(missing_packages "$@")
    [ -n "$missing" ] || return 0
    if [ "$install" = no ]; then
        echo "Missing packages, not installed: $missing"
        return
    fi
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null ||
            fail "packages are missing, and neither root nor sudo is available. As root: apt-get install --no-install-recommends $missing"
        as_root=(sudo)
        [ -t 0 ] || as_root=(sudo -n)
    fi
    as_root+=(env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300)
    log=$(mktemp)
    echo "Installing (some minutes on a bare machine; log in $log): $missing"
    # Word splitting of $missing is wanted.
    # shellcheck disable=SC2086
    if ! { "${as_root[@]}" update && "${as_root[@]}" install -y --no-install-recommends $missing; } >"$log" 2>&1; then
        tail -n 20 "$log" >&2
        fail "apt-get failed: see its last lines above; the whole log is $log"
    fi
    rm -f "$log"
}

# build [CMAKE OPTION]...: the preset "default" in build/. Ninja reconfigures when a CMakeLists.txt changes. In a copied or
# moved checkout build/ still names the sources of the old place, and would compile those. A build/ that was configured without
# help2man makes no manual pages, and without the Python modules no completions of the Python programs.
build() {
    local home
    home=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' build/CMakeCache.txt 2>/dev/null) || true
    if [ -n "$home" ] && ! [ "$home" -ef . ]; then
        echo "build/ was configured for the sources in $home: it is configured afresh for those in $PWD."
        cmake --preset default --fresh
    elif [ ! -f build/build.ninja ] || [ CMakePresets.json -nt build/build.ninja ] ||
        { command -v help2man >/dev/null && grep -q '^SOFTFALL_HELP2MAN:.*NOTFOUND' build/CMakeCache.txt; } ||
        grep -q '^SOFTFALL_PYTHON_HELP:INTERNAL=$' build/CMakeCache.txt; then
        cmake --preset default
    fi
    cmake --build build --parallel "$(processors)" "$@"
}

build_programs() {
    build --target programs
}

demo() {
    local dir=out/eva50-v4.5 report=out/eva50-v4.5/report.txt
    if [ "$force" = no ] && [ -f "$report" ] &&
        [ -z "$(find build/bin geo examples -type f -newer "$report" -print -quit)" ]; then
        echo "The results in $dir are up to date; ./setup.sh demo --force runs the drops again."
        cat "$report"
    else
        tools/run_case.sh examples/eva50-v4.5/case.cfg "$dir"
    fi
    echo "  $dir/model.h5           the model of softfall-pre"
    echo "  $dir/results.h5         the results of softfall-solve"
    echo "  $report         the figures above"
    [ ! -f "$dir/report.html" ] || echo "  $dir/report.html        the page of the drop"
    echo "The files are in $PWD. Next: docs/guide.md explains how to read the results and change the case."
}

# The packages of this Debian release. Their files are as old as the last commit.
make_package() {
    rm -f build/softfall_*.deb build/python3-softfall_*.deb
    SOURCE_DATE_EPOCH=$(git log -1 --format=%ct 2>/dev/null) || SOURCE_DATE_EPOCH=$(date +%s)
    export SOURCE_DATE_EPOCH
    (cd build && cpack -G DEB >cpack.log 2>&1 && cpack -G DEB --config CPackPython.cmake >>cpack.log 2>&1) ||
        fail "cpack failed: $(tail -n 5 build/cpack.log)"
    lintian --allow-root --fail-on error build/softfall_*.deb build/python3-softfall_*.deb ||
        fail "lintian finds errors in the packages: see above"
    echo "The packages are made; to install them, as root: apt-get install $(echo ./build/softfall_*.deb ./build/python3-softfall_*.deb)"
}

# nproc would take OMP_NUM_THREADS for the number of processors.
processors() {
    env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc
}

run_tests() {
    ctest --test-dir build --output-on-failure --no-tests=error --no-label-summary "$@"
}

word='' force=no install=yes label=.
while [ $# -gt 0 ]; do
    case $1 in
    --force) force=yes ;;
    --no-install) install=no ;;
    --label)
        [ $# -gt 1 ] || fail "--label needs a label: unit, pipeline or verify"
        label=$2
        shift
        ;;
    -h | --help | help) usage && exit 0 ;;
    -*) usage >&2 && fail "unknown option $1" ;;
    *)
        [ -z "$word" ] || { usage >&2 && fail "only one word is allowed: $1 is the second"; }
        word=$1
        ;;
    esac
    shift
done
[ "$word" = test ] || [ "$label" = . ] || fail "--label is only for the word test"
cd "$(dirname "${BASH_SOURCE[0]}")"
case $word in
demo)
    install_packages build run python # what the next command, softfall run, needs, too
    build_programs
    demo
    ;;
test)
    # Where no test may be skipped, Snakemake is needed too.
    install_packages build run show python test ${SF_NO_SKIP:+cluster}
    build
    # One thread per test (tests of threading set their own number), and one test more than there are
    # processors: tests of pages wait for the browser, others for a limit.
    OMP_NUM_THREADS=1 run_tests --label-regex "$label" --label-exclude slow --parallel "$(($(processors) + 1))"
    ;;
slow)
    install_packages build run show python test slow cluster slurm
    build
    run_tests --label-regex slow --parallel "$(processors)" # those that use every core run alone
    ;;
build)
    install_packages build run python
    build_programs
    ;;
core)
    install_packages build
    build_programs
    ;;
package)
    install_packages build run python package
    build_programs
    make_package
    ;;
'') usage >&2 && exit 2 ;;
*) usage >&2 && fail "unknown word $word" ;;
esac
