/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms of the loading curve (fit/form): each rises from its modulus to its pole, the card that the solver
 * gets has the stress of the closed form, the medians of the priors are a foam, and values that make no curve
 * are refused. */
#include "material/curve.h"
#include "study/fit/form/form.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const double MODULUS = 0.4136e6, DENSITY = 35, SOLID = 940; /* EVA of Penta et al. (2018) */

/* Values of a form at its medians, for this EVA. */
static void medians(const sf_curve_form *curve, double value[SF_PARAMETER_COUNT]) {
    const sf_foam_form form = {
        .base = {.shared.density = DENSITY, .modulus = MODULUS, .shared.hysteresis_alpha = 0.5},
        .curve = curve,
        .solid_density = SOLID};
    sf_foam_form_start(&form, value);
}

/* The form `index`; NULL for the table, which has no curve of its own. */
static const sf_curve_form *closed_form(int index) {
    const sf_curve_form *form = sf_curve_form_get(index);
    return form->stress ? form : NULL;
}

static void each_form_rises_from_its_modulus_to_its_pole(void **state) {
    (void)state;
    for (int f = 0; f < SF_CURVE_FORMS; f++) {
        const sf_curve_form *form = closed_form(f);
        double value[SF_PARAMETER_COUNT], before = 0, pole;
        if (!form)
            continue;
        medians(form, value);
        pole = form->pole(value);
        assert_true(pole <= 1 && pole > 0.9);
        assert_true(sf_curve_form_stress(form, value, 0) == 0);
        assert_true(fabs(sf_curve_form_stress(form, value, 1e-8) / 1e-8 / MODULUS - 1) < 1e-4);
        for (int k = 1; k < 1000; k++) {
            double next = sf_curve_form_stress(form, value, pole * k / 1000);
            assert_true(next > before);
            before = next;
        }
        assert_true(sf_curve_form_stress(form, value, pole * (1 - 1e-6)) > 1e9);
    }
}

/* A foam of this density is soft to 20 %, has the gas's stress at half and is dense at 85 %. */
static void medians_of_the_priors_are_a_foam(void **state) {
    (void)state;
    for (int f = 0; f < SF_CURVE_FORMS; f++) {
        const sf_curve_form *form = closed_form(f);
        double value[SF_PARAMETER_COUNT];
        if (!form)
            continue;
        medians(form, value);
        double soft = sf_curve_form_stress(form, value, 0.2), half = sf_curve_form_stress(form, value, 0.5),
               dense = sf_curve_form_stress(form, value, 0.85);
        assert_true(soft > 15e3 && soft < 80e3);
        assert_true(half > 80e3 && half < 250e3);
        assert_true(dense > 1e6 && dense < 10e6);
    }
}

/* The card as the solver evaluates it; false if the values make no curve. */
static bool build(const sf_curve_form *form, const double *value, sf_foam_card *card, sf_curve *curve) {
    sf_error err = SF_ERROR_INIT;
    if (sf_curve_form_tabulate(form, value, card, &err) != SF_OK)
        return false;
    assert_int_equal(sf_curve_build(card, 0, curve, &err), SF_OK);
    return true;
}

static void check_card(const sf_curve_form *form, const double *value) {
    sf_foam_card card = {0};
    sf_curve curve;
    double pole = sf_curve_form_pole(form, value), knee = sf_curve_form_stress(form, value, 0.005);
    assert_true(build(form, value, &card, &curve));
    assert_true(fabs(card.densification_limit - pole) < 1e-15);
    assert_true(curve.start >= 0.8 * pole && curve.start < 0.976 * pole);
    assert_int_equal(card.densification_rule, pole < 1 ? SF_DENSIFICATION_H2 : SF_DENSIFICATION_H1);
    for (int k = 1; k < 4000; k++) {
        double strain = curve.start * k / 4000, stress, slope, energy;
        sf_curve_evaluate(&curve, strain, &stress, &slope, &energy);
        double exact = sf_curve_form_stress(form, value, strain),
               error = (stress - exact) / fmax(exact, knee);
        if (!(fabs(error) < 1e-4 && slope > 0))
            fail_msg("%s: error of %g at a strain of %g", form->name, error, strain);
    }
    /* half of what is left to the pole: the law beyond has the form's growth */
    double stress, slope, energy, strain = 0.5 * (curve.start + pole);
    sf_curve_evaluate(&curve, strain, &stress, &slope, &energy);
    double error = stress / sf_curve_form_stress(form, value, strain) - 1;
    if (!(fabs(error) < (curve.start > 0.974 * pole ? 0.03 : 0.08))) /* beyond 1 GPa */
        fail_msg("%s: error of %g at a strain of %g", form->name, error, strain);
    sf_curve_free(&curve);
    sf_foam_card_free(&card);
}

