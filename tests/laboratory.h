/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A synthetic laboratory for identification from drops: its foams are of none of the forms of fit/form, and
 * its simulation is a set of stiffer and thinner columns than the surrogate. Three drops of each foam are
 * measured with noise; two are held out, of another thickness and of another speed. */
#ifndef SF_TESTS_LABORATORY_H
#define SF_TESTS_LABORATORY_H

#include "study/fit/drop/inference.h"
#include "point_fixture.h"
#include <gsl/gsl_rng.h>

enum { LAB_MODELS = 3, LAB_MEASURED = 3, LAB_DROPS = 5, LAB_KINDS = 3 };

typedef struct laboratory {
    bool locks; /* SF_LOCK is set: foams lock up at a strain of their own, and every model has it as an
                   unknown */
    point_card start;
    sf_fit_input input[LAB_MODELS]; /* one for each model, of the same drops */
    sf_columns surrogate[LAB_DROPS], real[LAB_DROPS];
    double truth[LAB_DROPS][LAB_KINDS]; /* logarithms, without noise */
} laboratory;

void laboratory_init(laboratory *lab);
/* Draws a foam and measures its drops. Draws again where a foam cannot be computed. */
void laboratory_measure(laboratory *lab, gsl_rng *random);

/* What a fit computes at the unknowns `u` of its drops 0 to `last` - 1 with other columns [count]. */
sf_status laboratory_respond(const sf_drop_fit *fit, const sf_columns *columns, int count, int last,
                             const double *u, double *y, sf_error *err);

/* Of the held-out drops: is the truth between the quantiles low and high of the average? */
typedef struct laboratory_tally {
    int foams, failed, reached;
    int inside[LAB_DROPS][LAB_KINDS];
    int open[LAB_DROPS][LAB_KINDS];        /* intervals without an upper end */
    double width[LAB_DROPS][LAB_KINDS];    /* sum of ln(high / low) of the others */
    double miss[LAB_DROPS][LAB_KINDS];     /* sum of |ln(median / truth)| */
    double bias[LAB_DROPS][LAB_KINDS];     /* sum of ln(median / truth) */
    double weight[LAB_MODELS];             /* sum */
    int best_inside[LAB_DROPS][LAB_KINDS]; /* the same with the model of the largest weight alone */
} laboratory_tally;

/* Identifies by every model, averages, and adds to the tally. */
void laboratory_identify(laboratory *lab, const sf_inference_options *options, laboratory_tally *tally);

#endif
