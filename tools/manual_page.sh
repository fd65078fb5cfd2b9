#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the manual pages of a program from its --help and --version, by help2man.
#
#     tools/manual_page.sh PROGRAM DIR [OTHER PROGRAM]...
#
# Writes DIR/PROGRAM.1.gz, and DIR/PROGRAM-WORD.1.gz for each word of a program whose help begins with "PROGRAM WORD". Its
# line of NAME is the first sentence of the help. The other programs stand under SEE ALSO.
set -euo pipefail
# shellcheck source=tools/help_text.sh
. "$(dirname "${BASH_SOURCE[0]}")/help_text.sh"
program=$1 dir=$2
shift 2
name=${program##*/}
see=
for other in "$@"; do
    [ "$other" = "$name" ] || see="$see.BR $other (1),
"
done

# page [WORD]
page() {
    local page=$name${1:+-$1}
    help2man --no-info --section 1 --manual "softfall" --name "$(help_summary "$program" "$@")" \
        --include <(printf '[see also]\n%sand the documents and examples in\n.IR share/doc/softfall .\n' "$see") \
        "$program${1:+ $1}" |
        sed -e "s/^\\.TH [^ ]*/.TH ${page^^}/" -e "s/^$name \\\\- /$page \\\\- /" | gzip -9n >"$dir/$page.1.gz"
}

mkdir -p "$dir"
page
for word in $(help_words "$program"); do
    [[ " $* " == *" $name-$word "* ]] || page "$word" # a word that is handed over to another program has that one's page
done
