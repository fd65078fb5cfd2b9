/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compression tests, and the fit of a free curve to them (libsoftfall-build). */
#pragma once
#include "softfall/status.h"

/* The facts about a compression test that its file does not state; zeros and NULL: none. */
typedef struct softfall_compression_source {
    const char *path;
    double rate, area,
        thickness;           /* 1/s; m2 and m, of a specimen whose force and displacement are in the file */
    int correct_toe, invert; /* 1: correct the toe; the sign of 1: strain, 2: stress, 3: both */
    double contact_force;    /* N, at which displacement is zero */
    const char *cycle;       /* number of the cycle that is taken; NULL: the first */
} softfall_compression_source;

/* A test as the fits take it: loading, then perhaps unloading; the arrays are its own. */
typedef struct softfall_compression_test {
    int64_t count, loading;        /* points, of which the first are loading */
    const double *strain, *stress; /* [count] -, Pa */
    double largest_strain, largest_stress;
    int cycles, dwell;          /* in the file; points of rests under strain that were left out */
    const char *interpretation; /* how the file was read */
} softfall_compression_test;
SOFTFALL_API softfall_status softfall_compression_read(const softfall_compression_source *source,
                                                       softfall_compression_test **out,
                                                       softfall_error *error);
SOFTFALL_API void softfall_compression_free(softfall_compression_test *test);

/* Fits a free curve, its rate dependence and its unloading to the tests that a file names
 * (docs/identification.md), and writes material.cfg with its curves, fit.json, fit.csv and loading_curve.csv
 * into the folder; `replace` 0: SOFTFALL_INPUT if one of them is there. */
SOFTFALL_API softfall_status softfall_fit_compression(const char *path, const char *folder, int replace,
                                                      softfall_error *error);
