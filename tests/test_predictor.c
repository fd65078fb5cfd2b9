/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predictions by Gaussian processes, and campaigns that simulate only the rows which these need; a formula
 * stands in place of the drops. */
#include "model_fixture.h"
#include "program_fixture.h"
#include "sweep_fixture.h"

#include "base/units.h"
#include "study/column.h"
#include "study/sweep/adaptive.h"
#include "study/sweep/analysis.h"
#include <gsl/gsl_rng.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* ---- one process ---- */

enum { INPUTS = 3, POINTS = 60 };
static const bool words[INPUTS] = {false, false, true};

/* A smooth function of two numbers, with another phase and size for each of three words. */
static double function(const double *x, double phase) {
    return (1 + 0.2 * x[2]) * sin(3 * x[0] + phase) + x[1] * x[1] + 0.5 * x[0] * x[1] + 0.3 * x[2];
}

static void draw_point(gsl_rng *random, double *x) {
    x[0] = gsl_rng_uniform(random);
    x[1] = gsl_rng_uniform(random);
    x[2] = (double)gsl_rng_uniform_int(random, 3);
}

static void fit(gsl_rng *random, double phase, double scatter, double *x, double *y, sf_predictor *p) {
    sf_error err = SF_ERROR_INIT;
    for (int k = 0; k < POINTS; k++) {
        draw_point(random, x + k * INPUTS);
        y[k] = function(x + k * INPUTS, phase) + scatter * (gsl_rng_uniform(random) - 0.5);
    }
    if (sf_predictor_fit(INPUTS, words, POINTS, x, y, p, &err) != SF_OK)
        fail_msg("%s", err.text);
}

static void a_process_meets_its_points_and_knows_nothing_far_away(void **state) {
    (void)state;
    double x[POINTS * INPUTS], y[POINTS], room[POINTS], mean, deviation, far[INPUTS] = {1e4, 1e4, 7};
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    sf_predictor p;
    fit(random, 0.3, 0, x, y, &p);
    for (int k = 0; k < POINTS; k++) {
        sf_predictor_at(&p, x + k * INPUTS, room, &mean, &deviation);
        assert_true(fabs(mean - y[k]) < 1e-3);
    }
    sf_predictor_at(&p, far, room, &mean, &deviation);
    assert_true(fabs(mean - p.mean) < 1e-9);
    assert_true(deviation >= p.calibration * p.deviation);
    sf_predictor_free(&p);
    gsl_rng_free(random);
}

static void an_input_without_influence_gets_a_long_length(void **state) {
    (void)state;
    const bool numbers[2] = {false, false};
    double x[2 * POINTS], y[POINTS];
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    sf_error err = SF_ERROR_INIT;
    sf_predictor p;
    for (int k = 0; k < POINTS; k++) {
        x[2 * k] = gsl_rng_uniform(random);
        x[2 * k + 1] = gsl_rng_uniform(random);
        y[k] = sin(6 * x[2 * k]);
    }
    assert_int_equal(sf_predictor_fit(2, numbers, POINTS, x, y, &p, &err), SF_OK);
    assert_true(p.length[1] > 10 * p.length[0]);
    assert_true(p.nugget < 1e-3);
    sf_predictor_free(&p);
    gsl_rng_free(random);
}

/* Over 40 functions, with and without scatter: the 95 % intervals hold 93 to 99.5 % of 8000 other points. */
static void intervals_hold_what_they_say(void **state) {
    (void)state;
    double x[POINTS * INPUTS], y[POINTS], room[POINTS], mean, deviation, at[INPUTS];
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    for (int scattered = 0; scattered < 2; scattered++) {
        int held = 0, all = 0;
        for (int trial = 0; trial < 40; trial++) {
            double phase = 6 * gsl_rng_uniform(random), scatter = scattered ? 0.05 : 0;
            sf_predictor p;
            fit(random, phase, scatter, x, y, &p);
            for (int k = 0; k < 100; k++, all++) {
                draw_point(random, at);
                sf_predictor_at(&p, at, room, &mean, &deviation);
                double value = function(at, phase) + scatter * (gsl_rng_uniform(random) - 0.5);
                held += fabs(mean - value) <= SF_PREDICTOR_SIDES * deviation;
            }
            sf_predictor_free(&p);
        }
        printf("intervals of 95 %%%s hold %.1f %%\n", scattered ? " with scatter" : "", 100. * held / all);
        assert_in_range(held, 0.93 * all, 0.995 * all);
    }
    gsl_rng_free(random);
}

