/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The changes of a_max and HIC with speed and thickness that softfall-post estimates from one drop, against
 * drops with 1 % more and less of each (post/figures/figures.c). */
#include "check.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define LOCKED " --set 'material.densification={rule=\"H2\"; start=0.76; limit=%g; exponent=%.1f;}'"

static void drop_on(const program_place *p, int spacing, double speed, double thickness, double limit,
                    double exponent) {
    char lock[120] = "";
    if (limit > 0)
        snprintf(lock, sizeof lock, LOCKED, limit, exponent);
    program_succeed(
        p, "pre",
        "good.cfg -o m.h5 --force --estimate %s --set missile.velocity='\"%.6f m/s\"' --set "
        "geometry.parameters.thickness=%.6f%s",
        program_coarse(spacing), speed, thickness, lock);
    program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
    program_figures(p, "r.h5 -o out --force");
}

static void drop(const program_place *p, double speed, double thickness, double limit) {
    drop_on(p, 20, speed, thickness, limit, 1);
}

static double figure(const program_place *p, const char *key) {
    return program_file_number(p, "out/summary.json", key);
}

/* Changes of a_max and HIC for 1 % of the speed, or of the thickness, between the drops with 1 % less and
 * more. */
static void changes(const program_place *p, bool speed, double v, double h, double limit, double change[2]) {
    double value[2][2];
    for (int side = 0; side < 2; side++) {
        double by = side ? 1.01 : 0.99;
        drop(p, speed ? by * v : v, speed ? h : by * h, limit);
        value[side][0] = figure(p, "a_max_g");
        value[side][1] = figure(p, "hic");
    }
    for (int k = 0; k < 2; k++)
        change[k] = log(value[1][k] / value[0][k]) / 2;
}

/* The same for 1 % of the foam's stress: its curve, E and ED. */
static void changes_by_stress(const program_place *p, double change[2]) {
    double value[2][2];
    for (int side = 0; side < 2; side++) {
        double by = side ? 1.01 : 0.99;
        program_shell(
            p,
            "awk -F, -v s=%g '/^[0-9]/ { print $1 \",\" s * $2; next } { print }' materials/eva35.csv > "
            "materials/other.csv",
            by);
        program_succeed(
            p, "pre",
            "good.cfg -o m.h5 --force --estimate %s --set material.curve='\"materials/other.csv\"' --set "
            "material.E='\"%.9g MPa\"' --set material.ED='\"%.9g MPa\"'",
            program_coarse(25), by * 0.4136, by * 1.52312043584);
        program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
        program_figures(p, "r.h5 -o out --force");
        value[side][0] = figure(p, "a_max_g");
        value[side][1] = figure(p, "hic");
    }
    for (int k = 0; k < 2; k++)
        change[k] = log(value[1][k] / value[0][k]) / 2;
}

/* The changes are small beside those by the speed: within 0.25 % of the figure. */
static void the_change_by_stress_agrees_with_simulations(void **state) {
    const program_place *p = *state;
    static const char *const estimates[2] = {"a_max_change_by_stress", "hic_change_by_stress"};
    double estimate[2], true_change[2];
    drop(p, 4.5, 50, 0);
    for (int k = 0; k < 2; k++)
        estimate[k] = figure(p, estimates[k]);
    changes_by_stress(p, true_change);
    for (int k = 0; k < 2; k++) {
        print_message("%s: %.4f, estimated %.4f\n", estimates[k], true_change[k], estimate[k]);
        assert_true(fabs(true_change[k]) > 0.001 && fabs(estimate[k] - true_change[k]) < 0.0025);
    }
}

