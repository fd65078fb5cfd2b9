#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Compares a page of the documents, whose figures stay as they were committed, with a copy in which they were written anew, and
# changes neither: says that they are equal, or prints what differs.
#
#     tools/compare_page.sh docs/validation.md out/validation.md
set -euo pipefail

[ $# -eq 2 ] || { echo 'usage: tools/compare_page.sh PAGE COPY' >&2 && exit 2; }
status=0
difference=$(diff -u "$1" "$2") || status=$?
[ $status -le 1 ] || exit "$status"
if [ $status -eq 0 ]; then
    echo "$2 is equal to $1: this run repeats its figures"
else
    printf '%s\n' "$difference"
    echo "$2 differs from $1, as shown: $1 keeps its figures, which were committed before the comparison"
fi
