/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Space mapping against what it approximates: Bayes of a linear problem, the minimum of a simulation, bounds,
 * steps that fail. */
#include "extreme.h"
#include "study/fit/space_mapping.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Truth and surrogate of two parameters and three responses. */
typedef struct toy {
    bool linear;
    int simulations;
} toy;

static sf_status toy_surrogate(void *context, const double *u, double *y, sf_error *err) {
    const toy *t = context;
    (void)err;
    y[0] = u[0] + 0.5 * u[1];
    y[1] = u[0] - u[1];
    y[2] = t->linear ? 2 * u[1] : exp(0.5 * u[1]) + 0.1 * u[0];
    return SF_OK;
}

static sf_status toy_simulate(void *context, const double *u, double *y, sf_error *err) {
    toy *t = context;
    t->simulations++;
    toy_surrogate(context, u, y, err);
    if (!t->linear) {
        y[0] += 0.3 + 0.2 * u[0] - 0.05 * u[0] * u[1];
        y[1] = 1.15 * y[1] - 0.2;
        y[2] += 0.1 * u[1];
    }
    return SF_OK;
}

static const double toy_zero[2] = {0, 0}, toy_width[2] = {1, 2}, toy_sd[3] = {0.01, 0.02, 0.03};

static sf_mapping_problem toy_problem(toy *t, const double *measured) {
    return (sf_mapping_problem){.parameters = 2,
                                .responses = 3,
                                .start = toy_zero,
                                .prior = toy_zero,
                                .prior_sd = toy_width,
                                .measured = measured,
                                .sd = toy_sd,
                                .surrogate = toy_surrogate,
                                .simulate = toy_simulate,
                                .context = t,
                                .max_iterations = 12,
                                .tolerance = 0.01};
}

static void mapping_of_a_linear_problem_is_bayes(void **state) {
    (void)state;
    toy t = {.linear = true};
    const double measured[3] = {0.8, 0.3, 0.5};
    sf_mapping_problem p = toy_problem(&t, measured);
    sf_mapping_result r;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_mapping_solve(&p, &r, &err), SF_OK);
    assert_true(r.converged);
    assert_int_equal(t.simulations, 2); /* the start and the minimum */
    const double row[3][2] = {{1, 0.5}, {1, -1}, {0, 2}};
    double wide[3] = {1 / (toy_width[0] * toy_width[0]), 0, 1 / (toy_width[1] * toy_width[1])}, a[3],
           b[2] = {0, 0};
    memcpy(a, wide, sizeof a);
    for (int i = 0; i < 3; i++) {
        double w = 1 / (toy_sd[i] * toy_sd[i]);
        a[0] += w * row[i][0] * row[i][0];
        a[1] += w * row[i][0] * row[i][1];
        a[2] += w * row[i][1] * row[i][1];
        b[0] += w * row[i][0] * measured[i];
        b[1] += w * row[i][1] * measured[i];
    }
    double det = a[0] * a[2] - a[1] * a[1];
    assert_true(fabs(r.u[0] - (a[2] * b[0] - a[1] * b[1]) / det) < 1e-6);
    assert_true(fabs(r.u[1] - (a[0] * b[1] - a[1] * b[0]) / det) < 1e-6);
    assert_true(r.scale > 1); /* the data contradict each other: their weight falls, the prior's does not */
    for (int k = 0; k < 3; k++)
        a[k] = (a[k] - wide[k]) / (r.scale * r.scale) + wide[k];
    det = a[0] * a[2] - a[1] * a[1];
    assert_true(fabs(r.covariance[0][0] / (a[2] / det) - 1) < 1e-6);
    assert_true(fabs(r.covariance[0][1] / (-a[1] / det) - 1) < 1e-6);
    assert_true(r.freedom > 0.9 && r.freedom < 1.1); /* three data, two parameters that they determine */
    sf_mapping_free(&r);
}

static void mapping_finds_the_minimum_of_the_simulation(void **state) {
    (void)state;
    toy t = {.linear = false};
    double measured[3];
    const double truth[2] = {0.6, -0.9};
    sf_error err = SF_ERROR_INIT;
    toy_simulate(&t, truth, measured, &err);
    t.simulations = 0;
    sf_mapping_problem p = toy_problem(&t, measured);
    sf_mapping_result r;
    assert_int_equal(sf_mapping_solve(&p, &r, &err), SF_OK);
    assert_true(r.converged && t.simulations <= 8);
    for (int j = 0; j < 2; j++)
        assert_true(fabs(r.u[j] - truth[j]) < 3e-3); /* but for the prior's pull */
    assert_true(r.misfit < 0.1);
    sf_mapping_free(&r);
}