/* Steep forms too are materials that softfall-pre takes: no slope above 1e12 Pa. */
static void steep_forms_end_at_1_gpa(void **state) {
    (void)state;
    static const struct {
        const sf_curve_form *form;
        sf_foam_parameter parameter;
        double value;
    } steep[] = {{&sf_form_gas, SF_PARAMETER_M, 6},
                 {&sf_form_gas_solid, SF_PARAMETER_M, 6},
                 {&sf_form_avalle, SF_PARAMETER_AVALLE_N, 5}};
    for (size_t k = 0; k < sizeof steep / sizeof *steep; k++) {
        double value[SF_PARAMETER_COUNT], stress, slope, energy;
        sf_foam_card card = {0};
        sf_curve curve;
        medians(steep[k].form, value);
        value[steep[k].parameter] = steep[k].value;
        assert_true(build(steep[k].form, value, &card, &curve));
        sf_curve_evaluate(&curve, curve.start, &stress, &slope, &energy);
        assert_true(stress > 0.9e9 && stress < 1.01e9);
        sf_curve_free(&curve);
        sf_foam_card_free(&card);
    }
}

static void the_card_has_the_stress_of_the_closed_form(void **state) {
    (void)state;
    for (int f = 0; f < SF_CURVE_FORMS; f++) {
        const sf_curve_form *form = closed_form(f);
        double value[SF_PARAMETER_COUNT];
        if (!form)
            continue;
        medians(form, value);
        check_card(form, value);
        for (int k = 0; k < form->entry_count; k++) { /* one standard deviation of each prior up and down */
            const sf_form_entry *e = &form->entry[k];
            for (int side = -1; side <= 1; side += 2) {
                medians(form, value);
                value[e->parameter] *= exp(side * e->prior_sd);
                check_card(form, value);
            }
        }
    }
}

/* With Phi = 0 gas_solid is gas. */
static void the_solid_fraction_moves_the_poles(void **state) {
    (void)state;
    double value[SF_PARAMETER_COUNT];
    medians(&sf_form_gas_solid, value);
    assert_true(fabs(value[SF_PARAMETER_SOLID_FRACTION] - DENSITY / SOLID) < 1e-12);
    assert_true(fabs(sf_form_gas_solid.pole(value) - (1 - 1.4 * DENSITY / SOLID)) < 1e-12);
    value[SF_PARAMETER_B] = 0; /* the gas alone: +23, 33 and 59 % at 0.8, 0.85 and 0.9 */
    static const double strain[3] = {0.8, 0.85, 0.9}, growth[3] = {1.23, 1.33, 1.59};
    for (int k = 0; k < 3; k++) {
        double with = sf_curve_form_stress(&sf_form_gas_solid, value, strain[k]) - value[SF_PARAMETER_S0],
               without = sf_curve_form_stress(&sf_form_gas, value, strain[k]) - value[SF_PARAMETER_S0];
        assert_true(fabs(with / without - growth[k]) < 0.01);
    }
    value[SF_PARAMETER_SOLID_FRACTION] = 0;
    for (int k = 0; k < 3; k++)
        assert_true(sf_curve_form_stress(&sf_form_gas_solid, value, strain[k]) ==
                    sf_curve_form_stress(&sf_form_gas, value, strain[k]));
}

/* Every form may lock up: its own curve to 0.95 e_D, then one that continues value and slope up to e_D; a
 * lock-up beyond its own pole changes nothing. */
static void a_lock_up_of_its_own_continues_the_form(void **state) {
    (void)state;
    for (int i = 0; i < SF_CURVE_FORMS; i++) {
        const sf_curve_form *form = sf_curve_form_get(i);
        double value[SF_PARAMETER_COUNT], locked[SF_PARAMETER_COUNT];
        assert_true(sf_curve_form_uses(form, SF_PARAMETER_LOCKED));
        if (!form->stress)
            continue;
        medians(form, value);
        medians(form, locked);
        locked[SF_PARAMETER_LOCKED] = 0.16;
        const double pole = 0.84, joint = 0.95 * pole, h = 1e-6;
        assert_true(fabs(sf_curve_form_pole(form, locked) - pole) < 1e-15);
        assert_true(sf_curve_form_stress(form, locked, 0.79) == sf_curve_form_stress(form, value, 0.79));
        double below = sf_curve_form_stress(form, locked, joint - h),
               at = sf_curve_form_stress(form, locked, joint),
               above = sf_curve_form_stress(form, locked, joint + h);
        assert_true(fabs((above - at) / (at - below) - 1) < 1e-3);
        assert_true(sf_curve_form_stress(form, locked, pole - 1e-6) > 1e9);
        check_card(form, locked);
        locked[SF_PARAMETER_LOCKED] = 1e-3;
        for (double strain = 0.05; strain < 0.93; strain += 0.05)
            assert_true(sf_curve_form_stress(form, locked, strain) ==
                        sf_curve_form_stress(form, value, strain));
        sf_foam_form foam = {.curve = form, .base = {.shared.density = DENSITY}, .solid_density = SOLID};
        assert_true(sf_foam_form_prior_sd(&foam, SF_PARAMETER_LOCKED) == 0.7);
    }
    double value[SF_PARAMETER_COUNT] = {[SF_PARAMETER_SOLID_FRACTION] = 0.1};
    sf_foam_form_start_lock(value);
    assert_true(fabs(value[SF_PARAMETER_LOCKED] - 0.14) < 1e-12);
}

