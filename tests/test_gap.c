/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The case says how the missile arrives: no figure of the impact depends on missile.gap. */
#include "check.h"
#include "model/flight.h"
#include "program_fixture.h"

#include "post/figures/figures.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

#define WHOLE                                                                                                \
    " --set geometry.parameters.quarter=0 --set geometry.missile_parameters.quarter=0"                       \
    " --set geometry.parameters.zone_side=160.0 --set geometry.parameters.side=240.0"
#define OBLIQUE " --set 'missile.direction=[0.4, 0.1, -1.0]' --set missile.friction=0.4"
#define SPINNING                                                                                             \
    " --set missile.freedom=free --set 'missile.angular_velocity=[\"2 rad/s\", \"-5 rad/s\", \"10 rad/s\"]'"

static int set_up(void **state) {
    return program_group_case(state);
}

static sf_figures drop(const program_place *p, const char *way, const char *gap) {
    sf_results results;
    sf_figures figures;
    sf_error err = SF_ERROR_INIT;
    program_succeed(
        p, "pre",
        "good.cfg -o m.h5 --force %s --set missile.velocity='\"3 m/s\"'%s --set missile.gap='\"%s\"' "
        "--set 'solver.end_time=\"%s\"'",
        program_coarse(25), way, gap, strlen(gap) > 5 ? "340 ms" : "80 ms");
    program_succeed(p, "solve", "m.h5 -o r.h5 --force");
    if (sf_results_open(program_path(p, "r.h5"), &results, &err) != SF_OK ||
        sf_figures_compute(&results, 1000, &figures, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(figures.rebounded && figures.energy_error < 1e-3);
    sf_results_close(&results);
    return figures;
}

static void compare_gaps(const program_place *p, const char *way, int count) {
    static const char *const gaps[] = {"60 mm", "350 mm"};
    sf_figures near = drop(p, way, "0 mm");
    for (int g = 0; g < count; g++) {
        sf_figures far = drop(p, way, gaps[g]);
        assert_close(far.injury.a_max_g / near.injury.a_max_g, 1, 1e-3);
        assert_close(far.injury.hic.value / near.injury.hic.value, 1, 2e-3);
        assert_close(far.v_rebound / near.v_rebound, 1, 2e-3);
        assert_close(far.absorbed_energy / near.absorbed_energy, 1, 5e-3);
        assert_close(far.v0, near.v0, 1e-12);
        sf_figures_free(&far);
    }
    sf_figures_free(&near);
}

static void the_impact_is_the_same_for_every_gap(void **state) {
    compare_gaps(*state, "", 2);
}

static void oblique_and_spinning_impacts_are_the_same_for_every_gap(void **state) {
    static const char *const ways[] = {WHOLE OBLIQUE, WHOLE " --set missile.freedom=free",
                                       WHOLE OBLIQUE SPINNING};
    for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++)
        compare_gaps(*state, ways[w], 1);
}

/* From rest over its height the missile starts with no speed, and one height more is refused. */
static void a_fall_from_rest_has_its_closed_form(void **state) {
    const program_place *p = *state;
    double height = 1 / (2 * SF_STANDARD_GRAVITY);
    sf_missile_card card = {
        .speed = 1, .direction = {0, 0, -1}, .gravity = SF_STANDARD_GRAVITY, .gap = 0.999999 * height};
    assert_close(sf_flight_time(&card), 1 / SF_STANDARD_GRAVITY, 1e-3);
    assert_close(sf_flight_start_speed(&card), 1e-3, 1e-6);
    sf_figures d = drop(p, " --set missile.velocity='\"1 m/s\"'", "50.98 mm");
    assert_close(d.v0, 1, 1e-12);
    sf_figures_free(&d);
    program_result r = program_run(
        p, "pre", "good.cfg -o x.h5 %s --set missile.velocity='\"1 m/s\"' --set missile.gap='\"51.1 mm\"'",
        program_coarse(25));
    assert_int_not_equal(r.code, 0);
    assert_non_null(strstr(r.err, "missile.gap"));
    assert_non_null(strstr(r.err, "faster (1.001 m/s)"));
    assert_non_null(strstr(r.err, "speed at first contact"));
}

/* Followed forwards in steps of its own, the free flight of a tumbling body ends in the pose of the model. */
static void the_flight_ends_in_the_pose_of_arrival(void **state) {
    (void)state;
    const sf_missile_card card = {.mass = 2,
                                  .speed = 2,
                                  .direction = {0.6, 0, -0.8},
                                  .gravity = SF_STANDARD_GRAVITY,
                                  .gap = 0.08,
                                  .freedom = SF_MISSILE_FREE,
                                  .inertia = {1e-3, 2e-3, 2.5e-3, 1e-4, 0, 0},
                                  .angular_velocity = {3, 40, -7}};
    double flight = sf_flight_time(&card), half[3], whole[3], start[3], velocity[3];
    sf_flight_start_velocity(&card, velocity);
    sf_flight_displacement(&card, flight, start);
    sf_flight_displacement(&card, 0, whole);
    for (int k = 0; k < 3; k++) {
        double pull = k == 2 ? -card.gravity : 0;
        assert_close(start[k] + velocity[k] * flight + 0.5 * pull * flight * flight, whole[k], 1e-14);
        assert_close(velocity[k] + pull * flight, card.speed * card.direction[k], 1e-14);
    }
    double along = 0;
    for (int k = 0; k < 3; k++)
        along += start[k] * card.direction[k];
    assert_close(along, 0, 1e-14); /* it starts `gap` away along the direction */
    sf_flight_displacement(&card, flight / 2, half);
    assert_true(half[2] > whole[2] && start[2] > half[2]);
}

static void a_part_that_arrives_before_is_refused(void **state) {
    const program_place *p = *state;
    program_result r = program_run(
        p, "pre",
        "good.cfg -o x.h5 %s" WHOLE " --set missile.freedom=free --set missile.gap='\"40 mm\"' "
        "--set 'geometry.missile_file=\"geo/missiles/bar.geo\"' --set 'geometry.missile_parameters={ element_size=20.0; length=250.0; diameter=100.0; }' "
        "--set 'missile.angular_velocity=[\"80 rad/s\", \"0 rad/s\", \"0 rad/s\"]'",
        program_coarse(25));
    assert_int_not_equal(r.code, 0);
    assert_non_null(strstr(r.err, "missile.angular_velocity"));
    assert_non_null(strstr(r.err, "inside the pad"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_impact_is_the_same_for_every_gap),
        cmocka_unit_test(a_fall_from_rest_has_its_closed_form),
        cmocka_unit_test(the_flight_ends_in_the_pose_of_arrival),
        cmocka_unit_test(a_part_that_arrives_before_is_refused),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(oblique_and_spinning_impacts_are_the_same_for_every_gap),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