/* A response without a datum that may not exceed a value: the minimum is there, and no free one. */
static void a_bound_holds_the_minimum(void **state) {
    (void)state;
    static const double sd[3] = {0.01, 0.02, INFINITY}, bound_sd[3] = {INFINITY, INFINITY, 0.001};
    for (int k = 0; k < 2; k++) {
        toy t = {.linear = true};
        const double measured[3] = {0.8, 0.3, k == 0 ? 0.1 : 1}; /* 2 / 3 without a bound */
        sf_mapping_problem p = toy_problem(&t, measured);
        sf_mapping_result r;
        sf_error err = SF_ERROR_INIT;
        p.sd = sd;
        p.bound_sd = bound_sd;
        assert_int_equal(sf_mapping_solve(&p, &r, &err), SF_OK);
        assert_int_equal(r.converged, k == 1);
        assert_true(fabs(r.y[2] - (k == 0 ? 0.1 : 2. / 3)) < 0.03);
        assert_true(k == 1 ? !r.reason : strstr(r.reason, "bound") != NULL);
        sf_mapping_free(&r);
    }
}

/* The surrogate leads far beyond where the simulation bends: first steps are rejected, one by a failure. */
static sf_status bent_surrogate(void *context, const double *u, double *y, sf_error *err) {
    (void)context;
    (void)err;
    y[0] = u[0];
    y[1] = u[1];
    y[2] = 0;
    return SF_OK;
}

static sf_status bent_simulate(void *context, const double *u, double *y, sf_error *err) {
    toy *t = context;
    t->simulations++;
    if (u[0] > 2.5)
        return SF_FAIL(err, SF_ERR_NUMERIC, "the drop collapsed");
    y[0] = u[0] + 4 * u[0] * u[0];
    y[1] = u[1] + u[0] * u[1];
    y[2] = 0;
    return SF_OK;
}

static void mapping_survives_rejected_and_failed_steps(void **state) {
    (void)state;
    toy t = {.linear = false};
    const double measured[3] = {3, 0.3, 0}, wide[2] = {10, 10}; /* u0 = 0.75, u1 = 0.3 / 1.75 */
    sf_mapping_problem p = toy_problem(&t, measured);
    p.surrogate = bent_surrogate;
    p.simulate = bent_simulate;
    p.prior_sd = wide;
    p.max_iterations = 30;
    sf_mapping_result r;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_mapping_solve(&p, &r, &err), SF_OK);
    assert_true(r.converged && t.simulations > 3);
    assert_true(fabs(r.u[0] - 0.75) < 0.01 && fabs(r.u[1] - 0.3 / 1.75) < 0.01);
    sf_mapping_free(&r);
}

/* The surrogate has an edge, as columns that lock up, which the simulation has not; its slope there is
 * nothing that a matrix corrects. */
static sf_status edged_surrogate(void *context, const double *u, double *y, sf_error *err) {
    (void)context;
    (void)err;
    y[0] = u[0] - 0.5 * tanh(50 * (u[0] - 0.7));
    y[1] = u[1] + 0.2 * u[0];
    y[2] = 0.5 * u[1];
    return SF_OK;
}

static sf_status smooth_simulate(void *context, const double *u, double *y, sf_error *err) {
    toy *t = context;
    t->simulations++;
    (void)err;
    y[0] = 1.2 * u[0];
    y[1] = u[1] + 0.2 * u[0];
    y[2] = 0.5 * u[1];
    return SF_OK;
}

static void simulations_replace_a_surrogate_with_an_edge(void **state) {
    (void)state;
    toy t = {.linear = false};
    const double measured[3] = {0.84, 0.44, 0.15}; /* u = 0.7, 0.3 */
    sf_mapping_problem p = toy_problem(&t, measured);
    p.surrogate = edged_surrogate;
    p.simulate = smooth_simulate;
    p.max_iterations = 40;
    sf_mapping_result r;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_mapping_solve(&p, &r, &err), SF_OK);
    assert_true(r.converged);
    assert_true(fabs(r.u[0] - 0.7) < 3e-3 && fabs(r.u[1] - 0.3) < 3e-3);
    assert_true(fabs(r.corrected[0] - 1.2) < 0.05); /* the derivative is the simulation's */
    /* a fit to the other responses goes on with that derivative, not with the surrogate's */
    static const double others[3] = {INFINITY, 0.02, 0.03};
    double y[3], u[2], real[3];
    assert_int_equal(sf_mapping_refit(&p, &r, others, u, y, &err), SF_OK);
    smooth_simulate(&t, u, real, &err);
    assert_true(fabs(y[0] - real[0]) < 0.05 && fabs(u[0] - 0.7) > 0.02);
    sf_mapping_free(&r);
}

