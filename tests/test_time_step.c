/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time step against exact eigenvalues of small assembled models, and against what leap-frog really
 * tolerates. */
#include "extreme.h"
#include "model_fixture.h"
#include "point_fixture.h"

#include "material/hyperfoam.h"
#include "solver/step.h"
#include "solver/time_step.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const double REST[9] = {0};
static const double SQUEEZED[9] = {0.02, 0, 0.05, 0, -0.03, 0, 0.04, 0, -0.55};
static const double CRUSHED[9] = {0.02, 0, 0.05, 0, -0.03, 0, 0.04, 0, -0.75};
static const double EASED[9] = {-0.05, 0, 0.01, 0, -0.04, 0, 0.02, 0, -0.07};
static const double SHEARED[9] = {0.3, -0.6, 0.1, 0.5, 0.2,
                                  0.4, -0.2, 0.1, -0.6}; /* turned, pulled and pressed */

/* Largest eigenvalue of the symmetric n x n matrix a (destroyed): cyclic Jacobi (Golub, Van Loan,
 * section 8.5). */
static double largest_eigenvalue(double *a, int64_t n) {
    for (int sweep = 0; sweep < 30; sweep++) {
        double off = 0, diagonal = 0;
        for (int64_t i = 0; i < n; i++)
            for (int64_t j = 0; j < n; j++)
                *(i == j ? &diagonal : &off) += a[i * n + j] * a[i * n + j];
        if (off < 1e-22 * diagonal)
            break;
        for (int64_t p = 0; p < n; p++)
            for (int64_t q = p + 1; q < n; q++) {
                if (a[p * n + q] == 0)
                    continue;
                double tau = (a[q * n + q] - a[p * n + p]) / (2 * a[p * n + q]);
                double t = (tau >= 0 ? 1 : -1) / (fabs(tau) + sqrt(1 + tau * tau)), c = 1 / sqrt(1 + t * t),
                       s = t * c;
                for (int64_t k = 0; k < n; k++) {
                    double x = a[k * n + p], y = a[k * n + q];
                    a[k * n + p] = c * x - s * y;
                    a[k * n + q] = s * x + c * y;
                }
                for (int64_t k = 0; k < n; k++) {
                    double x = a[p * n + k], y = a[q * n + k];
                    a[p * n + k] = c * x - s * y;
                    a[q * n + k] = s * x + c * y;
                }
            }
    }
    double largest = -INFINITY;
    for (int64_t i = 0; i < n; i++)
        largest = larger(largest, a[i * n + i]);
    return largest;
}

static double *matrix(int64_t n) {
    double *a = calloc((size_t)(n * n), sizeof *a);
    assert_non_null(a);
    return a;
}

/* a += weight row column^T */
static void add_product(double *a, int64_t n, double weight, const double *row, const double *column) {
    for (int64_t i = 0; i < n; i++)
        for (int64_t j = 0; j < n; j++)
            a[i * n + j] += weight * row[i] * column[j];
}

