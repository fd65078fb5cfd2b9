/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patch tests of the smoothed Galerkin method on a jittered block, on one with a slit and on the real pad
 * with its hexahedra, pyramids and tetrahedra: exact affine fields, exact equilibrium with held u_h,
 * invariance under rigid motion, momentum. */
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

static const double GRADIENT[9] = {0.06, -0.11, 0.04, 0.09, -0.05, 0.13, -0.07, 0.08, -0.32};
static const double SHIFT[3] = {0.013, -0.004, 0.021};
static const double STILL[3] = {0, 0, 0};

enum { BLOCK, PAD, SLIT, MODELS };

/* All models, every node of the surface held. */
static int set_up(void **state) {
    fixture *f = calloc(MODELS, sizeof *f);
    const fixture_block block = {.cells = {6, 5, 5}, .spacing = 0.01, .jitter = 0.25, .surface_jitter = 0.2};
    fixture_held_block(&block, &f[BLOCK]);
    const fixture_block parted = {
        .cells = {8, 5, 7}, .spacing = 0.01, .jitter = 0.15, .surface_jitter = 0.15};
    sf_mesh slit;
    fixture_block_mesh(&parted, &slit);
    fixture_open_slit(&parted, 4, 2, 0.004, &slit);
    fixture_hold_mesh(&slit, &f[SLIT]);

    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    fixture_case(&c, (const char *const[]){"geometry.parameters.fine_spacing=10.0",
                                           "geometry.parameters.outer_spacing=20.0",
                                           "geometry.missile_parameters.quarter=0", NULL});
    fixture_hold(&c, (const char *const[]){"base", "top", "sides", "symmetry_x", "symmetry_y", NULL});
    fixture_geometry(&c, &mesh, &surface);
    fixture_build(&c, &mesh, &surface, &f[PAD]);
    *state = f;
    return 0;
}

static int tear_down(void **state) {
    fixture *f = *state;
    for (int k = 0; k < MODELS; k++)
        fixture_free(&f[k]);
    free(f);
    return 0;
}

static double smallest_spacing(const sf_model *m) {
    double value = INFINITY;
    for (int64_t i = 0; i < m->node_count; i++)
        value = smaller(value, m->spacing[i]);
    return value;
}

/* F = I + `gradient` in every domain. */
static void assert_uniform(const fixture *f, const double gradient[9], double tolerance) {
    for (int64_t i = 0; i < f->model.node_count; i++)
        for (int k = 0; k < 9; k++)
            assert_close(f->state.f[9 * i + k], gradient[k] + (k % 4 == 0), tolerance);
}

static void pad_holds_hexahedra_pyramids_and_tetrahedra(void **state) {
    const fixture *f = *state;
    assert_true(f[PAD].report.cells[SF_CELL_HEXAHEDRON] > 100);
    assert_true(f[PAD].report.cells[SF_CELL_PYRAMID] > 100);
    assert_true(f[PAD].report.cells[SF_CELL_TETRAHEDRON] > 100);
}

static void affine_field_gives_its_gradient_in_every_domain(void **state) {
    fixture *f = *state;
    for (int k = 0; k < MODELS; k++) {
        fixture_start(&f[k]);
        fixture_set_affine(&f[k], GRADIENT, SHIFT);
        fixture_forces(&f[k]);
        assert_uniform(&f[k], GRADIENT, 1e-12);
    }
}

static void affine_field_gives_its_value_at_every_node(void **state) {
    fixture *f = *state;
    for (int k = 0; k < MODELS; k++) {
        const sf_model *m = &f[k].model;
        fixture_start(&f[k]);
        fixture_set_affine(&f[k], GRADIENT, SHIFT);
        for (int64_t i = 0; i < m->node_count; i++)
            for (int r = 0; r < 3; r++) {
                double value = 0;
                for (int64_t q = m->phi_ptr[i]; q < m->phi_ptr[i + 1]; q++)
                    value += m->phi_value[q] * f[k].state.d[3 * (int64_t)m->phi_node[q] + r];
                assert_close(value, f[k].state.d[3 * i + r], 1e-13);
            }
    }
}

