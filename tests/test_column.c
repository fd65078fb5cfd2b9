/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The columns' drop against an integration of its own with steps of 1 us, filtered and evaluated as
 * softfall-post does it. */
#include "extreme.h"
#include "foam_fixture.h"
#include "post/figures/signal.h"
#include "study/column.h"

#include "base/units.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <time.h>
#include <stdlib.h>
#include <cmocka.h>

/* A sphere of 160 mm over a pad of 70 mm. */
static sf_columns columns_at(double speed) {
    sf_columns c = {.mass = 4.6, .speed = speed, .thickness = 0.07, .count = SF_COLUMNS};
    for (int k = 0; k < c.count; k++) {
        c.gap[k] = 0.07 * (k + 0.5) / c.count;
        c.area[k] = 2 * M_PI * (0.08 - c.gap[k]) * 0.07 / c.count;
    }
    return c;
}

static double force_at(const sf_columns *c, const sf_material_law *law, double dt, double depth,
                       sf_uniaxial *point) {
    double sum = 0;
    for (int k = 0; k < c->count && c->gap[k] < depth; k++)
        sum += c->area[k] *
               fmax(0, law->law->uniaxial(law->numbers, dt, (depth - c->gap[k]) / c->thickness, &point[k]));
    return sum;
}

/* The drop by symplectic Euler steps of 1 us. */
static sf_columns_figures drop_finely(const sf_columns *c, const sf_material_law *law) {
    enum { MOST = 200000 };
    const double dt = 1e-6;
    sf_uniaxial point[SF_COLUMNS] = {{0}};
    sf_error err = SF_ERROR_INIT;
    sf_series raw, before, uniform, read;
    sf_hic hic;
    double depth = 0, speed = c->speed, deepest = 0;
    int64_t n = 0;
    assert_int_equal(sf_series_create(MOST, &raw, &err), SF_OK);
    do {
        double f = force_at(c, law, dt, depth, point);
        raw.time[n] = dt * (double)n;
        raw.value[n++] = f / c->mass / SF_STANDARD_GRAVITY;
        speed += dt * (SF_STANDARD_GRAVITY - f / c->mass);
        depth += dt * speed;
        deepest = larger(deepest, depth);
    } while (n < MOST && !(speed < 0 && raw.value[n - 1] == 0));
    raw.count = n;
    assert_int_equal(sf_signal_lead_in(&raw, 5e-3, 0, &before, &err), SF_OK);
    assert_int_equal(sf_signal_resample(&before, 100e3, &uniform, &err), SF_OK);
    assert_int_equal(sf_signal_filter_cfc(&uniform, 1000, &read, &err), SF_OK);
    assert_int_equal(sf_hic_evaluate(&read, INFINITY, &hic, &err), SF_OK);
    sf_columns_figures figures = {.hic = hic.value,
                                  .hic_window = hic.t2 - hic.t1,
                                  .v_rebound = -speed,
                                  .contact_time = dt * (double)(n - 1),
                                  .strain = deepest / c->thickness};
    for (int64_t k = 0; k < read.count; k++)
        figures.a_max_g = larger(figures.a_max_g, read.value[k]);
    sf_series_free(&raw);
    sf_series_free(&before);
    sf_series_free(&uniform);
    sf_series_free(&read);
    return figures;
}

/* Relative differences; the largest of each figure so far. */
static void add_difference(const sf_columns_figures *a, const sf_columns_figures *b,
                           sf_columns_figures *worst) {
    worst->a_max_g = larger(worst->a_max_g, fabs(a->a_max_g / b->a_max_g - 1));
    worst->hic = larger(worst->hic, fabs(a->hic / b->hic - 1));
    worst->hic_window = larger(worst->hic_window, fabs(a->hic_window / b->hic_window - 1));
    worst->v_rebound = larger(worst->v_rebound, fabs(a->v_rebound / b->v_rebound - 1));
    worst->contact_time = larger(worst->contact_time, fabs(a->contact_time / b->contact_time - 1));
    worst->strain = larger(worst->strain, fabs(a->strain / b->strain - 1));
}

