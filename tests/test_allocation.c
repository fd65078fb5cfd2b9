/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step of the solver allocates nothing: the linker sends the allocations of softfall's code through the
 * counters below. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

#include "model_fixture.h"
#include "solver/step.h"

static long allocations;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
int __real_posix_memalign(void **block, size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
int __wrap_posix_memalign(void **block, size_t alignment, size_t size);

void *__wrap_malloc(size_t size) {
    allocations++;
    return __real_malloc(size);
}
void *__wrap_calloc(size_t count, size_t size) {
    allocations++;
    return __real_calloc(count, size);
}
void *__wrap_realloc(void *block, size_t size) {
    allocations++;
    return __real_realloc(block, size);
}
int __wrap_posix_memalign(void **block, size_t alignment, size_t size) {
    allocations++;
    return __real_posix_memalign(block, alignment, size);
}

/* The left half of a block with a slit flies against the right one. */
static void start_slit(fixture *f) {
    static const fixture_block block = {.cells = {6, 3, 4}, .spacing = 0.01};
    enum { COLUMN = 3, TIP = 1 };
    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    fixture_case(&c, (const char *const[]){"pad.self_contact=\"on\"", NULL});
    fixture_hold(&c, (const char *const[]){"base", NULL});
    fixture_block_mesh(&block, &mesh);
    fixture_open_slit(&block, COLUMN, TIP, 0.0005, &mesh);
    fixture_plate(0.2, 0.03, 0.015, &surface);
    fixture_build(&c, &mesh, &surface, f);
    fixture_start(f);
    for (int64_t i = 0; i < f->model.node_count; i++)
        if (f->model.position[3 * i] < 0.03 && f->model.position[3 * i + 2] > 0.01)
            f->state.v[3 * i] = 10;
}

static void a_step_allocates_nothing(void **state) {
    (void)state;
    enum { FIRST_STEPS = 2, STEPS = 100 };
    fixture f;
    start_slit(&f);
    double largest = 0, room = 0;
    int renewals = 0;
    for (int step = 0; step < STEPS; step++) {
        if (step == FIRST_STEPS)
            allocations = 0;
        fixture_advance(&f);
        renewals += step >= FIRST_STEPS && f.state.skin.room > room;
        room = f.state.skin.room;
        for (int64_t p = 0; p < f.operators.skin.count; p++)
            if (!(fabs(f.state.skin.force[3 * p]) <= largest))
                largest = fabs(f.state.skin.force[3 * p]);
    }
    print_message("%d renewals of the candidates, force up to %.3g N\n", renewals, largest);
    assert_int_equal(allocations, 0);
    assert_true(renewals > 0 && largest > 0);
    fixture_free(&f);
}

static void the_counters_see_allocations(void **state) {
    (void)state;
    fixture f;
    allocations = 0;
    start_slit(&f);
    assert_true(allocations > 0);
    allocations = 0;
    fixture_advance(&f); /* the first step takes the memory of contact */
    assert_true(allocations > 0);
    fixture_free(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_allocates_nothing),
        cmocka_unit_test(the_counters_see_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
