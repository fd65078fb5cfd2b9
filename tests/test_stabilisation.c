/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stabilisation: it sees the sawtooth that nodal integration is blind to, leaves smooth fields alone, and
 * its forces are the gradient of its energy. */
#include "extreme.h"
#include "model_fixture.h"
#include "solver/field/domain_stress.h"
#include "solver/field/stabilisation.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

/* Layers of nodes between node i and the surface of the block. */
static int depth_of(const fixture *f, const fixture_block *b, int64_t i) {
    int depth = 1000;
    for (int c = 0; c < 3; c++) {
        int place = (int)lround(f->model.position[3 * i + c] / b->spacing);
        int low = place < b->cells[c] - place ? place : b->cells[c] - place;
        depth = low < depth ? low : depth;
    }
    return depth;
}

/* Half the energy (J) of the pairs of the nodes at `depth` or deeper. */
static double pair_energy(const fixture *f, const fixture_block *b, int depth) {
    const sf_state *s = &f->state;
    double sum = 0;
    for (int64_t i = 0; i < f->model.node_count; i++)
        if (depth_of(f, b, i) >= depth)
            sum += s->pair_energy[i];
    return sum;
}

/* d = -+ a along z by the parity of the lattice place, and its forces. */
static void set_sawtooth(fixture *f, const fixture_block *b, double amplitude) {
    fixture_start(f);
    for (int64_t i = 0; i < f->model.node_count; i++) {
        long parity = 0;
        for (int c = 0; c < 3; c++)
            parity += lround(f->model.position[3 * i + c] / b->spacing);
        f->state.d[3 * i + 2] = parity % 2 ? amplitude : -amplitude;
    }
    fixture_forces(f);
}

/* F = I in the bulk, yet every edge is stretched or shortened by 2 a. */
static void sawtooth_is_invisible_to_the_strain_but_costs_energy(void **state) {
    (void)state;
    const fixture_block block = {.cells = {10, 10, 10}, .spacing = 0.005};
    const double amplitude = 0.0004;
    fixture f;
    fixture_held_block(&block, &f);
    sf_foam_card_of(&f.model.material[0])->modulus *=
        2; /* above the curve's slope: one stiffness on both sides of zero strain */
    set_sawtooth(&f, &block, amplitude);
    double modulus = sf_foam_card_of(&f.model.material[0])->modulus;
    int64_t bulk = 0;
    for (int64_t i = 0; i < f.model.node_count; i++) {
        if (depth_of(&f, &block, i) < 4)
            continue;
        bulk++;
        for (int k = 0; k < 9; k++)
            assert_close(f.state.f[9 * i + k], k % 4 == 0, 1e-13);
        assert_close(fixture_peak(&f, i) / modulus, 0, 1e-24); /* W, the largest of one step */
        /* Six edges of weight c h / 6, k = weight 2 g, |e| = 2 a: half the sum of 1/2 k |e|^2 is 2 c h g a^2.
         */
        double expected =
            2 * f.model.run.stabilisation * block.spacing * amplitude * amplitude * f.state.stiffness[i];
        assert_relative(f.state.pair_energy[i], expected, 1e-10);
        /* Each of the six neighbours pulls back with 2 a pair (g + g). */
        double pull = -6 * (f.model.run.stabilisation * block.spacing / 6) * 2 * f.state.stiffness[i] * 2 *
                      f.state.d[3 * i + 2];
        assert_relative(f.state.force[3 * i + 2], pull, 1e-9);
    }
    assert_int_equal(bulk, 27);

    double pull = f.state.stiffness[0] * block.spacing * amplitude;
    f.model.run.stabilisation = 0; /* plain nodal integration: nothing holds the sawtooth */
    set_sawtooth(&f, &block, amplitude);
    for (int64_t i = 0; i < f.model.node_count; i++)
        if (depth_of(&f, &block, i) >= 4)
            assert_close(f.state.force[3 * i + 2] / pull, 0, 1e-11);
    fixture_free(&f);
}

static void affine_field_has_no_stabilisation_energy(void **state) {
    (void)state;
    const fixture_block block = {.cells = {6, 5, 4}, .spacing = 0.005, .jitter = 0.25, .surface_jitter = 0.2};
    const double gradient[9] = {0.1, 0.2, -0.05, 0.02, -0.1, 0.07, 0.03, -0.2, -0.4}, shift[3] = {1, 2, 3};
    fixture f;
    fixture_held_block(&block, &f);
    fixture_start(&f);
    fixture_set_affine(&f, gradient, shift);
    fixture_forces(&f);
    for (int64_t i = 0; i < f.model.node_count; i++)
        assert_close(f.state.pair_energy[i] /
                         (f.model.run.stabilisation * pow(block.spacing, 3) * f.state.stiffness[i]),
                     0, 1e-22);
    fixture_free(&f);
}