/* With eight inputs of which three matter, so few points do not tell the lengths, and the process is too
 * sure: over 60 functions its intervals hold less than 93 % of 6000 other points, and 93 to 99.5 % once they
 * are widened by points left out. The share of points left out that they held before is that of the other
 * points. Of 40 points one process in ten holds less than 93 % (one in five by the 95 % quantile of the
 * points left out). At 21 points the processes that learn seven eighths have too few to be calibrated. */
static void check_widening(int few) {
    enum { MANY = 8, MOST = 40, TRIALS = 60, OTHERS = 100 };
    const bool numbers[MANY] = {false};
    double x[(MOST + OTHERS) * MANY], y[MOST + OTHERS], room[MOST], mean, deviation;
    int before = 0, after = 0, left_out = 0, low = 0;
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    for (int trial = 0; trial < TRIALS; trial++) {
        sf_error err = SF_ERROR_INIT;
        sf_predictor p;
        double phase = 6 * gsl_rng_uniform(random);
        for (int k = 0; k < few + OTHERS; k++) {
            double *at = x + k * MANY;
            for (int i = 0; i < MANY; i++)
                at[i] = gsl_rng_uniform(random);
            y[k] = sin(5 * at[0] + phase) * (1 + at[1]) + fabs(at[2] - 0.4) + 0.3 * at[1] * at[2];
        }
        assert_int_equal(sf_predictor_fit(MANY, numbers, few, x, y, &p, &err), SF_OK);
        double own = p.calibration;
        int held = 0;
        assert_int_equal(sf_predictor_validate(&p, y, &held, &err), SF_OK);
        assert_true(p.calibration >= own && held <= few);
        left_out += held;
        int own_after = 0;
        for (int k = few; k < few + OTHERS; k++) {
            sf_predictor_at(&p, x + k * MANY, room, &mean, &deviation);
            double half = SF_PREDICTOR_SIDES * deviation, off = fabs(y[k] - mean);
            own_after += off <= half;
            before += off <= half / p.calibration * own;
        }
        after += own_after;
        low += own_after < 93;
        sf_predictor_free(&p);
    }
    double share = 100. * before / (TRIALS * OTHERS), widened = 100. * after / (TRIALS * OTHERS),
           told = 100. * left_out / (TRIALS * few);
    printf(
        "%d points: intervals hold %.1f %%, of points left out %.1f %%, and widened %.1f %%; %d of %d less "
        "than 93 %%\n",
        few, share, told, widened, low, TRIALS);
    assert_true(share < 93 && fabs(told - share) < 6);
    assert_true(widened > 93 && widened < 99.5);
    assert_true(few < 32 || low <= 0.15 * TRIALS); /* the largest of less cannot promise that */
    gsl_rng_free(random);
}

static void intervals_are_widened_by_points_left_out(void **state) {
    (void)state;
    check_widening(40);
    check_widening(21);
}

/* Points that are chosen together are those that would be chosen one after another, each computed in between,
 * as the deviation does not depend on the output. */
