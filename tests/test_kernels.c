/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vectorised kernels against plain scalar code, on random states that reach every branch. */
#include "extreme.h"
#include "foam_fixture.h"
#include "model_fixture.h"
#include "solver/field/domain_stress.h"
#include "solver/time_step.h"

#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

enum { TRIALS = 400 };

/* Points that took a branch of the law. */
typedef struct visits {
    int pulled, cut, dense, unloaded, repeated, resting;
} visits;

/* Stretches of lane l: compression, tension, densified foam, and where `special`, equal stretches and rest.
 * With curves at several rates rounding decides there: which of two shortest directions gives the rate, and
 * on which side of rest the overstress begins. */
static void random_stretches(uint64_t *seed, int trial, int l, bool special, double x[3]) {
    for (int i = 0; i < 3; i++)
        x[i] = point_random(seed, 0.12, 1.3);
    if (special && (trial + l) % 5 == 0)
        x[1] = x[0];
    if (special && (trial + l) % 7 == 0)
        x[0] = x[1] = 1;
    if (special && (trial + l) % 11 == 0)
        x[2] = 1 + point_random(seed, -2e-6, 2e-6);
}

static void random_batch(uint64_t *seed, int trial, bool special, sf_law_batch *b) {
    foam_reset(b);
    for (int l = 0; l < SF_LANES; l++) {
        double x[3], left[9], right[9], diagonal[9] = {0}, product[9], f[9];
        random_stretches(seed, trial, l, special, x);
        for (int i = 0; i < 3; i++)
            diagonal[4 * i] = x[i];
        point_rotation(seed, left);
        point_rotation(seed, right);
        point_product(left, diagonal, product);
        point_product(product, right, f);
        foam_set(b->f, l, (trial + l) % 13 == 0 ? diagonal : f);
        for (int k = 0; k < 9; k++)
            b->f_old[k][l] = b->f[k][l] + point_random(seed, -1e-3, 1e-3);
        for (int k = 0; k < 6; k++)
            b->history[SF_FOAM_MAXWELL + k][l] = point_random(seed, -1e5, 1e5);
        b->length[l] = point_random(seed, 1e-3, 1e-2);
        b->history[SF_FOAM_PEAK][l] = (trial + l) % 3 == 0 ? 0 : point_random(seed, 0, 2e5);
        b->history[SF_FOAM_RATE][l] = point_random(seed, 0, 120);
    }
}

static void count_visits(const sf_foam *foam, const sf_law_batch *b, visits *v) {
    for (int l = 0; l < SF_LANES; l++) {
        double x = b->stretch[0][l], y = b->stretch[1][l], z = b->stretch[2][l];
        double longest = fmax(x, fmax(y, z)), shortest = fmin(x, fmin(y, z));
        v->pulled += longest > 1.001;
        v->cut += (longest - 1) * foam->modulus > foam->cutoff;
        v->dense += 1 - shortest > foam->curve[0].start;
        v->unloaded += b->factor[l] < 1;
        v->repeated += fabs(x - y) < 1e-7 || fabs(y - z) < 1e-7 || fabs(x - z) < 1e-7;
        v->resting += fabs(x - 1) < 1e-6 || fabs(y - 1) < 1e-6 || fabs(z - 1) < 1e-6;
    }
}

/* One output of all lanes, relative to the largest of its components in the lane. */
static void compare(const char *name, int rows, double a[][SF_LANES], double b[][SF_LANES],
                    double tolerance) {
    for (int l = 0; l < SF_LANES; l++) {
        double size = 0;
        for (int k = 0; k < rows; k++)
            size = larger(size, fabs(b[k][l]));
        for (int k = 0; k < rows; k++)
            if (!(fabs(a[k][l] - b[k][l]) <= tolerance * size))
                fail_msg("%s %d of lane %d: %.17g, the reference %.17g", name, k, l, a[k][l], b[k][l]);
    }
}