/* A smooth field on a cube of 40 mm with `cells` a side; energies of all nodes and of the middle. */
static void smooth_energy(int cells, double *all, double *middle) {
    const fixture_block block = {.cells = {cells, cells, cells}, .spacing = 0.04 / cells};
    fixture f;
    fixture_held_block(&block, &f);
    fixture_start(&f);
    for (int64_t i = 0; i < f.model.node_count; i++) {
        const double *x = &f.model.position[3 * i];
        f.state.d[3 * i] = 1e-3 * sin(60 * x[0] + 20 * x[2]);
        f.state.d[3 * i + 1] = 1e-3 * cos(50 * x[1] + 30 * x[0]);
        f.state.d[3 * i + 2] = 1e-3 * sin(70 * x[2] - 40 * x[1]);
    }
    fixture_forces(&f);
    *all = pair_energy(&f, &block, 0);
    *middle = pair_energy(&f, &block, cells / 4);
    fixture_free(&f);
}

/* e is of third order in the bulk and of second order at the surface: energy h4 and h3. */
static void energy_of_a_smooth_field_vanishes_with_refinement(void **state) {
    (void)state;
    double all[3], middle[3];
    for (int k = 0; k < 3; k++)
        smooth_energy(8 << k, &all[k], &middle[k]);
    for (int k = 0; k < 2; k++) {
        double order = log2(all[k] / all[k + 1]), bulk_order = log2(middle[k] / middle[k + 1]);
        if (!(order > 2.5 && bulk_order > 3.7))
            fail_msg("orders %.2f (all) and %.2f (middle)", order, bulk_order);
    }
}

/* Total stabilisation energy at fixed stiffness, by the pairs alone. */
static double frozen_energy(fixture *f, const double *stiffness) {
    const sf_model *m = &f->model;
    double sum = 0, force[3], couple[9];
    sf_domain_stress(m, &f->operators, &f->state); /* F of the present d */
    for (int64_t i = 0; i < m->node_count; i++)
        sum += fixture_pairs(f, stiffness, i, force, couple);
    return sum;
}

/* A pair between two groups stands in both, with opposite arms and offsets. */
static void make_outer_offsets_opposite(fixture *f) {
    const sf_pairs *p = &f->operators.pairs;
    double *offset = f->state.pair_offset + 3 * p->inner_ptr[p->groups];
    for (int64_t g = 0; g < p->groups; g++)
        for (int64_t i = g * SF_GROUP, k = p->outer_ptr[g]; i < sf_halo_end(&f->model, g); i++)
            for (; k < p->outer_ptr[g] + p->outer_end[i]; k++) {
                int64_t j = p->outer_node[k], h = j / SF_GROUP,
                        first = j > h * SF_GROUP ? p->outer_end[j - 1] : 0;
                for (int64_t q = p->outer_ptr[h] + first; q < p->outer_ptr[h] + p->outer_end[j]; q++)
                    for (int c = 0; c < 3 && p->outer_node[q] == i; c++)
                        offset[3 * q + c] = -offset[3 * k + c];
            }
}

/* At frozen stiffness the energy is quadratic in d: central differences are exact but for rounding. */
static void forces_are_the_negative_gradient_of_the_energy(void **state) {
    (void)state;
    const fixture_block block = {.cells = {4, 4, 3}, .spacing = 0.01, .jitter = 0.25, .surface_jitter = 0.1};
    fixture f;
    uint64_t seed = 3;
    fixture_held_block(&block, &f);
    fixture_start(&f);
    sf_state *s = &f.state;
    const sf_model *m = &f.model;
    int64_t n = m->node_count;
    double *stiffness = malloc((size_t)n * sizeof *stiffness), *force = calloc(3 * (size_t)n, sizeof *force);
    for (int64_t i = 0; i < n; i++)
        stiffness[i] = sf_foam_card_of(&m->material[0])->modulus *
                       (2 + fixture_random(&seed)); /* as it differs from node to node */
    for (int64_t q = 0; q < 3 * n; q++)
        s->d[q] = 0.1 * block.spacing * fixture_random(&seed);
    for (int64_t q = 0; q < 3 * sf_pairs_count(m); q++)
        s->pair_offset[q] = 0.1 * block.spacing * fixture_random(&seed);
    make_outer_offsets_opposite(&f);
    for (int64_t g = 0; g < f.operators.pairs.groups; g++)
        s->group_has_offsets[g] = 1;
    sf_domain_stress(m, &f.operators, s);
    double scale = 0;
    for (int64_t i = 0; i < n; i++) {
        double pull[3], couple[9];
        fixture_pairs(&f, stiffness, i, pull, couple);
        for (int r = 0; r < 3; r++)
            force[3 * i + r] += pull[r];
        for (int64_t k = m->domain_ptr[i]; k < m->domain_ptr[i + 1]; k++)
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++)
                    force[3 * (int64_t)m->domain_node[k] + r] -= couple[3 * r + c] * m->domain_b[3 * k + c];
    } /* of a couple 1/2 k e (X + P) of both nodes */
    for (int64_t q = 0; q < 3 * n; q++)
        scale = larger(scale, fabs(force[q]));
    for (int64_t q = 0; q < 3 * n; q += 7) {
        double kept = s->d[q], h = 0.1 * block.spacing;
        s->d[q] = kept + h;
        double high = frozen_energy(&f, stiffness);
        s->d[q] = kept - h;
        double low = frozen_energy(&f, stiffness);
        s->d[q] = kept;
        assert_close(-(high - low) / (2 * h) / scale, force[q] / scale, 1e-11);
    }
    free(stiffness);
    free(force);
    fixture_free(&f);
}

