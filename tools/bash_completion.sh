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

# What the programs themselves know: examples, protocols, keys of a case.
names_of() {
    # shellcheck disable=SC2016 # the text is expanded in the completion
    local self='"${COMP_WORDS[0]}"' list="2>/dev/null | cut -d' ' -f1"
    # shellcheck disable=SC2016
    case $name in
    softfall-new) echo "    *' --from' | *' -f') values=\$($self --list $list) ;;" ;;
    softfall-protocol) echo "    *) [[ \$now == -* || \$COMP_CWORD -ne 1 ]] || values=\$($self --list $list) ;;" ;;
    softfall)
        echo "    'new --from' | 'new -f') values=\$($self new --list $list) ;;"
        echo "    'protocol protocol') values=\$($self protocol --list $list) ;;"
        echo "    run\\ [!-]*) [[ \$COMP_CWORD -lt 3 || \${COMP_WORDS[COMP_CWORD]} == = || \${COMP_WORDS[COMP_CWORD - 1]} == = ]] || values=\$($self run --keys \"\${COMP_WORDS[2]}\" 2>/dev/null | sed 's/=.*/=/') ;;"
        ;;
    esac
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
    case "\${COMP_WORDS[1]} \$option" in
$(names_of)
    esac
    COMPREPLY=()
    if [ -n "\$values" ]; then
        mapfile -t COMPREPLY < <(compgen -W "\$values" -- "\$now")
        [[ \${COMPREPLY[*]} != *= ]] || compopt -o nospace
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
