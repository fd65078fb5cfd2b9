/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fit of tables as the pipeline has it: the fit, its card in the solver's own law, and how both stand
 * against the data; its words for the files and the report. */
#ifndef SF_FIT_COMPRESSION_TABLE_RESULT_H
#define SF_FIT_COMPRESSION_TABLE_RESULT_H

#include "report/row.h"
#include "study/fit/compression/cube.h"
#include "study/fit/compression/table_fit.h"

/* A test against the fit. */
typedef struct sf_table_test {
    const char *path, *name; /* the file, and without its folders; borrowed */
    const char *interpretation;
    double toe, rate, largest_strain, largest_stress; /* SI */
    int loading, unloading;                           /* points */
    double rms[2];     /* of deviation over sigma, loading and unloading; NaN: no such branch */
    double percent[2]; /* root mean square of deviation, % of the stress, counted as one hundredth of the
                          largest at least */
    double speed_up, difference[2], energy_error; /* of the simulated test (cube.h) */
} sf_table_test;

/* An estimate as a reader sees it. */
typedef struct sf_table_estimate {
    const char *name, *note;
    char value[64], error[64], interval[140];
} sf_table_estimate;

/* A form that was tried. */
typedef struct sf_table_candidate {
    const char *phrase;
    int parameters;
    double chi2, above; /* BIC above the lowest */
    const char *chosen;
} sf_table_candidate;

typedef struct sf_table_result {
    sf_compression_fit fit;
    sf_foam_card card;   /* of the fit; owned */
    double card_percent; /* largest difference of card and fit, counted as `percent` */
    int test_count;
    sf_table_test test[SF_COMPRESSION_TESTS];
    bool simulated;
    sf_cube_test *cube; /* [test_count] if simulated; owned */
} sf_table_result;

/* Fits, builds the card and compares. `config` is borrowed until sf_table_result_free, which is due on
 * failure, too. */
sf_status sf_table_result_make(const sf_compression_config *config, sf_table_result *result, sf_error *err);
void sf_table_result_free(sf_table_result *result);

/* Rows of an sf_table_test: all, and those of the simulated test. */
sf_rows sf_table_test_rows(void);
sf_rows sf_table_simulation_rows(void);

sf_table_estimate sf_table_estimate_of(const sf_compression_fit *fit, int k);
const char *sf_table_rate_phrase(sf_rate_model model);
const char *sf_table_rule_phrase(sf_rule rule);

#endif