static void compare_batches(sf_law_batch *a, sf_law_batch *b) {
    compare("P", 9, a->p, b->p, 1e-11);
    compare("S of the Maxwell branch", 6, &a->history[SF_FOAM_MAXWELL], &b->history[SF_FOAM_MAXWELL], 1e-12);
    compare("stretch", 3, a->stretch, b->stretch, 1e-13);
    compare("det F", 1, &a->jacobian, &b->jacobian, 1e-12);
    compare("W", 1, &a->energy, &b->energy, 1e-11);
    compare("largest W", 1, &a->history[SF_FOAM_PEAK], &b->history[SF_FOAM_PEAK], 1e-11);
    compare("rate", 1, &a->history[SF_FOAM_RATE], &b->history[SF_FOAM_RATE], 1e-11);
    compare("hysteresis factor", 1, &a->factor, &b->factor, 1e-11);
    compare("stiffness", 1, &a->stiffness, &b->stiffness, 1e-11);
    compare("recoverable energy", 1, &a->stored, &b->stored, 1e-11);
    compare("lost energy", 1, &a->lost, &b->lost, 1e-11);
    compare("viscous work", 1, &a->work, &b->work, 1e-9);
    compare("tangent by direction", 3, a->direction_tangent, b->direction_tangent, 1e-8);
    compare("viscosity by direction", 3, a->direction_viscosity, b->direction_viscosity, 1e-10);
    compare("tangent", 1, &a->tangent, &b->tangent, 1e-8);
    compare("viscosity", 1, &a->viscosity, &b->viscosity, 1e-10);
    compare("A", 6, a->directional, b->directional, 1e-8);
}

static void compare_law(point_card *card, double dt, uint64_t seed) {
    sf_foam foam;
    visits seen = {0};
    bool special = card->card.curves.curve_count == 1;
    foam_build(card, &foam);
    for (int trial = 0; trial < TRIALS; trial++) {
        sf_law_batch kernel, plain;
        random_batch(&seed, trial, special, &kernel);
        plain = kernel;
        sf_foam_update(&foam, dt, &kernel);
        for (int l = 0; l < SF_LANES; l++)
            foam_reference_update(&foam, dt, &plain, l);
        compare_batches(&kernel, &plain);
        count_visits(&foam, &kernel, &seen);
    }
    assert_true(seen.pulled > 100 && seen.cut > 100 && seen.dense > 100 && seen.unloaded > 100);
    assert_true((seen.repeated > 100) == special && (seen.resting > 100) == special);
    sf_foam_free(&foam);
}

static void make_card(point_card *card) {
    point_card_init(card);
    point_card_add_eva(card, 1, 60, 0.8, 1);
    card->card.tension_cutoff = 6e4; /* from a stretch of 1.15 */
    card->card.shared.hysteresis_hu = 0.01;
    card->card.shared.hysteresis_shape = 1;
    card->card.shared.damp = 0.35;
    card->card.shared.maxwell_modulus = 3e6;
    card->card.shared.maxwell_rate = 5000;
}

static void foam_law_is_that_of_the_reference(void **state) {
    (void)state;
    static point_card card;
    make_card(&card);
    compare_law(&card, 1e-5, 1);
    compare_law(&card, 0, 2);
    card.card.shared.hysteresis_shape = 2.7;
    card.card.shared.kelvin_viscosity = 50;
    card.card.densification_limit = 1.05;
    card.card.densification_exponent = 1.4;
    compare_law(&card, 1e-5, 3);
}

static void foam_law_with_rates_is_that_of_the_reference(void **state) {
    (void)state;
    static point_card card;
    make_card(&card);
    point_card_add_eva(&card, 100, 60, 0.8, 1.5);
    compare_law(&card, 1e-5, 4);
}

