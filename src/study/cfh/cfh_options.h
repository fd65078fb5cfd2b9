/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The options of softfall-cfh beside those of every study. */
#ifndef SF_CFH_OPTIONS_H
#define SF_CFH_OPTIONS_H

#include "study/cfh/search.h"
#include "study/drop.h"
#include <argp.h>

/* Texts are borrowed from argv. Heights as given: of free fall, or on the rig. */
typedef struct sf_cfh_options {
    const char *material;  /* NULL: the case's own */
    const char *rig_path;  /* NULL: free fall */
    const char *posterior; /* folder of draws, NULL: none */
    int checks;            /* draws to simulate */
    int override_count;    /* at most SF_RUNNER_OVERRIDES - 1: one is used for the speed */
    const char *overrides[SF_RUNNER_OVERRIDES];
    double limit[SF_CFH_CRITERIA]; /* g, - */
    double height;                 /* m, 0: not given */
    double max_height;             /* m */
    int list_count;
    double list[SF_CFH_MAX_POINTS]; /* m, ascending */

    const char *texts[4]; /* of heights and checks, until sf_cfh_options_finish reads them */
} sf_cfh_options;

/* The table for --help; ends with {0}. */
extern const struct argp_option sf_cfh_option_list[];

/* The defaults. */
sf_cfh_options sf_cfh_options_begin(void);
/* Takes an option of the table. SF_ERR_INPUT: a value out of bounds or malformed. */
void sf_cfh_options_take(sf_cfh_options *options, int key, const char *text, sf_error *err);
/* Reads what depends on other options or on units. SF_ERR_INPUT as before, or options that contradict each
 * other. */
sf_status sf_cfh_options_finish(sf_cfh_options *options, sf_error *err);

#endif
