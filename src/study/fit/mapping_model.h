/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A problem of space mapping (space_mapping.h), and y_c, the model that it has of the simulation, with its
 * minimum. */
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
                         than ten times it, or in the second phase five in a row where a step of 0.1 expects
                         less than that. With a first_matrix a short step must lower it by less than twice the
                         tolerance, too */
    /* called after each simulation; may be NULL */
    void (*progress)(void *context, int iteration, const double *u, const double *y, double objective);
} sf_mapping_problem;

/* y_c(u) = s(u) + offset + matrix (u - anchor); borrows all. */
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
