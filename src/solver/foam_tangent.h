/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bounds by direction on the tangent of the foam law at one point (theory eq. 18): numbers a[i] of the
 * principal directions N_i with dF : dP <= sum over i of a[i] |dF N_i|^2 for every dF. The time step follows
 * the largest of them, the power iteration uses all three. */
#ifndef SF_SOLVER_FOAM_TANGENT_H
#define SF_SOLVER_FOAM_TANGENT_H

/* The elastic law at one point, in principal directions. */
typedef struct sf_foam_principal {
    double stretch[3]; /* - */
    double stress[3];  /* Pa, nominal, of the loading curve */
    double slope[3];   /* Pa, its derivative; at rest the larger of both sides */
    double factor;     /* -, of hysteresis */
    double softening;  /* m3 J-1, its derivative by W */
} sf_foam_principal;

/* Elastic part with the Maxwell branch's instantaneous `maxwell` (Pa) into a [3], Pa. */
void sf_foam_tangent_elastic(const sf_foam_principal *law, double maxwell, double a[3]);

/* Kelvin viscosity `kelvin` and DAMP's `damp` (Pa s): the same bound on dP by a rate of F, into eta [3], Pa
 * s. */
void sf_foam_tangent_viscous(const double stretch[3], double kelvin, double damp, double eta[3]);

#endif
