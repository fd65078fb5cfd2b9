/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact: no penetration, no pull, Coulomb's law, equal and opposite impulses, no energy from nowhere; the
 * exact sphere and its triangles agree. */
#include "extreme.h"
#include "model_fixture.h"

#include "base/mat3.h"
#include "solver/contact/contact.h"
#include "solver/contact/pair.h"
#include "solver/contact/shapes.h"
#include "solver/run/frame.h"
#include "solver/step.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

/* A block of 50 x 50 x 60 mm on its base under a large plate that moves along (x, 0, -z). */
static void start_press(fixture *f, double slant, double friction) {
    const fixture_block block = {.cells = {5, 5, 6}, .spacing = 0.01, .jitter = 0.1, .surface_jitter = 0.05};
    sf_case c;
    fixture_case(&c, NULL);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    c.missile_card.mass = 0.5;
    c.missile_card.friction = friction;
    fixture_slant(&c, slant);
    fixture_under_plate(&c, &block, 0.5, 0.025, 0.025, f);
    fixture_start(f);
}

/* Position of contact point c by u_h at the present coefficients. */
static void point_position(const fixture *f, int64_t c, double y[3]) {
    const sf_model *m = &f->model;
    int64_t node = m->contact_node[c];
    memcpy(y, &m->position[3 * node], 3 * sizeof *y);
    for (int64_t k = m->phi_ptr[node]; k < m->phi_ptr[node + 1]; k++)
        for (int r = 0; r < 3; r++)
            y[r] += m->phi_value[k] * f->state.d[3 * (int64_t)m->phi_node[k] + r];
}

/* Down and up again: after every step each point is either free and outside, or pressed and on the plate. */
static void pressed_points_lie_on_the_plate_and_free_ones_outside(void **state) {
    (void)state;
    fixture f;
    start_press(&f, 0, 0);
    const sf_model *m = &f.model;
    sf_state *s = &f.state;
    int64_t pressed = 0, free_points = 0;
    while (s->missile.velocity > 0 || s->contact_count > 0) {
        assert_true(s->time < 0.05);
        fixture_step(&f);
        double travel = s->dt * m->missile.speed, stiffest = 0;
        for (int64_t c = 0; c < m->contact_count; c++)
            stiffest = larger(stiffest, s->contact.force[3 * c + 2] * -1);
        sf_step_advance(m, s);
        double plate = m->surface_position[2] - s->missile.displacement;
        for (int64_t c = 0; c < m->contact_count; c++) {
            double y[3], p = -s->contact.force[3 * c + 2];
            point_position(&f, c, y);
            double gap = plate - y[2];
            assert_true(p >= 0);
            assert_true(gap >= -1e-6 * travel);
            if (p > 0)
                assert_close(p * gap / (stiffest * travel), 0, 1e-6);
            assert_true(hypot(s->contact.force[3 * c], s->contact.force[3 * c + 1]) <=
                        1e-9 * stiffest); /* no friction */
            pressed += p > 0;
            free_points += gap > 1e-3 * travel;
        }
        assert_true(s->penetration <= 1e-6 * travel);
    }
    assert_true(pressed > 1000);
    assert_true(free_points > 10); /* both branches were met */
    fixture_free(&f);
}

/* Advances to 0.6 ms into the impact; then contact alone acts on copied forces. */
static void pad_and_missile_exchange_equal_and_opposite_momentum(void **state) {
    (void)state;
    for (int oblique = 0; oblique < 2; oblique++) {
        fixture f;
        start_press(&f, oblique ? 0.5 : 0, oblique ? 0.4 : 0);
        const sf_model *m = &f.model;
        sf_state *s = &f.state;
        while (s->time < 0.6e-3) {
            fixture_advance(&f);
        }
        fixture_forces(&f);
        size_t bytes = 3 * (size_t)m->node_count * sizeof *s->force;
        double *before = malloc(bytes), sum[3] = {0}, size = 0;
        assert_non_null(before);
        memcpy(before, s->force, bytes);
        assert_int_equal(sf_contact_solve(m, &f.operators, s, SF_IGNORED), SF_OK);
        for (int64_t k = 0; k < 3 * m->node_count; k++) {
            sum[k % 3] += s->force[k] - before[k];
            size += fabs(s->force[k] - before[k]);
        }
        assert_true(s->contact_count > 10);
        assert_true(size > 1);
        for (int r = 0; r < 3; r++)
            assert_close((sum[r] + s->missile.force[r]) / size, 0, 1e-13);
        double along = sf_dot3(s->missile.force, m->missile.direction);
        double expected = along / m->missile.mass + m->missile.gravity * cos(oblique ? 0.5 : 0);
        assert_relative(s->missile.acceleration, expected, 1e-12);
        assert_true(along < 0); /* it brakes */
        free(before);
        fixture_free(&f);
    }
}

