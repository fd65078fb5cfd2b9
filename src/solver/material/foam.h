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
#include "core/model.h"

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

sf_status sf_foam_build(const sf_foam_card *card, sf_foam *foam, sf_error *err);
void sf_foam_free(sf_foam *foam);

typedef struct sf_foam_batch {
    /* in */
    double f[9][SF_LANES];     /* deformation gradient at the end of the step */
    double f_old[9][SF_LANES]; /* at its start */
    double length[SF_LANES];   /* m, L of DAMP */
    bool directions;           /* fill `directional`? Only the power iteration needs it */
    /* history, in and out */
    double maxwell[6][SF_LANES]; /* Pa, second Piola-Kirchhoff stress of the Maxwell branch */
    double peak[SF_LANES];       /* J m-3, largest W so far */
    double rate[SF_LANES];       /* s-1, filtered rate of compression */
    /* out */
    double p[9][SF_LANES];       /* Pa, first Piola-Kirchhoff stress */
    double stretch[3][SF_LANES]; /* -, principal stretches, unsorted */
    double jacobian[SF_LANES];   /* - */
    double energy[SF_LANES];     /* J m-3, W of the loading curve */
    double factor[SF_LANES];     /* -, hysteresis factor */
    double stiffness[SF_LANES];  /* Pa, largest slope of the loading curve in the principal directions, at
                                    least E and  its first slope: directions across the load are at rest, on
                                    either side by rounding */
    double direction_tangent[3][SF_LANES];   /* Pa, bounds on the tangent dP/dF by principal direction
                                                (foam_tangent.h) */
    double direction_viscosity[3][SF_LANES]; /* Pa s, the same on dP/d(rate of F) */
    double tangent[SF_LANES];                /* Pa, the largest of them: bound on the tangent */
    double viscosity[SF_LANES];              /* Pa s */
    double directional[6][SF_LANES];         /* Pa, A with dF : dP <= trace(dF A dF^T), of a + 2 eta / dt, if
                                                `directions` */
    double work[SF_LANES];                   /* J m-3, viscous work of the step */
    double stored[SF_LANES], lost[SF_LANES]; /* J m-3, recoverable energy; energy lost to hysteresis */
} sf_foam_batch;

/* Advances the batch over a step of dt (s); dt = 0 evaluates without viscous terms. */
void sf_foam_update(const sf_foam *foam, double dt, sf_foam_batch *batch);

/* Rate overstress sigma(eps, rate) - sigma(eps, slowest curve) in Pa, interpolated over the logarithm of the
 * rate (s-1), with its derivatives by strain and rate. Needs two curves or more. */
double sf_foam_overstress(const sf_foam *foam, double strain, double rate, double *slope, double *rate_slope);

/* Eigenvalues of symmetric matrices by cyclic Jacobi: a [6][lane] in, its diagonal = eigenvalues out, v
 * [9][lane] eigenvectors as columns. */
void sf_foam_eigen(double a[6][SF_LANES], double v[9][SF_LANES]);

#endif
