/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The columns: a point against the foam law, their areas against the closed form of a sphere, and their drop
 * against its energy and an integration of its own with steps of 1 us, filtered and evaluated as
 * softfall-post does it. */
#include "extreme.h"
#include "foam_fixture.h"
#include "study/column.h"
#include "study/fit/form/form.h"
#include "post_check.h"

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
            c.informed = 0.4;
            sf_error err = SF_ERROR_INIT;
            assert_int_equal(sf_columns_respond(&c, &law, &figures, NULL, &err), SF_OK);
            sf_columns_scale(&figures, y[i]);
        }
        for (int j = 0; j < FIGURES; j++)
            worst[j] = larger(worst[j], fabs((y[2][j] - y[1][j]) / 0.002 - (y[3][j] - y[0][j]) / 0.02));
    }
    print_message("derivatives differ by %.2g, %.2g, %.2g, %.2g, %.2g, %.2g, %.2g at most\n", worst[0],
                  worst[1], worst[2], worst[3], worst[4], worst[5], worst[6]);
    for (int j = 0; j < FIGURES; j++)
        assert_true(worst[j] < 0.05);
    sf_foam_free(&foam);
}

/* Returns the integral over u of u^2 (R - depth + u), to which the work of a linear foam is proportional. */
static double linear_work(double depth, double from) {
    return (0.08 - depth) * (pow(depth, 3) - pow(from, 3)) / 3 + (pow(depth, 4) - pow(from, 4)) / 4;
}

static void work_beyond_the_data_is_that_of_a_linear_foam(void **state) {
    (void)state;
    point_card card;
    sf_foam foam;
    sf_error err = SF_ERROR_INIT;
    point_card_init(&card);
    point_card_add_line(&card, 4e5, 0.95);
    foam_build(&card, &foam);
    const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &foam};
    for (double informed = 0.05; informed < 0.75; informed += 0.05) {
        sf_columns_figures figures;
        sf_columns c = columns_at(4.5);
        c.informed = informed;
        assert_int_equal(sf_columns_respond(&c, &law, &figures, NULL, &err), SF_OK);
        double depth = figures.strain * c.thickness, from = informed * c.thickness;
        double share = from < depth ? linear_work(depth, from) / linear_work(depth, 0) : 0;
        assert_true(fabs(figures.beyond - share) < 0.015);
        c.informed = 0;
        assert_int_equal(sf_columns_respond(&c, &law, &figures, NULL, &err), SF_OK);
        assert_true(figures.beyond == 0);
    }
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

static const sf_gas_curve eva = {0.4136e6, 7.4e3, 134e3, 23e3, 2.8, 0};

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

static void column_point_is_the_foam_law(void **state) {
    (void)state;
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 120, 0.9, 1);
    assert_uniaxial_is_the_law(&card);
    card.card.hysteresis_hu = 0.05;
    card.card.hysteresis_shape = 2.5;
    card.card.maxwell_modulus = 3e6;
    card.card.maxwell_rate = 4000;
    card.card.kelvin_viscosity = 300;
    assert_uniaxial_is_the_law(&card);
    point_card_add_eva(&card, 1, 120, 0.9, 1.2);
    point_card_add_eva(&card, 100, 120, 0.9, 1.5);
    card.card.curve_rate[0] = 0.01;
    card.card.rate_filter_time = 1e-4;
    assert_uniaxial_is_the_law(&card);
}

