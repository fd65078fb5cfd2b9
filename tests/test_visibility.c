/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The kernel does not reach across a slit: a block with a slit of 4 mm, narrower than its supports of 17 mm.
 */
#include "model_fixture.h"

#include "pre/cloud/cloud.h"
#include "pre/cloud/mls.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

enum { COLUMN = 4, TIP = 2, LAYERS = 8 };
static const fixture_block BLOCK = {
    .cells = {8, 4, LAYERS}, .spacing = 0.01, .jitter = 0.1, .surface_jitter = 0.1};
static const double WIDTH = 0.004;
/* Above this height no path around the tip stays near enough. */
static const double FREE = 0.055;

static int set_up(void **state) {
    fixture *f = calloc(1, sizeof *f);
    sf_mesh mesh;
    fixture_block_mesh(&BLOCK, &mesh);
    fixture_open_slit(&BLOCK, COLUMN, TIP, WIDTH, &mesh);
    fixture_hold_mesh(&mesh, f);
    *state = f;
    return 0;
}

static int tear_down(void **state) {
    fixture_free(*state);
    free(*state);
    return 0;
}

/* -1 left of the slit, 1 right of it, 0 below its tip. */
static int side_of(const sf_model *m, int64_t node) {
    const double *x = &m->position[3 * node];
    if (x[2] < (TIP + 0.5) * BLOCK.spacing)
        return 0;
    return x[0] < COLUMN * BLOCK.spacing + 0.5 * WIDTH ? -1 : 1;
}

static bool is_deep(const sf_model *m, int64_t node) {
    return m->position[3 * node + 2] > FREE;
}

/* Entries of the rows of deep nodes that lie on the other side.
 */
static int64_t count_across(const sf_model *m, const int64_t *ptr, const int32_t *node) {
    int64_t across = 0;
    for (int64_t i = 0; i < m->node_count; i++)
        for (int64_t k = ptr[i]; is_deep(m, i) && k < ptr[i + 1]; k++)
            across += side_of(m, i) * side_of(m, node[k]) < 0;
    return across;
}

static void no_row_reaches_across_the_slit(void **state) {
    const sf_model *m = &((fixture *)*state)->model;
    int64_t near = 0;
    for (int64_t i = 0; i < m->node_count; i++)
        for (int64_t j = 0; is_deep(m, i) && j < m->node_count; j++) {
            const double *x = &m->position[3 * i], *y = &m->position[3 * j];
            near += side_of(m, i) * side_of(m, j) < 0 &&
                    hypot(hypot(x[0] - y[0], x[1] - y[1]), x[2] - y[2]) < m->support[j];
        }
    assert_true(near > 100);
    assert_int_equal(count_across(m, m->domain_ptr, m->domain_node), 0);
    assert_int_equal(count_across(m, m->phi_ptr, m->phi_node), 0);
    assert_int_equal(count_across(m, m->edge_ptr, m->edge_node), 0);
}

/* Both sides move as rigid bodies, apart: away from the tip no strain, no force. */
static void halves_move_apart_without_strain(void **state) {
    fixture *f = *state;
    const sf_model *m = &f->model;
    const double apart[3] = {0.02, -0.01, 0.03};
    int64_t deep = 0;
    fixture_start(f);
    for (int64_t i = 0; i < m->node_count; i++)
        for (int r = 0; r < 3; r++)
            f->state.d[3 * i + r] = side_of(m, i) * apart[r];
    fixture_forces(f);
    double modulus = sf_foam_card_of(&m->material[0])->modulus;
    for (int64_t i = 0; i < m->node_count; i++) {
        if (!is_deep(m, i))
            continue;
        deep++;
        for (int k = 0; k < 9; k++)
            assert_close(f->state.f[9 * i + k], k % 4 == 0, 1e-12);
        if (m->position[3 * i + 2] < FREE + 0.02) /* forces come from the domains around */
            continue;
        for (int r = 0; r < 3; r++)
            assert_close(f->state.force[3 * i + r] / (modulus * 1e-4), 0, 1e-10);
    }
    assert_true(deep > 100);
}

/* Every node of the body sees all of a ball of two spacings beyond the supports. */
static int64_t count_hidden(sf_mesh *mesh) {
    sf_error err = SF_ERROR_INIT;
    sf_dual dual;
    sf_grid grid;
    unsigned long n = (unsigned long)mesh->node_count;
    int64_t count = 0;
    double *spacing = sf_alloc(&err, n, sizeof *spacing, "spacing"),
           *support = sf_alloc(&err, n, sizeof *support, "support"),
           *reach = sf_alloc(&err, n, sizeof *reach, "reach");
    assert_int_equal(sf_dual_build(mesh, &dual, &err), SF_OK);
    sf_cloud_spacing(mesh, &dual, spacing);
    for (int64_t i = 0; i < mesh->node_count; i++) {
        support[i] = 1.7 * spacing[i];
        reach[i] = 2 * spacing[i];
    }
    assert_int_equal(sf_grid_build(&grid, mesh->node_count, mesh->position, support, &err), SF_OK);
    sf_hidden *hidden = sf_visibility_build(mesh, &dual, &grid, reach, &err);
    assert_non_null(hidden);
    for (int64_t i = 0; i < mesh->node_count; i++)
        count += hidden[i].count;
    sf_visibility_free(hidden, mesh->node_count);
    sf_grid_free(&grid);
    sf_dual_free(&dual);
    sf_mesh_free(mesh);
    free(spacing);
    free(support);
    free(reach);
    return count;
}

static void convex_bodies_hide_nothing(void **state) {
    (void)state;
    const fixture_block shapes[] = {
        {.cells = {8, 7, 6}, .spacing = 0.01},
        {.cells = {8, 7, 6}, .spacing = 0.01, .jitter = 0.3, .surface_jitter = 0.3},
        {.cells = {8, 7, 6}, .spacing = 0.01, .jitter = 0.2, .flatness = 0.2},
        {.cells = {6, 5, 9}, .spacing = 0.01, .jitter = 0.2, .flatness = 5}};
    sf_mesh mesh;
    for (size_t k = 0; k < sizeof shapes / sizeof shapes[0]; k++) {
        fixture_block_mesh(&shapes[k], &mesh);
        assert_int_equal(count_hidden(&mesh), 0);
    }
    sf_case c;
    sf_surface surface;
    fixture_case(&c, (const char *const[]){"geometry.parameters.fine_spacing=6.0",
                                           "geometry.parameters.outer_spacing=25.0", NULL});
    fixture_geometry(&c, &mesh, &surface);
    assert_int_equal(count_hidden(&mesh), 0);
    sf_surface_free(&surface);
    sf_case_free(&c);
}

static void a_slit_hides_its_other_side(void **state) {
    (void)state;
    sf_mesh mesh;
    fixture_block_mesh(&BLOCK, &mesh);
    fixture_open_slit(&BLOCK, COLUMN, TIP, WIDTH, &mesh);
    assert_true(count_hidden(&mesh) > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_row_reaches_across_the_slit),
        cmocka_unit_test(halves_move_apart_without_strain),
        cmocka_unit_test(convex_bodies_hide_nothing),
        cmocka_unit_test(a_slit_hides_its_other_side),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
