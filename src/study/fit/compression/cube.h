/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fitted material in a simulated test: a foam cube between platens (softfall-pre, softfall-solve) against
 * the material point. A laboratory test of minutes is simulated faster by a factor k with everything that
 * depends on the rate scaled by k; the remaining inertia is small. */
#ifndef SF_FIT_COMPRESSION_CUBE_H
#define SF_FIT_COMPRESSION_CUBE_H

#include "study/fit/compression/table_fit.h"
#include <stdio.h>

enum { SF_CUBE_BLOCKS = 160 }; /* of a branch */

typedef struct sf_cube_options {
    const char
        *case_path; /* of a cube between platens (missile.motion, geometry.parameters.side); NULL: none */
    const char *friction; /* of the upper platen, in place of the case's; NULL: the case's */
    FILE *log;            /* progress */
} sf_cube_options;

/* One simulated test, as means over blocks of equal time. */
typedef struct sf_cube_test {
    double speed_up; /* k */
    int count;
    double strain[2 * SF_CUBE_BLOCKS]; /* - */
    double cube[2 * SF_CUBE_BLOCKS];   /* Pa, contact force over mean cross-section */
    double point[2 * SF_CUBE_BLOCKS];  /* Pa, material point at the same strains and the laboratory's rate */
    double percent[2];   /* largest difference, loading and unloading: % of the stress, counted as a
                            hundredth of the largest at least */
    double energy_error; /* of the simulation */
} sf_cube_test;

/* Simulates every test in folders of `folder` (which exists), with a line in options->log for each. `tests`
 * [config->test_count]. SF_ERR_INPUT if the specimen's side and thickness are not given and equal, as the
 * geometry is a cube. */
sf_status sf_compression_simulate(const sf_compression_fit *fit, const sf_foam_card *card,
                                  const sf_cube_options *options, const char *folder, sf_cube_test *tests,
                                  sf_error *err);

#endif
