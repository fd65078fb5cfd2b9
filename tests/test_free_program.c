/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A free missile through the three programs: its body, refusals, restart, threads, figures, ParaView. */
#include "extreme.h"
#include "model_fixture.h"
#include "program_fixture.h"
#include "run_fixture.h"

#include "base/mat3.h"
#include "model/model_io.h"
#include "post/figures/figures.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";
#define WHOLE                                                                                                \
    " --set geometry.parameters.quarter=0 --set geometry.missile_parameters.quarter=0"                       \
    " --set geometry.parameters.zone_side=160.0 --set geometry.parameters.side=240.0"
#define FREE " --set missile.freedom=free"
#define OBLIQUE                                                                                              \
    " --set 'missile.direction=[0.4, 0.1, -1.0]' --set missile.friction=0.4"                                 \
    " --set 'missile.angular_velocity=[\"2 rad/s\", \"-5 rad/s\", \"10 rad/s\"]'"

/* An oblique drop of the whole hemisphere, free.h5, and what one run makes of it, full.h5. */
static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    program_succeed(p, "pre", "'%s' -o free.h5 %s" WHOLE FREE OBLIQUE, fixture_source(EXAMPLE),
                    program_coarse(25));
    program_succeed(p, "solve", "free.h5 -o full.h5 --threads 1");
    return 0;
}

static void read_model(const program_place *p, const char *name, sf_model *m) {
    sf_error err = SF_ERROR_INIT;
    memset(m, 0, sizeof *m);
    if (sf_model_read(program_path(p, name), m, NULL, &err) != SF_OK)
        fail_msg("%s", err.text);
}

/* The hemisphere, of which only the dome is the touching surface: 3/8 R from its flat face, 83/320 and 2/5 m
 * R^2; with what lies between the triangles and the sphere, so that a coarse mesh is exact. */
static void the_body_of_the_hemisphere_has_the_closed_form(void **state) {
    const program_place *p = *state;
    const double radius = 0.08, mass = 4.6;
    program_succeed(
        p, "pre",
        "'%s' -o coarse.h5 --set geometry.parameters.fine_spacing=20 --set geometry.parameters.outer_spacing=20 "
        "--set pad.mesh_error_limit=1" WHOLE FREE " --set geometry.missile_parameters.element_size=25.0",
        fixture_source(EXAMPLE));
    for (int coarse = 0; coarse < 2; coarse++) {
        sf_model m;
        read_model(p, coarse ? "coarse.h5" : "free.h5", &m);
        const double bound = coarse ? 1e-4 : 1e-6; /* of the rule of integration */
        const double across = 83.0 / 320 * mass * radius * radius, axial = 0.4 * mass * radius * radius;
        for (int k = 0; k < 2; k++) {
            assert_close(m.missile.inertia[k] / across, 1, bound);
            assert_close(m.missile.centre[k] - m.missile.sphere_centre[k], 0, bound * radius);
        }
        assert_close(m.missile.inertia[2] / axial, 1, bound);
        for (int k = 3; k < 6; k++)
            assert_close(m.missile.inertia[k] / axial, 0, bound);
        assert_close((m.missile.sphere_centre[2] - m.missile.centre[2]) / radius, 3.0 / 8, bound);
        sf_model_free(&m);
    }
}

/* Given in the geometry's coordinates, the centre goes with the surface to the pad. */
static void a_given_body_is_taken(void **state) {
    const program_place *p = *state;
    sf_model m, own;
    program_succeed(
        p, "pre",
        "'%s' -o given.h5 %s" WHOLE FREE OBLIQUE
        " --set 'missile.inertia=[\"0.01 kg m2\", \"0.012 kg m2\", \"0.015 kg m2\", \"10 kg cm2\", "
        "\"0 kg m2\", \"0 kg m2\"]' --set 'missile.centre=[\"5 mm\", \"0 mm\", \"50 mm\"]' "
        "--set 'missile.position=[\"20 mm\", \"10 mm\"]'",
        fixture_source(EXAMPLE), program_coarse(25));
    read_model(p, "given.h5", &m);
    read_model(p, "free.h5", &own);
    double moved[3]; /* against the other model, whose missile is placed elsewhere */
    for (int k = 0; k < 3; k++)
        moved[k] = m.surface_position[k] - own.surface_position[k];
    assert_close(m.missile.impact[0], 0.02, 1e-9);
    assert_true(fabs(moved[0]) > 0.01 && fabs(moved[1]) > 0.001);
    assert_close(m.missile.centre[0] - own.missile.centre[0], 0.005 + moved[0], 1e-6);
    assert_close(m.missile.centre[1] - own.missile.centre[1], moved[1], 1e-6);
    assert_close(m.missile.centre[2] - own.missile.centre[2], moved[2],
                 1e-6); /* 5/8 of 80 mm above the pole */
    assert_close(m.missile.inertia[1], 0.012, 1e-15);
    assert_close(m.missile.inertia[3], 0.001, 1e-15);
    assert_close(m.missile.angular_velocity[1], -5, 1e-15);
    sf_model_free(&m);
    sf_model_free(&own);
}

