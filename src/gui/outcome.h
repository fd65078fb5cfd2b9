/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figures of a run in the tree, by the functions of softfall-post. */
#ifndef SF_GUI_OUTCOME_H
#define SF_GUI_OUTCOME_H

#include "post/results/results.h"

/* Puts them into the branch Results, coloured by pass and fail; returns the sentence of the verdict in
 * `line`. A run that has not ended or never touched has what is known. */
sf_status sf_outcome_show(const sf_results *results, char *line, size_t size, sf_error *err);
/* Empties the branch. */
void sf_outcome_clear(void);
/* The curve of the figures so far, filtered as they are; the raw one, and its title says so, of a run that
 * has no figures yet. */
void sf_outcome_plot(const sf_results *results);

#endif
