/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/form/form.h"

#include "material/curve.h"

double sf_curve_form_pole(const sf_curve_form *form, const double *value) {
    double own = form->pole(value), locked = value[SF_PARAMETER_LOCKED];
    return locked > 0 ? fmin(own, 1 - locked) : own;
}

static const double TAKES_OVER = 0.95; /* of e_D: from there a lock-up continues the form */

void sf_curve_form_stresses(const sf_curve_form *form, const double *value, int count, const double *strain,
                            double *stress) {
    double pole = sf_curve_form_pole(form, value), end = TAKES_OVER * pole, h = 1e-4 * (pole - end), own[3],
           unused[2];
    const double about[3] = {end - h, end, end + h};
    form->stress(value, count, strain, stress);
    if (!(pole < form->pole(value)))
        return;
    form->stress(value, 3, about, own);
    double slope = (own[2] - own[0]) / (2 * h);
    const sf_densification beyond = sf_densification_join(
        end, pole, sf_densification_steep_exponent(end, pole, own[1], slope), own[1], slope, 0);
    for (int k = 0; k < count; k++)
        if (strain[k] > end)
            sf_densification_evaluate(&beyond, strain[k], &stress[k], &unused[0], &unused[1]);
}

double sf_curve_form_stress(const sf_curve_form *form, const double *value, double strain) {
    double stress;
    sf_curve_form_stresses(form, value, 1, &strain, &stress);
    return stress;
}

/* ---- tabulation ---- */

sf_status sf_form_curves_alloc(int64_t count, int64_t points, sf_law_curves *curves, sf_error *err) {
    *curves = (sf_law_curves){
        .curve_count = count,
        .curve_points = points,
        .curve_rate = sf_alloc(err, count, sizeof(double), "curves"),
        .curve_ptr = sf_alloc(err, count + 1, sizeof(int64_t), "curves"),
        .curve_strain = sf_alloc(err, points, sizeof(double), "curves"),
        .curve_stress = sf_alloc(err, points, sizeof(double), "curves"),
    };
    for (int64_t k = 1; k <= count && err->status == SF_OK; k++)
        curves->curve_ptr[k] = k * (points / count);
    if (err->status != SF_OK)
        sf_law_curves_free(curves);
    return err->status;
}

/* Strains of the table: close together in the knee, and by equal ratios of the distance to the pole where the
 * stress rises steeply. So dense that the solver's interpolant has the stress to 1e-4. */
enum { KNEE = 160, MIDDLE = 100, END = 200, POINTS = KNEE + MIDDLE + END + 1 };
static const double MIDDLE_START = 0.1, END_START = 0.55, LAST = 0.975; /* parts of the pole */
static const double MOST_STRESS = 1e9;                                  /* Pa */

/* Part of the pole at which the table ends: before the stress is beyond all that a foam bears, where the
 * slope would be one that no card may have. */
static double last_part(const sf_curve_form *form, const double *value, double pole) {
    double low = END_START, high = LAST;
    if (sf_curve_form_stress(form, value, pole * LAST) <= MOST_STRESS)
        return LAST;
    for (int k = 0; k < 40; k++) {
        double middle = 0.5 * (low + high);
        *(sf_curve_form_stress(form, value, pole * middle) <= MOST_STRESS ? &low : &high) = middle;
    }
    return fmax(low, END_START + 0.05);
}

static double part_of(int k, double last) {
    if (k <= KNEE)
        return MIDDLE_START * k * k / (KNEE * KNEE);
    if (k <= KNEE + MIDDLE)
        return MIDDLE_START + (END_START - MIDDLE_START) * (k - KNEE) / MIDDLE;
    return 1 - (1 - END_START) * pow((1 - last) / (1 - END_START), (double)(k - KNEE - MIDDLE) / END);
}

/* The stress must rise, which the solver's law needs. */
static sf_status check_table(const sf_curve_form *form, const double *strain, const double *stress,
                             sf_error *err) {
    for (int k = 1; k < POINTS; k++)
        if (!(stress[k] > stress[k - 1]) || !isfinite(stress[k]))
            return SF_FAIL(err, SF_ERR_NUMERIC, "the curve of the form %s does not rise at a strain of %.3g",
                           form->name, strain[k]);
    return SF_OK;
}

/* The law beyond the table. */
static void set_densification(const sf_curve_form *form, const double *value, double pole, double end,
                              sf_foam_card *card) {
    double h = 1e-4 * (pole - end), at[3] = {end - h, end, end + h}, stress[3];
    sf_curve_form_stresses(form, value, 3, at, stress);
    card->densification_start = 0; /* at the table's end */
    card->densification_rule = pole < 1 ? SF_DENSIFICATION_H2 : SF_DENSIFICATION_H1;
    card->densification_limit = pole;
    card->densification_exponent =
        pole < 1 ? sf_densification_steep_exponent(end, pole, stress[1], (stress[2] - stress[0]) / (2 * h))
                 : 0;
}

