/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bounds by direction on the tangent of the foam law at SF_LANES points (theory eq. 18): numbers a[i] of the
 * principal directions N_i with dF : dP <= sum over i of a[i] |dF N_i|^2 for every dF. The time step follows
 * the largest of them, the power iteration uses all three. */
#ifndef SF_SOLVER_MATERIAL_FOAM_TANGENT_H
#define SF_SOLVER_MATERIAL_FOAM_TANGENT_H

#include "base/lanes.h"

/* The elastic law in principal directions; borrowed. */
typedef struct sf_foam_principal {
    double (*stretch)[SF_LANES]; /* [3] - */
    double (*stress)[SF_LANES];  /* [3] Pa, nominal, of the loading curve */
    double (*slope)[SF_LANES];   /* [3] Pa, its derivative; at rest the larger of both sides */
    const double *factor;        /* -, of hysteresis */
    const double *softening;     /* m3 J-1, its derivative by W */
} sf_foam_principal;

/* Elastic part with the Maxwell branch's instantaneous `maxwell` (Pa) into a, Pa. */
void sf_foam_tangent_elastic(const sf_foam_principal *law, double maxwell, double a[3][SF_LANES]);

/* Kelvin viscosity `kelvin` and DAMP's `damp` (Pa s): the same bound on dP by a rate of F, into eta, Pa s. */
void sf_foam_tangent_viscous(double stretch[3][SF_LANES], double kelvin, const double damp[SF_LANES],
                             double eta[3][SF_LANES]);

#endif
