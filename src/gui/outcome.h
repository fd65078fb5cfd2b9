/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_GUI_OUTCOME_H
#define SF_GUI_OUTCOME_H
#include <stddef.h>

#include "post/results/results.h"

/* Shows the checks of softfall-pre, and the sentences of programs, from their output. */

enum { SF_CHECK_ENTRIES = 10, SF_CHECK_NAME = 80, SF_CHECK_VALUE = 200 };

typedef struct sf_check_entry {
    char name[SF_CHECK_NAME]; /* in the tree: "3Checks/00nodes" */
    char value[SF_CHECK_VALUE];
} sf_check_entry;

typedef struct sf_check_entries {
    int count;
    sf_check_entry entry[SF_CHECK_ENTRIES];
} sf_check_entries;

/* Reads the checks that softfall-pre left in model.h5 (/provenance/report). */
sf_status sf_checks_read(const char *model, sf_check_entries *checks, sf_error *err);
/* Puts them into the branch Checks of the tree, and removes them from it. */
void sf_checks_show(const sf_check_entries *checks);
void sf_checks_clear(const sf_check_entries *checks);

/* The last sentence of a program's output, without the program's name. */
void sf_checks_sentence(const char *text, char *out, size_t size);
/* The solver's last line of progress, without double blanks; "" if there is none. */
void sf_checks_progress(const char *text, char *out, size_t size);

/* The figures of a run in the tree, by the functions of softfall-post. */

/* Puts them into the rows below the buttons, coloured by pass and fail; returns the sentence of the verdict in
 * `line`. A run that has not ended or never touched has what is known. */
sf_status sf_outcome_show(const sf_results *results, char *line, size_t size, sf_error *err);
/* Puts a dash into each row. */
void sf_outcome_clear(void);
/* The curve of the figures so far, filtered as they are; the raw one, and its title says so, of a run that
 * has no figures yet. */
void sf_outcome_plot(const sf_results *results);
#endif