/* A bend of the spline's logarithm is felt on its own side, and the initial slope stays. */
static void the_spline_bends_where_its_parameter_says(void **state) {
    (void)state;
    double value[SF_PARAMETER_COUNT], bent[SF_PARAMETER_COUNT];
    medians(&sf_form_spline, value);
    medians(&sf_form_spline, bent);
    bent[SF_PARAMETER_SPLINE_7] = exp(0.2); /* at a strain of 0.60 */
    assert_true(fabs(sf_curve_form_stress(&sf_form_spline, bent, 0.4) /
                         sf_curve_form_stress(&sf_form_spline, value, 0.4) -
                     1) < 1e-9);
    double raised = log(sf_curve_form_stress(&sf_form_spline, bent, 0.85) /
                        sf_curve_form_stress(&sf_form_spline, value, 0.85));
    assert_true(fabs(raised - 0.2 * (0.85 - 0.60) / 0.15) < 1e-9);
    bent[SF_PARAMETER_SPLINE_1] = 2; /* the level */
    assert_true(fabs(sf_curve_form_stress(&sf_form_spline, bent, 1e-8) / 1e-8 / MODULUS - 1) < 1e-4);
}

static void refuse(const sf_curve_form *form, sf_foam_parameter parameter, double to, const char *reason) {
    double value[SF_PARAMETER_COUNT];
    sf_foam_card card = {0};
    sf_error err = SF_ERROR_INIT;
    medians(form, value);
    value[parameter] = to;
    assert_int_equal(sf_curve_form_tabulate(form, value, &card, &err), SF_ERR_NUMERIC);
    if (!strstr(err.text, reason))
        fail_msg("\"%s\" was expected, got: %s", reason, err.text);
    assert_null(card.curves.curve_strain);
}

static void values_that_make_no_curve_are_refused(void **state) {
    (void)state;
    refuse(&sf_form_gas, SF_PARAMETER_M, 0.9, "not above 1");
    refuse(&sf_form_gas_solid, SF_PARAMETER_SOLID_FRACTION, 0.7, "that is no foam");
    refuse(&sf_form_rusch, SF_PARAMETER_RUSCH_M, 1.2, "outside 0 to 1");
    refuse(&sf_form_rusch, SF_PARAMETER_RUSCH_END, 0.99, "rusch_end");
    refuse(&sf_form_avalle, SF_PARAMETER_AVALLE_N, 0.8, "not above 1");
    refuse(&sf_form_avalle, SF_PARAMETER_AVALLE_M, 15, "does not rise");
    refuse(&sf_form_spline, SF_PARAMETER_SPLINE_6, 0.1, "does not rise");
}

/* A fine table in place of curve and densification holds no stress that the reader of a material file
 * refuses, with a densification that is next to a wall. */
static void a_fine_table_ends_at_1_gpa(void **state) {
    (void)state;
    const sf_foam_form form = {
        .base = {.shared.density = DENSITY, .modulus = MODULUS, .densification_limit = 1},
        .curve = &sf_form_avalle};
    double value[SF_PARAMETER_COUNT];
    sf_foam_card card;
    sf_error err = SF_ERROR_INIT;
    sf_foam_form_start(&form, value);
    value[SF_PARAMETER_E] = MODULUS;
    value[SF_PARAMETER_AVALLE_N] = 5;
    assert_int_equal(sf_foam_form_card(&form, value, &card, &err), SF_OK);
    assert_int_equal(sf_foam_card_resample(&card, &err), SF_OK);
    int64_t last = card.curves.curve_points - 1;
    assert_true(card.curves.curve_stress[last] <= 1e9 && card.curves.curve_stress[last] > 1e8);
    assert_true(card.curves.curve_stress[last] - card.curves.curve_stress[last - 1] <
                1e12 * (card.curves.curve_strain[last] - card.curves.curve_strain[last - 1]));
    sf_foam_card_free(&card);
}

