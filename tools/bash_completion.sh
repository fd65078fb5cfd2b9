#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints bash's completion of a program's command line, from its --help.
#
#     tools/bash_completion.sh PROGRAM >share/bash-completion/completions/PROGRAM
set -euo pipefail
# shellcheck source=tools/help_text.sh
. "$(dirname "${BASH_SOURCE[0]}")/help_text.sh"
program=$1
name=${program##*/}
function=_${name//-/_}
words=$(help_words "$program" | xargs)

# case_of PATTERN [WORD]
case_of() {
    local pattern=$1
    shift
    printf '    %s) options="%s" ;;\n' "$pattern" "$(help_options "$program" "$@" | sed 's/=.*/=/' | xargs)"
}

# The values of options that take one of a few.
values_of() {
    help_options "$program" "$@" | sed -nE 's/^(--[^=]*)=(.+)$/    \1) values="\2" ;;/p' | tr '|' ' '
}

cat <<TEXT
# bash completion of $name, made from its --help
$function() {
    local now=\${COMP_WORDS[COMP_CWORD]} option=\${COMP_WORDS[COMP_CWORD - 1]} options='' values=''
    [ "\$option" != = ] || option=\${COMP_WORDS[COMP_CWORD - 2]}
    [ "\$now" != = ] || now=
    case \${COMP_WORDS[1]} in
$(for word in $words; do case_of "$word" "$word"; done)
$(case_of '*')
    esac
    case \$option in
$(values_of && for word in $words; do values_of "$word"; done)
    esac
    COMPREPLY=()
    if [ -n "\$values" ]; then
        mapfile -t COMPREPLY < <(compgen -W "\$values" -- "\$now")
    elif [[ \$now == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "\$options" -- "\$now")
        [[ \${COMPREPLY[*]} != *= ]] || compopt -o nospace
    elif [ -n "$words" ] && [ "\$COMP_CWORD" -eq 1 ]; then
        mapfile -t COMPREPLY < <(compgen -W "$words" -- "\$now")
    else
        compopt -o filenames
        mapfile -t COMPREPLY < <(compgen -f -- "\$now")
    fi
}
complete -F $function $name
TEXT
