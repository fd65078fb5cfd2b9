/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Held displacements: the projection is exact, its reactions are the forces of the base, and dependent
 * constraints are refused. */
#include "extreme.h"
#include "model_fixture.h"

#include "solver/constraint/constraint.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const double DT = 1.3e-5;

/* Random forces and velocities of a model, projected. */
typedef struct projection {
    double *force, *v, *reaction;
    double force_size, velocity_size;
    sf_constraint_step step;
    double residual; /* m s-1, what the solver measures */
} projection;

static projection project(const fixture *f, uint64_t seed) {
    size_t n = 3 * (size_t)f->model.node_count;
    projection p = {
        calloc(n, sizeof(double)), calloc(n, sizeof(double)), calloc(n, sizeof(double)), 0, 0, {0}, 0};
    assert_true(p.force && p.v && p.reaction);
    for (size_t k = 0; k < n; k++) {
        p.force[k] = f->model.mass[k / 3] * 1e5 * fixture_random(&seed);
        p.v[k] = fixture_random(&seed);
        p.force_size = larger(p.force_size, fabs(p.force[k]));
        p.velocity_size = larger(p.velocity_size, fabs(p.v[k]));
    }
    p.step = (sf_constraint_step){.force = p.force, .v = p.v, .dt = DT, .reaction = p.reaction};
    sf_constraint_project(&f->operators.constraint, &p.step);
    p.residual = sf_constraint_residual(&f->model, &f->operators.constraint, &p.step);
    return p;
}

/* v at the next half step, in place of v. */
static void advance(const fixture *f, projection *p) {
    for (int64_t k = 0; k < 3 * f->model.node_count; k++)
        p->v[k] += DT * (p->force[k] - p->reaction[k]) / f->model.mass[k / 3];
}

static void projection_free(projection *p) {
    free(p->force);
    free(p->v);
    free(p->reaction);
}

/* u_h's velocity at a node. */
static double value_at(const sf_model *m, const double *v, int64_t node, int component) {
    double sum = 0;
    for (int64_t k = m->phi_ptr[node]; k < m->phi_ptr[node + 1]; k++)
        sum += m->phi_value[k] * v[3 * (int64_t)m->phi_node[k] + component];
    return sum;
}

/* Largest |G v| over the held components; the number of them in *count. */
static double held_velocity(const sf_model *m, const double *v, int64_t *count) {
    double largest = 0;
    *count = 0;
    for (int64_t k = 0; k < m->fixed_count; k++)
        for (int c = 0; c < 3; c++)
            if (m->fixed_mask[k] >> c & 1) {
                largest = larger(largest, fabs(value_at(m, v, m->fixed_node[k], c)));
                (*count)++;
            }
    return largest;
}

/* The quarter pad: its base held in all components, its symmetry planes in one. */
static int set_up(void **state) {
    fixture *f = calloc(1, sizeof *f);
    fixture_pad((const char *const[]){"geometry.parameters.fine_spacing=10.0",
                                      "geometry.parameters.outer_spacing=20.0", NULL},
                f);
    fixture_start(f);
    *state = f;
    return 0;
}

static int tear_down(void **state) {
    fixture_free(*state);
    free(*state);
    return 0;
}

static void quarter_pad_holds_base_and_symmetry_planes(void **state) {
    const sf_model *m = &((fixture *)*state)->model;
    int64_t base = 0, plane[2] = {0}, axis = 0;
    assert_int_equal(m->symmetry_factor, 4);
    for (int64_t k = 0; k < m->fixed_count; k++) {
        const double *x = &m->position[3 * (int64_t)m->fixed_node[k]];
        int expected = x[2] < 1e-9 ? 7 : (x[0] < 1e-9 ? SF_FIX_X : 0) | (x[1] < 1e-9 ? SF_FIX_Y : 0);
        assert_int_equal(m->fixed_mask[k], expected);
        assert_int_equal(m->fixed_base[k], x[2] < 1e-9);
        base += expected == 7;
        plane[0] += expected == SF_FIX_X;
        plane[1] += expected == SF_FIX_Y;
        axis += expected == (SF_FIX_X | SF_FIX_Y);
    }
    assert_true(base > 100 && plane[0] > 20 && plane[1] > 20);
    assert_int_equal(axis, 5); /* 50 mm of 10 mm cells, without the base */
}