/* Exact largest eigenvalue of M^-1 K, K = sum V B^T A B plus the pairs, from the definitions. */
static double scalar_eigenvalue(const fixture *f) {
    const sf_model *m = &f->model;
    const sf_state *s = &f->state;
    static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    int64_t n = m->node_count;
    double *a = matrix(n), *gradient = calloc(3 * (size_t)(n * n), sizeof *gradient),
           *row = calloc((size_t)n, sizeof *row);
    assert_true(gradient && row);
    for (int64_t l = 0; l < n; l++) {
        for (int64_t k = m->domain_ptr[l]; k < m->domain_ptr[l + 1]; k++)
            for (int c = 0; c < 3; c++)
                gradient[(3 * l + c) * n + m->domain_node[k]] = m->domain_b[3 * k + c];
        for (int c = 0; c < 3; c++)
            for (int r = 0; r < 3; r++)
                add_product(a, n, m->volume[l] * s->directional[6 * l + place[r][c]],
                            &gradient[(3 * l + r) * n], &gradient[(3 * l + c) * n]);
    }
    const double *offset = s->pair_offset; /* of one group, in the order of its pairs */
    assert_true(n <= SF_GROUP);
    for (int64_t i = 0; i < n; i++)
        for (int64_t k = m->edge_ptr[i]; k < m->edge_ptr[i + 1]; k++) {
            int64_t j = m->edge_node[k];
            if (j < i)
                continue;
            for (int64_t q = 0; q < n; q++) {
                row[q] = (q == j) - (q == i);
                for (int c = 0; c < 3; c++)
                    row[q] -= 0.5 * (gradient[(3 * i + c) * n + q] + gradient[(3 * j + c) * n + q]) *
                              (m->position[3 * j + c] - m->position[3 * i + c] + offset[c]);
            }
            offset += 3;
            add_product(a, n, fixture_pair_weight(m, i, j) * (s->stiffness[i] + s->stiffness[j]), row, row);
        }
    for (int64_t i = 0; i < n; i++)
        for (int64_t j = 0; j < n; j++)
            a[i * n + j] /= sqrt(m->mass[i] * m->mass[j]);
    double value = largest_eigenvalue(a, n);
    free(a);
    free(gradient);
    free(row);
    return value;
}

/* Exact largest eigenvalue of the full tangent, by differences of the forces themselves. */
static double tangent_eigenvalue(fixture *f) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    int64_t n = 3 * m->node_count;
    double *a = matrix(n), *b = matrix(n);
    for (int64_t q = 0; q < n; q++) {
        double kept = s->d[q], h = 1e-6 * m->spacing[q / 3];
        for (int side = -1; side <= 1; side += 2) {
            s->d[q] = kept + side * h;
            fixture_forces(f);
            for (int64_t p = 0; p < n; p++)
                b[p * n + q] -= side * s->force[p] / (2 * h * sqrt(m->mass[p / 3] * m->mass[q / 3]));
        }
        s->d[q] = kept;
    }
    fixture_forces(f);
    for (int64_t p = 0; p < n; p++)
        for (int64_t q = 0; q < n; q++)
            a[p * n + q] = 0.5 * (b[p * n + q] + b[q * n + p]);
    double value = largest_eigenvalue(a, n);
    free(a);
    free(b);
    return value;
}

/* Hyperfoam of the stiffness of the EVA, with nu = 0.25. */
static void make_hyperfoam(sf_case *c) {
    sf_error err = SF_ERROR_INIT;
    sf_material_free(&c->material);
    assert_int_equal(sf_material_create(&sf_hyperfoam_law, &c->material, &err), SF_OK);
    *(sf_hyperfoam_card *)c->material.card = (sf_hyperfoam_card){
        .shared = point_elastic_foam(35),
        .stable_to = 0.9,
        .term = {{.mu = 1.5e5, .alpha = 8, .nu = 0.25}, {.mu = 4e4, .alpha = -1.5, .beta = 0.2}}};
}

/* A small free block of elastic foam, its missile out of reach; 64 nodes. */
static void start_block_of(fixture *f, bool linear, bool hyper, double stabilisation) {
    const fixture_block block = {.cells = {3, 3, 3}, .spacing = 0.01, .jitter = 0.25, .surface_jitter = 0.2};
    sf_case c;
    fixture_case(&c, NULL);
    fixture_hold(&c, (const char *const[]){NULL});
    if (linear)
        fixture_make_linear(&c);
    else
        fixture_make_elastic(&c);
    if (hyper)
        make_hyperfoam(&c);
    c.missile_card.gap = 100;
    c.missile_card.gravity = 0; /* at its speed from there */
    c.run.stabilisation = stabilisation;
    c.run.step_limit = 1;
    fixture_under_plate(&c, &block, 0.5, 0.015, 0.015, f);
    fixture_start(f);
}

static void start_block(fixture *f, bool linear, double stabilisation) {
    start_block_of(f, linear, false, stabilisation);
}

static void deform(fixture *f, const double gradient[9]) {
    const double still[3] = {0};
    uint64_t seed = 9;
    fixture_set_affine(f, gradient, still);
    for (int64_t q = 0; q < 3 * f->model.node_count && gradient != REST; q++)
        f->state.d[q] += 0.01 * f->model.spacing[q / 3] * fixture_random(&seed);
    fixture_forces(f);
}

