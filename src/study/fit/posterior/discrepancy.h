/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normal data with two discrepancies of unknown size: the residual r of `data` values is
 *
 *     r = J delta + G x + e,   delta ~ N(0, tau^2 K),   x ~ N(0, kappa^2),   e ~ N(0, D),
 *
 * J the data's derivatives by a function at `bins` places, from which the truth differs by delta; G those by
 * `effects` independent errors x. Both are integrated in closed form: with their `latent` standard variables
 * z and the whitened derivatives H, one evaluation factorises 1 + S H^T H S, S the sizes, or 1 + H S S H^T
 * where the data are fewer than the variables. */
#pragma once
#include "base/error.h"
#include <gsl/gsl_rng.h>

enum { SF_DISCREPANCY_MOST = 160 }; /* bins and effects together */

typedef struct sf_discrepancy {
    int data, bins, effects, latent; /* latent = bins + effects */
    double *root;                    /* [bins][bins] R, K = R R^T */
    double *base_root;               /* [data][data] Cholesky factor L of D */
    double *white;                   /* [data][latent] H = L^-1 (J R, G) */
    double *gram;                    /* [latent][latent] H^T H */
    double *spread[2];      /* [data][data] H H^T of delta and of x; NULL: more data than variables */
    double log_determinant; /* of D */
} sf_discrepancy;

typedef struct sf_discrepancy_size {
    double tau, kappa;
} sf_discrepancy_size;

/* K of a Gaussian process with squared exponential correlation: places [bins], correlation length in their
 * unit. */
void sf_kernel_fill(int bins, const double *place, double length, double *kernel);

/* J [data][bins], K [bins][bins], G [data][effects], D [data][data]; all are copied. `data` may be 0. Release
 * with sf_discrepancy_free, also on failure. Errors: D is not positive definite, too many effects. */
sf_status sf_discrepancy_build(int data, int bins, const double *jacobian, const double *kernel, int effects,
                               const double *effect, const double *base, sf_discrepancy *discrepancy,
                               sf_error *err);
void sf_discrepancy_free(sf_discrepancy *discrepancy);

/* Log density of residuals [data]. */
double sf_discrepancy_log_density(const sf_discrepancy *discrepancy, const double *residual,
                                  sf_discrepancy_size size);
/* delta [bins] and x [effects] drawn from their distribution given the residuals and the sizes. */
void sf_discrepancy_draw(const sf_discrepancy *discrepancy, const double *residual, sf_discrepancy_size size,
                         gsl_rng *random, double *delta, double *x);

/* tau = `scale` times the half-normal variable that the normal variable z stands for; 0.6745 `scale` at z =
 * 0. So a prior that is half-normal in tau is normal in z. */
double sf_half_normal(double z, double scale);