static void held_velocity_is_zero_after_a_step_from_any_motion(void **state) {
    const fixture *f = *state;
    int64_t rows;
    projection p = project(f, 1);
    assert_true(held_velocity(&f->model, p.v, &rows) > 0.1 * p.velocity_size);
    advance(f, &p);
    double residual = held_velocity(&f->model, p.v, &rows);
    assert_close(residual / p.velocity_size, 0, 1e-12);
    assert_true(rows > 500);
    assert_close(p.residual / p.velocity_size, 0, 1e-12); /* what the solver reports is of that size too */
    projection_free(&p);
}

/* The residual that the solver reports is measured, not assumed: masses that are not those of the factor show
 * in it. */
static void reported_residual_is_the_largest_held_velocity(void **state) {
    const fixture *f = *state;
    int64_t rows;
    uint64_t seed = 2;
    fixture heavier = *f; /* shares everything but the masses */
    size_t n = (size_t)f->model.node_count;
    heavier.model.mass = malloc(n * sizeof *heavier.model.mass);
    assert_non_null(heavier.model.mass);
    for (size_t i = 0; i < n; i++)
        heavier.model.mass[i] = f->model.mass[i] * (2 + fixture_random(&seed));
    projection p = project(&heavier, 2);
    advance(&heavier, &p);
    assert_true(p.residual > 1e-3 * p.velocity_size);
    assert_relative(held_velocity(&f->model, p.v, &rows), p.residual, 1e-12);
    for (size_t k = 0; k < 3 * n; k++) /* the other sign has the same size */
        p.v[k] = -p.v[k];
    p.step.dt = 1e-300;
    double turned = sf_constraint_residual(&heavier.model, &f->operators.constraint, &p.step);
    assert_relative(turned, p.residual, 1e-12);
    projection_free(&p);
    free(heavier.model.mass);
}

/* Reactions add up to minus the forces on the pad; those of the base leave out the symmetry planes. */
static void reactions_sum_to_the_force_of_the_base_and_planes(void **state) {
    const fixture *f = *state;
    const sf_model *m = &f->model;
    projection p = project(f, 3);
    double sum[3] = {0}, size = 0;
    for (int64_t k = 0; k < 3 * m->node_count; k++) {
        sum[k % 3] += p.reaction[k];
        size += fabs(p.reaction[k]);
    }
    for (int c = 0; c < 3; c++)
        assert_close((sum[c] + p.step.all[c]) / size, 0, 1e-13);
    assert_close(p.step.base[2], p.step.all[2], 0); /* only the base holds z */
    assert_true(fabs(p.step.base[0] - p.step.all[0]) > 1e-6 * size);
    assert_true(fabs(p.step.base[1] - p.step.all[1]) > 1e-6 * size);
    projection_free(&p);
}

/* Constraint forces do no work on any admissible motion: the projection is orthogonal in the mass. */
static void reactions_do_no_work_on_admissible_motion(void **state) {
    const fixture *f = *state;
    projection p = project(f, 4), other = project(f, 5);
    advance(f, &other);
    double power = 0, size = 0;
    for (int64_t k = 0; k < 3 * f->model.node_count; k++) {
        power += p.reaction[k] * other.v[k];
        size += fabs(p.reaction[k] * other.v[k]);
    }
    assert_close(power / size, 0, 1e-12);
    projection_free(&p);
    projection_free(&other);
}

static void projecting_an_admissible_motion_again_changes_nothing(void **state) {
    const fixture *f = *state;
    projection p = project(f, 6);
    double first = 0, second = 0;
    for (int64_t k = 0; k < 3 * f->model.node_count; k++)
        first = larger(first, fabs(p.reaction[k]));
    advance(f, &p);
    memset(p.force, 0, 3 * (size_t)f->model.node_count * sizeof *p.force);
    sf_constraint_project(&f->operators.constraint, &p.step);
    for (int64_t k = 0; k < 3 * f->model.node_count; k++)
        second = larger(second, fabs(p.reaction[k]));
    assert_close(second / first, 0, 1e-12);
    projection_free(&p);
}