/* Soft to hard drops of foams with hysteresis, a Maxwell branch, Kelvin viscosity, curves at two rates. */
static void drop_is_that_of_fine_steps(void **state) {
    (void)state;
    static const struct {
        double hu, shape, maxwell, beta, kelvin;
        int curves;
    } foam[] = {{1, 1, 0, 1, 0, 1},        {0.01, 1, 0, 1, 0, 1},   {0.1, 2.5, 4e6, 5000, 0, 1},
                {0.01, 1, 1e6, 300, 0, 1}, {0.05, 1, 0, 1, 100, 1}, {0.05, 1, 0, 1, 0, 2}};
    static const double speed[] = {2, 4.5, 6.2, 7};
    enum { REPEATS = 20 };
    sf_columns_figures worst = {0};
    double time = 0;
    int drops = 0;
    for (size_t k = 0; k < sizeof foam / sizeof foam[0]; k++) {
        point_card card;
        sf_foam built;
        point_card_init(&card);
        point_card_add_eva(&card, 0, 120, 0.9, 1);
        if (foam[k].curves == 2) {
            point_card_add_eva(&card, 100, 120, 0.9, 1.3);
            card.card.curve_rate[0] = 0.01;
            card.card.rate_filter_time = 1e-4;
        }
        card.card.hysteresis_hu = foam[k].hu;
        card.card.hysteresis_shape = foam[k].shape;
        card.card.maxwell_modulus = foam[k].maxwell;
        card.card.maxwell_rate = foam[k].beta;
        card.card.kelvin_viscosity = foam[k].kelvin;
        foam_build(&card, &built);
        const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &built};
        for (size_t v = 0; v < sizeof speed / sizeof speed[0]; v++) {
            sf_columns c = columns_at(speed[v]);
            sf_columns_figures quick, fine = drop_finely(&c, &law);
            sf_error err = SF_ERROR_INIT;
            clock_t begin = clock();
            for (int i = 0; i < REPEATS; i++)
                assert_int_equal(sf_columns_respond(&c, &law, &quick, NULL, &err), SF_OK);
            time += (double)(clock() - begin) / CLOCKS_PER_SEC / REPEATS;
            drops++;
            add_difference(&quick, &fine, &worst);
        }
        sf_foam_free(&built);
    }
    print_message("%.3g ms per drop with its figures; ", 1e3 * time / drops);
    print_message("largest differences: a_max %.2g, HIC %.2g, window %.2g, rebound speed %.2g, contact time "
                  "%.2g, strain %.2g\n",
                  worst.a_max_g, worst.hic, worst.hic_window, worst.v_rebound, worst.contact_time,
                  worst.strain);
    assert_true(worst.a_max_g < 1e-3 && worst.hic < 2e-3 && worst.hic_window < 2e-3);
    assert_true(worst.v_rebound < 2e-3 && worst.contact_time < 3e-3 && worst.strain < 1e-4);
}

/* Derivatives by speed from differences of 0.1 %, as space mapping takes them, are those of wide differences:
 * the steps' places do not show. */
static void figures_change_smoothly(void **state) {
    (void)state;
    enum { FIGURES = SF_COLUMNS_LOGARITHMS };
    point_card card;
    sf_foam foam;
    double worst[FIGURES] = {0};
    point_card_init(&card);
    point_card_add_eva(&card, 0, 120, 0.9, 1);
    card.card.hysteresis_hu = 0.01;
    card.card.maxwell_modulus = 2e6;
    card.card.maxwell_rate = 5000;
    foam_build(&card, &foam);
    const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &foam};
    for (int k = 0; k < 12; k++) {
        double y[4][FIGURES], speed = 4.5 + 0.13 * k;
        const double shift[4] = {-0.01, -0.001, 0.001, 0.01};
        for (int i = 0; i < 4; i++) {
            sf_columns c = columns_at(speed * (1 + shift[i]));
            sf_columns_figures figures;
            sf_error err = SF_ERROR_INIT;
            assert_int_equal(sf_columns_respond(&c, &law, &figures, NULL, &err), SF_OK);
            sf_columns_scale(&figures, y[i]);
        }
        for (int j = 0; j < FIGURES; j++)
            worst[j] = larger(worst[j], fabs((y[2][j] - y[1][j]) / 0.002 - (y[3][j] - y[0][j]) / 0.02));
    }
    print_message("derivatives differ by %.2g, %.2g, %.2g, %.2g, %.2g, %.2g at most\n", worst[0], worst[1],
                  worst[2], worst[3], worst[4], worst[5]);
    for (int j = 0; j < FIGURES; j++)
        assert_true(worst[j] < 0.05);
    sf_foam_free(&foam);
}

/* Beyond what the foam bears, one sentence. */
static void collapse_is_told(void **state) {
    (void)state;
    point_card card;
    sf_foam foam;
    sf_columns_figures figures;
    sf_error err = SF_ERROR_INIT;
    sf_columns c = columns_at(6);
    point_card_init(&card);
    point_card_add_line(&card, 1e4, 0.9);
    foam_build(&card, &foam);
    const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &foam};
    c.mass = 1e7;
    assert_int_equal(sf_columns_respond(&c, &law, &figures, NULL, &err), SF_ERR_NUMERIC);
    assert_non_null(strstr(err.text, "collapsed at an indentation of"));
    sf_foam_free(&foam);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(drop_is_that_of_fine_steps),
        cmocka_unit_test(figures_change_smoothly),
        cmocka_unit_test(collapse_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
