/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is computed and drawn of the rows of a campaign, of which the drops are replaced by a formula. */
#include "post_check.h"
#include "sweep_fixture.h"

#include "study/sweep/sweep_report.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Counts: below at x <= 3 (hic 1000 at 3), all of y alike. */
static void the_probability_is_over_what_is_uncertain(void **state) {
    sweep_evaluated done;
    const sf_analysis *a = &done.a;
    sweep_evaluate_plan(*state, SWEEP_GRID, 3, &done);
    assert_int_equal(a->probability.cells, 10);
    for (int k = 0; k < 10; k++) {
        const sf_probability *hic = &a->probability.cell[a->probability.cells + k];
        double x = 1 + 3 * k / 9.0;
        assert_int_equal(hic->unknown, k == 0);
        assert_int_equal(hic->below, x < 3 - 1e-9 ? 6 - (k == 0) : 0);
        assert_int_equal(hic->above, x < 3 - 1e-9 ? 0 : 6);
        assert_int_equal(hic->within, k >= 5 && k <= 7 ? 6 : 0); /* from 981 to 1020 */
    }
    sweep_free_evaluated(&done);
    /* whole, so that means are over the same rows: a_max moves by 100 with x, by 5/3 with y */
    sweep_evaluate_plan(*state, SWEEP_GRID, -1, &done);
    assert_relative(a->effect[0][0].last - a->effect[0][0].first, 100, 1e-8);
    assert_relative(a->effect[0][1].high - a->effect[0][1].low, 5.0 / 3, 1e-6);
    assert_true(a->surface[1].fit.q2 > 0.999999); /* hic is linear */
    sweep_free_evaluated(&done);
}

/* Of 40,000 rows every second one would be of the same level of the factor that changes fastest. */
static void a_surface_of_very_many_rows_has_every_level(void **state) {
    sweep_evaluated done;
    sweep_evaluate_plan(
        *state,
        "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 20000; }, { key = \"a.y\"; values = [1, 2]; }", -1,
        &done);
    const sf_sweep_surface *surface = &done.a.surface[1];
    assert_string_equal(surface->fit.problem, "");
    assert_int_equal(surface->rows, SF_SURFACE_ROWS);
    assert_int_equal(surface->of, 40000);
    assert_true(surface->fit.q2 > 0.999999); /* hic is linear */
    sweep_free_evaluated(&done);
}

static const char *const SAMPLED_DRAWS = "{ sample = \"latin_hypercube\"; count = 40; of = ("
                                         "{ key = \"a.x\"; low = 1.0; high = 4.0; },"
                                         "{ key = \"a.y\"; values = [1, 2]; },"
                                         "{ key = \"material\"; posterior = \"ten\"; } ); }";

/* Twenty rows, each of other numbers: no mean of one row is an effect. a_max = 100 sqrt(x) + y / 3 has 100
 * from x and 3 from y between 0 and 9, the surface is off by 1 or so; z does nothing. */
static void numbers_that_are_sampled_have_the_effect_of_the_surface(void **state) {
    sweep_evaluated done;
    sweep_evaluate_plan(
        *state,
        "{ sample = \"latin_hypercube\"; count = 20; of = ( { key = \"a.x\"; low = 1.0; high = 4.0; },"
        "{ key = \"a.y\"; low = 0.0; high = 9.0; }, { key = \"a.z\"; low = 0.0; high = 1.0; } ); }",
        -1, &done);
    assert_true(done.a.surface[0].fit.q2 > 0.99);
    const sf_effect *e = done.a.effect[0];
    const double expected[3] = {100 * (sqrt(4) - sqrt(1)), 3, 0};
    for (int k = 0; k < 3; k++) {
        const double *value = done.plan.factor[k].value;
        double range = k == 0 ? 3 : k == 1 ? 9 : 1, least = INFINITY, greatest = -INFINITY;
        for (int row = 0; row < 20; row++) {
            least = value[row] < least ? value[row] : least;
            greatest = value[row] > greatest ? value[row] : greatest;
        }
        assert_close(e[k].last - e[k].first, expected[k] * (greatest - least) / range, 4);
        assert_true(e[k].low <= e[k].first && e[k].high >= e[k].last);
    }
    sweep_free_evaluated(&done);
}

/* A run of x = 1 fails: without it the mean of its y would be that of greater x, 22 more than that of the
 * other y. */