static void points_are_chosen_as_if_one_after_another(void **state) {
    (void)state;
    enum { CANDIDATES = 50, CHOSEN = 6 };
    double x[(POINTS + CHOSEN) * INPUTS], y[POINTS + CHOSEN], candidate[CANDIDATES * INPUTS],
        wish[CANDIDATES], room[POINTS + CHOSEN], mean, deviation;
    int chosen[CHOSEN];
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    sf_predictor p;
    fit(random, 1.1, 0.02, x, y, &p);
    for (int c = 0; c < CANDIDATES; c++) {
        draw_point(random, candidate + c * INPUTS);
        wish[c] = 1e-9 * (1 + c % 3);
    }
    assert_int_equal(sf_predictor_choose(&p, CANDIDATES, candidate, wish, CHOSEN, chosen), CHOSEN);
    double largest = 0;
    int first = -1;
    for (int c = 0; c < CANDIDATES; c++) {
        sf_predictor_at(&p, candidate + c * INPUTS, room, &mean, &deviation);
        if (deviation / wish[c] > largest) {
            largest = deviation / wish[c];
            first = c;
        }
    }
    assert_int_equal(chosen[0], first);
    for (int i = 0; i < CHOSEN; i++)
        for (int j = 0; j < i; j++)
            assert_int_not_equal(chosen[i], chosen[j]);
    for (int c = 0; c < CANDIDATES; c++)
        wish[c] = 100;
    assert_int_equal(sf_predictor_choose(&p, CANDIDATES, candidate, wish, CHOSEN, chosen), 0);
    sf_predictor_free(&p);
    gsl_rng_free(random);
}

/* ---- campaigns ---- */

static const char *const PLAN =
    "{ sample = \"latin_hypercube\"; count = 300; of = ("
    "{ key = \"a.speed\"; low = 3.0; high = 6.0; }, { key = \"a.mass\"; low = 3.0; high = "
    "6.0; }, { key = \"a.thickness\"; low = 40.0; high = 80.0; } ); },"
    "{ key = \"a.kind\"; values = (\"soft\", \"hard\", \"new\"); }";

/* A pad on which the missile comes to rest by the energy m v^2 / (stress area thickness); it fails near the
 * anvil. */
static void pad(const sf_plan *plan, int64_t row, double *a_max, double *hic, double *strain) {
    static const double stress[] = {0.8, 1.0, 1.3};
    double v = sf_plan_value(plan, 0, row), m = sf_plan_value(plan, 1, row), h = sf_plan_value(plan, 2, row),
           s = plan->factor_count > 3 ? stress[(int)sf_plan_value(plan, 3, row)] : 2,
           energy = 0.8 * m * v * v / (s * h);
    *strain = 1 - exp(-energy);
    *a_max = 180 * s / m * (0.3 + energy) / sqrt(1.02 - *strain);
    *hic = 1.2 * pow(*a_max, 1.4) * v;
}

/* Time of contact (ms); the run of the case ends after 40 ms. */
static double contact_of(const sf_plan *plan, int64_t row) {
    return 1.35 * sf_plan_value(plan, 1, row) * sqrt(sf_plan_value(plan, 2, row)) /
           pow(sf_plan_value(plan, 0, row), 0.3);
}

enum { RUN_END = 40 };

typedef struct formula {
    int64_t calls, stop_at;
    bool coarse; /* of coarse drops: softer, and a little nearer to the anvil */
    int ends;    /* 1: runs end, some of them in contact: then they have no rebound; 2: of no known time */
} formula;

static sf_status evaluate(void *context, sf_runs *runs, int count, const int64_t *row, int *fresh,
                          sf_error *err) {
    formula *f = context;
    *fresh = 0;
    for (int k = 0; k < count && err->status == SF_OK; k++) {
        double a_max, hic, strain, *place = sf_runs_place(runs, row[k]);
        if (runs->state[row[k]] == SF_SWEEP_DONE)
            continue;
        if (f->stop_at > 0 && f->calls == f->stop_at)
            return SF_FAIL(err, SF_INTERRUPTED, "interrupted");
        f->calls++;
        *fresh += 1;
        pad(runs->plan, row[k], &a_max, &hic, &strain);
        if (f->coarse) {
            strain *= 1.01;
            a_max *= 0.98 - 0.1 * strain;
            hic *= 0.97 - 0.2 * strain * strain;
        }
        if (strain > 0.97) {
            sf_runs_failed(runs, row[k], "the missile reached the anvil", err);
            continue;
        }
        place[sf_runs_figure("a_max_g")] = a_max;
        place[sf_runs_figure("hic")] = hic;
        place[sf_runs_figure("max_mean_strain")] = strain;
        place[sf_runs_figure("v_rebound_m_s")] = 0.01 * a_max;
        double time = contact_of(runs->plan, row[k]);
        if (f->ends) {
            place[sf_runs_figure("contact_time_ms")] = 0;
            place[sf_runs_figure("rebound_time_ms")] = f->ends == 1 && time < RUN_END ? time : NAN;
            place[sf_runs_figure("v_rebound_m_s")] = time < RUN_END ? 0.01 * a_max : NAN;
        }
        place[sf_runs_figure("negative_dissipation")] = fmax(0, 0.2 * (strain - 0.9)); /* 0.01 of 0.95 */
        place[sf_runs_figure("energy_beyond_data")] = strain > 0.7 ? 2 * (strain - 0.7) : 0;
        sf_runs_done(runs, row[k], strain > 0.95 ? SF_GRADE_DO_NOT_USE : SF_GRADE_VALID, "drop", NULL, err);
    }
    return err->status;
}

