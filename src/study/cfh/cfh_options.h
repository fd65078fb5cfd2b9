/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command line of softfall-cfh. */
#ifndef SF_CFH_OPTIONS_H
#define SF_CFH_OPTIONS_H

#include "study/runner.h"
#include "study/cfh/search.h"

/* Texts are borrowed from argv. Heights as given: of free fall, or on the rig. */
typedef struct sf_cfh_options {
    const char *case_path;
    const char *directory;
    const char *material;  /* NULL: the case's own */
    const char *rig_path;  /* NULL: free fall */
    const char *posterior; /* folder of draws, NULL: none */
    int checks;            /* draws to simulate */
    bool force;
    sf_runner_engine engine;
    int threads;
    int jobs;           /* drops that run side by side, 0: as many as threads */
    int override_count; /* at most SF_RUNNER_OVERRIDES - 1: one is used for the speed */
    const char *overrides[SF_RUNNER_OVERRIDES];
    double limit[SF_CFH_CRITERIA]; /* g, - */
    double height;                 /* m, 0: not given */
    double max_height;             /* m */
    int list_count;
    double list[SF_CFH_MAX_POINTS]; /* m, ascending */
} sf_cfh_options;

/* Exits by argp for --help, --version and unknown options. SF_ERR_INPUT: a value out of bounds or
 * malformed. */
sf_status sf_cfh_options_parse(int argc, char **argv, sf_cfh_options *options, sf_error *err);

#endif
