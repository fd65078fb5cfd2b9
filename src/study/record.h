/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of a finished drop, cached beside its results in a small text, figures.txt. It is read in place
 * of results.h5 as long as that is the file that it was made of (size and time); without it, or with one
 * of another version, damaged or half written, results.h5 is read and it is written anew. */
#ifndef SF_CAMPAIGN_RECORD_H
#define SF_CAMPAIGN_RECORD_H

#include "post/figures/verdict.h"

typedef struct sf_run_record {
    sf_grade grade;
    const char *verdict;  /* sf_verdict_line */
    const char *status;   /* /summary/status */
    const char *geometry; /* the list of what the geometries read (pre/mesh/mesh_store.h) */
    double *figure;       /* [of sf_figure_list] sf_figure_number; owned */
    char *text;           /* that the strings are parts of; owned */
} sf_run_record;

/* True if the record at `path` is whole, of this version, and made of the file `results` as it is now.
 * Release with sf_run_record_free, also if it is false. */
bool sf_run_record_read(const char *path, const char *results, sf_run_record *record);
void sf_run_record_free(sf_run_record *record);

/* Writes the record at `path`, of the open results of the file `results`. It is only a shorter way: where it
 * cannot be written, nothing is said. */
void sf_run_record_write(const char *path, const char *results, const sf_results *r, const sf_figures *f,
                         sf_grade grade, const char *verdict, const char *geometry);

#endif