/* The pressure of a frame adds up to the force across the plate; nodes without contact have none. */
static void pressure_of_a_frame_adds_up_to_the_normal_force(void **state) {
    (void)state;
    fixture f;
    start_press(&f, 0.5, 0.4);
    const sf_model *m = &f.model;
    sf_state *s = &f.state;
    while (s->time < 0.6e-3) {
        fixture_advance(&f);
    }
    fixture_step(&f);
    double *pressure = malloc((size_t)m->node_count * sizeof *pressure), sum = 0;
    assert_non_null(pressure);
    sf_frame_take(m, &f.operators, s, SF_FRAME_CONTACT_PRESSURE, pressure);
    for (int64_t c = 0; c < m->contact_count; c++) {
        double *p = &pressure[m->contact_node[c]];
        assert_true(*p >= 0);
        sum += m->contact_area[c] * *p;
        *p = 0;
    }
    for (int64_t i = 0; i < m->node_count; i++)
        assert_true(pressure[i] == 0);
    assert_true(s->contact_count > 10);
    assert_true(s->missile.force[2] > 1);
    assert_relative(sum, s->missile.force[2], 1e-12);
    free(pressure);
    fixture_free(&f);
}

typedef struct friction_count {
    int64_t sticking, sliding;
} friction_count;

/* Coulomb's law at every pressed point of the step that has just been taken. */
static void check_coulomb(const fixture *f, double (*old)[3], double travel, friction_count *count) {
    const sf_model *m = &f->model;
    const sf_state *s = &f->state;
    const double *e = m->missile.direction;
    double mu = m->missile.friction, step = s->missile.displacement - s->missile.displacement_old,
           strongest = 0;
    for (int64_t c = 0; c < m->contact_count; c++)
        strongest = larger(strongest, -s->contact.force[3 * c + 2]);
    for (int64_t c = 0; c < m->contact_count; c++) {
        const double *q = &s->contact.force[3 * c];
        double y[3], slip[2], p = -q[2], size = hypot(q[0], q[1]);
        assert_true(size <= mu * p * (1 + 1e-9));
        if (p < 1e-3 * strongest)
            continue;
        point_position(f, c, y);
        for (int r = 0; r < 2; r++)
            slip[r] = step * e[r] - (y[r] - old[c][r]);
        if (size < mu * p * (1 - 1e-6)) { /* below the bound: no slip */
            assert_close(hypot(slip[0], slip[1]) / travel, 0, 1e-5);
            count->sticking++;
        } else if (hypot(slip[0], slip[1]) > 1e-3 * travel) { /* at the bound: dragged along the slip */
            double cosine = (q[0] * slip[0] + q[1] * slip[1]) / (size * hypot(slip[0], slip[1]));
            assert_close(cosine, 1, 1e-4);
            count->sliding++;
        }
    }
}

static friction_count press_with_friction(double friction) {
    fixture f;
    friction_count count = {0, 0};
    start_press(&f, 0.5, friction);
    const sf_model *m = &f.model;
    sf_state *s = &f.state;
    double(*old)[3] = calloc((size_t)m->contact_count, sizeof *old);
    double lost = 0;
    assert_non_null(old);
    while (s->time < 1.2e-3) {
        for (int64_t c = 0; c < m->contact_count; c++)
            point_position(&f, c, old[c]);
        fixture_step(&f);
        double travel = s->dt * m->missile.speed;
        sf_step_advance(m, s);
        check_coulomb(&f, old, travel, &count);
        /* A force that turns within a step may give back a little of the last one's work. */
        assert_true(s->ledger.friction >= lost - 1e-4 * s->ledger.reference);
        lost = larger(lost, s->ledger.friction);
        assert_close(s->ledger.error, 0, 5e-3);
        assert_true(s->ledger.kinetic_missile + s->ledger.kinetic_pad <= 1.005 * s->ledger.reference);
    }
    free(old);
    fixture_free(&f);
    return count;
}

static void rough_plate_sticks(void **state) {
    (void)state;
    friction_count count = press_with_friction(5);
    assert_true(count.sticking > 20 * (count.sliding + 1));
}

static void smooth_plate_slides_at_the_coulomb_bound(void **state) {
    (void)state;
    friction_count count = press_with_friction(0.05);
    assert_true(count.sliding > 500);
}

/* Friction cannot drive: sliding work is lost, and more of it with a rougher plate until it sticks. */
static void sliding_friction_loses_energy(void **state) {
    (void)state;
    fixture f;
    start_press(&f, 0.5, 0.05);
    while (f.state.time < 1.2e-3) {
        fixture_advance(&f);
    }
    assert_true(f.state.ledger.friction > 1e-3 * f.state.ledger.reference);
    assert_close(f.state.ledger.contact / f.state.ledger.reference, 0, 0.01);
    fixture_free(&f);
}

/* Largest deceleration of the coarse drop, m s-2; `all` points looked at in every step, or those that the
 * list of near ones holds. */