/* The card takes the curves; its own go. */
static void replace_curves(sf_foam_card *card, sf_law_curves *curves) {
    sf_law_curves_free(&card->curves);
    card->curves = *curves;
    *curves = (sf_law_curves){0};
}

sf_status sf_curve_form_tabulate(const sf_curve_form *form, const double *value, sf_foam_card *card,
                                 sf_error *err) {
    SF_OWNED_BY(sf_law_curves_free) sf_law_curves made = {0};
    SF_TRY(form->check(value, err));
    SF_TRY(sf_form_curves_alloc(1, POINTS, &made, err));
    double pole = sf_curve_form_pole(form, value), last = last_part(form, value, pole);
    for (int k = 0; k < POINTS; k++)
        made.curve_strain[k] = pole * part_of(k, last);
    sf_curve_form_stresses(form, value, POINTS, made.curve_strain, made.curve_stress);
    SF_TRY(check_table(form, made.curve_strain, made.curve_stress, err));
    set_densification(form, value, pole, made.curve_strain[POINTS - 1], card);
    replace_curves(card, &made);
    return SF_OK;
}

/* ---- parameters of a foam ---- */

static const double UNKNOWN_SOLID_SD = 0.5; /* of the logarithm */
static const double USUAL_SOLID = 0.05;     /* solid fraction, where it is not known */
static const double RATE_FACTOR = 0.1;      /* median where the start material has none */
static const double RATE_REFERENCE = 1;     /* s-1, the same; drops are far above */

/* Parameters that are members of the card. */
static const struct {
    sf_foam_parameter parameter;
    size_t offset;
} members[] = {{SF_PARAMETER_E, offsetof(sf_foam_card, modulus)},
               {SF_PARAMETER_HU, offsetof(sf_foam_card, shared.hysteresis_hu)},
               {SF_PARAMETER_SHAPE, offsetof(sf_foam_card, shared.hysteresis_shape)},
               {SF_PARAMETER_ALPHA, offsetof(sf_foam_card, shared.hysteresis_alpha)},
               {SF_PARAMETER_DAMP, offsetof(sf_foam_card, shared.damp)},
               {SF_PARAMETER_ED, offsetof(sf_foam_card, shared.maxwell_modulus)},
               {SF_PARAMETER_BETA1, offsetof(sf_foam_card, shared.maxwell_rate)},
               {SF_PARAMETER_ETA, offsetof(sf_foam_card, shared.kelvin_viscosity)},
               {SF_PARAMETER_RATE_FACTOR, offsetof(sf_foam_card, shared.rate_factor)},
               {SF_PARAMETER_RATE_REFERENCE, offsetof(sf_foam_card, shared.rate_reference)},
               {SF_PARAMETER_RATE_FILTER_TIME, offsetof(sf_foam_card, shared.rate_filter_time)},
               {SF_PARAMETER_RELOAD, offsetof(sf_foam_card, shared.memory.reload)},
               {SF_PARAMETER_DRIFT, offsetof(sf_foam_card, shared.memory.drift)},
               {SF_PARAMETER_RECOVERY, offsetof(sf_foam_card, shared.memory.recovery)}};
enum { MEMBERS = sizeof members / sizeof *members };

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
    memset(value, 0, SF_PARAMETER_COUNT * sizeof *value);
    for (int k = 0; k < MEMBERS; k++)
        value[members[k].parameter] = *(const double *)((const char *)&form->base + members[k].offset);
    if (!(form->base.shared.rate_factor > 0))
        value[SF_PARAMETER_RATE_REFERENCE] = RATE_REFERENCE;
    value[SF_PARAMETER_STRESS_SCALE] = 1;
    value[SF_PARAMETER_EXPONENT] = form->base.densification_exponent;
    value[SF_PARAMETER_SOLID_FRACTION] =
        form->solid_density > 0 ? form->base.shared.density / form->solid_density : 0;
    form->curve->start(value);
}

double sf_foam_form_prior_sd(const sf_foam_form *form, sf_foam_parameter parameter) {
    const sf_form_entry *entry = sf_curve_form_entry(form->curve, parameter);
    if (parameter == SF_PARAMETER_SOLID_FRACTION && !(form->solid_density > 0))
        return UNKNOWN_SOLID_SD;
    return entry ? entry->prior_sd : sf_parameter_get(parameter)->prior_sd;
}