/* A missile whose surface is a fine spherical cap over a wide pad. */
static void columns_are_the_closed_form(void **state) {
    (void)state;
    enum { RINGS = 60, SECTORS = 60 };
    static double position[3 * (RINGS + 1) * SECTORS];
    static int32_t triangle[6 * RINGS * SECTORS];
    const double radius = 0.08, thickness = 0.07;
    double pad[] = {-1, -1, 0, 1, 1, 0};
    sf_results r = {.node_count = 2,
                    .position = pad,
                    .surface_node_count = (RINGS + 1) * SECTORS,
                    .surface_position = position,
                    .surface_triangle = triangle,
                    .symmetry_factor = 1,
                    .thickness = thickness,
                    .missile_mass = 4.6,
                    .missile_speed = 5,
                    .missile_direction = {0, 0, -1}};
    for (int i = 0; i <= RINGS; i++)
        for (int j = 0; j < SECTORS; j++) {
            double polar = 0.5 * M_PI * i / RINGS, angle = 2 * M_PI * j / SECTORS,
                   *x = &position[3 * (i * SECTORS + j)];
            x[0] = radius * sin(polar) * cos(angle);
            x[1] = radius * sin(polar) * sin(angle);
            x[2] = radius * (1 - cos(polar));
        }
    for (int i = 0; i < RINGS; i++)
        for (int j = 0; j < SECTORS; j++) {
            int a = i * SECTORS + j, b = i * SECTORS + (j + 1) % SECTORS;
            const int32_t two[6] = {a, b,           a + SECTORS,
                                    b, b + SECTORS, a + SECTORS}; /* normals outwards: down */
            memcpy(&triangle[6 * r.surface_triangle_count / 2], two, sizeof two);
            r.surface_triangle_count += 2;
        }
    sf_columns c;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_columns_build(&r, &c, &err), SF_OK);
    assert_true(c.mass == 4.6 && c.speed == 5);
    double depth = 0.05, sum = 0, closed = 0, energy = 0;
    for (int k = 0; k < c.count && c.gap[k] < depth; k++)
        sum += c.area[k] * sf_gas_curve_stress(&eva, (depth - c.gap[k]) / thickness);
    int n = 20000; /* F = 2 pi H [(R - delta) W + H int e sigma] */
    for (int k = 0; k < n; k++) {
        double strain = depth / thickness * (k + 0.5) / n, part = depth / thickness / n;
        energy += part * sf_gas_curve_stress(&eva, strain);
        closed += part * strain * sf_gas_curve_stress(&eva, strain);
    }
    closed = 2 * M_PI * thickness * ((radius - depth) * energy + thickness * closed);
    assert_true(fabs(sum / closed - 1) < 0.01);
}

static void column_drop_keeps_energy(void **state) {
    (void)state;
    point_card card;
    sf_foam foam;
    sf_series curve;
    sf_error err = SF_ERROR_INIT;
    sf_columns c = {.mass = 2, .speed = 3, .thickness = 0.05, .count = 1, .area = {0.01}, .gap = {0}};
    point_card_init(&card); /* no hysteresis, no viscosity: the rebound is the impact */
    point_card_add_eva(&card, 0, 120, 0.9, 1);
    foam_build(&card, &foam);
    const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &foam};
    double impulse = 0;
    sf_columns_figures figures;
    assert_int_equal(sf_columns_drop(&c, &law, &curve, &figures, &err), SF_OK);
    for (int64_t k = 1; k < curve.count; k++)
        impulse +=
            0.5 * (curve.value[k] + curve.value[k - 1] - 2) * 9.80665 * (curve.time[k] - curve.time[k - 1]);
    assert_true(fabs(impulse / (2 * c.speed) - 1) < 2e-3);
    sf_series_free(&curve);
    sf_foam_free(&foam);
}

/* The figures of the columns are those of the filtered reading F/m, from free flight to the rebound. */
static void column_figures_are_those_of_the_reading(void **state) {
    (void)state;
    point_card card;
    sf_foam foam;
    sf_series raw, read;
    sf_columns_figures figures;
    sf_hic hic;
    sf_error err = SF_ERROR_INIT;
    sf_columns c = {.mass = 2, .speed = 3, .thickness = 0.05, .count = 1, .area = {0.01}, .gap = {0}};
    point_card_init(&card);
    point_card_add_eva(&card, 0, 120, 0.9, 1);
    foam_build(&card, &foam);
    const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &foam};
    assert_int_equal(sf_columns_drop(&c, &law, &raw, &figures, &err), SF_OK);
    assert_int_equal(sf_columns_respond(&c, &law, &figures, &read, &err), SF_OK);
    assert_int_equal(sf_hic_evaluate(&read, INFINITY, &hic, &err), SF_OK);
    double peak = 0;
    for (int64_t k = 0; k < raw.count; k++)
        peak = larger(peak, raw.value[k]);
    assert_true(raw.value[0] == 0 && fabs(read.value[0]) < 1e-6); /* free flight: 0, not -1 g */
    assert_true(fabs(figures.a_max_g / peak - 1) < 2e-3);
    assert_true(fabs(figures.hic / hic.value - 1) < 2e-3);
    assert_true(fabs(figures.hic_window / (hic.t2 - hic.t1) - 1) < 5e-3);
    assert_true(fabs(figures.v_rebound / c.speed - 1) < 5e-3); /* no loss */
    assert_true(fabs(figures.contact_time - raw.time[raw.count - 1]) < 1e-4);
    sf_series_free(&raw);
    sf_series_free(&read);
    sf_foam_free(&foam);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(column_point_is_the_foam_law),
        cmocka_unit_test(columns_are_the_closed_form),
        cmocka_unit_test(column_drop_keeps_energy),
        cmocka_unit_test(column_figures_are_those_of_the_reading),
        cmocka_unit_test(drop_is_that_of_fine_steps),
        cmocka_unit_test(figures_change_smoothly),
        cmocka_unit_test(work_beyond_the_data_is_that_of_a_linear_foam),
        cmocka_unit_test(collapse_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