/* Columns with an edge and a second parameter that hardly counts; the simulation with the noise of a drop. */
static sf_status flat_surrogate(void *context, const double *u, double *y, sf_error *err) {
    (void)context;
    (void)err;
    y[0] = 0.3 * u[0] - 0.1 * tanh(50 * (u[0] - 0.3)) + 0.02 * u[1];
    y[1] = 0.5 * u[0] + 0.02 * u[1];
    y[2] = 0.25 * u[0] + 0.02 * u[1];
    return SF_OK;
}

static sf_status noisy_simulate(void *context, const double *u, double *y, sf_error *err) {
    const toy *t = context;
    (void)err;
    y[0] = 0.3 * u[0] + 0.03 * u[1];
    y[1] = 0.5 * u[0] + 0.03 * u[1];
    y[2] = 0.25 * u[0] + 0.04 * u[1];
    for (int i = 0; i < 3; i++)
        y[i] += 0.002 * sin(1e5 * (u[0] + 2 * u[1]) + 2.4 * i + t->simulations);
    return SF_OK;
}

/* Data that contradict each other leave a minimum with large residuals, at the end of a valley along the
 * second parameter, whose gradient over a difference of 0.1 is lost in the noise. The search finds it, and
 * says so. With two simulations it says that there were too few. */
static void a_search_finds_the_end_of_a_valley_with_noise(void **state) {
    (void)state;
    enum { PHASES = 200 };
    static const double measured[3] = {0.05, 0.35, 0.1}, sd[3] = {0.02, 0.04, 0.02};
    static const double LOWEST = 23.33; /* objective without noise at 0.569, -1.706; 33 where u[1] = 1.4 */
    int converged = 0, found = 0;
    for (int phase = 0; phase < PHASES; phase++) {
        toy t = {.simulations = phase};
        sf_mapping_problem p = toy_problem(&t, measured);
        p.sd = sd;
        p.surrogate = flat_surrogate;
        p.simulate = noisy_simulate;
        p.max_iterations = 60;
        p.tolerance = 0.1;
        sf_mapping_result r;
        sf_error err = SF_ERROR_INIT;
        assert_int_equal(sf_mapping_solve(&p, &r, &err), SF_OK);
        assert_true(r.linear);
        converged += r.converged;
        found += r.objective < LOWEST + 1;
        sf_mapping_free(&r);
    }
    print_message("%d of %d searches converged, %d at the minimum\n", converged, PHASES, found);
    assert_true(converged >= 0.95 * PHASES);
    assert_true(found >= 0.85 * PHASES);
    toy t = {.simulations = 0};
    sf_mapping_problem p = toy_problem(&t, measured);
    sf_mapping_result r;
    sf_error err = SF_ERROR_INIT;
    p.sd = sd;
    p.surrogate = flat_surrogate;
    p.simulate = noisy_simulate;
    p.max_iterations = 2;
    assert_int_equal(sf_mapping_solve(&p, &r, &err), SF_OK);
    assert_true(!r.converged);
    assert_string_equal(r.reason, "the limit of simulations came first");
    sf_mapping_free(&r);
}

static sf_status failing_simulate(void *context, const double *u, double *y, sf_error *err) {
    (void)context;
    (void)u;
    (void)y;
    return SF_FAIL(err, SF_ERR_NUMERIC, "the drop collapsed");
}

static void mapping_passes_on_a_failed_simulation(void **state) {
    (void)state;
    toy t = {.linear = true};
    const double measured[3] = {0};
    sf_mapping_problem p = toy_problem(&t, measured);
    p.simulate = failing_simulate;
    sf_mapping_result r;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_mapping_solve(&p, &r, &err), SF_ERR_NUMERIC);
    assert_string_equal(err.text, "the drop collapsed");
    sf_mapping_free(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mapping_of_a_linear_problem_is_bayes),
        cmocka_unit_test(mapping_finds_the_minimum_of_the_simulation),
        cmocka_unit_test(a_bound_holds_the_minimum),
        cmocka_unit_test(mapping_survives_rejected_and_failed_steps),
        cmocka_unit_test(simulations_replace_a_surrogate_with_an_edge),
        cmocka_unit_test(a_search_finds_the_end_of_a_valley_with_noise),
        cmocka_unit_test(mapping_passes_on_a_failed_simulation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