/* Stiffness that follows the tangent: never below E, and the energy scales with the coefficient. From no
 * energy at the stiffness E the work is that at E: what the rise of the stiffness would add is left out by
 * the offsets. */
static void energy_is_proportional_to_the_coefficient_and_tied_to_the_tangent(void **state) {
    (void)state;
    const fixture_block block = {.cells = {4, 4, 4}, .spacing = 0.01};
    const double squeeze[9] = {[8] = -0.7}, still[3] = {0};
    fixture f;
    fixture_held_block(&block, &f);
    double energy[2], coefficient = f.model.run.stabilisation;
    for (int k = 0; k < 2; k++) {
        uint64_t seed = 5;
        f.model.run.stabilisation = (k + 1) * coefficient;
        fixture_start(&f);
        fixture_set_affine(&f, squeeze, still);
        for (int64_t q = 0; q < 3 * f.model.node_count; q++)
            f.state.d[q] += 0.01 * block.spacing * fixture_random(&seed);
        fixture_forces(&f);
        double work = 0;
        energy[k] = 0;
        for (int64_t chunk = 0; chunk < f.state.chunk_count; chunk++)
            work += f.state.partial[chunk].stabilisation;
        for (int64_t i = 0; i < f.model.node_count; i++)
            energy[k] += f.state.pair_energy[i];
        assert_relative(work, energy[k], 1e-12);
    }
    assert_relative(energy[1], 2 * energy[0], 1e-12);
    for (int64_t i = 0; i < f.model.node_count; i++) /* at 70 % the curve is some ten times stiffer than E */
        assert_true(f.state.stiffness[i] > 5 * sf_foam_card_of(&f.model.material[0])->modulus);
    fixture_free(&f);
}

/* The stabilisation of the present d and of given stiffnesses, in place of the law's; the state goes on from
 * there. */
static void stabilise(fixture *f, const double *stiffness) {
    sf_domain_stress(&f->model, &f->operators, &f->state);
    memcpy(f->state.stiffness, stiffness, (size_t)f->model.node_count * sizeof *stiffness);
    sf_stabilisation(&f->model, &f->operators, &f->state);
}

static double sum_work(const fixture *f) {
    double work = 0;
    for (int64_t chunk = 0; chunk < f->state.chunk_count; chunk++)
        work += f->state.partial[chunk].stabilisation;
    return work;
}

static double sum_energy(const fixture *f) {
    double energy = 0;
    for (int64_t i = 0; i < f->model.node_count; i++)
        energy += f->state.pair_energy[i];
    return energy;
}

/* Along a random path of nodes and stiffnesses, by factors of up to ten either way: no change of stiffness
 * raises the energy of the pairs of any node, all work so far is at least the energy held, and forces and
 * couples balance. */