static void power_iteration_finds_the_highest_frequency(void **state) {
    (void)state;
    static const double *const gradients[] = {REST, SQUEEZED};
    for (int k = 0; k < 2; k++) {
        fixture f;
        start_block(&f, false, 0.1);
        deform(&f, gradients[k]);
        double exact = scalar_eigenvalue(&f);
        sf_time_step_choose(&f.model, &f.operators, &f.state);
        double estimate = f.state.tightness * f.state.bound_load;
        assert_true(estimate <= exact * (1 + 5e-4)); /* a Rayleigh quotient */
        assert_relative(estimate, exact, 0.02);
        assert_relative(sf_time_step_power(&f.model, &f.operators, &f.state, 2000, 0), exact, 1e-6);
        /* It comes from below by 2 % at most, and the step safety keeps the step within the limit of
         * leap-frog. */
        assert_true(f.state.dt <= 1.01 * f.model.run.step_safety * 2 / sqrt(exact));
        assert_true(f.state.dt >= 0.9 * f.model.run.step_safety * 2 / sqrt(exact)); /* and is not wasteful */
        fixture_free(&f);
    }
}

/* Where no spot is the stiffest, the highest frequencies of a lattice crowd together and the iteration is at
 * its slowest: its first estimate is good to a part in a thousand. */
static void first_estimate_of_a_crowded_spectrum_is_good(void **state) {
    (void)state;
    const fixture_block block = {.cells = {14, 14, 14}, .spacing = 0.01};
    fixture f;
    fixture_held_block(&block, &f);
    fixture_start(&f);
    fixture_forces(&f);
    sf_time_step_choose(&f.model, &f.operators, &f.state);
    double estimate = f.state.tightness * f.state.bound_load;
    double converged = sf_time_step_power(&f.model, &f.operators, &f.state, 1500, 0);
    assert_relative(estimate, converged, 1e-3);
    fixture_free(&f);
}

/* The partition bound holds for any field of tangents; it knows nothing of the pairs. */
static void partition_bound_is_never_below_the_exact_frequency(void **state) {
    (void)state;
    fixture f;
    uint64_t seed = 4;
    start_block(&f, false, 0);
    for (int trial = 0; trial < 5; trial++) {
        deform(&f, trial == 0 ? REST : SQUEEZED);
        double bound = 0;
        for (int64_t i = 0; i < f.model.node_count; i++) {
            double factor =
                trial > 1 ? pow(10, fixture_random(&seed)) : 1; /* any field: up to a hundred between nodes */
            f.state.tangent[i] *= factor;
            for (int k = 0; k < 6; k++)
                f.state.directional[6 * i + k] *= (float)factor;
            bound = larger(bound, f.operators.stability[i] * f.state.tangent[i]);
        }
        double exact = scalar_eigenvalue(&f);
        assert_true(bound >= exact * (1 - 1e-12));
        assert_true(bound <= 10 * exact);
    }
    fixture_free(&f);
}

/* The scalar operator bounds the vector problem, stabilisation included: the chosen step is stable for the
 * tangent in loading, in large shear and on the unloading branch, where the stress falls with the energy. */
static void chosen_step_is_stable_for_the_full_tangent(void **state) {
    (void)state;
    static const struct {
        bool linear;
        double hu;
        const double *before, *now;
    } cases[] = {
        {true, 1, REST, REST},          {false, 1, REST, SQUEEZED},       {false, 1, REST, SHEARED},
        {false, 0.01, SQUEEZED, EASED}, {false, 0.01, CRUSHED, SQUEEZED}, {false, 0.1, SHEARED, SQUEEZED}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        fixture f;
        start_block(&f, cases[k].linear, 0.1);
        sf_foam_card_of(&f.model.material[0])->shared.hysteresis_hu = cases[k].hu;
        fixture_start(&f);
        deform(&f, cases[k].before);
        deform(&f, cases[k].now);
        double exact = tangent_eigenvalue(&f);
        sf_time_step_choose(&f.model, &f.operators, &f.state);
        double share = f.state.dt * sqrt(exact) / 2;
        if (!(share <= 1.01 * f.model.run.step_safety && share > 0.5))
            fail_msg("case %zu: the step is %.3f of the limit", k, share);
        fixture_free(&f);
    }
}

