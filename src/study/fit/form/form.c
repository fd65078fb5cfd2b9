/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/form/form.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "material/curve.h"

static const sf_parameter_info info[SF_PARAMETER_COUNT] = {
#define SF_FIT_PARAMETER_ROW(id, name, quantity, unit, per_unit, low, high, prior_sd, description)           \
    [SF_PARAMETER_##id] = {name, quantity, unit, per_unit, low, high, prior_sd, description},
    SF_FIT_PARAMETERS(SF_FIT_PARAMETER_ROW, SF_QUANTITY_COUNT)};

const sf_parameter_info *sf_parameter_get(sf_foam_parameter parameter) {
    return &info[parameter];
}

sf_foam_parameter sf_parameter_find(const char *name) {
    int k = 0;
    while (k < SF_PARAMETER_COUNT && strcmp(info[k].name, name) != 0)
        k++;
    return (sf_foam_parameter)k;
}

static const sf_curve_form *const forms[SF_CURVE_FORMS] = {
#define SF_CURVE_FORM(form) &sf_form_##form,
#include "study/fit/form/forms.def"
#undef SF_CURVE_FORM
};

const sf_curve_form *sf_curve_form_get(int index) {
    return forms[index];
}

const sf_curve_form *sf_curve_form_find(const char *name) {
    for (int k = 0; k < SF_CURVE_FORMS; k++)
        if (strcmp(forms[k]->name, name) == 0)
            return forms[k];
    return NULL;
}

const char *sf_curve_form_words(void) {
#define SF_CURVE_FORM(form) "|" #form
    static const char words[] =
#include "study/fit/form/forms.def"
        ;
#undef SF_CURVE_FORM
    return words + 1;
}

const sf_form_entry *sf_curve_form_entry(const sf_curve_form *form, sf_foam_parameter parameter) {
    for (int k = 0; k < form->entry_count; k++)
        if (form->entry[k].parameter == parameter)
            return &form->entry[k];
    return NULL;
}

bool sf_curve_form_uses(const sf_curve_form *form, sf_foam_parameter parameter) {
    bool of_a_form = false;
    if (parameter == SF_PARAMETER_LOCKED)
        return form->stress != NULL;
    for (int k = 0; k < SF_CURVE_FORMS; k++)
        of_a_form = of_a_form || sf_curve_form_entry(forms[k], parameter);
    return !of_a_form || sf_curve_form_entry(form, parameter);
}

double sf_curve_form_pole(const sf_curve_form *form, const double *value) {
    double own = form->pole(value), locked = value[SF_PARAMETER_LOCKED];
    return locked > 0 ? fmin(own, 1 - locked) : own;
}

static const double TAKES_OVER = 0.95; /* of e_D: from there a lock-up continues the form */

/* Value and slope of the form itself. */
static void join(const sf_curve_form *form, const double *value, double at, double h, double *stress,
                 double *slope) {
    const double strain[3] = {at - h, at, at + h};
    double sigma[3];
    form->stress(value, 3, strain, sigma);
    *stress = sigma[1];
    *slope = (sigma[2] - sigma[0]) / (2 * h);
}

void sf_curve_form_stresses(const sf_curve_form *form, const double *value, int count, const double *strain,
                            double *stress) {
    double pole = sf_curve_form_pole(form, value), end = TAKES_OVER * pole, at_end, slope, unused[2];
    form->stress(value, count, strain, stress);
    if (!(pole < form->pole(value)))
        return;
    join(form, value, end, 1e-4 * (pole - end), &at_end, &slope);
    const sf_densification beyond = sf_densification_join(
        end, pole, sf_densification_steep_exponent(end, pole, at_end, slope), at_end, slope, 0);
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

static void replace_curves(sf_foam_card *card, double *strain, double *stress, double *rate, int64_t *ptr) {
    free(card->curve_strain);
    free(card->curve_stress);
    free(card->curve_rate);
    free(card->curve_ptr);
    card->curve_strain = strain;
    card->curve_stress = stress;
    card->curve_rate = rate;
    card->curve_ptr = ptr;
    card->curve_count = 1;
    card->curve_points = ptr[1] = POINTS;
}

sf_status sf_curve_form_tabulate(const sf_curve_form *form, const double *value, sf_foam_card *card,
                                 sf_error *err) {
    if (form->check(value, err) != SF_OK)
        return err->status;
    double pole = sf_curve_form_pole(form, value), *strain = sf_alloc(err, POINTS, sizeof *strain, "curve"),
           *stress = sf_alloc(err, POINTS, sizeof *stress, "curve"),
           *rate = sf_alloc(err, 1, sizeof *rate, "curve");
    int64_t *ptr = sf_alloc(err, 2, sizeof *ptr, "curve");
    if (err->status == SF_OK) {
        double last = last_part(form, value, pole);
        for (int k = 0; k < POINTS; k++)
            strain[k] = pole * part_of(k, last);
        sf_curve_form_stresses(form, value, POINTS, strain, stress);
        check_table(form, strain, stress, err);
    }
    if (err->status != SF_OK) {
        free(strain);
        free(stress);
        free(rate);
        free(ptr);
        return err->status;
    }
    set_densification(form, value, pole, strain[POINTS - 1], card);
    replace_curves(card, strain, stress, rate, ptr);
    return SF_OK;
}

/* The form `table`: the start material's curve, scaled; its densification law stays. */

static const sf_form_entry entries[] = {{SF_PARAMETER_STRESS_SCALE, 0.3, true},
                                        {SF_PARAMETER_EXPONENT, 0.3, false}};

static void start(double *value) {
    value[SF_PARAMETER_STRESS_SCALE] = 1;
}

const sf_curve_form sf_form_table = {
    .name = "table",
    .formula = "the start material's curve times stress_scale",
    .entry = entries,
    .entry_count = sizeof entries / sizeof *entries,
    .start = start,
};
