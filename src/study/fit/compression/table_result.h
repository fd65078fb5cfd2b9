/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fit of tables as the pipeline has it: the fit, its card in the solver's own law, and how both stand
 * against the data. Internal to table_kind.c and to table_report.c, which has the page and
 * the words and rows that stand there, too. */
#pragma once
#include "report/row.h"
#include "study/fit/compression/compression_kind.h"
#include "study/fit/compression/table_fit.h"

/* A test against the fit. */
typedef struct sf_table_test {
    sf_compression_test test; /* its arrays are the configuration's */
    const char *name;         /* the file without its folders; borrowed */
    int unloading;            /* points */
    double rms[2];            /* of deviation over sigma, loading and unloading; NaN: no such branch */
    double percent[2]; /* root mean square of deviation, % of the stress, counted as one hundredth of the
                          largest at least */
    double speed_up, difference[2], energy_error; /* of the simulated test */
} sf_table_test;

typedef struct sf_table_result {
    sf_compression_fit fit;
    sf_foam_card card;   /* of the fit; owned */
    double card_percent; /* largest difference of card and fit, counted as `percent` */
    int test_count;
    sf_table_test test[SF_COMPRESSION_TESTS];
    bool simulated;
} sf_table_result;

/* Rows of an sf_table_test: all, and those of the simulated test. */
extern const sf_rows sf_table_test_rows, sf_table_simulation_rows;

/* Phrases of sf_rate_model and sf_rule. */
extern const char *const sf_table_rates[SF_RATE_MODELS], *const sf_table_rules[SF_RULES];

/* An estimate as a reader sees it. */
typedef struct sf_table_estimate {
    char value[64], error[64], interval[140];
} sf_table_estimate;
sf_table_estimate sf_table_estimate_of(const sf_estimate *estimate);
/* "rms deviation ...: how well a side is fitted. Returns `text`. */
const char *sf_table_misfit(const sf_side *side, char text[160]);

/* fit.gp, fit.png and report.html. */
sf_status sf_table_report_write(const sf_compression_job *job, const sf_staging *output,
                                const sf_table_result *result, char *warning, size_t size, sf_error *err);
