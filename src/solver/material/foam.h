/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The foam law at material points (theory, section "Foam"): uncoupled principal nominal stresses from the
 * compression curve, hysteretic unloading, Maxwell branch, Kelvin and DAMP viscosity, rate-dependent loading
 * curves. Pure functions on batches of SF_LANES points; arrays are [component][lane]. Matrices are row-major
 * (9) or symmetric (xx, yy, zz, xy, yz, xz). */
#ifndef SF_SOLVER_MATERIAL_FOAM_H
#define SF_SOLVER_MATERIAL_FOAM_H

#include "core/curve.h"
#include "core/error.h"
#include "core/lanes.h"
#include "solver/material/law.h"
#include <math.h>

typedef struct sf_foam {
    double density;      /* kg m-3 */
    double modulus;      /* Pa, E */
    double hu, shape;    /* - */
    double damp;         /* - */
    double maxwell;      /* Pa, ED */
    double maxwell_rate; /* s-1, BETA1 */
    double kelvin;       /* Pa s, eta */
    double cutoff;       /* Pa */
    double filter_time;  /* s */
    int64_t curve_count;
    double *curve_rate; /* [curve_count] s-1, owned */
    sf_curve *curve;    /* [curve_count] owned */
} sf_foam;

/* The foam's entry in the table of laws (low_density_foam.c). */
extern const sf_law sf_low_density_foam;

/* A material of this card, which it borrows: not for sf_material_free. */
static inline sf_material sf_foam_material(const sf_foam_card *card) {
    return (sf_material){.law = &sf_low_density_foam, .card = (void *)(uintptr_t)card};
}

sf_status sf_foam_build(const sf_foam_card *card, sf_foam *foam, sf_error *err);
void sf_foam_free(sf_foam *foam);

/* Rows of sf_law_batch.history. */
enum {
    SF_FOAM_PEAK = 0,    /* J m-3, largest W so far */
    SF_FOAM_RATE = 1,    /* s-1, filtered rate of compression */
    SF_FOAM_MAXWELL = 2, /* [6] Pa, second Piola-Kirchhoff stress of the Maxwell branch */
};

/* Advances the batch over a step of dt (s); dt = 0 evaluates without viscous terms. */
void sf_foam_update(const sf_foam *foam, double dt, sf_law_batch *batch);

/* sf_law.uniaxial: the law of a point under uniaxial compression, without DAMP. */
double sf_foam_uniaxial(const sf_foam *foam, double dt, double strain, sf_uniaxial *point);

/* Factor on the stress of the loading curve where W is `ratio` of its largest (theory eq. 14). */
static inline double sf_foam_unloading(double hu, double shape, double ratio) {
    return 1 - (1 - hu) * (1 - (shape == 1 ? ratio : pow(ratio, shape)));
}

/* Stress (Pa, second Piola-Kirchhoff) of a Maxwell branch after a step of dt (s) at a constant rate of the
 * Green strain (s-1), from `held` before it: exact. */
static inline double sf_foam_maxwell(double modulus, double decay_rate, double dt, double green_rate,
                                     double held) {
    return exp(-decay_rate * dt) * held - modulus / decay_rate * expm1(-decay_rate * dt) * green_rate;
}

/* Rate overstress sigma(eps, rate) - sigma(eps, slowest curve) in Pa, interpolated over the logarithm of the
 * rate (s-1), with its derivatives by strain and rate. Needs two curves or more. */
double sf_foam_overstress(const sf_foam *foam, double strain, double rate, double *slope, double *rate_slope);

/* Eigenvalues of symmetric matrices by cyclic Jacobi: a [6][lane] in, its diagonal = eigenvalues out, v
 * [9][lane] eigenvectors as columns. */
void sf_foam_eigen(double a[6][SF_LANES], double v[9][SF_LANES]);

#endif
