/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/parameters.h"

#include "material/curve.h"
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

static void copy_items(void *to, const void *from, int64_t count, size_t size) {
    if (from && count > 0)
        memcpy(to, from, (size_t)count * size);
}

sf_status sf_foam_card_copy(const sf_foam_card *from, sf_foam_card *to, sf_error *err) {
    *to = *from;
    SF_TRY(sf_form_curves_alloc(from->curve_count, from->curve_points, &to->curves, err));
    copy_items(to->curve_rate, from->curve_rate, from->curve_count, sizeof(double));
    copy_items(to->curve_ptr, from->curve_ptr, from->curve_count + 1, sizeof(int64_t));
    copy_items(to->curve_strain, from->curve_strain, from->curve_points, sizeof(double));
    copy_items(to->curve_stress, from->curve_stress, from->curve_points, sizeof(double));
    return SF_OK;
}

void sf_foam_card_free(sf_foam_card *card) {
    sf_law_curves_free(&card->curves);
    *card = (sf_foam_card){0};
}

sf_status sf_foam_form_card(const sf_foam_form *form, const double value[SF_PARAMETER_COUNT],
                            sf_foam_card *card, sf_error *err) {
    SF_TRY(sf_foam_card_copy(&form->base, card, err));
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
    sf_law_curves fine;
    SF_TRY(sf_form_curves_alloc(card->curve_count, POINTS * card->curve_count, &fine, err));
    for (int64_t c = 0; c < card->curve_count && err->status == SF_OK; c++) {
        sf_curve curve;
        if (sf_curve_build(card, c, &curve, err) != SF_OK)
            break;
        double last = table_end(&curve, card->densification_limit), slope, energy;
        fine.curve_rate[c] = card->curve_rate[c];
        for (int k = 0; k < POINTS; k++) {
            int64_t at = c * POINTS + k;
            fine.curve_strain[at] = last * k / (POINTS - 1);
            sf_curve_evaluate(&curve, fine.curve_strain[at], &fine.curve_stress[at], &slope, &energy);
        }
        sf_curve_free(&curve);
    }
    if (err->status != SF_OK) {
        sf_law_curves_free(&fine);
        return err->status;
    }
    sf_law_curves_free(&card->curves);
    card->curves = fine;
    card->densification_start = 0;
    return SF_OK;
}