/* Of the corners of what pads are used for, those with the numbers `first` to `last`. */
static void assert_estimates(const program_place *p, size_t first, size_t last) {
    static const struct { double speed, thickness; } cases[] = {{4.5, 50}, {6.2, 70}, {5.2, 50}, {4.5, 70}};
    static const char *const estimates[4] = {"a_max_change_by_speed", "hic_change_by_speed",
                                             "a_max_change_by_thickness", "hic_change_by_thickness"};
    for (size_t c = first; c <= last; c++) {
        double v = cases[c].speed, h = cases[c].thickness, estimate[4], true_change[4];
        drop(p, v, h, 0);
        for (int k = 0; k < 4; k++)
            estimate[k] = figure(p, estimates[k]);
        double spread = hypot(estimate[0], estimate[2] * 100 / h); /* 1 % of speed and 1 mm, the defaults */
        assert_true(fabs(figure(p, "a_max_scatter") / spread - 1) < 1e-6);
        changes(p, true, v, h, 0, true_change);
        changes(p, false, v, h, 0, true_change + 2);
        for (int k = 0; k < 4; k++) {
            print_message("%g m/s on %g mm, %s: %.4f, estimated %.4f\n", v, h, estimates[k], true_change[k],
                          estimate[k]);
            assert_true(fabs(estimate[k] / true_change[k] - 1) < 1.0 / 3);
        }
        assert_true(estimate[0] < 0.1);
    }
}

static void estimates_agree_with_simulations(void **state) {
    assert_estimates(*state, 0, 0);
}

static void estimates_agree_with_simulations_of_other_pads(void **state) {
    assert_estimates(*state, 1, 3);
}

/* A foam that locks up in the drop is found, before the lock-up or in it. */
static void assert_edge(const program_place *p, double limit) {
    double change[2];
    drop(p, 5.2, 50, limit);
    double estimate = figure(p, "a_max_change_by_speed");
    changes(p, true, 5.2, 50, limit, change);
    print_message("locked at %g: %.4f, estimated %.4f\n", limit, change[0], estimate);
    assert_true(estimate > 0.7 * change[0] && estimate < 3 * change[0]);
}

static void an_edge_is_not_overlooked(void **state) {
    assert_edge(*state, 0.80);
}

static void a_later_edge_is_not_overlooked(void **state) {
    assert_edge(*state, 0.83);
}

/* Lock-up strains 0.0025 less and more, of foams that lock up in the drop, on a mesh that shows how deep: the
 * estimate is 0.6 to 4/3 of the change. */
static void assert_lock_up(const program_place *p, size_t first, size_t last) {
    static const double lock[][2] = {{0.83, 1}, {0.83, 1.5}, {0.84, 2}}; /* pole, exponent */
    static const char *const figures[2][2] = {{"a_max_g", "a_max_change_by_lock_up"},
                                              {"hic", "hic_change_by_lock_up"}};
    for (size_t c = first; c <= last; c++) {
        double value[2][2], limit = lock[c][0], exponent = lock[c][1];
        for (int side = 0; side < 2; side++) {
            drop_on(p, 10, 5.2, 50, limit + (side ? 0.0025 : -0.0025), exponent);
            for (int k = 0; k < 2; k++)
                value[side][k] = figure(p, figures[k][0]);
        }
        drop_on(p, 10, 5.2, 50, limit, exponent);
        for (int k = 0; k < 2; k++) {
            double estimate = figure(p, figures[k][1]), true_change = log(value[1][k] / value[0][k]);
            print_message("locked at %g, exponent %g, %s: %.4f, estimated %.4f\n", limit, exponent,
                          figures[k][1], true_change, estimate);
            assert_true(estimate / true_change > 0.6 && estimate / true_change < 4.0 / 3);
        }
    }
}

static void a_later_lock_up_is_estimated(void **state) {
    assert_lock_up(*state, 1, 1);
}

static void a_later_lock_up_with_other_exponents_is_estimated(void **state) {
    assert_lock_up(*state, 0, 0);
    assert_lock_up(*state, 2, 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(estimates_agree_with_simulations),
        cmocka_unit_test(an_edge_is_not_overlooked),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(a_later_lock_up_is_estimated),
        cmocka_unit_test(the_change_by_stress_agrees_with_simulations),
        cmocka_unit_test(estimates_agree_with_simulations_of_other_pads),
        cmocka_unit_test(a_later_edge_is_not_overlooked),
        cmocka_unit_test(a_later_lock_up_with_other_exponents_is_estimated),
    };
    return check_slow() ? cmocka_run_group_tests(slow, program_group_case, program_group_tear_down)
                        : cmocka_run_group_tests(tests, program_group_case, program_group_tear_down);
}