static void what_no_free_missile_can_be_is_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *words, *said;
    } rows[] = {
        {FREE, "a free missile needs the whole pad and the whole missile; this model is 1/4"},
        {" --set 'missile.angular_velocity=[\"1 rad/s\", \"0 rad/s\", \"0 rad/s\"]'",
         "missile.angular_velocity has no meaning for a guided missile"},
        {" --set 'missile.inertia=[\"1 kg m2\", \"1 kg m2\", \"1 kg m2\"]'",
         "missile.inertia has no meaning for a guided missile"},
        {WHOLE FREE " --set 'missile.inertia=[\"1 kg m2\", \"1 kg m2\", \"3 kg m2\"]'",
         "no body has the principal moments 1, 1 and 3 kg m2"},
        {WHOLE FREE " --set 'missile.inertia=[\"1 kg m2\", \"1 kg m2\", \"-1 kg m2\"]'", "no body has"},
        {WHOLE FREE " --set 'missile.inertia=[\"1 kg m2\", \"1 kg m2\"]'", "an array of 3 or 6 values"},
        {WHOLE FREE " --set 'missile.inertia=[\"1 kg\", \"1 kg\", \"1 kg\"]'", "is a mass"},
        {WHOLE FREE " --set 'missile.centre=[\"1 mm\", \"1 mm\", \"1 mm\"]'",
         "missile.centre needs missile.inertia"},
        {WHOLE FREE " --set 'missile.angular_velocity=[\"2000 rad/s\", \"0 rad/s\", \"0 rad/s\"]'",
         "2000 rad s-1 is out of bounds"},
        {" --set missile.freedom=loose", "none of: guided, free"},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        program_result r = program_run(p, "pre", "'%s' -o refused.h5 %s%s", fixture_source(EXAMPLE),
                                       program_coarse(25), rows[k].words);
        if (r.code == 0 || !strstr(r.err, rows[k].said))
            fail_msg("%s: %s", rows[k].words, r.err);
        assert_false(run_is_there(p, "refused.h5"));
    }
}

/* Interrupted, resumed, on two threads: the same bits. */
static void restart_and_threads_keep_the_bits(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "free.h5 -o parts.h5 --threads 1 --end-time '6 ms'");
    program_succeed(p, "solve", "--restart parts.h5 --threads 2 --end-time '40 ms'");
    run_assert_same(p, "full.h5", "parts.h5");
}

static double column_largest(const double *a, const double *b, const double *c, int64_t rows) {
    double largest = 0;
    for (int64_t i = 0; i < rows; i++)
        largest = larger(largest, sqrt(a[i] * a[i] + b[i] * b[i] + c[i] * c[i]));
    return largest;
}

