/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normal data with a discrepancy of unknown size: the residual r of `data` values is
 *
 *     r = J delta + e,   delta ~ N(0, tau^2 K),   e ~ N(0, D),
 *
 * J the data's derivatives by a function at `bins` places, from which the truth differs by delta. One
 * generalised eigenproblem is solved beforehand: each tau then costs a product of a matrix and a vector. */
#ifndef SF_FIT_POSTERIOR_DISCREPANCY_H
#define SF_FIT_POSTERIOR_DISCREPANCY_H

#include "core/error.h"
#include <gsl/gsl_rng.h>

typedef struct sf_discrepancy {
    int data, bins;
    double *jacobian;       /* [data][bins] J */
    double *kernel;         /* [bins][bins] K */
    double *kernel_root;    /* [bins][bins] a root of K */
    double *base_root;      /* [data][data] Cholesky factor of D */
    double *whiten;         /* [data][data] W: W D W^T = 1 and W J K J^T W^T = diag(value) */
    double *value;          /* [data] */
    double log_determinant; /* of D */
} sf_discrepancy;

/* K of a Gaussian process with squared exponential correlation: places [bins], correlation length in their
 * unit. */
void sf_kernel_fill(int bins, const double *place, double length, double *kernel);

/* Copies J [data][bins], K [bins][bins] and D [data][data]. `data` may be 0. Release with
 * sf_discrepancy_free, also on failure. Errors: D is not positive definite. */
sf_status sf_discrepancy_build(int data, int bins, const double *jacobian, const double *kernel,
                               const double *base, sf_discrepancy *discrepancy, sf_error *err);
void sf_discrepancy_free(sf_discrepancy *discrepancy);

/* Log density of residuals [data] for a given tau. */
double sf_discrepancy_log_density(const sf_discrepancy *discrepancy, const double *residual, double tau);
/* delta [bins] drawn from its distribution given the residuals and tau; `scratch` [2 data]. */
void sf_discrepancy_draw(const sf_discrepancy *discrepancy, const double *residual, double tau,
                         gsl_rng *random, double *scratch, double *delta);

/* tau = `scale` times the half-normal variable that the normal variable z stands for; 0.6745 `scale` at z =
 * 0. So a prior that is half-normal in tau is normal in z. */
double sf_half_normal(double z, double scale);

#endif
