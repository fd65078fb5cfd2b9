/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameter identification with an expensive simulation and a cheap surrogate (output space mapping; Bandler
 * et al. 2004, doi:10.1109/TMTT.2003.820904). At each iterate u_k the surrogate s is corrected so that it
 * agrees with the simulation y there, and its derivatives by a matrix M, a regression of y - s over all
 * simulated points:
 *
 *     y_c(u) = s(u) + [y(u_k) - s(u_k)] + M (u - u_k),
 *
 * and the next iterate minimises   sum ((y_c - measured) / sd)^2 + sum ((u - prior) / prior_sd)^2   (GSL's
 * Levenberg-Marquardt) within a trust region: the best point is kept, and the radius follows the ratio of
 * what the objective lost to what y_c expected. Everything is in the caller's scaled variables: logarithms of
 * parameters and of responses.
 *
 * Where these steps lower nothing any more, or end at a misfit that contradicts the standard deviations, a
 * second phase begins without the surrogate: one simulation along each parameter, then steps by
 *
 *     y_c(u) = y(u_k) + M (u - u_k),   M a regression of y over all simulated points.
 *
 * A problem that begins with another's M is not checked in this way at its end. */
#pragma once
#include "study/fit/mapping_model.h"

typedef struct sf_mapping_result {
    double u[SF_MAPPING_MAX_PARAMETERS]; /* best simulated point */
    double *y;                           /* [responses] of the simulation there; owned */
    double *corrected;                   /* [responses][parameters] Jacobian of y_c there; owned */
    double *offset;                      /* [responses] y - s there; owned */
    double *matrix;                      /* [responses][parameters] M; owned */
    bool linear; /* it ended in the second phase: `corrected` is all that is known beside the best point */
    double covariance[SF_MAPPING_MAX_PARAMETERS][SF_MAPPING_MAX_PARAMETERS];
    double misfit;    /* sum over the data of ((y - measured) / sd)^2 */
    double objective; /* misfit and prior */
    double freedom;   /* number of data less the effective number of parameters that they determine */
    double scale;     /* factor on the data's standard deviations in `covariance`: sqrt(misfit / freedom) if
                         chi-squared contradicts them (5 %), else 1 */
    double gain;      /* by which y_c says that the objective could still fall */
    int iterations;
    bool converged;
    const char *reason; /* for which it has not converged; static storage; NULL: it has */
} sf_mapping_result;

/* Finds the minimum. Release with sf_mapping_free, also on failure. */
sf_status sf_mapping_solve(const sf_mapping_problem *problem, sf_mapping_result *result, sf_error *err);
void sf_mapping_free(sf_mapping_result *result);

/* Minimises once more with the corrected surrogate of `result` and other standard deviations `sd` (INFINITY
 * leaves a datum out); `u` [parameters] and `y` [responses] get the minimum and y_c there. */
sf_status sf_mapping_refit(const sf_mapping_problem *problem, const sf_mapping_result *result,
                           const double *sd, double *u, double *y, sf_error *err);
