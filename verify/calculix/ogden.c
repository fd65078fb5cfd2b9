/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "calculix/ogden.h"

#include <math.h>

sf_ogden sf_ogden_foam(void) {
    return (sf_ogden){.mu = {11.2e3, 90.6e3}, .alpha = {-2, 3.25}};
}

double sf_ogden_stress(const sf_ogden *law, double stretch) {
    double stress = 0;
    for (int k = 0; k < SF_OGDEN_TERMS; k++)
        stress += 2 * law->mu[k] / law->alpha[k] * (pow(stretch, law->alpha[k] - 1) - 1 / stretch);
    return stress;
}

double sf_ogden_modulus(const sf_ogden *law) {
    double modulus = 0;
    for (int k = 0; k < SF_OGDEN_TERMS; k++)
        modulus += 2 * law->mu[k];
    return modulus;
}

void sf_ogden_table(const sf_ogden *law, FILE *file) {
    fprintf(file, "strain,stress_Pa\n0,0\n");
    for (int k = 1; k <= 950; k++)
        fprintf(file, "%.3f,%.12g\n", 1e-3 * k, -sf_ogden_stress(law, 1 - 1e-3 * k));
}
