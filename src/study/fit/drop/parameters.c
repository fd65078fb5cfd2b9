/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/parameters.h"

#include "material/curve.h"
#include "study/fit/form/gas.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double LEAST_SOLID = 300, MOST_SOLID = 20000; /* kg m-3 */
static const double MOST_FRACTION = 0.5;
static const double UNKNOWN_SOLID_SD = 0.5; /* of the logarithm */
static const double USUAL_SOLID = 0.05;     /* solid fraction, where it is not known */
static const double RATE_FACTOR = 0.1;      /* median where the start material has none */
static const double RATE_REFERENCE = 1;     /* s-1, the same; drops are far above */

sf_status sf_foam_form_check_solid(const sf_foam_form *form, sf_error *err) {
    double solid = form->solid_density, foam = form->base.density;
    if (!(solid >= LEAST_SOLID && solid <= MOST_SOLID))
        return SF_FAIL(err, SF_ERR_INPUT,
                       "solid_density is %g kg/m3; solids that foams are made of have %g to %g kg/m3", solid,
                       LEAST_SOLID, MOST_SOLID);
    if (!(foam < MOST_FRACTION * solid))
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "solid_density is %g kg/m3, the foam's density %g kg/m3: a foam is less than half solid", solid,
            foam);
    return SF_OK;
}

static void start_common(const sf_foam_card *base, double value[SF_PARAMETER_COUNT]) {
    const double start[SF_PARAMETER_COUNT] = {
        [SF_PARAMETER_E] = base->modulus,
        [SF_PARAMETER_STRESS_SCALE] = 1,
        [SF_PARAMETER_EXPONENT] = base->densification_exponent,
        [SF_PARAMETER_HU] = base->hysteresis_hu,
        [SF_PARAMETER_SHAPE] = base->hysteresis_shape,
        [SF_PARAMETER_ALPHA] = base->hysteresis_alpha,
        [SF_PARAMETER_DAMP] = base->damp,
        [SF_PARAMETER_ED] = base->maxwell_modulus,
        [SF_PARAMETER_BETA1] = base->maxwell_rate,
        [SF_PARAMETER_ETA] = base->kelvin_viscosity,
        [SF_PARAMETER_RATE_FACTOR] = base->rate_factor,
        [SF_PARAMETER_RATE_REFERENCE] = base->rate_factor > 0 ? base->rate_reference : RATE_REFERENCE,
    };
    memcpy(value, start, sizeof start);
}

void sf_foam_form_start_rate(double value[SF_PARAMETER_COUNT]) {
    if (!(value[SF_PARAMETER_RATE_FACTOR] > 0))
        value[SF_PARAMETER_RATE_FACTOR] = RATE_FACTOR;
}

void sf_foam_form_start_lock(double value[SF_PARAMETER_COUNT]) {
    double solid = value[SF_PARAMETER_SOLID_FRACTION];
    if (!(value[SF_PARAMETER_LOCKED] > 0))
        value[SF_PARAMETER_LOCKED] = 1 - sf_form_dense_strain(solid > 0 ? solid : USUAL_SOLID);
}

void sf_foam_form_start(const sf_foam_form *form, double value[SF_PARAMETER_COUNT]) {
    start_common(&form->base, value);
    value[SF_PARAMETER_SOLID_FRACTION] =
        form->solid_density > 0 ? form->base.density / form->solid_density : 0;
    form->curve->start(value);
}

double sf_foam_form_prior_sd(const sf_foam_form *form, sf_foam_parameter parameter) {
    const sf_form_entry *entry = sf_curve_form_entry(form->curve, parameter);
    if (parameter == SF_PARAMETER_SOLID_FRACTION && !(form->solid_density > 0))
        return UNKNOWN_SOLID_SD;
    return entry ? entry->prior_sd : sf_parameter_get(parameter)->prior_sd;
}

int sf_foam_form_usual(const sf_foam_form *form, sf_foam_parameter usual[SF_PARAMETER_COUNT]) {
    int count = 0;
    for (int k = 0; k < form->curve->entry_count; k++)
        if (form->curve->entry[k].usual)
            usual[count++] = form->curve->entry[k].parameter;
    usual[count++] = SF_PARAMETER_ED;
    return count;
}

/* A copy of `count` items; zeros for NULL. */
static void *copy_items(const void *from, int64_t count, size_t size, sf_error *err) {
    void *to = sf_alloc(err, (unsigned long)count, size, "foam card");
    if (to && from && count > 0)
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
    card->hysteresis_alpha = value[SF_PARAMETER_ALPHA];
    card->damp = value[SF_PARAMETER_DAMP];
    card->maxwell_modulus = value[SF_PARAMETER_ED];
    card->maxwell_rate = value[SF_PARAMETER_BETA1];
    card->kelvin_viscosity = value[SF_PARAMETER_ETA];
    card->rate_factor = value[SF_PARAMETER_RATE_FACTOR];
    card->rate_reference = value[SF_PARAMETER_RATE_REFERENCE];
    if (form->curve->stress) {
        sf_curve_form_tabulate(form->curve, value, card, err);
    } else {
        card->densification_exponent = value[SF_PARAMETER_EXPONENT];
        for (int64_t k = 0; k < card->curve_points; k++)
            card->curve_stress[k] *= value[SF_PARAMETER_STRESS_SCALE];
    }
    if (err->status != SF_OK)
        sf_foam_card_free(card);
    return err->status;
}

/* The end of a fine table of the curve: 0.975 of the strain limit, or where the stress is as high as a table
 * holds. */
static double table_end(const sf_curve *curve, double limit) {
    static const double MOST_STRESS = 1e9, STEP = 0.005; /* Pa; of the limit */
    double part = 0.975 + STEP, stress, slope, energy;
    do {
        part -= STEP;
        sf_curve_evaluate(curve, part * limit, &stress, &slope, &energy);
    } while (stress > MOST_STRESS && part > 0.5);
    return part * limit;
}

sf_status sf_foam_card_resample(sf_foam_card *card, sf_error *err) {
    enum { POINTS = 196 };
    int64_t n = card->curve_count;
    double *strain = sf_alloc(err, (unsigned long)n * POINTS, sizeof *strain, "curves"),
           *stress = sf_alloc(err, (unsigned long)n * POINTS, sizeof *stress, "curves");
    for (int64_t c = 0; c < n && err->status == SF_OK; c++) {
        sf_curve curve;
        if (sf_curve_build(card, c, &curve, err) != SF_OK)
            break;
        double last = table_end(&curve, card->densification_limit);
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