static double peak_of(const char *shape, bool all) {
    fixture f;
    double peak = 0;
    fixture_pad((const char *const[]){"geometry.parameters.fine_spacing=10.0",
                                      "geometry.parameters.outer_spacing=20.0", shape, NULL},
                &f);
    fixture_start(&f);
    assert_int_equal(f.model.missile.shape, strstr(shape, "sphere") ? SF_SHAPE_SPHERE : SF_SHAPE_SURFACE);
    while (f.state.time < 0.016) {
        if (all)
            f.state.contact.room = 0;
        fixture_step(&f);
        assert_true(all || f.state.step < 1 || f.state.contact.close_count < f.model.contact_count);
        peak = larger(peak, -f.state.missile.acceleration);
        for (int64_t c = 0; c < f.model.contact_count;
             c++) /* nowhere does the foam pull, at the rim of the contact least */
            assert_true(sf_dot3(&f.state.contact.force[3 * c], &f.state.contact.normal[3 * c]) >= 0);
        sf_step_advance(&f.model, &f.state);
    }
    assert_true(-f.state.missile.acceleration < 0.9 * peak); /* past it */
    fixture_free(&f);
    return peak;
}

/* Facets of 10 mm lie up to 0.16 mm inside the sphere, of some 40 mm of indentation: to first order they only
 * shift it, which the peak does not see. */
static void sphere_and_its_triangles_give_the_same_drop(void **state) {
    (void)state;
    double sphere = peak_of("missile.shape=sphere", false), surface = peak_of("missile.shape=surface", false);
    assert_relative(surface, sphere, 0.005);
    assert_true(surface != sphere);
    /* The lists of near points miss nothing. */
    assert_true(peak_of("missile.shape=sphere", true) == sphere);
    assert_true(peak_of("missile.shape=surface", true) == surface);
}

/* A shape that the solver does not know: the half-space above z = 60 mm, as a row of the table of shapes. */
static bool above_is_near(const void *data, const double x[3], double margin) {
    (void)data;
    return x[2] > 0.06 - margin;
}

static bool above_gap(const void *data, const double x[3], double *gap, double normal[3]) {
    (void)data;
    *gap = 0.06 - x[2];
    memcpy(normal, (const double[3]){0, 0, -1}, 3 * sizeof *normal);
    return true;
}

/* A row is all that a new shape needs: the half-space presses the block as the plate's triangles do. */
static void a_shape_is_one_row(void **state) {
    (void)state;
    static const sf_shape above = {.is_near = above_is_near,
                                   .gap = above_gap,
                                   .meet = sf_pair_missile,
                                   .entry = 0.1,
                                   .deepest = INFINITY};
    fixture plate, half_space;
    start_press(&plate, 0.3, 0.2);
    start_press(&half_space, 0.3, 0.2);
    sf_body_free(&half_space.operators.body[SF_BODY_MISSILE]);
    half_space.operators.body[SF_BODY_MISSILE] = (sf_body){.shape = &above};
    for (int k = 0; k < 200; k++) {
        fixture_step(&plate);
        fixture_step(&half_space);
        sf_step_advance(&plate.model, &plate.state);
        sf_step_advance(&half_space.model, &half_space.state);
    }
    assert_true(plate.state.contact_count > 20);
    assert_int_equal(plate.state.contact_count, half_space.state.contact_count);
    double most = largest_of(plate.state.d, 3 * plate.model.node_count);
    for (int64_t k = 0; k < 3 * plate.model.node_count; k++)
        assert_true(fabs(plate.state.d[k] - half_space.state.d[k]) < 1e-9 * most);
    half_space.operators.body[SF_BODY_MISSILE] = (sf_body){0};
    fixture_free(&plate);
    fixture_free(&half_space);
}

/* A point that is free and deeper than a tenth of its spacing did not come through the surface: nothing
 * pushes it. */
static void points_that_come_from_behind_stay_free(void **state) {
    (void)state;
    for (int deep = 0; deep < 2; deep++) {
        fixture f;
        sf_error ignored = SF_ERROR_INIT; /* of the energy that pushing out at once takes */
        double finest = INFINITY, coarsest = 0;
        start_press(&f, 0, 0);
        for (int64_t c = 0; c < f.model.contact_count; c++) {
            finest = smaller(finest, f.model.spacing[f.model.contact_node[c]]);
            coarsest = larger(coarsest, f.model.spacing[f.model.contact_node[c]]);
        }
        f.state.missile.displacement = deep ? 0.11 * coarsest : 0.09 * finest;
        sf_step_evaluate(&f.model, &f.operators, &f.state, &ignored);
        assert_int_equal(f.state.contact_count > 0, !deep);
        fixture_free(&f);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pressed_points_lie_on_the_plate_and_free_ones_outside),
        cmocka_unit_test(pad_and_missile_exchange_equal_and_opposite_momentum),
        cmocka_unit_test(pressure_of_a_frame_adds_up_to_the_normal_force),
        cmocka_unit_test(rough_plate_sticks),
        cmocka_unit_test(smooth_plate_slides_at_the_coulomb_bound),
        cmocka_unit_test(sliding_friction_loses_energy),
        cmocka_unit_test(sphere_and_its_triangles_give_the_same_drop),
        cmocka_unit_test(a_shape_is_one_row),
        cmocka_unit_test(points_that_come_from_behind_stay_free),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
