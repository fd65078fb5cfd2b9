/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The meaning of the acceleration: the reading of an accelerometer by default, the kinematic acceleration on
 * request; that a force plate has its filter; and that the figures of a flat missile, whose contact begins
 * with an impulse, do not depend on the time step. */
#include "check.h"
#include "post/figures/verdict.h"

#include "base/units.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"
#include "program_fixture.h"

typedef struct drop {
    sf_results results;
    sf_figures figures;
    sf_verdict verdict;
} drop;

static int set_up(void **state) {
    return program_group_example(state);
}

static drop evaluate(const program_place *p, const char *name) {
    const sf_limits limits = SF_DEFAULT_LIMITS;
    drop d = {0};
    sf_error err = SF_ERROR_INIT;
    if (sf_results_open(program_path(p, name), &d.results, &err) != SF_OK ||
        sf_figures_compute(&d.results, 1000, &d.figures, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_verdict_compute(&d.results, &d.figures, &limits, &d.verdict);
    return d;
}

static void release(drop *d) {
    sf_figures_free(&d->figures);
    sf_results_close(&d->results);
}

/* The missile falls 20 mm freely at first. */
static drop falling(const program_place *p, const char *name, const char *convention) {
    program_succeed(p, "pre", "good.cfg -o model.h5 --force %s --set missile.gap='\"20 mm\"' --set %s",
                    program_coarse(25), convention);
    program_succeed(p, "solve", "model.h5 -o %s --force --threads 1", name);
    return evaluate(p, name);
}

static void an_accelerometer_reads_nothing_in_free_fall(void **state) {
    drop reading = falling(*state, "reading.h5", "missile.friction=0.0");
    drop kinematic = falling(*state, "kinematic.h5", "output.acceleration='\"kinematic\"'");
    const sf_series *a = &reading.figures.raw, *b = &kinematic.figures.raw;
    int64_t free_rows = 0;
    assert_int_equal(a->count, b->count);
    for (int64_t i = 0; i < a->count; i++) {
        bool flying = reading.results.history.contact_nodes[i] == 0;
        assert_close(b->value[i], a->value[i] - 1, 1e-12);
        if (flying)
            assert_true(a->value[i] == 0);
        free_rows += flying;
    }
    assert_true(free_rows > 100 && reading.results.contact_time > 3e-3);
    assert_true(kinematic.figures.kinematic && !reading.figures.kinematic);
    program_result report = program_succeed(*state, "post", "kinematic.h5 -o out --force");
    assert_non_null(strstr(report.out, "kinematic acceleration"));
    assert_int_equal(
        program_shell(*state, "grep -q '\"acceleration\": \"kinematic deceleration' out/summary.json").code,
        0);
    assert_close(kinematic.figures.injury_raw.a_max_g, reading.figures.injury_raw.a_max_g - 1, 1e-9);
    double part = kinematic.figures.injury.hic.value / reading.figures.injury.hic.value;
    assert_true(part > 0.93 && part < 0.99); /* as (1 - 1 g / a)^2.5 */
    release(&reading);
    release(&kinematic);
}

static void the_reading_is_the_force_over_the_mass(void **state) {
    drop d = falling(*state, "reading.h5", "missile.friction=0.0");
    const sf_history *h = &d.results.history;
    for (int64_t i = 0; i < h->rows; i++)
        assert_close(h->acceleration[i], h->contact_force[i] / d.results.missile_mass,
                     1e-12 * fabs(h->acceleration[i]));
    release(&d);
}

/* A plate that carries the force on the missile shows its filtered peak, whatever mount the missile has. */
static void a_force_plate_has_the_class_of_the_accelerometer(void **state) {
    sf_error err = SF_ERROR_INIT;
    sf_signal_chain mount = {.mount_frequency = 300, .mount_damping = 0.05};
    drop d = falling(*state, "plate.h5", "missile.friction=0.0");
    sf_history *h = &d.results.history;
    for (int64_t i = 0; i < h->rows; i++)
        h->base_reaction[i] = 5 * h->acceleration[i];
    for (int through = 0; through < 2; through++) {
        sf_figures f;
        if (sf_figures_compute_through(&d.results, 180, through ? &mount : NULL, &f, &err) != SF_OK)
            fail_msg("%s", err.text);
        if (!through)
            assert_relative(f.base_force, 5 * SF_STANDARD_GRAVITY * f.injury.a_max_g, 1e-9);
        else
            assert_true(fabs(f.base_force / (5 * SF_STANDARD_GRAVITY * f.injury.a_max_g) - 1) > 0.01);
        assert_true(f.base_force < 0.999 * 5 * SF_STANDARD_GRAVITY * f.injury_raw.a_max_g);
        sf_figures_free(&f);
    }
    release(&d);
}

/* Free flight of 5 ms precedes the contact in the filtered curve, wherever the history begins. */
static void curves_begin_before_the_contact(void **state) {
    drop late = falling(*state, "late.h5", "missile.friction=0.0");
    drop early = falling(*state, "early.h5", "missile.gap='\"0 mm\"'");
    assert_true(late.figures.filtered.time[0] <= late.results.contact_time - 5e-3 + 1e-9);
    assert_true(early.figures.filtered.time[0] <= early.results.contact_time - 5e-3 + 1e-9);
    assert_close(early.figures.filtered.value[0], 0, 1e-6);
    program_succeed(*state, "post", "early.h5 -o early --force");
    assert_int_equal(
        program_shell(*state,
                      "awk -F, 'NR == 2 { exit !($1 <= -4.9 && $2 * $2 < 1e-12) }' early/acceleration.csv")
            .code,
        0);
    release(&late);
    release(&early);
}

static drop flat(const program_place *p, double step_safety) {
    program_succeed(p, "pre",
                    "good.cfg -o flat.h5 --force --set geometry.missile_file='\"geo/platen.geo\"' "
                    "--set 'geometry.missile_parameters={ side = 100.0; thickness = 10.0; }' "
                    "--set 'geometry.parameters={ side = 200.0; thickness = 50.0; zone_side = 100.0; "
                    "fine_spacing = 25.0; outer_spacing = 25.0; quarter = 1; }' "
                    "--set pad.mesh_error_limit=1.0 --set solver.step_safety=%g",
                    step_safety);
    program_succeed(p, "solve", "flat.h5 -o flat-results.h5 --force --threads 1");
    return evaluate(p, "flat-results.h5");
}

static const sf_check *row(const drop *d, const char *key) {
    for (int k = 0; k < d->verdict.count; k++)
        if (strcmp(d->verdict.rows[k].key, key) == 0)
            return &d->verdict.rows[k];
    fail_msg("the verdict has no row %s", key);
    return NULL;
}

/* The impulse on the mass of the contact nodes takes one time step: its force grows as the step shrinks, its
 * impulse does not. */
static void figures_of_a_flat_missile_do_not_depend_on_the_step(void **state) {
    drop large = flat(*state, 0.95), small = flat(*state, 0.01);
    assert_true(small.results.has_peak &&
                small.results.peak.time > 5e-3); /* the fields are not the artefact's */
    assert_relative(small.figures.local_collapse, large.figures.local_collapse, 0.05);
    assert_true(small.figures.steps > 20 * large.figures.steps);
    assert_true(small.figures.injury_raw.a_max_g > 5 * small.figures.injury.a_max_g);
    assert_relative(small.figures.injury.a_max_g, large.figures.injury.a_max_g, 0.01);
    assert_relative(small.figures.injury.hic.value, large.figures.injury.hic.value, 0.01);
    assert_relative(sf_series_at(&small.figures.filtered, small.results.contact_time),
                    sf_series_at(&large.figures.filtered, large.results.contact_time), 0.05);
    assert_int_equal(row(&small, "step_artefact")->grade, SF_GRADE_REMARKS);
    assert_int_equal(row(&small, "filter")->grade, SF_GRADE_VALID); /* the artefact is not judged twice */
    release(&large);
    release(&small);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_accelerometer_reads_nothing_in_free_fall),
        cmocka_unit_test(the_reading_is_the_force_over_the_mass),
        cmocka_unit_test(a_force_plate_has_the_class_of_the_accelerometer),
        cmocka_unit_test(curves_begin_before_the_contact),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(figures_of_a_flat_missile_do_not_depend_on_the_step),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