/* Uniform stress is in equilibrium with tractions that act at the held points of the surface. */
static void affine_field_with_held_surface_is_in_equilibrium(void **state) {
    fixture *f = *state;
    for (int k = 0; k < MODELS; k++) {
        fixture_start(&f[k]);
        fixture_set_affine(&f[k], GRADIENT, SHIFT);
        fixture_forces(&f[k]);
        assert_close(fixture_held_acceleration(&f[k], &f[k].operators.constraint), 0, 1e-10);
    }
}

/* The same with shape functions at the held nodes replaced by the identity, that is with held coefficients.
 */
static void holding_coefficients_instead_of_displacements_fails_the_patch_test(void **state) {
    fixture *f = *state;
    for (int k = 0; k < MODELS; k++) {
        sf_error err = SF_ERROR_INIT;
        sf_constraint constraint;
        fixture_start(&f[k]);
        fixture_set_affine(&f[k], GRADIENT, SHIFT);
        fixture_forces(&f[k]);
        fixture wrong = f[k];
        sf_model *m = &wrong.model;
        m->phi_ptr = malloc(((size_t)m->node_count + 1) * sizeof *m->phi_ptr);
        m->phi_node = malloc((size_t)m->node_count * sizeof *m->phi_node);
        m->phi_value = malloc((size_t)m->node_count * sizeof *m->phi_value);
        for (int64_t i = 0; i <= m->node_count; i++)
            m->phi_ptr[i] = i;
        for (int64_t i = 0; i < m->node_count; i++) {
            m->phi_node[i] = (int32_t)i;
            m->phi_value[i] = 1;
        }
        assert_int_equal(sf_constraint_build(m, &constraint, &err), SF_OK);
        double wrong_way = fixture_held_acceleration(&wrong, &constraint);
        sf_constraint_free(&constraint);
        free(m->phi_ptr);
        free(m->phi_node);
        free(m->phi_value);
        if (!(wrong_way > 1e-3)) /* some 1e-2: phi of inner nodes is small, not zero, on the surface */
            fail_msg("held coefficients leave only %.3g of the free acceleration", wrong_way);
    }
}

/* 37 degrees about (1, 2, 3): no stress, no force, no stabilisation. */
static void rigid_rotation_and_translation_cost_nothing(void **state) {
    fixture *f = *state;
    double angle = 37 * acos(-1) / 180, axis[3] = {1 / sqrt(14), 2 / sqrt(14), 3 / sqrt(14)}, gradient[9];
    const double cross[9] = {0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0};
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) /* Rodrigues, minus the identity */
            gradient[3 * r + c] =
                sin(angle) * cross[3 * r + c] + (1 - cos(angle)) * (axis[r] * axis[c] - (r == c));
    for (int k = 0; k < MODELS; k++) {
        const sf_model *m = &f[k].model;
        const sf_state *s = &f[k].state;
        double h = smallest_spacing(m), modulus = sf_foam_card_of(&m->material[0])->modulus, energy = 0;
        fixture_start(&f[k]);
        fixture_set_affine(&f[k], gradient, SHIFT);
        fixture_forces(&f[k]);
        assert_uniform(&f[k], gradient, 1e-12);
        for (int64_t i = 0; i < m->node_count; i++)
            assert_close(largest_of(&s->stress[9 * i], 9) / (m->volume[i] * modulus), 0, 1e-11);
        assert_close(largest_of(s->force, 3 * m->node_count) / (modulus * h * h), 0, 1e-11);
        for (int64_t chunk = 0; chunk < s->chunk_count; chunk++)
            energy += s->partial[chunk].stabilisation + s->partial[chunk].stored;
        assert_close(energy / (modulus * h * h * h), 0, 1e-18);
    }
}

