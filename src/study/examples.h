/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The examples that come with softfall: the folders of share/softfall/examples with a case.cfg. */
#ifndef SF_NEW_EXAMPLES_H
#define SF_NEW_EXAMPLES_H

#include "base/error.h"
#include <stdio.h>

typedef struct sf_examples {
    char *folder;
    int count;
    char **name; /* [count] ascending; owned */
} sf_examples;

/* SF_ERR_IO: the folder is missing. Release with sf_examples_free, also on failure. */
sf_status sf_examples_find(sf_examples *examples, sf_error *err);
void sf_examples_free(sf_examples *examples);

/* A line for each: its name and the first line of its case, a comment. */
sf_status sf_examples_print(const sf_examples *examples, FILE *out, sf_error *err);

/* The case of the example of this name; from malloc. NULL: SF_ERR_INPUT with the names that exist. */
char *sf_examples_case(const sf_examples *examples, const char *name, sf_error *err);

#endif
