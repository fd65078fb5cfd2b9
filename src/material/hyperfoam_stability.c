/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drucker's condition: the derivatives of the Kirchhoff stresses by the logarithms of the stretches,
 *     D = sum over the terms of 2 mu (diag(l^alpha) + beta J^(-alpha beta) 1 1^T),
 * are positive definite. */
#include "material/hyperfoam.h"

#include <string.h>

enum { STEPS = 200 };

/* A family of deformations with one parameter, the strain. */
typedef struct path {
    const char *name;
    int held;   /* directions with a given stretch; the others are free of stress */
    int axes;   /* of them, how many change */
    bool pulls; /* tension */
} path;
static const path paths[] = {
    {"uniaxial compression", 1, 1, false},   {"uniaxial tension", 1, 1, true},
    {"biaxial compression", 2, 2, false},    {"biaxial tension", 2, 2, true},
    {"confined compression", 3, 1, false},   {"confined tension", 3, 1, true},
    {"volumetric compression", 3, 3, false}, {"volumetric tension", 3, 3, true},
};

/* Contribution of term k to the form v . D v. */
static double share(const sf_hyperfoam *foam, int k, const double stretch[3], const double v[3]) {
    double sum = 0, along = 0, volume = log(stretch[0]) + log(stretch[1]) + log(stretch[2]);
    for (int i = 0; i < 3; i++) {
        sum += v[i];
        along += pow(stretch[i], foam->alpha[k]) * v[i] * v[i];
    }
    return 2 * foam->mu[k] *
           (along + foam->beta[k] * exp(-foam->alpha[k] * foam->beta[k] * volume) * sum * sum);
}

/* D = diag(d) + b 1 1^T. */
static double parts(const sf_hyperfoam *foam, const double stretch[3], double d[3]) {
    double b = 0, volume = log(stretch[0]) + log(stretch[1]) + log(stretch[2]);
    for (int i = 0; i < 3; i++) {
        d[i] = 0;
        for (int k = 0; k < foam->count; k++)
            d[i] += 2 * foam->mu[k] * pow(stretch[i], foam->alpha[k]);
    }
    for (int k = 0; k < foam->count; k++)
        b += 2 * foam->mu[k] * foam->beta[k] * exp(-foam->alpha[k] * foam->beta[k] * volume);
    return b;
}

/* Is it positive definite? With two d[i] at or below 0 it is not, whatever b: a change of the two against
 * each other shows it. Otherwise the sign of its determinant decides, and 1/d[i] is the change of least work.
 */
static bool positive(double b, const double d[3], double v[3]) {
    int below[3], count = 0;
    double sum = 1;
    for (int i = 0; i < 3; i++) {
        v[i] = 0;
        if (!(d[i] > 0))
            below[count++] = i;
    }
    if (count >= 2) {
        v[below[0]] = 1;
        v[below[1]] = -1;
        return false;
    }
    for (int i = 0; i < 3; i++) {
        v[i] = d[i] != 0 ? 1 / d[i] : 1e100;
        sum += b * v[i];
    }
    return count == 0 ? sum > 0 : b > 0 && sum < 0;
}

/* Is the law stable there? Otherwise the term that takes most from the work of the critical change. */
static bool stable(const sf_hyperfoam *foam, const double stretch[3], int *term) {
    double d[3], along[3], b = parts(foam, stretch, d);
    if (positive(b, d, along))
        return true;
    *term = 0;
    for (int k = 1; k < foam->count; k++)
        if (share(foam, k, stretch, along) < share(foam, *term, stretch, along))
            *term = k;
    return false;
}

static bool path_fails(const sf_hyperfoam *foam, const path *p, double limit, sf_hyperfoam_failure *out) {
    double stretch[3] = {1, 1, 1};
    for (int k = 0; k <= STEPS; k++) {
        double strain = limit * k / STEPS;
        for (int i = 0; i < p->axes; i++)
            stretch[i] = p->pulls ? 1 + strain : 1 - strain;
        bool found = p->held == 3 || sf_hyperfoam_release(foam, p->held, stretch);
        out->term = 0;
        if (stable(foam, stretch, &out->term) && found)
            continue;
        out->path = p->name;
        out->strain = strain;
        return true;
    }
    return false;
}

/* At constant volume: one direction compressed, one stretched. */
static bool shear_fails(const sf_hyperfoam *foam, double limit, sf_hyperfoam_failure *out) {
    for (int k = 0; k <= STEPS; k++) {
        double strain = limit * k / STEPS;
        const double stretch[3] = {1 - strain, 1 / (1 - strain), 1};
        if (stable(foam, stretch, &out->term))
            continue;
        out->path = "shear";
        out->strain = strain;
        return true;
    }
    return false;
}

bool sf_hyperfoam_fails(const sf_hyperfoam *foam, double limit, sf_hyperfoam_failure *out) {
    for (size_t k = 0; k < sizeof paths / sizeof *paths; k++)
        if (path_fails(foam, &paths[k], limit, out))
            return true;
    return shear_fails(foam, limit, out);
}
