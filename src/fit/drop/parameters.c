/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/drop/parameters.h"

#include "core/curve.h"
#include "fit/gas_curve.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const sf_parameter_info info[SF_PARAMETER_COUNT] = {
    [SF_PARAMETER_E] = {"E", SF_PRESSURE, "MPa", 1e6, 1e3, 1e10, 0.1, false, false,
                        "modulus, and initial slope"},
    [SF_PARAMETER_S0] = {"s0", SF_PRESSURE, "kPa", 1e3, 1, 1e9, 0.7, true, false,
                         "yield stress of the cell walls"},
    [SF_PARAMETER_P0] = {"p0", SF_PRESSURE, "kPa", 1e3, 1, 1e9, 0.3, true, false, "gas pressure"},
    [SF_PARAMETER_B] = {"B", SF_PRESSURE, "kPa", 1e3, 1e-3, 1e9, 1, true, false, "densification stress"},
    [SF_PARAMETER_M] = {"m", SF_QUANTITY_COUNT, "", 1, 1, 10, 0.3, true, false, "densification exponent"},
    [SF_PARAMETER_STRESS_SCALE] = {"stress_scale", SF_QUANTITY_COUNT, "", 1, 1e-3, 1e3, 0.3, false, true,
                                   "factor on the tabulated curve"},
    [SF_PARAMETER_EXPONENT] = {"exponent", SF_QUANTITY_COUNT, "", 1, 0.1, 50, 0.3, false, true,
                               "exponent of the densification law"},
    [SF_PARAMETER_HU] = {"HU", SF_QUANTITY_COUNT, "", 1, 1e-4, 1, 0.5, false, false,
                         "hysteretic unloading factor"},
    [SF_PARAMETER_SHAPE] = {"SHAPE", SF_QUANTITY_COUNT, "", 1, 1e-2, 100, 0.5, false, false,
                            "shape of unloading"},
    [SF_PARAMETER_DAMP] = {"DAMP", SF_QUANTITY_COUNT, "", 1, 1e-4, 10, 0.5, false, false,
                           "viscous coefficient"},
    [SF_PARAMETER_ED] = {"ED", SF_PRESSURE, "MPa", 1e6, 1, 1e10, 1, false, false,
                         "modulus of the Maxwell branch"},
    [SF_PARAMETER_BETA1] = {"BETA1", SF_RATE, "1/s", 1, 1e-6, 1e9, 1, false, false, "its decay rate"},
    [SF_PARAMETER_ETA] = {"eta", SF_VISCOSITY, "Pa s", 1, 1e-3, 1e6, 1, false, false, "Kelvin viscosity"},
};

const sf_parameter_info *sf_parameter_get(sf_foam_parameter parameter) {
    return &info[parameter];
}

sf_foam_parameter sf_parameter_find(const char *name) {
    int k = 0;
    while (k < SF_PARAMETER_COUNT && strcmp(info[k].name, name) != 0)
        k++;
    return (sf_foam_parameter)k;
}

void sf_foam_form_start(const sf_foam_form *form, double value[SF_PARAMETER_COUNT]) {
    const sf_foam_card *base = &form->base;
    double pressure = fmin(101325, base->modulus / 2);
    const double start[SF_PARAMETER_COUNT] = {
        [SF_PARAMETER_E] = base->modulus,
        [SF_PARAMETER_S0] = 0.02 * base->modulus,
        [SF_PARAMETER_P0] = pressure,
        [SF_PARAMETER_B] = pressure / 4,
        [SF_PARAMETER_M] = 3,
        [SF_PARAMETER_STRESS_SCALE] = 1,
        [SF_PARAMETER_EXPONENT] = base->densification_exponent,
        [SF_PARAMETER_HU] = base->hysteresis_hu,
        [SF_PARAMETER_SHAPE] = base->hysteresis_shape,
        [SF_PARAMETER_DAMP] = base->damp,
        [SF_PARAMETER_ED] = base->maxwell_modulus,
        [SF_PARAMETER_BETA1] = base->maxwell_rate,
        [SF_PARAMETER_ETA] = base->kelvin_viscosity,
    };
    memcpy(value, start, sizeof start);
}

/* A copy of `count` items; NULL for none. */
static void *copy_items(const void *from, int64_t count, size_t size, sf_error *err) {
    void *to = sf_alloc(err, (unsigned long)count, size, "foam card");
    if (to && count > 0)
        memcpy(to, from, (size_t)count * size);
    return to;
}