static sf_status copy_card(const sf_foam_card *from, sf_foam_card *to, sf_error *err) {
    *to = *from;
    size_t count = (size_t)from->curves.curve_count, points = (size_t)from->curves.curve_points;
    SF_TRY(sf_form_curves_alloc(from->curves.curve_count, from->curves.curve_points, &to->curves, err));
    if (count > 0) {
        memcpy(to->curves.curve_rate, from->curves.curve_rate, count * sizeof *to->curves.curve_rate);
        memcpy(to->curves.curve_ptr, from->curves.curve_ptr, (count + 1) * sizeof *to->curves.curve_ptr);
        memcpy(to->curves.curve_strain, from->curves.curve_strain, points * sizeof *to->curves.curve_strain);
        memcpy(to->curves.curve_stress, from->curves.curve_stress, points * sizeof *to->curves.curve_stress);
    }
    return SF_OK;
}

void sf_foam_card_free(sf_foam_card *card) {
    sf_law_curves_free(&card->curves);
    *card = (sf_foam_card){0};
}

/* A lock-up before the pole of the table: from 0.95 of it, or where the data end, the densification law goes
 * on to it, with the exponent given or, without one, that of the closed forms. */
static sf_status lock_table(double pole, sf_foam_card *card, sf_error *err) {
    double start = TAKES_OVER * pole, own = card->densification_start, stress, slope, energy;
    sf_curve curve;
    for (int64_t c = 1; c <= card->curves.curve_count; c++)
        start = fmin(start, card->curves.curve_strain[card->curves.curve_ptr[c] - 1]);
    start = own > 0 ? fmin(start, own) : start;
    SF_TRY(sf_curve_build(card, 0, &curve, err));
    sf_curve_evaluate(&curve, start, &stress, &slope, &energy);
    sf_curve_free(&curve);
    card->densification_rule = SF_DENSIFICATION_H2;
    card->densification_start = start;
    card->densification_limit = pole;
    if (!(card->densification_exponent > 0))
        card->densification_exponent = sf_densification_steep_exponent(start, pole, stress, slope);
    return SF_OK;
}

sf_status sf_foam_form_card(const sf_foam_form *form, const double value[SF_PARAMETER_COUNT],
                            sf_foam_card *card, sf_error *err) {
    SF_TRY(copy_card(&form->base, card, err));
    for (int k = 0; k < MEMBERS; k++)
        *(double *)((char *)card + members[k].offset) = value[members[k].parameter];
    card->shared.hysteresis_hu = fmin(1, card->shared.hysteresis_hu);
    if (form->curve->stress) {
        sf_curve_form_tabulate(form->curve, value, card, err);
    } else {
        card->densification_exponent = value[SF_PARAMETER_EXPONENT];
        for (int64_t k = 0; k < card->curves.curve_points; k++)
            card->curves.curve_stress[k] *= value[SF_PARAMETER_STRESS_SCALE];
        double locked = value[SF_PARAMETER_LOCKED];
        if (locked > 0 && 1 - locked < card->densification_limit)
            lock_table(1 - locked, card, err);
    }
    if (err->status != SF_OK)
        sf_foam_card_free(card);
    return err->status;
}

/* The end of a fine table of the curve: 0.975 of the strain limit, or where the stress is as high as a table
 * holds. */
static double table_end(const sf_curve *curve, double limit) {
    static const double STEP = 0.005; /* of the limit */
    double part = 0.975 + STEP, stress, slope, energy;
    do {
        part -= STEP;
        sf_curve_evaluate(curve, part * limit, &stress, &slope, &energy);
    } while (stress > MOST_STRESS && part > 0.5);
    return part * limit;
}

sf_status sf_foam_card_resample(sf_foam_card *card, sf_error *err) {
    enum { FINE = 196 };
    SF_OWNED_BY(sf_law_curves_free) sf_law_curves fine = {0};
    SF_TRY(sf_form_curves_alloc(card->curves.curve_count, FINE * card->curves.curve_count, &fine, err));
    for (int64_t c = 0; c < card->curves.curve_count; c++) {
        SF_OWNED_BY(sf_curve_free) sf_curve curve = {0};
        SF_TRY(sf_curve_build(card, c, &curve, err));
        double last = table_end(&curve, card->densification_limit), slope, energy;
        fine.curve_rate[c] = card->curves.curve_rate[c];
        for (int k = 0; k < FINE; k++) {
            int64_t at = c * FINE + k;
            fine.curve_strain[at] = last * k / (FINE - 1);
            sf_curve_evaluate(&curve, fine.curve_strain[at], &fine.curve_stress[at], &slope, &energy);
        }
    }
    replace_curves(card, &fine);
    card->densification_start = 0;
    return SF_OK;
}
