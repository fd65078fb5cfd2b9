/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_GUI_OUTCOME_H
#define SF_GUI_OUTCOME_H
#include <stddef.h>

#include "post/results/results.h"

/* Shows the checks of softfall-pre, and the sentences of programs, from their output. */

/* Puts the checks that the text of softfall-pre holds into the branch Checks of the tree. */
void sf_checks_show(const char *text);
/* Empties the branch. */
void sf_checks_clear(void);

/* The last sentence of a program's output, without the program's name. */
void sf_checks_sentence(const char *text, char *out, size_t size);
/* The solver's last line of progress, without double blanks; "" if there is none. */
void sf_checks_progress(const char *text, char *out, size_t size);

/* The figures of a run in the tree, by the functions of softfall-post. */

/* Puts them into the branch Results, coloured by pass and fail; returns the sentence of the verdict in
 * `line`. A run that has not ended or never touched has what is known. */
sf_status sf_outcome_show(const sf_results *results, char *line, size_t size, sf_error *err);
/* Empties the branch. */
void sf_outcome_clear(void);
/* The curve of the figures so far, filtered as they are; the raw one, and its title says so, of a run that
 * has no figures yet. */
void sf_outcome_plot(const sf_results *results);
#endif
