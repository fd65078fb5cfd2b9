/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A compression test from a CSV file: loading, then perhaps unloading, at a constant nominal rate. Columns
 * `strain` or `strain_percent` and `stress_Pa`, `stress_kPa` or `stress_MPa`; engineering strain and nominal
 * stress, positive in compression, with the scatter of a measurement.
 *
 * Of a branch with more than SF_COMPRESSION_BRANCH_POINTS points the means of neighbours are kept: they hold
 * as much about the law, and the fit stays quick. The turn is kept as it is. */
#ifndef SF_FIT_COMPRESSION_TEST_H
#define SF_FIT_COMPRESSION_TEST_H

#include "core/error.h"

enum { SF_COMPRESSION_LOADING_POINTS = 20, SF_COMPRESSION_UNLOADING_POINTS = 8 }; /* the least of them */
enum { SF_COMPRESSION_BRANCH_POINTS = 500 };

typedef struct sf_compression_test {
    char *path;            /* owned */
    double rate;           /* s-1, nominal, of loading and of unloading */
    int count;             /* points */
    int loading;           /* the first of them are loading, the rest unloading */
    double *strain;        /* [count] -, not falling while loading, not rising while unloading; owned */
    double *stress;        /* [count] Pa; owned */
    int *line;             /* [count] in the file; owned */
    double largest_strain; /* - */
    double largest_stress; /* Pa */
} sf_compression_test;

/* Reads and checks a test. SF_ERR_INPUT names file, line and value: negative strain or stress, strain of 1 or
 * more, strain that turns twice, stress that falls by more than a tenth while loading, unloading above
 * loading, too few points, too small a compression. On failure `*test` is zeroed. */
sf_status sf_compression_test_read(const char *path, double rate, sf_compression_test *test, sf_error *err);
void sf_compression_test_free(sf_compression_test *test);

#endif