/* The same for the hyperfoam, whose principal directions are coupled. */
static void chosen_step_is_stable_for_the_hyperfoam(void **state) {
    (void)state;
    static const struct {
        double hu, alpha;
        const double *before, *now;
    } cases[] = {{1, 1, REST, REST},
                 {1, 1, REST, SQUEEZED},
                 {1, 1, REST, SHEARED},
                 {1, 1, REST, CRUSHED},
                 {0.01, 1, SQUEEZED, EASED},
                 {0.01, 1, CRUSHED, SQUEEZED},
                 {0.1, 0.3, CRUSHED, SQUEEZED},
                 {0.1, 1, SHEARED, SQUEEZED}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        fixture f;
        start_block_of(&f, false, true, 0.1);
        sf_hyperfoam_card *card = f.model.material[0].card;
        card->shared.hysteresis_hu = cases[k].hu;
        card->shared.hysteresis_alpha = cases[k].alpha;
        fixture_start(&f);
        deform(&f, cases[k].before);
        deform(&f, cases[k].now);
        double exact = tangent_eigenvalue(&f);
        sf_time_step_choose(&f.model, &f.operators, &f.state);
        double share = f.state.dt * sqrt(exact) / 2;
        if (!(share <= 1.01 * f.model.run.step_safety && share > 0.4))
            fail_msg("case %zu: the step is %.3f of the limit", k, share);
        fixture_free(&f);
    }
}

/* Leap-frog of the free block from a small random displacement; the largest coefficient of the last tenth
 * over the first one's. */
static double free_vibration(fixture *f, double dt, int steps) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    int64_t n = 3 * m->node_count;
    uint64_t seed = 6;
    double start = 1e-7 * m->spacing[0], largest = 0;
    memset(s->v, 0, (size_t)n * sizeof *s->v);
    for (int64_t q = 0; q < n; q++)
        s->d[q] = start * fixture_random(&seed);
    for (int step = 0; step < steps; step++) {
        fixture_forces(f);
        for (int64_t q = 0; q < n; q++) {
            s->v[q] += (step ? dt : 0.5 * dt) * s->force[q] / m->mass[q / 3];
            s->d[q] += dt * s->v[q];
            largest = larger(largest, fabs(s->d[q]));
        }
        if (largest > 1e3 * start)
            break;
    }
    return largest / start;
}

static void free_vibration_is_stable_up_to_the_exact_limit_only(void **state) {
    (void)state;
    fixture f;
    start_block(&f, true, 0.1);
    deform(&f, REST);
    double limit = 2 / sqrt(tangent_eigenvalue(&f));
    assert_true(free_vibration(&f, 0.95 * limit, 3000) < 20);
    assert_true(free_vibration(&f, 1.02 * limit, 3000) > 1e3);
    assert_true(free_vibration(&f, 1.3 * limit, 60) > 1e3);
    fixture_free(&f);
}

/* The solver's own steps at 95 % of its limit: the pad's energy stays what it was. */
static void solver_conserves_the_energy_of_a_free_vibration(void **state) {
    (void)state;
    fixture f;
    uint64_t seed = 2;
    start_block(&f, true, 0.1);
    f.model.run.step_safety = 0.95;
    f.model.missile.gravity = 0;
    sf_state *s = &f.state;
    for (int64_t q = 0; q < 3 * f.model.node_count; q++)
        s->v[q] = 0.05 * fixture_random(&seed);
    double first = 0, largest = 0, smallest = INFINITY;
    f.model.run.energy_limit = 1e9; /* the ledger starts with a pad at rest */
    for (int step = 0; step < 3000; step++) {
        fixture_step(&f);
        const sf_ledger *l = &s->ledger;
        double energy = l->kinetic_pad + l->stored + l->stabilisation;
        if (step == 1)
            first = energy;
        if (step > 0) {
            largest = larger(largest, energy / first);
            smallest = smaller(smallest, energy / first);
        }
        sf_step_advance(&f.model, s);
    }
    assert_close(largest, 1, 0.005);
    assert_close(smallest, 1, 0.005);
    fixture_free(&f);
}

