/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The checks behind sf_results_open: each refuses with SF_ERR_IO and a sentence naming the dataset, the value
 * and the bound. */
#ifndef SF_POST_RESULTS_CHECK_H
#define SF_POST_RESULTS_CHECK_H

#include "post/results/results.h"

/* True for the statuses finished, rebound and interrupted. */
bool sf_results_ended_well(const sf_results *results);

/* Adds a sentence to the notes; further ones are dropped when they are full. */
void sf_results_note(sf_results *results, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The same of a sentence that only says how the run ended. */
void sf_results_note_ending(sf_results *results, const char *sentence);

sf_status sf_results_check_finite(const double *values, int64_t count, const char *path, sf_error *err);

/* Cells, indices, positions, and the missile. */
sf_status sf_results_check_model(const sf_results *results, sf_error *err);

/* Sets history.rows from the lengths of the columns, `rows` [SF_HISTORY_COUNT]: equal lengths, finite
 * values, times ascending; of a run that did not end well the longest part of which that holds. */
sf_status sf_results_check_history(sf_results *results, const int64_t *rows, sf_error *err);

#endif