static sf_status run_with(const program_place *p, const sf_plan *plan, formula *f,
                          sf_sweep_adaptive *adaptive, sf_runs *runs, sf_error *err) {
    const sf_sweep_engine engine = {evaluate, f, 64, NULL};
    const sf_sweep_chooser chooser = sf_sweep_adaptive_chooser(adaptive);
    const sf_sweep_campaign c = {.plan = plan, .folder = p->folder, .inputs = 1, .chooser = &chooser};
    if (sf_runs_create(plan, runs, err) == SF_OK)
        sf_sweep_campaign_run(&c, &engine, runs, err);
    return err->status;
}

static sf_status run(const program_place *p, const sf_plan *plan, formula *f, sf_runs *runs, sf_error *err) {
    *err = (sf_error)SF_ERROR_INIT;
    sf_sweep_adaptive *adaptive = sf_sweep_adaptive_new(plan, NULL, 2, NULL, err);
    run_with(p, plan, f, adaptive, runs, err);
    sf_sweep_adaptive_free(adaptive);
    return err->status;
}

static void read_plan(const program_place *p, sf_plan *plan) {
    sweep_read_plan(p, PLAN, plan);
    plan->figure[0].accuracy = 0.01;
    plan->figure[1].accuracy = 0.02;
    program_shell(p, "rm -f runs.csv sweep.key");
}

/* True if a value is in the interval of a predicted row. */
static bool is_held(const sf_runs *r, int64_t row, int figure, double value) {
    double predicted = sf_runs_place((sf_runs *)r, row)[sf_runs_figure(r->plan->figure[figure].figure)];
    return fabs(log(predicted / value)) <= sf_runs_half(r, row, figure);
}

/* The campaign is interrupted first: it goes on from what was simulated, and once it has ended nothing is
 * simulated again. */
