/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every numerical failure is caught in the step that it happens in, and named: node, position, time, cause.
 */
#include "model_fixture.h"

#include "solver/step.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

static const char *const coarse[] = {"geometry.parameters.fine_spacing=20.0",
                                     "geometry.parameters.outer_spacing=20.0",
                                     "geometry.missile_parameters.element_size=20.0", NULL};
enum { STEPS = 20 };

/* The example's pad after some steps, about to take the next. */
static int set_up(void **state) {
    static fixture f;
    fixture_pad(coarse, &f);
    fixture_start(&f);
    for (int k = 0; k < STEPS; k++) {
        fixture_advance(&f);
    }
    *state = &f;
    return 0;
}

static int tear_down(void **state) {
    fixture_free(*state);
    return 0;
}

/* The next step fails with these words and names the node, its place and the time. */
static void assert_fails(const fixture *f, sf_state *s, int64_t node, const char *what, const char *cause) {
    sf_error err = SF_ERROR_INIT;
    char name[128], time[64];
    assert_int_equal(sf_step_evaluate(&f->model, &f->operators, s, &err), SF_ERR_NUMERIC);
    snprintf(time, sizeof time, "at t = %.6g s", s->time);
    if (!strstr(err.text, time) || !strstr(err.text, what) || !strstr(err.text, cause))
        fail_msg("%s; expected \"%s\", \"%s\", \"%s\"", err.text, time, what, cause);
    if (node < 0)
        return;
    const double *x = &f->model.position[3 * node];
    snprintf(name, sizeof name, "node %lld", (long long)node);
    assert_non_null(strstr(err.text, name));
    snprintf(name, sizeof name, "(%.5g, %.5g, %.5g) m", x[0], x[1], x[2]);
    assert_non_null(strstr(err.text, name));
}

/* The node nearest to a point half-way up in the impact zone: free to move, whatever order a mesher gives. */
static int64_t middle(const fixture *f) {
    static const double point[3] = {0.025, 0.025, 0.025};
    double least = INFINITY;
    int64_t nearest = 0;
    for (int64_t i = 0; i < f->model.node_count; i++) {
        const double *x = &f->model.position[3 * i];
        double distance = hypot(hypot(x[0] - point[0], x[1] - point[1]), x[2] - point[2]);
        if (distance < least) {
            least = distance;
            nearest = i;
        }
    }
    return nearest;
}

static void inverted_domain(void **state) {
    fixture *f = *state;
    for (int64_t i = 0; i < f->model.node_count; i++) /* upside down about the base, so that every J < 0 */
        f->state.d[3 * i + 2] = -1.5 * f->model.position[3 * i + 2];
    assert_fails(f, &f->state, -1, "has collapsed: det F = -",
                 "check its densification (material.densification: ");
}

static void displacement_without_a_number(void **state) {
    fixture *f = *state;
    f->state.d[3 * middle(f) + 1] = NAN;
    assert_fails(f, &f->state, -1, "holds a NaN or infinity: det F = nan", "smaller solver.step_safety");
    f->state.d[3 * middle(f) + 1] = INFINITY;
    assert_fails(f, &f->state, -1, "holds a NaN or infinity: det F = ", "smaller solver.step_safety");
}

static void velocity_without_a_number(void **state) {
    fixture *f = *state;
    f->state.v[3 * middle(f)] = NAN;
    assert_fails(f, &f->state, -1, "holds a NaN or infinity", "smaller solver.step_safety");
}

/* A history variable of the foam: the stress of one domain, in the step itself. */
static void stress_without_a_number(void **state) {
    fixture *f = *state;
    for (int64_t row = 0; row < f->state.history_rows; row++)
        f->state
            .history[(middle(f) / SF_LANES * f->state.history_rows + row) * SF_LANES + middle(f) % SF_LANES] =
            NAN;
    assert_fails(f, &f->state, -1, "holds a NaN or infinity", "smaller solver.step_safety");
}

static void missile_without_a_number(void **state) {
    fixture *f = *state;
    f->state.missile.velocity = NAN;
    assert_fails(f, &f->state, -1, "holds a NaN or infinity", "smaller solver.step_safety");
}

static void growing_energy(void **state) {
    fixture *f = *state;
    int64_t node = middle(f);
    f->state.v[3 * node] +=
        sqrt(0.4 * f->state.ledger.reference /
             f->model.mass[node]); /* 20 % of the impact's energy, of which the first half step sees a part */
    assert_fails(f, &f->state, node, "the energy balance is off by ", "the run is unstable");
}

static void vanishing_time_step(void **state) {
    fixture *f = *state;
    f->model.run.end_time = 1e9 * 1.03 * f->state.dt; /* the floor is a part of it; a step grows by 2 % */
    assert_fails(f, &f->state, -1, "the stable time step fell to",
                 "densified beyond what the curve can carry");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(inverted_domain, set_up, tear_down),
        cmocka_unit_test_setup_teardown(displacement_without_a_number, set_up, tear_down),
        cmocka_unit_test_setup_teardown(velocity_without_a_number, set_up, tear_down),
        cmocka_unit_test_setup_teardown(stress_without_a_number, set_up, tear_down),
        cmocka_unit_test_setup_teardown(missile_without_a_number, set_up, tear_down),
        cmocka_unit_test_setup_teardown(growing_energy, set_up, tear_down),
        cmocka_unit_test_setup_teardown(vanishing_time_step, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
