/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Operators taken from a model, which loses what they alone are made of, against operators built beside it.
 */
#include "model_fixture.h"

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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(taken_operators_give_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