static void rows_are_predicted_as_accurately_as_asked(void **state) {
    enum { FIRST = 40 };
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err;
    formula f = {.stop_at = FIRST};
    int64_t predicted = 0, held[2] = {0}, unusable = 0, lost = 0, given_back = 0;
    read_plan(p, &plan);
    assert_int_equal(run(p, &plan, &f, &runs, &err), SF_INTERRUPTED);
    assert_int_equal(sf_runs_count(&runs, SF_SWEEP_PREDICTED), 0);
    sf_runs_free(&runs);
    f = (formula){0};
    if (run(p, &plan, &f, &runs, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(f.calls > 0);
    int64_t simulated = FIRST + f.calls;
    for (int64_t row = 0; row < runs.count; row++) {
        double a_max, hic, strain;
        pad(&plan, row, &a_max, &hic, &strain);
        unusable += strain > 0.95;
        lost += runs.state[row] == SF_SWEEP_OPEN && strain <= 0.95;
        given_back += runs.state[row] == SF_SWEEP_OPEN && strstr(runs.message[row], "give back too much");
        if (runs.state[row] != SF_SWEEP_PREDICTED)
            continue;
        predicted++;
        held[0] += is_held(&runs, row, 0, a_max);
        held[1] += is_held(&runs, row, 1, hic);
        assert_true(strain <= 0.95); /* no figure where there is none to be used */
        assert_true(sf_runs_half(&runs, row, 0) <= log(1.01) * (1 + 1e-12));
        assert_true(sf_runs_half(&runs, row, 1) <= log(1.02) * (1 + 1e-12));
    }
    printf(
        "%lld rows: %lld simulated, %lld predicted, %lld open (%lld are not to be used); held %.1f and %.1f %%\n",
        (long long)runs.count, (long long)simulated, (long long)predicted,
        (long long)sf_runs_count(&runs, SF_SWEEP_OPEN), (long long)unusable,
        100 * (double)held[0] / (double)predicted, 100 * (double)held[1] / (double)predicted);
    assert_true(simulated < runs.count / 6);
    assert_true(predicted + simulated + unusable + lost >= runs.count && lost <= unusable / 5);
    assert_true(given_back > 0);
    for (int k = 0; k < 2; k++)
        assert_true((double)held[k] >= 0.93 * (double)predicted);
    assert_true(predicted > runs.count / 2);
    sf_runs_free(&runs);
    f = (formula){0};
    assert_int_equal(run(p, &plan, &f, &runs, &err), SF_OK);
    assert_int_equal(f.calls, 0); /* the table has all that is needed */
    assert_int_equal(sf_runs_count(&runs, SF_SWEEP_PREDICTED), predicted);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

/* The same rows from coarse ones, simulated or predicted, cost fewer drops, and their intervals hold. */
static void rows_are_predicted_from_coarse_rows(void **state) {
    const program_place *p = *state;
    sf_plan plan, coarse_plan;
    sf_runs runs, coarse;
    sf_error err = SF_ERROR_INIT;
    formula f = {0}, of_coarse = {.coarse = true};
    int64_t predicted = 0, held[2] = {0};
    read_plan(p, &coarse_plan);
    for (int k = 0; k < 2; k++)
        coarse_plan.figure[k].accuracy *= 0.5;
    sf_sweep_adaptive *first = sf_sweep_adaptive_new(&coarse_plan, NULL, 2, NULL, &err);
    assert_int_equal(run_with(p, &coarse_plan, &of_coarse, first, &coarse, &err), SF_OK);
    read_plan(p, &plan);
    sf_sweep_adaptive *second = sf_sweep_adaptive_new(&plan, NULL, 2, NULL, &err);
    sf_sweep_adaptive_correct(second, first, &coarse);
    assert_int_equal(run_with(p, &plan, &f, second, &runs, &err), SF_OK);
    for (int64_t row = 0; row < runs.count; row++) {
        double a_max, hic, strain;
        pad(&plan, row, &a_max, &hic, &strain);
        if (runs.state[row] != SF_SWEEP_PREDICTED)
            continue;
        predicted++;
        held[0] += is_held(&runs, row, 0, a_max);
        held[1] += is_held(&runs, row, 1, hic);
        assert_true(strain <= 0.95 &&
                    sf_runs_usable(&coarse, row)); /* nothing of a coarse row without figures */
        for (int k = 0; k < 2; k++) {
            assert_true(sf_runs_half(&runs, row, k) > sf_runs_half(&coarse, row, k));
            assert_true(sf_runs_half(&runs, row, k) <= log1p(plan.figure[k].accuracy) * (1 + 1e-12));
        }
    }
    printf("%lld of %lld rows simulated, after %lld coarse ones; held %.1f and %.1f %%\n", (long long)f.calls,
           (long long)runs.count, (long long)of_coarse.calls, 100 * (double)held[0] / (double)predicted,
           100 * (double)held[1] / (double)predicted);
    assert_true(predicted > runs.count * 3 / 4 && f.calls < of_coarse.calls);
    for (int k = 0; k < 2; k++)
        assert_true((double)held[k] >= 0.93 * (double)predicted);
    sf_sweep_adaptive_free(first);
    sf_sweep_adaptive_free(second);
    sf_runs_free(&runs);
    sf_runs_free(&coarse);
    sf_plan_free(&plan);
    sf_plan_free(&coarse_plan);
}

/* A figure that the drop would not define is not predicted: the rows are simulated or left open, with a
 * sentence, whether their time of contact is known (then at a small cost) or only that they have none. */
static void what_a_drop_would_not_define_is_not_predicted(void **state) {
    static const char *const plans[] = {
        "{ sample = \"latin_hypercube\"; count = 600; of = ("
        "{ key = \"missile.velocity\"; low = \"3 m/s\"; high = \"6 m/s\"; }, { key = \"missile.mass\"; low = \"3 kg\"; "
        "high = \"6 kg\"; }, { key = \"geometry.parameters.thickness\"; low = 40.0; high = 80.0; } ); }",
        "{ sample = \"latin_hypercube\"; count = 150; of = ("
        "{ key = \"a.speed\"; low = 3.0; high = 6.0; }, { key = \"a.mass\"; low = 3.0; high = 6.0; }, "
        "{ key = \"a.thickness\"; low = 40.0; high = 80.0; } ); }"};
    const program_place *p = *state;
    sf_error held = SF_ERROR_INIT;
    assert_int_equal(sf_units_hold(&held), SF_OK);
    for (int known = 1; known >= 0; known--) {
        sf_plan plan;
        sf_runs runs;
        sf_error err;
        formula f = {.ends = 2 - known};
        int64_t undefined = 0, told = 0;
        sweep_read_plan(p, plans[!known], &plan);
        plan.figure[0].accuracy = plan.figure[1].accuracy = 0.02;
        plan.figure[plan.figure_count++] = (sf_sweep_limit){"v_rebound_m_s", NAN, 0.02};
        program_shell(p, "rm -f runs.csv sweep.key");
        if (run(p, &plan, &f, &runs, &err) != SF_OK)
            fail_msg("%s", err.text);
        for (int64_t row = 0; row < runs.count; row++) {
            bool defined = contact_of(&plan, row) < RUN_END;
            undefined += !defined;
            assert_true(runs.state[row] != SF_SWEEP_PREDICTED || defined);
            told += runs.state[row] == SF_SWEEP_OPEN && runs.message[row] &&
                    (strstr(runs.message[row], "solver.end_time") || !known);
        }
        printf("%lld rows, %lld without a rebound: %lld simulated, %lld predicted, %lld open\n",
               (long long)runs.count, (long long)undefined, (long long)f.calls,
               (long long)sf_runs_count(&runs, SF_SWEEP_PREDICTED), (long long)told);
        assert_in_range(undefined, runs.count / 20, runs.count / 3);
        assert_true(!known || (told > undefined / 2 && f.calls < runs.count / 5));
        assert_true(f.calls + told + sf_runs_count(&runs, SF_SWEEP_PREDICTED) == runs.count);
        sf_runs_free(&runs);
        sf_plan_free(&plan);
    }
    sf_units_let_go();
}

/* A prediction whose interval holds the limit is neither below nor above, nor is a row that is left open. */
static void a_prediction_that_may_exceed_the_limit_is_unknown(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err = SF_ERROR_INIT;
    sf_probabilities q;
    const double value[2] = {199, 500}, half[2] = {0.01, 0.01};
    sweep_read_plan(p, "{ key = \"a.x\"; uncertain = true; values = (1, 2, 3, 4); }", &plan);
    plan.figure[0].accuracy = plan.figure[1].accuracy = 0.01;
    assert_int_equal(sf_runs_create(&plan, &runs, &err), SF_OK);
    for (int64_t row = 0; row < 2; row++)
        sf_runs_predicted(&runs, row, value, half);
    assert_int_equal(sf_runs_leave(&runs, 2, "not simulated: it is expected to have no figures", &err),
                     SF_OK);
    assert_int_equal(sf_probabilities_count(&runs, &q, &err), SF_OK);
    assert_int_equal(q.cell[0].unknown, 3);
    assert_int_equal(q.cell[1].below, 2);
    assert_int_equal(q.cell[1].unknown, 1);
    assert_int_equal(q.open, 1);
    assert_true(fabs(q.cell[1].share - 2. / 3) < 1e-12);
    sf_probabilities_free(&q);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

/* Indices of a plan of which most rows are predicted are those of all its drops. */
static void indices_of_predicted_rows_are_those_of_the_drops(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs, all;
    sf_error err = SF_ERROR_INIT;
    sf_analysis of_predicted, of_drops;
    formula f = {0};
    int fresh;
    sweep_read_plan(
        p,
        "{ sample = \"saltelli\"; count = 128; of = ("
        "{ key = \"a.speed\"; low = 3.0; high = 4.0; }, { key = \"a.mass\"; low = 3.0; high = 5.0; }, "
        "{ key = \"a.thickness\"; low = 50.0; high = 80.0; } ); }",
        &plan);
    plan.figure[0].accuracy = 0.01;
    plan.figure[1].accuracy = 0.02;
    program_shell(p, "rm -f runs.csv sweep.key");
    if (run(p, &plan, &f, &runs, &err) != SF_OK || sf_analysis_make(&runs, &of_predicted, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(f.calls < runs.count / 6);
    assert_int_equal(sf_runs_create(&plan, &all, &err), SF_OK);
    for (int64_t row = 0; row < all.count; row++)
        assert_int_equal(evaluate(&(formula){0}, &all, 1, &row, &fresh, &err), SF_OK);
    assert_int_equal(sf_analysis_make(&all, &of_drops, &err), SF_OK);
    for (int figure = 0; figure < 2; figure++)
        for (int factor = 0; factor < 3; factor++) {
            const sf_index *i = &of_predicted.index[figure][factor], *j = &of_drops.index[figure][factor];
            assert_true(j->total > 0.02);
            assert_true(fabs(i->first - j->first) < 0.01 && fabs(i->total - j->total) < 0.01);
        }
    printf(
        "%lld of %lld rows simulated; total indices of a_max %.4f %.4f %.4f, of all drops %.4f %.4f %.4f\n",
        (long long)f.calls, (long long)runs.count, of_predicted.index[0][0].total,
        of_predicted.index[0][1].total, of_predicted.index[0][2].total, of_drops.index[0][0].total,
        of_drops.index[0][1].total, of_drops.index[0][2].total);
    sf_analysis_free(&of_predicted);
    sf_analysis_free(&of_drops);
    sf_runs_free(&runs);
    sf_runs_free(&all);
    sf_plan_free(&plan);
}

static void wishes_are_for_all_figures_or_none(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_error err;
    static const char *const wrong[][2] = {
        {"{ key = \"a_max_g\"; accuracy = 0.01; }, { key = \"hic\"; }", "every figure or to none"},
        {"{ key = \"a_max_g\"; accuracy = 0.0; }", "accuracy"},
        {"{ key = \"a_max_g\"; accuracy = -0.01; }", "accuracy"},
        {"{ key = \"a_max_g\"; accuracy = 2.0; }", "accuracy"}};
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        char text[512];
        snprintf(text, sizeof text, "{ key = \"a.x\"; values = (1, 2); } ); figures = ( %s", wrong[k][0]);
        assert_int_equal(sweep_try_plan(p, text, false, &plan, &err), SF_ERR_INPUT);
        assert_non_null(strstr(err.text, wrong[k][1]));
        sf_plan_free(&plan);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_process_meets_its_points_and_knows_nothing_far_away),
        cmocka_unit_test(an_input_without_influence_gets_a_long_length),
        cmocka_unit_test(intervals_hold_what_they_say),
        cmocka_unit_test(intervals_are_widened_by_points_left_out),
        cmocka_unit_test(points_are_chosen_as_if_one_after_another),
        cmocka_unit_test(rows_are_predicted_as_accurately_as_asked),
        cmocka_unit_test(rows_are_predicted_from_coarse_rows),
        cmocka_unit_test(what_a_drop_would_not_define_is_not_predicted),
        cmocka_unit_test(a_prediction_that_may_exceed_the_limit_is_unknown),
        cmocka_unit_test(indices_of_predicted_rows_are_those_of_the_drops),
        cmocka_unit_test(wishes_are_for_all_figures_or_none),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
