/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Operators taken from a model, which loses what they alone are made of, against operators built beside it;
 * the masses of a cloud. */
#include "extreme.h"
#include "model_fixture.h"
#include "post_check.h"

#include "model/stability.h"
#include "solver/step.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void start(fixture *f) {
    const fixture_block block = {.cells = {7, 6, 5}, .spacing = 0.01, .jitter = 0.2, .surface_jitter = 0.1};
    fixture_held_block(&block, f);
}

static void push(fixture *f) {
    uint64_t seed = 4;
    for (int64_t q = 0; q < 3 * f->model.node_count; q++)
        f->state.d[q] = 5e-4 * fixture_random(&seed);
}

static void taken_operators_give_the_same_bits(void **state) {
    (void)state;
    fixture built, taken;
    sf_error err = SF_ERROR_INIT;
    start(&built);
    start(&taken);
    fixture_start(&built);
    assert_int_equal(sf_operators_take(&taken.model, &taken.operators, &err), SF_OK);
    assert_int_equal(sf_state_create(&taken.model, &taken.state, &err), SF_OK);
    sf_model *m = &taken.model;
    assert_true(!m->domain_node && !m->support && !m->edge_ptr && !m->edge_node);
    push(&built);
    push(&taken);
    for (int step = 0; step < 5; step++) {
        fixture_step(&built);
        fixture_step(&taken);
        sf_step_advance(&built.model, &built.state);
        sf_step_advance(&taken.model, &taken.state);
    }
    size_t bytes = 3 * (size_t)m->node_count * sizeof(double);
    assert_memory_equal(taken.state.d, built.state.d, bytes);
    assert_memory_equal(taken.state.force, built.state.force, bytes);
    assert_true(taken.state.dt == built.state.dt);
    fixture_free(&built);
    fixture_free(&taken);
}

/* Largest stability constant of the model with the masses rho V, over that with its own. */
static double constant_ratio(sf_model *m, double density) {
    sf_error err = SF_ERROR_INIT;
    double *own = m->mass, largest[2] = {0, 0};
    double *constant = malloc((size_t)m->node_count * sizeof *constant),
           *lumped = malloc((size_t)m->node_count * sizeof *lumped);
    assert_true(constant && lumped);
    for (int k = 0; k < 2; k++) {
        m->mass = k ? own : lumped;
        for (int64_t i = 0; i < m->node_count; i++)
            lumped[i] = density * m->volume[i];
        assert_int_equal(sf_stability_constants(m, constant, &err), SF_OK);
        for (int64_t i = 0; i < m->node_count; i++)
            largest[k] = larger(largest[k], constant[i]);
    }
    m->mass = own;
    free(constant);
    free(lumped);
    return largest[0] / largest[1];
}

typedef struct mass_figures {
    double total, moment[3]; /* kg, kg m, over those of the volumes */
    double least, most;      /* of mass / (rho V) */
} mass_figures;

static mass_figures figures_of(const sf_model *m, double reach) {
    mass_figures f = {.least = INFINITY};
    for (int64_t i = 0; i < m->node_count; i++) {
        const double *x = &m->position[3 * i];
        double even = sf_material_density(&m->material[m->node_material[i]]) * m->volume[i];
        f.total += m->mass[i] - even;
        for (int c = 0; c < 3; c++)
            f.moment[c] += x[c] * (m->mass[i] - even);
        if (x[0] > reach || x[1] > reach)
            continue;
        f.least = smaller(f.least, m->mass[i] / even);
        f.most = larger(f.most, m->mass[i] / even);
    }
    return f;
}

/* Masses of the example's pad have the mass and the centre of mass of its volume, those of its lattice are
 * rho V up to the surfaces, and the light nodes at its rim set no step of their own. */
static void light_nodes_share_the_mass_of_their_neighbours(void **state) {
    (void)state;
    fixture f;
    fixture_pad((const char *const[]){NULL}, &f);
    mass_figures all = figures_of(&f.model, INFINITY), lattice = figures_of(&f.model, 0.06);
    assert_close(all.total, 0, 1e-14);
    for (int c = 0; c < 3; c++)
        assert_close(all.moment[c], 0, 1e-14);
    assert_true(all.least >= 0.5 && all.least < 0.95 && all.most > 1.5);
    assert_true(lattice.least == 1 && lattice.most == 1);
    assert_true(constant_ratio(&f.model, sf_material_density(&f.model.material[0])) > 1.2);
    fixture_free(&f);
}

/* No node of a lattice is light, whatever its cells and supports: not at corners either. */
static void lattices_keep_their_masses(void **state) {
    (void)state;
    static const double flatness[] = {1, 0.5, 2};
    for (int k = 0; k < 6; k++) {
        fixture f;
        sf_case c;
        const fixture_block block = {.cells = {6, 5, 5}, .spacing = 0.01, .flatness = flatness[k / 2]};
        fixture_case(&c, (const char *const[]){k % 2 ? "kernel.support_ratio=1.7" : NULL, NULL});
        fixture_hold(&c, (const char *const[]){"base", "top", "sides", NULL});
        fixture_under_plate(&c, &block, 1, 0, 0, &f);
        mass_figures all = figures_of(&f.model, INFINITY);
        assert_true(all.least == 1 && all.most == 1);
        fixture_free(&f);
    }
}

/* In the narrow margin of this pad sums of shape functions fall below half of rho V: no mass does. */
static void no_mass_is_less_than_half(void **state) {
    (void)state;
    fixture f;
    fixture_pad((const char *const[]){"geometry.parameters.side=280", "geometry.parameters.zone_side=260",
                                      "geometry.parameters.fine_spacing=6",
                                      "geometry.parameters.outer_spacing=8", NULL},
                &f);
    mass_figures all = figures_of(&f.model, INFINITY);
    assert_close(all.least, 0.5, 1e-12);
    assert_close(all.total, 0, 1e-14);
    fixture_free(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(taken_operators_give_the_same_bits),
        cmocka_unit_test(no_mass_is_less_than_half),
        cmocka_unit_test(lattices_keep_their_masses),
        cmocka_unit_test(light_nodes_share_the_mass_of_their_neighbours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