static void curve_over_lanes_is_the_curve(void **state) {
    (void)state;
    static point_card card;
    sf_foam foam;
    make_card(&card);
    foam_build(&card, &foam);
    const sf_curve *curve = &foam.curve[0];
    double last = nextafter(curve->start, 0);
    const double strain[SF_LANES] = {0,    -0.3, 0.4 * curve->step, 511 * curve->step, last, curve->start,
                                     0.97, 1};
    double stress[SF_LANES], slope[SF_LANES], energy[SF_LANES];
    sf_curve_evaluate_lanes(curve, strain, stress, slope, energy);
    for (int l = 0; l < SF_LANES; l++) {
        double t, g, w;
        sf_curve_evaluate(curve, fmax(0, strain[l]), &t, &g, &w);
        if (isinf(t)) {
            assert_true(l == 7 && stress[l] == t && slope[l] == t && energy[l] == t);
            continue;
        }
        assert_close(stress[l], t, 1e-13 * fabs(t));
        assert_close(slope[l], g, 1e-10 * fabs(g));
        assert_close(energy[l], w, 1e-13 * fabs(w));
    }
    sf_foam_free(&foam);
}

/* ---- sums over neighbours ---- */

/* A block of several groups of domains, irregular, with a random displacement and its forces. */
static void start_block(fixture *f) {
    const fixture_block block = {.cells = {9, 8, 7}, .spacing = 0.01, .jitter = 0.2, .surface_jitter = 0.1};
    uint64_t seed = 8;
    fixture_held_block(&block, f);
    fixture_start(f);
    assert_true(f->operators.halo.group_count > 3);
    for (int64_t q = 0; q < 3 * f->model.node_count; q++)
        f->state.d[q] = 5e-4 * fixture_random(&seed);
}

/* Theory eq. 7, entry by entry. */
static void plain_gradient(const sf_model *m, const double *d, int64_t l, double f[9]) {
    for (int k = 0; k < 9; k++)
        f[k] = k % 4 == 0;
    for (int64_t k = m->domain_ptr[l]; k < m->domain_ptr[l + 1]; k++)
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                f[3 * r + c] += d[3 * (int64_t)m->domain_node[k] + r] * m->domain_b[3 * k + c];
}

static void deformation_gradients_are_those_of_the_definition(void **state) {
    (void)state;
    fixture f;
    start_block(&f);
    sf_domain_stress(&f.model, &f.operators, &f.state);
    for (int64_t l = 0; l < f.model.node_count; l++) {
        double plain[9];
        plain_gradient(&f.model, f.state.d, l, plain);
        assert_close(point_distance(9, &f.state.f[9 * l], plain), 0, 1e-14);
    }
    fixture_free(&f);
}

/* A pad that grows everywhere: lanes behind the last node must not pass for the most compressed one. */
static void spare_lanes_say_nothing(void **state) {
    (void)state;
    const fixture_block block = {.cells = {4, 4, 4}, .spacing = 0.01};
    fixture f;
    fixture_held_block(&block, &f);
    fixture_start(&f);
    int64_t n = f.model.node_count;
    assert_true(n % SF_LANES != 0);
    for (int64_t k = 0; k < 3 * n; k++)
        f.state.d[k] = 0.01 * f.model.position[k];
    sf_domain_stress(&f.model, &f.operators, &f.state);
    for (int64_t k = 0; k < f.state.chunk_count; k++) {
        const sf_partial *p = &f.state.partial[k];
        assert_true(p->jacobian_node >= k * SF_CHUNK && p->jacobian_node < n);
        assert_relative(p->jacobian, 1.01 * 1.01 * 1.01, 1e-12);
        assert_relative(p->shortest, 1.01, 1e-12);
    }
    fixture_free(&f);
}

