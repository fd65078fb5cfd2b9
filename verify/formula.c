/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "formula.h"

#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdlib.h>

static const double DATA_END = 0.8; /* strain to which the table goes */
static const double DATA_STEP = 0.001;

static double formula(double strain) {
    double x = strain / (1 - strain);
    return 7.4e3 * -expm1(-56 * strain) + 134e3 * x + 23.3e3 * pow(x, 2.8);
}

static double slope(double strain) {
    double x = strain / (1 - strain);
    return 7.4e3 * 56 * exp(-56 * strain) +
           (134e3 + 2.8 * 23.3e3 * pow(x, 1.8)) / ((1 - strain) * (1 - strain));
}

static double exponent(void) {
    return (1 - DATA_END) * slope(DATA_END) / formula(DATA_END);
}

double sf_formula_stress(double strain) {
    return strain <= DATA_END ? formula(strain)
                              : formula(DATA_END) * pow((1 - DATA_END) / (1 - strain), exponent());
}

double sf_formula_slope(double strain) {
    return strain <= DATA_END ? slope(strain) : exponent() * sf_formula_stress(strain) / (1 - strain);
}

static double integrand(double strain, void *unused) {
    (void)unused;
    return sf_formula_stress(strain);
}

double sf_formula_energy(double strain) {
    enum { PIECES = 8 }; /* short enough for the rule's 87 points */
    gsl_function f = {integrand, NULL};
    const double ends[3] = {0, fmin(strain, DATA_END), strain};
    double sum = 0;
    for (int k = 0; k < 2; k++) {
        double width = (ends[k + 1] - ends[k]) / PIECES;
        for (int piece = 0; piece < PIECES && width > 0; piece++) {
            double part, error, from = ends[k] + piece * width;
            size_t calls;
            gsl_integration_qng(&f, from, from + width, 0, 1e-10, &part, &error, &calls);
            sum += part;
        }
    }
    return sum;
}

void sf_formula_table(sf_foam_card *card, int curves, const double *rate, const double *factor) {
    int64_t points = (int64_t)lround(DATA_END / DATA_STEP) + 1;
    free(card->curves.curve_rate);
    free(card->curves.curve_ptr);
    free(card->curves.curve_strain);
    free(card->curves.curve_stress);
    card->curves.curve_count = curves;
    card->curves.curve_points = curves * points;
    card->curves.curve_rate = calloc((size_t)curves, sizeof(double));
    card->curves.curve_ptr = calloc((size_t)curves + 1, sizeof(int64_t));
    card->curves.curve_strain = calloc((size_t)card->curves.curve_points, sizeof(double));
    card->curves.curve_stress = calloc((size_t)card->curves.curve_points, sizeof(double));
    for (int k = 0; k < curves; k++) {
        card->curves.curve_rate[k] = rate[k];
        card->curves.curve_ptr[k + 1] = (k + 1) * points;
        for (int64_t i = 0; i < points; i++) {
            double strain = (double)i * DATA_STEP;
            card->curves.curve_strain[k * points + i] = strain;
            card->curves.curve_stress[k * points + i] = factor[k] * formula(strain);
        }
    }
    card->densification_start = card->densification_exponent = 0;
    card->densification_limit = 1;
}