/* Every parameter of the card comes from its value, with every form; the table scales its curve. */
static void a_card_has_the_values(void **state) {
    (void)state;
    double rate = 0, strain[3] = {0, 0.4, 0.8}, stress[3] = {0, 50e3, 900e3};
    int64_t ptr[2] = {0, 3};
    for (int f = 0; f < SF_CURVE_FORMS; f++) {
        const sf_foam_form form = {.base = {.shared.density = DENSITY,
                                            .modulus = MODULUS,
                                            .shared.hysteresis_hu = 0.1,
                                            .shared.hysteresis_shape = 2,
                                            .shared.hysteresis_alpha = 0.5,
                                            .densification_limit = 1,
                                            .curves.curve_rate = &rate,
                                            .curves.curve_ptr = ptr,
                                            .curves.curve_strain = strain,
                                            .curves.curve_stress = stress,
                                            .curves.curve_count = 1,
                                            .curves.curve_points = 3},
                                   .curve = sf_curve_form_get(f)};
        double value[SF_PARAMETER_COUNT];
        sf_foam_card card;
        sf_error err = SF_ERROR_INIT;
        sf_foam_form_start(&form, value);
        assert_true(value[SF_PARAMETER_RATE_FACTOR] == 0 && value[SF_PARAMETER_RATE_REFERENCE] == 1);
        sf_foam_form_start_rate(value);
        assert_true(value[SF_PARAMETER_RATE_FACTOR] == 0.1);
        value[SF_PARAMETER_RATE_FACTOR] = 0.2;
        value[SF_PARAMETER_ALPHA] = 0.3;
        value[SF_PARAMETER_STRESS_SCALE] = 2;
        assert_int_equal(sf_foam_form_card(&form, value, &card, &err), SF_OK);
        assert_true(card.shared.hysteresis_alpha == 0.3 && card.shared.hysteresis_hu == 0.1 &&
                    card.shared.hysteresis_shape == 2);
        assert_true(card.modulus == MODULUS && card.shared.rate_factor == 0.2 &&
                    card.shared.rate_reference == 1);
        if (form.curve == &sf_form_table)
            assert_true(card.curves.curve_points == 3 && card.curves.curve_stress[1] == 100e3);
        sf_foam_card_free(&card);
        if (form.curve != &sf_form_table)
            continue;
        for (int k = 0; k < 3; k++) { /* a lock-up: at two strains, and none */
            static const double locked[] = {0.25, 0.16, 0}, start[] = {0.7125, 0.798, 0},
                                limit[] = {0.75, 0.84, 1};
            sf_curve curve, own;
            double slope[2], at, energy;
            value[SF_PARAMETER_LOCKED] = locked[k];
            assert_int_equal(sf_foam_form_card(&form, value, &card, &err), SF_OK);
            assert_true(fabs(card.densification_start - start[k]) < 1e-12);
            assert_true(fabs(card.densification_limit - limit[k]) < 1e-8);
            assert_int_equal(sf_curve_build(&card, 0, &curve, &err), SF_OK);
            if (k < 2) {
                sf_curve_evaluate(&curve, start[k] - 1e-9, &at, &slope[0], &energy);
                sf_curve_evaluate(&curve, start[k] + 1e-9, &at, &slope[1], &energy);
                assert_true(fabs(slope[1] / slope[0] - 1) < 1e-3);
                sf_curve_evaluate(&curve, limit[k], &at, &slope[0], &energy);
                card.densification_start = 0;
                card.densification_limit = 1;
                card.densification_exponent = 0;
                assert_int_equal(sf_curve_build(&card, 0, &own, &err), SF_OK);
                sf_curve_evaluate(&own, limit[k], &at, &slope[1], &energy);
                assert_true(slope[0] > 100 * slope[1]);
                sf_curve_free(&own);
            }
            sf_curve_free(&curve);
            sf_foam_card_free(&card);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_form_rises_from_its_modulus_to_its_pole),
        cmocka_unit_test(medians_of_the_priors_are_a_foam),
        cmocka_unit_test(steep_forms_end_at_1_gpa),
        cmocka_unit_test(the_card_has_the_stress_of_the_closed_form),
        cmocka_unit_test(the_solid_fraction_moves_the_poles),
        cmocka_unit_test(a_lock_up_of_its_own_continues_the_form),
        cmocka_unit_test(the_spline_bends_where_its_parameter_says),
        cmocka_unit_test(values_that_make_no_curve_are_refused),
        cmocka_unit_test(a_fine_table_ends_at_1_gpa),
        cmocka_unit_test(a_card_has_the_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