/* Theory eq. 8, by scattering. */
static void internal_forces_are_those_of_the_definition(void **state) {
    (void)state;
    fixture f;
    start_block(&f);
    const sf_model *m = &f.model;
    int64_t n = 3 * m->node_count;
    double *plain = test_calloc((size_t)n, sizeof *plain);
    sf_domain_stress(m, &f.operators, &f.state);
    memset(f.state.force, 0, (size_t)n * sizeof *f.state.force);
    sf_internal_force(m, &f.operators, &f.state);
    for (int64_t l = 0; l < m->node_count; l++)
        for (int64_t k = m->domain_ptr[l]; k < m->domain_ptr[l + 1]; k++)
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++)
                    plain[3 * (int64_t)m->domain_node[k] + r] -=
                        f.state.stress[9 * l + 3 * r + c] * m->domain_b[3 * k + c];
    double size = 0;
    for (int64_t q = 0; q < n; q++)
        size = larger(size, fabs(plain[q]));
    assert_close(point_distance((int)n, f.state.force, plain) / size, 0, 1e-13);
    test_free(plain);
    fixture_free(&f);
}

/* Theory eq. 24 to 26, pair by pair. */
static void stabilisation_is_that_of_the_definition(void **state) {
    (void)state;
    fixture f;
    start_block(&f);
    const sf_model *m = &f.model;
    const sf_state *s = &f.state;
    sf_domain_stress(m, &f.operators, &f.state);
    for (int64_t i = 0; i < m->node_count; i++) {
        double force[3], couple[9], plain_force[3] = {0}, plain_couple[9] = {0}, sum = 0;
        for (int64_t k = m->edge_ptr[i]; k < m->edge_ptr[i + 1]; k++) {
            int64_t j = m->edge_node[k];
            double weight = fixture_pair_weight(m, i, j) * (s->stiffness[i] + s->stiffness[j]);
            for (int r = 0; r < 3; r++) {
                double e = s->d[3 * j + r] - s->d[3 * i + r];
                for (int c = 0; c < 3; c++) {
                    double arm = m->position[3 * j + c] - m->position[3 * i + c];
                    e += ((r == c) - 0.5 * (s->f[9 * i + 3 * r + c] + s->f[9 * j + 3 * r + c])) * arm;
                }
                sum += 0.25 * weight * e * e;
                plain_force[r] += weight * e;
                for (int c = 0; c < 3; c++)
                    plain_couple[3 * r + c] -=
                        0.5 * weight * e * (m->position[3 * j + c] - m->position[3 * i + c]);
            }
        }
        double value = fixture_pairs(&f, s->stiffness, i, force, couple);
        assert_close(value, sum, 1e-12 * sum);
        assert_close(point_distance(3, force, plain_force), 0, 1e-11 * point_norm(3, plain_force));
        assert_close(point_distance(9, couple, plain_couple), 0, 1e-11 * point_norm(9, plain_couple));
    }
    fixture_free(&f);
}

/* The first step measures the highest frequency: the same seed, other threads, the same bits. */
static void sums_do_not_depend_on_the_threads(void **state) {
    (void)state;
    fixture f[2];
    for (int k = 0; k < 2; k++) {
        omp_set_num_threads(k ? 3 : 1);
        start_block(&f[k]);
        fixture_forces(&f[k]);
        sf_time_step_choose(&f[k].model, &f[k].operators, &f[k].state);
    }
    omp_set_num_threads(1);
    size_t bytes = 3 * (size_t)f[0].model.node_count * sizeof(double);
    assert_memory_equal(f[0].state.force, f[1].state.force, bytes);
    assert_memory_equal(f[0].state.mode, f[1].state.mode, bytes / 3);
    assert_true(f[0].state.dt == f[1].state.dt);
    for (int k = 0; k < 2; k++)
        fixture_free(&f[k]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(foam_law_is_that_of_the_reference),
        cmocka_unit_test(foam_law_with_rates_is_that_of_the_reference),
        cmocka_unit_test(curve_over_lanes_is_the_curve),
        cmocka_unit_test(deformation_gradients_are_those_of_the_definition),
        cmocka_unit_test(spare_lanes_say_nothing),
        cmocka_unit_test(internal_forces_are_those_of_the_definition),
        cmocka_unit_test(stabilisation_is_that_of_the_definition),
        cmocka_unit_test(sums_do_not_depend_on_the_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
