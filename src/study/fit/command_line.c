/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/command_line.h"

#include "io/provenance.h"
#include <stdio.h>
#include <stdlib.h>

char *sf_fit_command_line(int argc, char *const *argv) {
    char *words = sf_command_line(argc, argv), *text = NULL;
    if (words && asprintf(&text, "softfall-fit %s", words) < 0)
        text = NULL;
    free(words);
    return text;
}
