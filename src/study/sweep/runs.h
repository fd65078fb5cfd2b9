/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of every run of a plan and its figures: the table runs.csv. */
#pragma once
#include "study/sweep/plan.h"

typedef enum sf_sweep_state {
    SF_SWEEP_OPEN,
    SF_SWEEP_DONE,
    SF_SWEEP_FAILED,
    SF_SWEEP_PREDICTED
} sf_sweep_state;

enum { SF_RUNS_TEXTS = 64 };

typedef struct sf_runs {
    const sf_plan *plan; /* borrowed */
    const struct sf_runs
        *coarse; /* by which its rows are predicted or refined, ended; borrowed; NULL: none */
    int64_t count;
    size_t column[SF_SWEEP_FIGURES]; /* of those of the plan among them */
    unsigned char *state, *grade; /* [count] sf_sweep_state, sf_grade */
    double *value;                /* [count][figures] as in summary.json; NaN: none; a text: its number */
    double *half; /* [count][figures of the plan] of a predicted row half of the 95 % interval of the
                     logarithm, else 0; NULL: the plan predicts none */
    int checked[SF_SWEEP_FIGURES], held[SF_SWEEP_FIGURES]; /* simulated rows that were predicted from the
                        others, and those of them in their intervals before these were widened */
    char **folder;                /* [count] name of its folder; NULL: none */
    char **message; /* [count] why it failed or is left open, or the remarks of its verdict; NULL:
                       none */
    char text[SF_RUNS_TEXTS][80]; /* of the figures that are texts */
    int text_count;
} sf_runs;

/* All open. Release with sf_runs_free. */
sf_status sf_runs_create(const sf_plan *plan, sf_runs *runs, sf_error *err);
void sf_runs_free(sf_runs *runs);

/* The figures of a row, to be filled before sf_runs_done. */
double *sf_runs_place(const sf_runs *runs, int64_t row);
/* The place of a figure among them; the key must be in the list. */
size_t sf_runs_figure(const char *key);
/* The figures of a drop, [of sf_figure_at] sf_figure_number, into the place of the row; `status` is the one
 * that is a text. */
void sf_runs_take(sf_runs *runs, int64_t row, const double *figure, const char *status);

/* Figures are rounded to the 9 digits of runs.csv, so that a campaign in pieces computes with the same. */
sf_status sf_runs_done(sf_runs *runs, int64_t row, sf_grade grade, const char *folder, const char *message,
                       sf_error *err);
sf_status sf_runs_failed(sf_runs *runs, int64_t row, const char *message, sf_error *err);
void sf_runs_open(sf_runs *runs, int64_t row);
/* Leaves an open row as it is, and says why. */
sf_status sf_runs_leave(sf_runs *runs, int64_t row, const char *message, sf_error *err);
/* Predicts the figures of the plan, value [figures of the plan], with half of the 95 % interval of each
 * logarithm. A table that is read again has the row open: it is predicted anew. */
void sf_runs_predicted(sf_runs *runs, int64_t row, const double *value, const double *half);
/* Returns that half; 0 of a row that was simulated. */
double sf_runs_half(const sf_runs *runs, int64_t row, int figure);
int64_t sf_runs_count(const sf_runs *runs, sf_sweep_state state);

/* Figure `figure` of the plan if the row can be used, else NaN. */
double sf_runs_value(const sf_runs *runs, int64_t row, int figure);

/* The figures of a row that its coarse drop refines; NaN where there is no value, `note` then says why. */
enum { SF_REFINED = 4 };
typedef struct sf_runs_pair {
    int64_t id;
    double figure[SF_REFINED][2]; /* and its error */
    char note[1024];
} sf_runs_pair;

sf_runs_pair sf_runs_refine(const sf_runs *runs, int64_t row);
extern const sf_rows sf_runs_pair_rows;

/* True if the figures of the row can be used: done and not "do not use", or predicted. */
bool sf_runs_usable(const sf_runs *runs, int64_t row);

/* Writes runs.csv aside and renames it. `hash`: of its text. */
sf_status sf_runs_write(const sf_runs *runs, const char *path, uint64_t *hash, sf_error *err);
/* Reads what sf_runs_write wrote. All rows stay open if the file is of another table or has another hash:
 * something else has written it. */
sf_status sf_runs_read(sf_runs *runs, const char *path, uint64_t hash, sf_error *err);
