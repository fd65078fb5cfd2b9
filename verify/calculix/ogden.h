/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The law that both codes can hold: Ogden-Hill foam (*HYPERFOAM). With nu = 0 it is separable in the
 * principal stretches, T(lambda) = sum 2 mu/alpha (lambda^(alpha - 1) - 1/lambda)          nominal stress, Pa
 * Its two terms were fitted to verify/materials/eva_like.csv between 10 and 85 % strain under the condition
 * that tension stays near the straight line that softfall has there; the knee below 10 % is given up for
 * that. */
#ifndef SF_VERIFY_OGDEN_H
#define SF_VERIFY_OGDEN_H

#include <stdio.h>

enum { SF_OGDEN_TERMS = 2 };

typedef struct sf_ogden {
    double mu[SF_OGDEN_TERMS];    /* Pa */
    double alpha[SF_OGDEN_TERMS]; /* - */
    double nu[SF_OGDEN_TERMS];    /* -; the functions below take 0 */
} sf_ogden;

/* The law of the study. */
sf_ogden sf_ogden_foam(void);

/* Nominal stress (Pa) at the stretch. */
double sf_ogden_stress(const sf_ogden *law, double stretch);

/* Modulus at the undeformed state (Pa), 2 sum mu. */
double sf_ogden_modulus(const sf_ogden *law);

/* The compression curve as a table for softfall-pre, strain 0 to 0.95. */
void sf_ogden_table(const sf_ogden *law, FILE *file);

#endif
