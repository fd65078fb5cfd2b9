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
#include "base/error.h"

enum { SF_MAPPING_MAX_PARAMETERS = 47 };

typedef struct sf_mapping_problem {
    int parameters, responses;
    const double *start;      /* [parameters] */
    const double *prior;      /* [parameters] mean */
    const double *prior_sd;   /* [parameters] > 0 */
    const double *low, *high; /* [parameters] bounds that no point exceeds; INFINITY: none of that parameter;
                                 NULL: none at all */
    const double *measured;   /* [responses] */
    const double *sd;         /* [responses] > 0; INFINITY: predicted only, no datum */
    const double *bound_sd; /* [responses] INFINITY: none; else no datum: what exceeds `measured` counts over
                               it. NULL: none */
    /* [responses] y - s of a similar problem: the first simulation is then at the minimum of s with it; NULL:
     * at the start */
    const double *first_offset;
    /* The end of an earlier mapping with the same parameters and responses: [parameters] the point at
     * which first_offset is its y - s (NULL: the start), and [responses][parameters] its M, with which
     * this one begins (NULL: 0) */
    const double *first_point, *first_matrix;
    bool first_linear; /* that mapping ended without the surrogate: first_offset is its y, first_matrix its
                          Jacobian, and this one has no surrogate either */
    sf_status (*surrogate)(void *context, const double *u, double *y, sf_error *err);
    sf_status (*simulate)(void *context, const double *u, double *y, sf_error *err);
    void *context;
    int max_iterations; /* simulations at most */
    bool wide; /* first the lowest minimum of y_c from a design over the prior, not only from the start */
    double tolerance; /* in standard deviations. Converged: the free next step is below it in every parameter,
                         or would lower the objective by less than its square, or two steps in a row, taken or
                         not, lowered it by less than twice the tolerance where the free step expects less
                         than ten times it, or in the second phase five in a row and a longer one where a step
                         of 0.1 expects less than that. With a first_matrix a short step must lower it by less
                         than twice the tolerance, too */
    /* called after each simulation; may be NULL */
    void (*progress)(void *context, int iteration, const double *u, const double *y, double objective);
} sf_mapping_problem;

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
                         chi-squared contradicts them (5 %), else 1; at least one degree of freedom */
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

/* The model that the search has of the simulation, and its minimum (mapping_model.c).
 *
 * y_c(u) = s(u) + offset + matrix (u - anchor); borrows all. */
typedef struct sf_mapping_model {
    const sf_mapping_problem *problem;
    bool linear;          /* the second phase: s = 0 */
    const double *anchor; /* [parameters] simulated point */
    const double *offset; /* [responses] y - s there */
    const double *matrix; /* [responses][parameters] M */
} sf_mapping_model;

/* y_c [responses] at `u` [parameters]. */
sf_status sf_mapping_evaluate(const sf_mapping_model *model, const double *u, double *y, sf_error *err);

/* Jacobian [responses][parameters] of y_c at the anchor, by central differences. */
sf_status sf_mapping_differentiate(const sf_mapping_model *model, double *jacobian, sf_error *err);

/* Minimises y_c's objective with the standard deviations `sd` [responses] from `u` [parameters], which gets
 * the minimum within the bounds. `hold` is the standard deviation about `about` [parameters] that holds the
 * step back; INFINITY: free. */
sf_status sf_mapping_minimise(const sf_mapping_model *model, const double *sd, const double *about,
                              double hold, double *u, sf_error *err);

/* Residual of a response `y[i]`: of a datum, or of what exceeds a bound. */
double sf_mapping_residual(const sf_mapping_problem *problem, const double *sd, const double *y, int i);

/* The value of parameter `j` within its bounds. */
double sf_mapping_inside(const sf_mapping_problem *problem, int j, double u);
