/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/gas_curve.h"

#include <math.h>
#include <stdlib.h>

double sf_gas_curve_stress(const sf_gas_curve *curve, double strain) {
    double x = strain / (1 - strain), slope = fmax(curve->modulus - curve->pressure, 1e-3 * curve->modulus);
    return -curve->yield * expm1(-slope * strain / curve->yield) + curve->pressure * x +
           curve->factor * pow(x, curve->exponent);
}

/* Strains of the table: close together in the knee, and by equal ratios of x where the stress rises steeply.
 */
enum { KNEE = 20, MIDDLE = 25, END = 80, POINTS = KNEE + MIDDLE + END + 1 };
static const double MIDDLE_START = 0.1, END_START = 0.6, LAST = 0.975;

static double strain_of(int k) {
    if (k <= KNEE)
        return MIDDLE_START * k * k / (KNEE * KNEE);
    if (k <= KNEE + MIDDLE)
        return MIDDLE_START + (END_START - MIDDLE_START) * (k - KNEE) / MIDDLE;
    double first = END_START / (1 - END_START), last = LAST / (1 - LAST),
           x = first * pow(last / first, (double)(k - KNEE - MIDDLE) / END);
    return x / (1 + x);
}

sf_status sf_gas_curve_tabulate(const sf_gas_curve *curve, sf_foam_card *card, sf_error *err) {
    double *strain = sf_alloc(err, POINTS, sizeof *strain, "curve"),
           *stress = sf_alloc(err, POINTS, sizeof *stress, "curve"),
           *rate = sf_alloc(err, 1, sizeof *rate, "curve");
    int64_t *ptr = sf_alloc(err, 2, sizeof *ptr, "curve");
    if (err->status != SF_OK) {
        free(strain);
        free(stress);
        free(rate);
        free(ptr);
        return err->status;
    }
    for (int k = 0; k < POINTS; k++) {
        strain[k] = strain_of(k);
        stress[k] = sf_gas_curve_stress(curve, strain[k]);
    }
    ptr[1] = POINTS;
    free(card->curve_strain);
    free(card->curve_stress);
    free(card->curve_rate);
    free(card->curve_ptr);
    card->curve_strain = strain;
    card->curve_stress = stress;
    card->curve_rate = rate;
    card->curve_ptr = ptr;
    card->curve_count = 1;
    card->curve_points = POINTS;
    return SF_OK;
}