static void main_effects_are_over_combinations_that_are_whole(void **state) {
    sweep_evaluated done;
    sweep_evaluate_plan(*state, SWEEP_GRID, 3, &done);
    const sf_effect *x = &done.a.effect[0][0], *y = &done.a.effect[0][1];
    assert_int_equal(x->used, 5);
    assert_int_equal(x->of, 6);
    assert_int_equal(y->used, 9);
    assert_int_equal(y->of, 10);
    assert_relative(x->last - x->first, 100, 1e-8);
    assert_relative(y->high - y->low, 5.0 / 3, 1e-6);
    sweep_free_evaluated(&done);
}

static void draws_that_are_sampled_with_others_have_no_main_effect(void **state) {
    sweep_evaluated done;
    sweep_make_posterior(*state);
    sweep_evaluate_plan(*state, SAMPLED_DRAWS, -1, &done);
    assert_true(isnan(done.a.effect[0][2].low) && isnan(done.a.effect[0][2].high));
    assert_true(done.a.effect[0][0].high > done.a.effect[0][0].low);
    assert_true(sf_effect_is_scatter(&done.plan, 2));
    done.plan.block[done.plan.block_of[2]].rows =
        SF_EFFECT_RUNS * done.plan.factor[2].count; /* so many have a mean */
    assert_false(sf_effect_is_scatter(&done.plan, 2));
    done.plan.block[done.plan.block_of[2]].rows = 40;
    sweep_free_evaluated(&done);
    sweep_evaluate_plan(*state,
                        "{ key = \"a.x\"; values = [1, 2]; }, { key = \"material\"; posterior = \"ten\"; }",
                        -1, &done); /* crossed: a_max moves by 9/3 with the index of the draw */
    assert_relative(done.a.effect[0][1].high - done.a.effect[0][1].low, 0.9 * 3, 1e-6);
    sweep_free_evaluated(&done);
}

/* Ten draws in 40 rows are ten foams. */
static void draws_that_are_sampled_count_once_in_the_interval(void **state) {
    sweep_evaluated done;
    sweep_make_posterior(*state);
    sweep_evaluate_plan(*state, SAMPLED_DRAWS, -1, &done);
    assert_int_equal(done.a.probability.cells, 1);
    sf_probability ten = done.a.probability.cell[1];
    assert_int_equal(ten.below + ten.above, 40);
    sf_probability_judge(&ten, 10);
    assert_close(done.a.probability.cell[1].low, ten.low, 1e-12);
    assert_close(done.a.probability.cell[1].high, ten.high, 1e-12);
    sweep_free_evaluated(&done);
}

/* Six rows of three words. */
static void a_word_that_a_zip_repeats_is_one_level(void **state) {
    sweep_evaluated done;
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    sweep_evaluate_plan(
        *state,
        "{ zip = ( { key = \"a.x\"; values = [1, 1, 1, 4, 4, 4]; },"
        "{ key = \"pad.base\"; values = [\"glued\", \"glued\", \"smooth\", \"smooth\", \"glued\","
        " \"resting\"]; } ); }",
        -1, &done);
    static const int level[] = {0, 0, 1, 1, 0, 2};
    assert_int_equal(done.plan.rows, 6);
    assert_int_equal(done.plan.factor[1].count, 3);
    for (int64_t row = 0; row < 6; row++)
        assert_int_equal((int)sf_plan_value(&done.plan, 1, row), level[row]);
    sf_plan_overrides(&done.plan, 5, text, NULL);
    assert_string_equal(text[1], "pad.base=\"resting\"");
    /* of a_max: glued 100, 100, 200; smooth 100 + 1/3, 200 + 1/3; resting 200 + 2/3 */
    assert_relative(done.a.effect[0][1].low, 400.0 / 3, 1e-8);
    assert_relative(done.a.effect[0][1].high, 200 + 2.0 / 3, 1e-8);
    sweep_free_evaluated(&done);
}

