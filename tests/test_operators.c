/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Operators taken from a model, in its memory and with what they need no more released, against operators
 * built beside it. */
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
    assert_true(!m->domain_b && !m->domain_node && !m->support && !m->edge_ptr && !m->edge_node);
    size_t bytes = (size_t)sf_packed_start(m->node_count, m->domain_nnz);
    assert_memory_equal(taken.operators.gradient, built.operators.gradient, bytes);
    push(&built);
    push(&taken);
    for (int step = 0; step < 5; step++) {
        fixture_step(&built);
        fixture_step(&taken);
        sf_step_advance(&built.model, &built.state);
        sf_step_advance(&taken.model, &taken.state);
    }
    bytes = 3 * (size_t)m->node_count * sizeof(double);
    assert_memory_equal(taken.state.d, built.state.d, bytes);
    assert_memory_equal(taken.state.force, built.state.force, bytes);
    assert_true(taken.state.dt == built.state.dt);
    fixture_free(&built);
    fixture_free(&taken);
}

/* A row of one to three entries is longer packed than as doubles: rows behind it must not be overrun. */
static void rows_too_short_for_their_own_memory_are_packed_beside_it(void **state) {
    (void)state;
    enum { ROWS = 6, ENTRIES = 20 };
    static const int64_t end[ROWS] = {1, 3, 8, 9, 15, 20};
    sf_model m = {.node_count = ENTRIES, .domain_nnz = ENTRIES};
    sf_error err = SF_ERROR_INIT;
    uint64_t seed = 9;
    uint8_t *built = NULL, *taken = NULL;
    m.position = calloc(3 * ENTRIES, sizeof *m.position);
    m.domain_ptr = calloc(ENTRIES + 1, sizeof *m.domain_ptr);
    m.domain_node = calloc(ENTRIES, sizeof *m.domain_node);
    m.domain_b = calloc(3 * ENTRIES, sizeof *m.domain_b);
    assert_true(m.position && m.domain_ptr && m.domain_node && m.domain_b);
    for (int64_t l = 1; l <= ENTRIES; l++)
        m.domain_ptr[l] = l <= ROWS ? end[l - 1] : ENTRIES; /* the others are empty */
    for (int64_t k = 0; k < 3 * ENTRIES; k++) {
        m.position[k] = fixture_random(&seed);
        m.domain_b[k] = 100 * fixture_random(&seed);
        m.domain_node[k / 3] = (int32_t)(k / 3);
    }
    assert_int_equal(sf_gradient_build(&m, &built, &err), SF_OK);
    assert_int_equal(sf_gradient_take(&m, &taken, &err), SF_OK);
    assert_null(m.domain_b);
    assert_memory_equal(taken, built, (size_t)sf_packed_start(ENTRIES, ENTRIES));
    free(built);
    free(taken);
    sf_model_free(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(taken_operators_give_the_same_bits),
        cmocka_unit_test(rows_too_short_for_their_own_memory_are_packed_beside_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
