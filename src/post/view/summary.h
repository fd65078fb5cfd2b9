/* SPDX-License-Identifier: GPL-3.0-or-later */
/* summary.json, and the short table that softfall-post prints. Keys carry their units; a figure that the run
 * does not define is null. docs/formats.md lists the keys. */
#pragma once
#include "post/figures/compare.h"

/* A drop and the figures that softfall-post has computed of it, for its files. */
typedef struct sf_summary {
    const char *results_path;
    const char *reference_path; /* NULL without comparison */
    const char *command_line;   /* of softfall-post */
    const sf_results *results;
    const sf_figures *figures;
    const sf_comparison *comparison; /* NULL: nothing was measured */
    const sf_verdict *verdict;
} sf_summary;

sf_status sf_summary_write(const sf_staging *output, const sf_summary *summary, sf_error *err);

/* The verdict, its rows that are not valid, and the table on `out`; the last line says that the figures are
 * indicative. */
void sf_summary_print(FILE *out, const sf_summary *summary);
