/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "material/foam_point.h"

/* Compressible hyperfoam of Ogden and Storakers (theory, section "Hyperfoam"), of 1 to 6 terms:
 *     W = sum 2 mu/alpha^2 [l1^alpha + l2^alpha + l3^alpha - 3 + (J^(-alpha beta) - 1)/beta]
 * with the hysteresis and viscosity of the foam laws (foam_point.h). Pure functions. */

enum { SF_HYPERFOAM_TERMS = 6 };

/* A term has either nu or beta; the other one is 0. mu = 0: the term is absent. */
typedef struct sf_hyperfoam_term {
    double mu;    /* Pa */
    double alpha; /* - */
    double nu;    /* -, beta = nu / (1 - 2 nu) */
    double beta;  /* - */
} sf_hyperfoam_term;

typedef struct sf_hyperfoam_card {
    sf_foam_shared shared;
    double stable_to; /* -, strain up to which the terms must be stable */
    sf_hyperfoam_term term[SF_HYPERFOAM_TERMS];
} sf_hyperfoam_card;
_Static_assert(offsetof(sf_hyperfoam_card, shared) == 0, "a foam's card begins with sf_foam_shared");

typedef struct sf_hyperfoam {
    sf_foam_options options;
    double rest; /* Pa, modulus of confined compression at rest */
    int count;
    double mu[SF_HYPERFOAM_TERMS], alpha[SF_HYPERFOAM_TERMS], beta[SF_HYPERFOAM_TERMS];
} sf_hyperfoam;
_Static_assert(offsetof(sf_hyperfoam, options) == 0, "a foam's numbers begin with sf_foam_options");

/* The law's entry in the table. */
extern const sf_law sf_hyperfoam_law;

/* A material of this card, which it borrows: not for sf_material_free. */
static inline sf_material sf_hyperfoam_material(const sf_hyperfoam_card *card) {
    return (sf_material){.law = &sf_hyperfoam_law, .card = (void *)(uintptr_t)card};
}

sf_hyperfoam sf_hyperfoam_build(const sf_hyperfoam_card *card);

/* Loading at one point: W (J m-3), nominal principal stresses and their derivatives by the stretches (Pa). */
typedef struct sf_hyperfoam_point {
    double energy, t[3], slope[3][3];
} sf_hyperfoam_point;
sf_hyperfoam_point sf_hyperfoam_evaluate(const sf_hyperfoam *foam, const double stretch[3]);

/* The stretch of the directions that are free, where their stress vanishes: directions 0 .. held - 1 have
 * stretch[0 .. held - 1] (held 1 or 2), the others a common one, found from stretch[held] on by Newton's
 * method. False if there is none. */
bool sf_hyperfoam_release(const sf_hyperfoam *foam, int held, double stretch[3]);

/* The place at which the terms cease to be stable. */
typedef struct sf_hyperfoam_failure {
    const char *path; /* "uniaxial compression" ... ; static storage */
    double strain;    /* - */
    int term;         /* that takes most away, from 0 */
} sf_hyperfoam_failure;
/* Drucker's condition, d(tau) : d(ln stretch) > 0 for every change, along uniaxial, equibiaxial, confined and
 * volumetric compression and tension and in shear, up to a strain of `limit`. False: stable. */
bool sf_hyperfoam_fails(const sf_hyperfoam *foam, double limit, sf_hyperfoam_failure *out);

/* Advances the batch over a step of dt (s); dt = 0 evaluates without viscous terms. */
void sf_hyperfoam_update(const void *foam, double dt, sf_law_batch *batch);