static void no_change_of_stiffness_creates_energy(void **state) {
    (void)state;
    const fixture_block block = {.cells = {4, 4, 3}, .spacing = 0.01, .jitter = 0.25, .surface_jitter = 0.1};
    fixture f;
    fixture_held_block(&block, &f);
    fixture_start(&f);
    uint64_t seed = 11;
    sf_state *s = &f.state;
    int64_t n = f.model.node_count;
    double rest = sf_material_rest_modulus(&f.model.material[0]), work = 0;
    double *stiffness = malloc((size_t)n * sizeof *stiffness), *held = malloc((size_t)n * sizeof *held);
    for (int64_t i = 0; i < n; i++)
        stiffness[i] = rest;
    for (int step = 0; step < 60; step++) {
        for (int64_t q = 0; q < 3 * n; q++)
            s->d[q] += 0.02 * block.spacing * fixture_random(&seed);
        stabilise(&f, stiffness); /* the same stiffness: work alone */
        work += sum_work(&f);
        double energy = sum_energy(&f);
        assert_true(work >= energy * (1 - 1e-12) && energy >= 0);
        memcpy(held, s->pair_energy, (size_t)n * sizeof *held);
        for (int64_t i = 0; i < n; i++)
            stiffness[i] = rest * pow(10, 1 + fixture_random(&seed));
        stabilise(&f, stiffness); /* the same place */
        assert_close(sum_work(&f) / energy, 0, 1e-12);
        for (int64_t i = 0; i < n; i++)
            assert_true(s->pair_energy[i] <= held[i] * (1 + 1e-12));
        double force[3] = {0}, size = 0;
        for (int64_t i = 0; i < n; i++)
            for (int r = 0; r < 3; r++) {
                force[r] += s->force[3 * i + r];
                size += fabs(s->force[3 * i + r]);
            }
        assert_close((fabs(force[0]) + fabs(force[1]) + fabs(force[2])) / size, 0, 1e-14);
    }
    for (int64_t i = 0; i < n; i++)
        stiffness[i] = 1e-3 * rest; /* much energy is set free: every offset goes */
    stabilise(&f, stiffness);
    stabilise(&f, stiffness);
    for (int64_t q = 0; q < 3 * sf_pairs_count(&f.model); q++)
        assert_close(s->pair_offset[q], 0, 0);
    free(stiffness);
    free(held);
    fixture_free(&f);
}

/* Offsets are of the undeformed pad: a rotation of the deformed one keeps the energy and turns the forces. */
static void offsets_turn_with_the_pad(void **state) {
    (void)state;
    const fixture_block block = {.cells = {4, 3, 3}, .spacing = 0.01, .jitter = 0.2, .surface_jitter = 0.1};
    fixture f;
    fixture_held_block(&block, &f);
    fixture_start(&f);
    uint64_t seed = 7;
    sf_state *s = &f.state;
    int64_t n = f.model.node_count;
    const double c = cos(0.7), z = sin(0.7), turn[9] = {c, -z, 0, z, c, 0, 0, 0, 1};
    double *stiffness = malloc((size_t)n * sizeof *stiffness), *force = malloc(3 * (size_t)n * sizeof *force);
    for (int64_t i = 0; i < n; i++)
        stiffness[i] = 10 * sf_material_rest_modulus(&f.model.material[0]);
    for (int64_t q = 0; q < 3 * n; q++)
        s->d[q] += 0.1 * block.spacing * fixture_random(&seed);
    stabilise(&f, stiffness); /* offsets */
    stabilise(&f, stiffness);
    double energy = sum_energy(&f), size = 0, off = 0;
    memcpy(force, s->force, 3 * (size_t)n * sizeof *force);
    for (int64_t q = 0; q < 3 * sf_pairs_count(&f.model); q++)
        off = larger(off, fabs(s->pair_offset[q]));
    assert_true(off > 1e-3 * block.spacing);
    for (int64_t i = 0; i < n; i++) {
        const double *at = &sf_model_coefficients(&f.model)[3 * i];
        double x[3];
        for (int r = 0; r < 3; r++)
            x[r] = at[r] + s->d[3 * i + r];
        for (int r = 0; r < 3; r++)
            s->d[3 * i + r] = turn[3 * r] * x[0] + turn[3 * r + 1] * x[1] + turn[3 * r + 2] * x[2] - at[r];
    }
    stabilise(&f, stiffness);
    assert_relative(sum_energy(&f), energy, 1e-12);
    for (int64_t i = 0; i < n; i++)
        for (int r = 0; r < 3; r++)
            size = larger(size, fabs(force[3 * i + r]));
    for (int64_t i = 0; i < n; i++)
        for (int r = 0; r < 3; r++) {
            const double *g = &force[3 * i], *row = &turn[3 * r];
            assert_close(s->force[3 * i + r] / size, (row[0] * g[0] + row[1] * g[1] + row[2] * g[2]) / size,
                         1e-12);
        }
    free(stiffness);
    free(force);
    fixture_free(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sawtooth_is_invisible_to_the_strain_but_costs_energy),
        cmocka_unit_test(affine_field_has_no_stabilisation_energy),
        cmocka_unit_test(energy_of_a_smooth_field_vanishes_with_refinement),
        cmocka_unit_test(forces_are_the_negative_gradient_of_the_energy),
        cmocka_unit_test(energy_is_proportional_to_the_coefficient_and_tied_to_the_tangent),
        cmocka_unit_test(no_change_of_stiffness_creates_energy),
        cmocka_unit_test(offsets_turn_with_the_pad),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