/* Scripts and pictures of a campaign, beside runs.csv. */
static void draw(const program_place *p, const sf_analysis *a) {
    static const char *const names[] = {"factors.gp",     "factors.png",     "curves.gp",  "curves.png",
                                        "effects.gp",     "effects.png",     "surface.gp", "surface.png",
                                        "probability.gp", "probability.png", NULL};
    char warning[320];
    sf_staging output = {0};
    sf_error err = SF_ERROR_INIT;
    if (sf_staging_begin(program_path(p, "drawn"), names, true, &output, &err) != SF_OK ||
        sf_sweep_plot(&output, a, p->folder, warning, sizeof warning, &err) != SF_OK ||
        sf_staging_commit(&output, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_staging_end(&output);
    assert_string_equal(warning, "");
}

/* Of one run there is no effect, and a figure may be of no run: gnuplot ends where all of a panel is NaN. */
static void panels_without_data_are_left_out(void **state) {
    const program_place *p = *state;
    sweep_evaluated done;
    sweep_evaluate_plan(p, "{ key = \"a.x\"; values = [1]; }, { key = \"a.y\"; values = [1]; }", -1, &done);
    draw(p, &done.a);
    assert_int_equal(program_shell(p, "test -s drawn/factors.png && test ! -e drawn/effects.gp").code, 0);
    sweep_free_evaluated(&done);
    static const char *const chosen[] = {"", "{ key = \"a.z\"; values = [1, 2]; },"}; /* intervals, a map */
    for (int k = 0; k < 2; k++) {
        char factors[512];
        snprintf(
            factors, sizeof factors,
            "{ key = \"a.x\"; values = [1, 2, 3]; }, %s { key = \"a.y\"; uncertain = true; values = [1, 2]; } );"
            "figures = ( { key = \"peak_stress_kPa\"; limit = 9.0; }, { key = \"hic\"; limit = 1000.0; }",
            chosen[k]);
        sweep_evaluate_plan(p, factors, -1, &done);
        draw(p, &done.a);
        assert_int_equal(program_shell(p,
                                       "test -s drawn/factors.png && test -s drawn/effects.png && "
                                       "test -s drawn/probability.png && ! grep peak_stress drawn/effects.gp")
                             .code,
                         0);
        sweep_free_evaluated(&done);
    }
}

/* Every 14th of 40,000 rows would be of the first level of the factor that changes fastest. */
static void the_points_of_a_picture_are_of_every_level(void **state) {
    const program_place *p = *state;
    sweep_evaluated done;
    sweep_evaluate_plan(
        p, "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 20000; }, { key = \"a.y\"; values = [1, 2]; }", -1,
        &done);
    draw(p, &done.a);
    /* The second panel is the first figure against a.y. */
    int of_one = atoi(program_shell(p, "sed -n '/^$d1_/,/^EOD/p' drawn/factors.gp | grep -c '^1,'").out),
        of_two = atoi(program_shell(p, "sed -n '/^$d1_/,/^EOD/p' drawn/factors.gp | grep -c '^2,'").out);
    if (of_one + of_two < 2900 || of_one + of_two > 3100 || abs(of_one - of_two) > 300)
        fail_msg("%d and %d points", of_one, of_two);
    sweep_free_evaluated(&done);
}

/* A factor of one number is as good as one of the case. */
static void a_factor_of_one_value_is_not_in_the_surface(void **state) {
    sweep_evaluated done;
    char term[100];
    sweep_evaluate_plan(
        *state,
        "{ key = \"a.z\"; from = 1.0; to = 4.0; count = 10; }, { key = \"a.y\"; values = [5]; },"
        "{ key = \"a.x\"; values = [1, 2, 3]; }",
        -1, &done);
    const sf_quadratic *fit = &done.a.surface[1].fit;
    assert_string_equal(fit->problem, "");
    assert_int_equal(fit->d, 2);
    assert_true(fit->q2 > 0.999999); /* hic is linear */
    sf_analysis_term(&done.a, fit, 2, term, sizeof term);
    assert_string_equal(term, "a.x");
    sweep_free_evaluated(&done);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_probability_is_over_what_is_uncertain),
        cmocka_unit_test(a_surface_of_very_many_rows_has_every_level),
        cmocka_unit_test(numbers_that_are_sampled_have_the_effect_of_the_surface),
        cmocka_unit_test(main_effects_are_over_combinations_that_are_whole),
        cmocka_unit_test(draws_that_are_sampled_with_others_have_no_main_effect),
        cmocka_unit_test(draws_that_are_sampled_count_once_in_the_interval),
        cmocka_unit_test(a_word_that_a_zip_repeats_is_one_level),
        cmocka_unit_test(panels_without_data_are_left_out),
        cmocka_unit_test(the_points_of_a_picture_are_of_every_level),
        cmocka_unit_test(a_factor_of_one_value_is_not_in_the_surface),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
