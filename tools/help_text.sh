# SPDX-License-Identifier: GPL-3.0-or-later
# Reads the --help of a program; sourced by manual_page.sh and bash_completion.sh. A help has lines "Usage: ..." and
# "  or:  ...", then what the program does, then its options.
# shellcheck shell=bash

# help_words PROGRAM: the words of a program whose usage is "PROGRAM WORD ...", from the list in its help.
help_words() {
    "$1" --help | awk '
        /^Usage: [^ ]+ WORD/ { listed = 1 }
        listed && /^  [a-z][a-z-]*  / { print $1 }'
}

# help_summary PROGRAM [WORD]: the first sentence on what it does, without its stop, up to a colon; small at its beginning.
help_summary() {
    "$@" --help | awk '
        /^(Usage:|  or:)/ || (!text && !NF) { next }
        !NF || /^ / { exit }
        { text = text (text ? " " : "") $0 }
        END {
            sub(/[.:;]( .*)?$/, "", text)
            first = match(text, /[.:;] /)
            if (first) text = substr(text, 1, first - 1)
            sub(/ *\([^)]*\)/, "", text)
            if (text ~ /^[A-Z][a-z ]/) text = tolower(substr(text, 1, 1)) substr(text, 2)
            print text
        }'
}

# help_options PROGRAM [WORD]: its long options, one a line; "--name=" if it takes a value, "--name=a|b" if one of these.
help_options() {
    "$@" --help | grep -oE '^ +(-.,  ?)?--[a-z][a-z-]*(=[^ ]*)?' |
        sed -E -e 's/^.*(--[a-z])/\1/' -e '/=[a-z]+(\|[a-z]+)+$/! s/=.*/=/'
}