/* A strong random motion with every term of the law: hysteresis, Maxwell, DAMP, stabilisation. */
static void internal_forces_conserve_linear_and_angular_momentum(void **state) {
    fixture *f = *state;
    for (int k = 0; k < MODELS; k++) {
        const sf_model *m = &f[k].model;
        sf_state *s = &f[k].state;
        uint64_t seed = 7;
        fixture_start(&f[k]);
        for (int step = 0; step < 3; step++) {
            for (int64_t q = 0; q < 3 * m->node_count; q++)
                s->d[q] = 0.1 * m->spacing[q / 3] * fixture_random(&seed);
            s->dt_old = step * 1e-5;
            fixture_forces(&f[k]);
        }
        double sum[3] = {0}, moment[3] = {0}, size = 0, moment_size = 0;
        for (int64_t i = 0; i < m->node_count; i++) {
            double x[3];
            const double *force = &s->force[3 * i];
            for (int r = 0; r < 3; r++)
                x[r] = m->position[3 * i + r] + s->d[3 * i + r];
            for (int r = 0; r < 3; r++) {
                sum[r] += force[r];
                moment[r] += x[(r + 1) % 3] * force[(r + 2) % 3] - x[(r + 2) % 3] * force[(r + 1) % 3];
            }
            double force_size = sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
            size += force_size;
            moment_size += force_size * sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        }
        for (int r = 0; r < 3; r++) {
            assert_close(sum[r] / size, 0, 1e-13);
            assert_close(moment[r] / moment_size, 0, 1e-13);
        }
    }
}

static double stored_energy(fixture *f) {
    double sum = 0;
    fixture_forces(f);
    for (int64_t chunk = 0; chunk < f->state.chunk_count; chunk++)
        sum += f->state.partial[chunk].stored;
    return sum;
}

/* Without losses and without stabilisation the law is hyperelastic: forces are the energy's negative
 * gradient. */
static void elastic_forces_are_the_gradient_of_the_stored_energy(void **state) {
    fixture *f = &((fixture *)*state)[BLOCK];
    sf_model *m = &f->model;
    sf_foam_card card = *sf_foam_card_of(&m->material[0]);
    double coefficient = m->run.stabilisation;
    uint64_t seed = 11;
    sf_foam_card_of(&m->material[0])->shared.hysteresis_hu = 1;
    sf_foam_card_of(&m->material[0])->shared.damp = sf_foam_card_of(&m->material[0])->shared.maxwell_modulus =
        m->run.stabilisation = 0;
    fixture_start(f);
    sf_state *s = &f->state;
    fixture_set_affine(f, GRADIENT, STILL); /* away from the kink of the curve's slope at zero strain */
    for (int64_t q = 0; q < 3 * m->node_count; q++)
        s->d[q] += 0.02 * m->spacing[q / 3] * fixture_random(&seed);
    fixture_forces(f);
    size_t bytes = 3 * (size_t)m->node_count * sizeof *s->force;
    double *force = malloc(bytes), scale = 0;
    memcpy(force, s->force, bytes);
    scale = largest_of(force, 3 * m->node_count);
    for (int64_t q = 5; q < 3 * m->node_count; q += 61) {
        double kept = s->d[q], h = 1e-5 * m->spacing[q / 3];
        s->d[q] = kept + h;
        double high = stored_energy(f);
        s->d[q] = kept - h;
        double low = stored_energy(f);
        s->d[q] = kept;
        assert_close(-(high - low) / (2 * h) / scale, force[q] / scale, 2e-6);
    }
    free(force);
    *sf_foam_card_of(&m->material[0]) = card;
    m->run.stabilisation = coefficient;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pad_holds_hexahedra_pyramids_and_tetrahedra),
        cmocka_unit_test(affine_field_gives_its_gradient_in_every_domain),
        cmocka_unit_test(affine_field_gives_its_value_at_every_node),
        cmocka_unit_test(affine_field_with_held_surface_is_in_equilibrium),
        cmocka_unit_test(holding_coefficients_instead_of_displacements_fails_the_patch_test),
        cmocka_unit_test(rigid_rotation_and_translation_cost_nothing),
        cmocka_unit_test(internal_forces_conserve_linear_and_angular_momentum),
        cmocka_unit_test(elastic_forces_are_the_gradient_of_the_stored_energy),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
