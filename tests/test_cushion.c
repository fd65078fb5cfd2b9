/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The drop of a flat mass on a block: a point against the foam law, the peak against an integration of its own
 * with steps of 1 us, filtered as softfall-post does it, and against the energy of a linear foam. */
#include "extreme.h"
#include "foam_fixture.h"
#include "post/figures/signal.h"
#include "study/cushion.h"
#include "post_check.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <stdlib.h>
#include <cmocka.h>

/* Compression, release, compression again at changing speed: the point is lane 0 of the batch. */
static void assert_uniaxial_is_the_law(const point_card *card) {
    sf_foam foam;
    sf_law_batch batch;
    sf_uniaxial point = {0};
    double dt = 2e-5, largest = 0, f[9];
    foam_build(card, &foam);
    foam_reset(&batch);
    for (int k = 1; k <= 3000; k++) {
        double strain = 0.75 * (1 - cos(0.004 * k)) / 2 * (1 + 0.2 * sin(0.011 * k));
        foam_uniaxial(1 - strain, f);
        foam_step(&foam, dt, f, &batch);
        double stress = sf_foam_uniaxial(&foam, dt, strain, &point);
        largest = larger(largest, fabs(stress));
        assert_true(fabs(stress + batch.p[0][0]) < 1e-9 * fmax(largest, 1));
    }
    assert_true(largest > 1e4);
    sf_foam_free(&foam);
}

static void point_is_the_foam_law(void **state) {
    (void)state;
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 120, 0.9, 1);
    assert_uniaxial_is_the_law(&card);
    card.card.shared.hysteresis_hu = 0.05;
    card.card.shared.hysteresis_shape = 2.5;
    card.card.shared.maxwell_modulus = 3e6;
    card.card.shared.maxwell_rate = 4000;
    card.card.shared.kelvin_viscosity = 300;
    assert_uniaxial_is_the_law(&card);
    point_card_add_eva(&card, 1, 120, 0.9, 1.2);
    point_card_add_eva(&card, 100, 120, 0.9, 1.5);
    card.card.curves.curve_rate[0] = 0.01;
    card.card.shared.rate_filter_time = 1e-4;
    assert_uniaxial_is_the_law(&card);
}

/* The peak by symplectic Euler steps of 1 us. */
static double peak_finely(const sf_cushion *c, const sf_material_law *law) {
    enum { MOST = 200000 };
    const double dt = 1e-6, mass = c->static_stress / SF_STANDARD_GRAVITY;
    sf_uniaxial point = {0};
    sf_error err = SF_ERROR_INIT;
    sf_series raw, before, uniform, read;
    double depth = 0, speed = sqrt(2 * SF_STANDARD_GRAVITY * c->height), peak = 0;
    int64_t n = 0;
    assert_int_equal(sf_series_create(MOST, &raw, &err), SF_OK);
    do {
        double stress = depth > 0 ? larger(0, law->law->uniaxial(law->numbers, dt, depth / c->thickness, &point)) : 0;
        raw.time[n] = dt * (double)n;
        raw.value[n++] = stress / mass / SF_STANDARD_GRAVITY;
        speed += dt * (SF_STANDARD_GRAVITY - stress / mass);
        depth += dt * speed;
    } while (n < MOST && !(speed < 0 && raw.value[n - 1] == 0));
    raw.count = n;
    assert_int_equal(sf_signal_lead_in(&raw, 5e-3, 0, &before, &err), SF_OK);
    assert_int_equal(sf_signal_resample(&before, 100e3, &uniform, &err), SF_OK);
    assert_int_equal(sf_signal_filter_cfc(&uniform, 1000, &read, &err), SF_OK);
    for (int64_t k = 0; k < read.count; k++)
        peak = larger(peak, read.value[k]);
    sf_series_free(&raw);
    sf_series_free(&before);
    sf_series_free(&uniform);
    sf_series_free(&read);
    return peak;
}