/* Balances, columns and figures of the oblique drop. */
static void history_and_figures_hold(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_results r;
    sf_figures f;
    if (sf_results_open(program_path(p, "full.h5"), &r, &err) != SF_OK ||
        sf_figures_compute(&r, 1000, &f, &err) != SF_OK)
        fail_msg("%s", err.text);
    const sf_history *h = &r.history;
    assert_true(f.turns && r.turns && f.rebounded);
    assert_close(f.momentum_error_space, 0, 1e-8);
    assert_close(f.angular_momentum_error, 0, 1e-8);
    assert_close(f.energy_error, 0, 2e-3);
    assert_close(h->angular_velocity_z[0], 10, 1e-12);
    double fastest =
               column_largest(h->angular_velocity_x, h->angular_velocity_y, h->angular_velocity_z, h->rows),
           hardest = column_largest(h->angular_acceleration_x, h->angular_acceleration_y,
                                    h->angular_acceleration_z, h->rows);
    assert_true(fastest > 15);
    assert_close(f.peak_angular_velocity / fastest, 1, 0.01);
    double largest[3] = {0}; /* about the missile's own axes: the columns of its rotation */
    for (int64_t k = 0; k < h->rows; k++) {
        double w = h->quaternion_w[k], x = h->quaternion_x[k], y = h->quaternion_y[k], z = h->quaternion_z[k];
        const double axis[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                                   {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                                   {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
        for (int j = 0; j < 3; j++)
            largest[j] = larger(largest[j], fabs(axis[j][0] * h->angular_velocity_x[k] +
                                                 axis[j][1] * h->angular_velocity_y[k] +
                                                 axis[j][2] * h->angular_velocity_z[k]));
    }
    double bric = hypot(largest[0] / 66.25, hypot(largest[1] / 56.45, largest[2] / 42.87));
    assert_close(f.bric / bric, 1, 0.01);
    assert_close(f.peak_angular_acceleration / hardest, 1, 0.05);
    double pulled = column_largest(h->specific_force_x, h->specific_force_y, h->specific_force_z, h->rows);
    assert_close(f.injury_raw.a_max_g * 9.80665 / pulled, 1, 1e-12);
    assert_close(f.peak_resultant / f.injury_raw.a_max_g, 1, 0.02);
    assert_true(f.injury_raw.a_max_g * 9.80665 >
                1.005 * h->acceleration[sf_history_row_of_largest(h, h->acceleration)]);
    for (int64_t i = 1; i < h->rows; i++) { /* the pose is the integral of the velocities */
        double dt = h->time[i] - h->time[i - 1], turn[3], next[4];
        const double before[4] = {h->quaternion_w[i - 1], h->quaternion_x[i - 1], h->quaternion_y[i - 1],
                                  h->quaternion_z[i - 1]},
                     after[4] = {h->quaternion_w[i], h->quaternion_x[i], h->quaternion_y[i],
                                 h->quaternion_z[i]};
        turn[0] = 0.5 * dt * (h->angular_velocity_x[i] + h->angular_velocity_x[i - 1]);
        turn[1] = 0.5 * dt * (h->angular_velocity_y[i] + h->angular_velocity_y[i - 1]);
        turn[2] = 0.5 * dt * (h->angular_velocity_z[i] + h->angular_velocity_z[i - 1]);
        sf_rotation_advance(before, turn, next);
        for (int k = 0; k < 4; k++)
            assert_close(next[k], after[k], 1e-6);
        assert_close(h->translation_z[i] - h->translation_z[i - 1],
                     0.5 * dt * (h->velocity_z[i] + h->velocity_z[i - 1]), 1e-7);
    }
    sf_figures_free(&f);
    sf_results_close(&r);
}

/* In ParaView every node of the missile keeps its distance to the others, and they turn. */
static void the_missile_turns_in_paraview(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_results r;
    assert_int_equal(sf_results_open(program_path(p, "full.h5"), &r, &err), SF_OK);
    const sf_frame_head *last = &r.frames[r.frame_count - 1];
    double a[3], b[3], way[3], start[3];
    const double *x = r.surface_position, *y = &r.surface_position[3 * (r.surface_node_count - 1)];
    sf_results_place(&r, last, x, a);
    sf_results_place(&r, last, y, b);
    for (int k = 0; k < 3; k++) {
        way[k] = b[k] - a[k];
        start[k] = y[k] - x[k];
    }
    double length = sqrt(sf_dot3(start, start));
    assert_close(sqrt(sf_dot3(way, way)), length, 1e-12);
    assert_true(sf_dot3(way, start) < length * length * cos(0.1));
    int64_t row = sf_history_row_of_largest(&r.history, r.history.contact_force);
    while (r.history.time[row] < r.peak.time)
        row++;
    assert_true(sf_figures_reading(&r, row) > 1.003 * r.peak.acceleration / SF_STANDARD_GRAVITY);
    sf_results_close(&r);
    program_result made = program_succeed(p, "post", "full.h5 -o out");
    assert_non_null(strstr(made.out, "free missile: a_max, HIC and all that follows of the resultant"));
    assert_non_null(strstr(made.out, "edge and scatter: not estimated of a free missile"));
    assert_non_null(strstr(made.out, "angular acceleration"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_body_of_the_hemisphere_has_the_closed_form),
        cmocka_unit_test(a_given_body_is_taken),
        cmocka_unit_test(what_no_free_missile_can_be_is_refused),
        cmocka_unit_test(restart_and_threads_keep_the_bits),
        cmocka_unit_test(history_and_figures_hold),
        cmocka_unit_test(the_missile_turns_in_paraview),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