sf_status sf_foam_card_copy(const sf_foam_card *from, sf_foam_card *to, sf_error *err) {
    *to = *from;
    to->curve_rate = copy_items(from->curve_rate, from->curve_count, sizeof(double), err);
    to->curve_ptr = copy_items(from->curve_ptr, from->curve_count + 1, sizeof(int64_t), err);
    to->curve_strain = copy_items(from->curve_strain, from->curve_points, sizeof(double), err);
    to->curve_stress = copy_items(from->curve_stress, from->curve_points, sizeof(double), err);
    if (err->status != SF_OK)
        sf_foam_card_free(to);
    return err->status;
}

void sf_foam_card_free(sf_foam_card *card) {
    free(card->curve_rate);
    free(card->curve_ptr);
    free(card->curve_strain);
    free(card->curve_stress);
    *card = (sf_foam_card){0};
}

sf_status sf_foam_form_card(const sf_foam_form *form, const double value[SF_PARAMETER_COUNT],
                            sf_foam_card *card, sf_error *err) {
    if (sf_foam_card_copy(&form->base, card, err) != SF_OK)
        return err->status;
    card->modulus = value[SF_PARAMETER_E];
    card->hysteresis_hu = fmin(1, value[SF_PARAMETER_HU]);
    card->hysteresis_shape = value[SF_PARAMETER_SHAPE];
    card->damp = value[SF_PARAMETER_DAMP];
    card->maxwell_modulus = value[SF_PARAMETER_ED];
    card->maxwell_rate = value[SF_PARAMETER_BETA1];
    card->kelvin_viscosity = value[SF_PARAMETER_ETA];
    card->densification_exponent = value[SF_PARAMETER_EXPONENT];
    for (int64_t k = 0; k < card->curve_points; k++)
        card->curve_stress[k] *= value[SF_PARAMETER_STRESS_SCALE];
    if (form->gas) {
        const sf_gas_curve curve = {.modulus = value[SF_PARAMETER_E],
                                    .yield = value[SF_PARAMETER_S0],
                                    .pressure = value[SF_PARAMETER_P0],
                                    .factor = value[SF_PARAMETER_B],
                                    .exponent = value[SF_PARAMETER_M]};
        card->densification_start = 0; /* at the table's end, rule H1 */
        card->densification_rule = SF_DENSIFICATION_H1;
        card->densification_limit = 1;
        card->densification_exponent = 0;
        if (!(curve.pressure < curve.modulus && curve.exponent > 1))
            SF_FAIL(err, SF_ERR_NUMERIC,
                    "p0 = %g Pa is not below E = %g Pa, or m = %g not above 1: no rising curve of initial "
                    "slope E",
                    curve.pressure, curve.modulus, curve.exponent);
        else
            sf_gas_curve_tabulate(&curve, card, err);
    }
    if (err->status != SF_OK)
        sf_foam_card_free(card);
    return err->status;
}

sf_status sf_foam_card_resample(sf_foam_card *card, sf_error *err) {
    enum { POINTS = 196 };
    double last = 0.975 * card->densification_limit;
    int64_t n = card->curve_count;
    double *strain = sf_alloc(err, (unsigned long)n * POINTS, sizeof *strain, "curves"),
           *stress = sf_alloc(err, (unsigned long)n * POINTS, sizeof *stress, "curves");
    for (int64_t c = 0; c < n && err->status == SF_OK; c++) {
        sf_curve curve;
        if (sf_curve_build(card, c, &curve, err) != SF_OK)
            break;
        for (int k = 0; k < POINTS; k++) {
            double slope, energy;
            strain[c * POINTS + k] = last * k / (POINTS - 1);
            sf_curve_evaluate(&curve, strain[c * POINTS + k], &stress[c * POINTS + k], &slope, &energy);
        }
        sf_curve_free(&curve);
    }
    if (err->status != SF_OK) {
        free(strain);
        free(stress);
        return err->status;
    }
    free(card->curve_strain);
    free(card->curve_stress);
    card->curve_strain = strain;
    card->curve_stress = stress;
    card->curve_points = n * POINTS;
    for (int64_t c = 0; c <= n; c++)
        card->curve_ptr[c] = c * POINTS;
    card->densification_start = 0;
    return SF_OK;
}