/* Soft to hard drops of foams with hysteresis, a Maxwell branch, Kelvin viscosity, curves at two rates. */
static void peak_is_that_of_fine_steps(void **state) {
    (void)state;
    static const struct {
        double hu, shape, maxwell, beta, kelvin;
        int curves;
    } foam[] = {{1, 1, 0, 1, 0, 1},        {0.01, 1, 0, 1, 0, 1},   {0.1, 2.5, 4e6, 5000, 0, 1},
                {0.01, 1, 1e6, 300, 0, 1}, {0.05, 1, 0, 1, 100, 1}, {0.05, 1, 0, 1, 0, 2}};
    static const sf_cushion block[] = {{2e3, 0.05, 0.3}, {5e3, 0.05, 0.6}, {10e3, 0.05, 0.6}, {20e3, 0.07, 0.5}};
    for (size_t k = 0; k < sizeof foam / sizeof foam[0]; k++) {
        point_card card;
        sf_foam built;
        point_card_init(&card);
        point_card_add_eva(&card, 0, 120, 0.9, 1);
        if (foam[k].curves == 2) {
            point_card_add_eva(&card, 100, 120, 0.9, 1.3);
            card.card.curves.curve_rate[0] = 0.01;
            card.card.shared.rate_filter_time = 1e-4;
        }
        card.card.shared.hysteresis_hu = foam[k].hu;
        card.card.shared.hysteresis_shape = foam[k].shape;
        card.card.shared.maxwell_modulus = foam[k].maxwell;
        card.card.shared.maxwell_rate = foam[k].beta;
        card.card.shared.kelvin_viscosity = foam[k].kelvin;
        foam_build(&card, &built);
        const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &built};
        for (size_t b = 0; b < sizeof block / sizeof block[0]; b++) {
            double peak;
            sf_error err = SF_ERROR_INIT;
            assert_int_equal(sf_cushion_peak(&block[b], &law, &peak, &err), SF_OK);
            assert_relative(peak, peak_finely(&block[b], &law), 1e-3);
        }
        sf_foam_free(&built);
    }
}

static sf_foam linear_foam(double modulus) {
    point_card card;
    sf_foam foam;
    point_card_init(&card);
    point_card_add_line(&card, modulus, 0.9);
    foam_build(&card, &foam);
    return foam;
}

/* On a linear foam k = E/H the mass swings: peak = 1 + sqrt(1 + 2 h k/(p)) of its weight p. */
static void peak_on_a_linear_foam_is_that_of_a_spring(void **state) {
    (void)state;
    sf_foam foam = linear_foam(0.3e6);
    double peak;
    sf_error err = SF_ERROR_INIT;
    const sf_cushion c = {.static_stress = 2e3, .thickness = 0.05, .height = 0.4};
    const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &foam};
    assert_int_equal(sf_cushion_peak(&c, &law, &peak, &err), SF_OK);
    assert_relative(peak, 1 + sqrt(1 + 2 * c.height * 0.3e6 / c.thickness / c.static_stress), 1e-3);
    sf_foam_free(&foam);
}

/* Beyond what the foam bears, one sentence. */
static void collapse_is_told(void **state) {
    (void)state;
    sf_foam foam = linear_foam(1e4);
    double peak;
    sf_error err = SF_ERROR_INIT;
    const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &foam};
    const sf_cushion heavy = {.static_stress = 1e10, .thickness = 0.07, .height = 2}, none = {.static_stress = 1e3, .thickness = 0.07};
    assert_int_equal(sf_cushion_peak(&heavy, &law, &peak, &err), SF_ERR_NUMERIC);
    assert_non_null(strstr(err.text, "collapsed at an indentation of"));
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_cushion_peak(&none, &law, &peak, &err), SF_ERR_INPUT);
    sf_foam_free(&foam);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(point_is_the_foam_law),
        cmocka_unit_test(peak_is_that_of_fine_steps),
        cmocka_unit_test(peak_on_a_linear_foam_is_that_of_a_spring),
        cmocka_unit_test(collapse_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