/* A free block with a little DAMP is thrown together along z, with some noise: many reversals. The largest
 * energy over that of the first step. */
static double largest_energy(bool hyper, double alpha) {
    fixture f;
    uint64_t seed = 2;
    double first = 0, largest = 0;
    start_block_of(&f, false, hyper, 0.1);
    f.model.run.step_safety = 0.95;
    f.model.missile.gravity = 0;
    f.model.run.energy_limit = 1e9; /* the ledger starts with a pad at rest */
    sf_foam_shared *card = f.model.material[0].card;
    card->hysteresis_hu = 0.05;
    card->hysteresis_alpha = alpha;
    card->damp = 0.1;
    fixture_start(&f);
    sf_state *s = &f.state;
    for (int64_t q = 0; q < 3 * f.model.node_count; q++)
        s->v[q] = 0.1 * fixture_random(&seed) - (q % 3 == 2 ? 300 * f.model.position[q] : 0);
    for (int step = 0; step < 600; step++) {
        fixture_step(&f);
        const sf_ledger *l = &s->ledger;
        double energy = l->kinetic_pad + l->stored + l->hysteresis + l->viscous + l->stabilisation;
        if (step == 1)
            first = energy;
        if (step > 0)
            largest = larger(largest, energy / first);
        sf_step_advance(&f.model, s);
    }
    assert_true(s->ledger.hysteresis > 0.05 * first);
    fixture_free(&f);
    return largest;
}

/* ALPHA < 1 has no bounded tangent at a reversal, where the bound is a mean (theory, "Hysteresis"). That
 * makes no energy beyond what a reversal with ALPHA = 1 makes. */
static void reversals_with_alpha_below_one_make_no_energy(void **state) {
    (void)state;
    for (int hyper = 0; hyper < 2; hyper++) {
        double usual = largest_energy(hyper, 1);
        assert_true(usual < 1.05);
        double half = largest_energy(hyper, 0.5), least = largest_energy(hyper, 0.15);
        assert_true(half < usual + 0.01);
        assert_true(least < usual + 0.04);
    }
}

static void step_shrinks_at_once_and_grows_slowly(void **state) {
    (void)state;
    fixture f;
    start_block(&f, false, 0.1);
    deform(&f, REST);
    sf_state *s = &f.state;
    sf_time_step_choose(&f.model, &f.operators, s);
    double dt = s->dt;
    s->step = 1;
    s->dt_old = 0.1 * dt;
    sf_time_step_choose(&f.model, &f.operators, s);
    assert_relative(s->dt, 0.102 * dt, 1e-12);
    s->dt_old = 10 * dt;
    sf_time_step_choose(&f.model, &f.operators, s);
    assert_true(s->dt <= dt * (1 + 1e-12));
    f.model.run.step_limit = 0.5 * dt;
    sf_time_step_choose(&f.model, &f.operators, s);
    assert_relative(s->dt, 0.5 * dt, 1e-12);
    fixture_free(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(power_iteration_finds_the_highest_frequency),
        cmocka_unit_test(first_estimate_of_a_crowded_spectrum_is_good),
        cmocka_unit_test(partition_bound_is_never_below_the_exact_frequency),
        cmocka_unit_test(chosen_step_is_stable_for_the_full_tangent),
        cmocka_unit_test(chosen_step_is_stable_for_the_hyperfoam),
        cmocka_unit_test(free_vibration_is_stable_up_to_the_exact_limit_only),
        cmocka_unit_test(solver_conserves_the_energy_of_a_free_vibration),
        cmocka_unit_test(reversals_with_alpha_below_one_make_no_energy),
        cmocka_unit_test(step_shrinks_at_once_and_grows_slowly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