/* Two held points with the same row of shape functions: one of them says nothing new. */
static void repeated_constraint_is_refused(void **state) {
    (void)state;
    const fixture_block block = {.cells = {4, 4, 4}, .spacing = 0.01};
    sf_error err = SF_ERROR_INIT;
    sf_constraint constraint;
    fixture f;
    fixture_held_block(&block, &f);
    sf_model *m = &f.model;
    assert_int_equal(sf_constraint_build(m, &constraint, &err), SF_OK);
    sf_constraint_free(&constraint);
    int64_t a = -1, b = -1; /* two held nodes with rows of one length */
    for (int64_t i = 0; i < m->fixed_count && b < 0; i++)
        for (int64_t j = i + 1; j < m->fixed_count && b < 0; j++) {
            a = m->fixed_node[i];
            if (m->phi_ptr[a + 1] - m->phi_ptr[a] ==
                m->phi_ptr[m->fixed_node[j] + 1] - m->phi_ptr[m->fixed_node[j]])
                b = m->fixed_node[j];
        }
    assert_true(b >= 0);
    size_t length = (size_t)(m->phi_ptr[a + 1] - m->phi_ptr[a]);
    memcpy(&m->phi_node[m->phi_ptr[b]], &m->phi_node[m->phi_ptr[a]], length * sizeof *m->phi_node);
    memcpy(&m->phi_value[m->phi_ptr[b]], &m->phi_value[m->phi_ptr[a]], length * sizeof *m->phi_value);
    assert_int_equal(sf_constraint_build(m, &constraint, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "depend on each other"));
    assert_non_null(strstr(err.text, "kernel.support_ratio"));
    assert_int_equal(constraint.rows, 0); /* released */
    fixture_free(&f);
}

/* Wide kernels make the rows nearly dependent: an honest refusal, or constraints that hold as well as any. */
static void wide_kernels_hold_or_are_refused(void **state) {
    (void)state;
    static const char *const ratio[] = {"kernel.support_ratio=1.8", "kernel.support_ratio=2.2",
                                        "kernel.support_ratio=2.6"};
    int refused = 0;
    for (size_t k = 0; k < sizeof ratio / sizeof ratio[0]; k++) {
        const fixture_block block = {.cells = {6, 6, 5}, .spacing = 0.01, .jitter = 0.1};
        sf_case c;
        sf_error err = SF_ERROR_INIT;
        int64_t rows;
        fixture f;
        fixture_case(&c, (const char *const[]){ratio[k], NULL});
        fixture_hold(&c, (const char *const[]){"base", NULL});
        fixture_under_plate(&c, &block, 1, 0, 0, &f);
        if (sf_operators_build(&f.model, &f.operators, &err) == SF_OK) {
            projection p = project(&f, 8);
            advance(&f, &p);
            assert_close(held_velocity(&f.model, p.v, &rows) / p.velocity_size, 0, 1e-10);
            projection_free(&p);
        } else {
            refused++;
            assert_int_equal(err.status, SF_ERR_MODEL);
            assert_non_null(strstr(err.text, "depend on each other"));
        }
        fixture_free(&f);
    }
    assert_true(refused < 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quarter_pad_holds_base_and_symmetry_planes),
        cmocka_unit_test(held_velocity_is_zero_after_a_step_from_any_motion),
        cmocka_unit_test(reported_residual_is_the_largest_held_velocity),
        cmocka_unit_test(reactions_sum_to_the_force_of_the_base_and_planes),
        cmocka_unit_test(reactions_do_no_work_on_admissible_motion),
        cmocka_unit_test(projecting_an_admissible_motion_again_changes_nothing),
        cmocka_unit_test(repeated_constraint_is_refused),
        cmocka_unit_test(wide_kernels_hold_or_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
