/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The points of all tests in one list, with the scatter of each: the input of the joint fit. */
#ifndef SF_FIT_COMPRESSION_DATA_H
#define SF_FIT_COMPRESSION_DATA_H

#include "study/fit/compression/compression_config.h"
#include "study/fit/bspline.h"
#include <stdbool.h>

typedef struct sf_compression_data {
    const sf_compression_config *config; /* borrowed */
    int count;
    int *test;       /* [count] index into config->test; points of a branch stand together, in order; owned */
    bool *unloading; /* [count] owned */
    double *strain;  /* [count] -, not below 0; owned */
    double *stress;  /* [count] Pa; owned */
    double *smooth;  /* [count] Pa, by the smoothing spline of the branch; owned */
    double *sigma;   /* [count] Pa, standard deviation of the stress; owned */
    sf_scatter scatter;
    int intervals; /* of the loading curves' splines up to the start, before joining */
    double start;  /* -, strain from which densification is fitted */
    double end;    /* -, largest strain of all tests */
} sf_compression_data;

sf_status sf_compression_data_init(const sf_compression_config *config, sf_compression_data *data,
                                   sf_error *err);
void sf_compression_data_free(sf_compression_data *data);

/* First point and number of points of a branch of a test. */
void sf_compression_branch(const sf_compression_data *data, int test, bool unloading, int *first, int *count);

#endif
