/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Local collapse on a lattice of hexahedra: smooth strain of a thin and a thick pad is none, and neither is
 * the edge or corner of a flat missile; a node, a row, a layer and a checkerboard are. */
#include "post/figures/strain_field.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "model/good_run.h"
#include "post_check.h"

enum { N = 13, NODES = N * N * N, CELLS = (N - 1) * (N - 1) * (N - 1) };

static int32_t at(int i, int j, int k) {
    return i + N * (j + N * k);
}

static int set_up(void **state) {
    static sf_results r;
    static double position[3 * NODES];
    static uint8_t type[CELLS];
    r = (sf_results){.node_count = NODES,
                     .cell_count = CELLS,
                     .cell_nnz = 8 * CELLS,
                     .position = position,
                     .cell_type = type,
                     .thickness = N - 1,
                     .symmetry_place = {NAN, NAN}};
    memset(type, 9, sizeof type);
    for (int k = 0; k < 3 * NODES; k++)
        position[k] = k % 3 == 0 ? k / 3 % N : k % 3 == 1 ? k / 3 / N % N : k / 3 / N / N;
    r.cell_ptr = calloc(CELLS + 1, sizeof *r.cell_ptr);
    r.cell_node = calloc((size_t)r.cell_nnz, sizeof *r.cell_node);
    assert_true(r.cell_ptr && r.cell_node);
    int64_t used = 0, cell = 0;
    for (int k = 0; k < N - 1; k++)
        for (int j = 0; j < N - 1; j++)
            for (int i = 0; i < N - 1; i++) {
                for (int corner = 0; corner < 8; corner++) /* in the order of VTK */
                    r.cell_node[used++] =
                        at(i + ((corner + 1) >> 1 & 1), j + (corner >> 1 & 1), k + (corner >> 2));
                r.cell_ptr[++cell] = used;
            }
    *state = &r;
    return 0;
}

static int tear_down(void **state) {
    sf_results *r = *state;
    free(r->cell_ptr);
    free(r->cell_node);
    return 0;
}

static double collapse(void **state, double (*strain)(int i, int j, int k)) {
    static double value[NODES];
    double result = NAN;
    sf_error err = SF_ERROR_INIT;
    for (int k = 0; k < N; k++)
        for (int j = 0; j < N; j++)
            for (int i = 0; i < N; i++)
                value[at(i, j, k)] = strain(i, j, k);
    if (sf_strain_field_collapse(*state, &(sf_peak_fields){.compression = value}, &result, &err) != SF_OK)
        fail_msg("%s", err.text);
    return result;
}

/* Below a sphere: a bell over the radius. */
static double bell(int i, int j) {
    return exp(-(i * i + j * j) / 30.0);
}
static double thin(int i, int j, int k) {
    (void)k;
    return 0.8 * bell(i, j);
}
static double thick(int i, int j, int k) { /* top three times the base */
    return 0.6 * bell(i, j) * (1 + 2.0 * k / (N - 1)) / 3;
}
static double punch(int i, int j, int k) { /* flat, with a corner at (6, 6) */
    (void)k;
    return i <= 6 && j <= 6 ? 0.7 : 0.05;
}
static double node(int i, int j, int k) {
    return thick(i, j, k) + (i == 3 && j == 4 && k == 5 ? 0.4 : 0);
}
static double top_node(int i, int j, int k) {
    return thick(i, j, k) + (i == 0 && j == 0 && k == N - 1 ? 0.4 : 0);
}
static double line(int i, int j, int k) {
    (void)i;
    return j == 3 && k == 5 ? 0.6 : 0.2;
}
static double layer(int i, int j, int k) {
    (void)i, (void)j;
    return k == N - 2 ? 0.6 : 0.2;
}
static double top_layer(int i, int j, int k) {
    (void)i, (void)j;
    return k == N - 1 ? 0.6 : 0.2;
}
static double checkerboard(int i, int j, int k) {
    return (i + j + k) % 2 ? 0.6 : 0.2;
}

static void smooth_strain_is_no_collapse_in_a_pad_of_any_thickness(void **state) {
    double bound = sf_good_run_limits()->local_collapse;
    assert_true(collapse(state, thin) < bound);
    assert_true(collapse(state, thick) < bound);
}

static void edge_and_corner_of_a_flat_missile_are_no_collapse(void **state) {
    assert_close(collapse(state, punch), 0, 1e-12);
}

static void nodes_that_collapse_alone_stand_out(void **state) {
    assert_close(collapse(state, node), 0.4, 0.02);
    assert_close(collapse(state, top_node), 0.4, 0.1);
    assert_close(collapse(state, line), 0.4, 1e-12);
    assert_close(collapse(state, layer), 0.4, 1e-12);
    assert_close(collapse(state, top_layer), 0.4, 1e-12);
    assert_close(collapse(state, checkerboard), 0.4, 1e-12);
}

/* Collapse where the side i = 0 is strained by `side`, and its middle by `lone` in addition, and all else by
 * 0.2; the missile presses the top, and the side if `pressed`. */
static double wall_excess(const sf_results *r, double side, double lone, bool pressed) {
    static double value[NODES], moved[3 * NODES], pressure[NODES];
    double result = NAN;
    sf_error err = SF_ERROR_INIT;
    for (int n = 0; n < NODES; n++) {
        value[n] = n % N == 0 ? side : 0.2;
        moved[3 * n + 2] = -0.1 * (n / N / N);
        pressure[n] = n / N / N == N - 1 || (pressed && n % N == 0);
    }
    value[at(0, 6, 6)] += lone;
    if (sf_strain_field_collapse(r, &(sf_peak_fields){value, moved, pressure, NULL}, &result, &err) != SF_OK)
        fail_msg("%s", err.text);
    return result;
}

/* The missile presses the top up to the row i = 6, which alone collapses: it is on no wall. */
static void the_edge_of_the_contact_is_no_wall(void **state) {
    static double value[NODES], pressure[NODES];
    double result = NAN;
    sf_error err = SF_ERROR_INIT;
    for (int n = 0; n < NODES; n++) {
        bool top = n / N / N == N - 1;
        value[n] = top && n % N == 6 ? 0.6 : 0.2;
        pressure[n] = top && n % N <= 6;
    }
    assert_int_equal(
        sf_strain_field_collapse(*state, &(sf_peak_fields){value, NULL, pressure, NULL}, &result, &err),
        SF_OK);
    assert_close(result, 0.4, 1e-12);
}

static void the_surface_of_a_wall_that_bends_is_no_collapse(void **state) {
    assert_close(wall_excess(*state, 0.6, 0, false), 0, 1e-12);
    assert_close(wall_excess(*state, 0.6, 0, true), 0.4, 1e-12);
    assert_close(wall_excess(*state, 0.6, 0.3, false), 0.3, 1e-12);
    assert_close(wall_excess(*state, 0.2, 0.3, false), 0.3, 1e-12);
}

/* Two nodes stand out, the first with a part `share` of the energy of all. */
static double lone_excess(sf_results r, double share) {
    static double value[NODES], density[NODES], volume[NODES];
    double result = NAN;
    sf_error err = SF_ERROR_INIT;
    for (int n = 0; n < NODES; n++) {
        value[n] = 0.2;
        volume[n] = 2;
        density[n] = 1;
    }
    value[at(3, 4, 5)] = 0.6;
    value[at(8, 8, 8)] = 0.3;
    density[at(3, 4, 5)] = share / (1 - share) * (NODES - 1);
    r.volume = volume;
    if (sf_strain_field_collapse(&r, &(sf_peak_fields){.compression = value, .energy_density = density},
                                 &result, &err) != SF_OK)
        fail_msg("%s", err.text);
    return result;
}

static void nodes_that_hold_no_energy_do_not_count(void **state) {
    const sf_results *r = *state;
    assert_close(lone_excess(*r, 1.01 * SF_COLLAPSE_SHARE), 0.4, 1e-12);
    assert_close(lone_excess(*r, 0.99 * SF_COLLAPSE_SHARE), 0.1, 1e-12); /* with the other node */
    assert_close(lone_excess(*r, 0.1 * SF_COLLAPSE_SHARE), 0, 1e-12);
}

/* Strain of a plug and of the pad around it, which share the plane i = 6: the nodes of the pad there follow
 * the plug, and alone are far above their neighbours in the pad. */
static double plug_excess(bool slips, double lone) {
    static double position[3 * 2 * NODES], displacement[3 * 2 * NODES], compression[2 * NODES];
    static int64_t cell_ptr[CELLS + 1];
    static int32_t cell_node[8 * CELLS];
    sf_results r = {.node_count = 2 * NODES,
                    .cell_count = CELLS,
                    .cell_nnz = 8 * CELLS,
                    .position = position,
                    .cell_ptr = cell_ptr,
                    .cell_node = cell_node,
                    .thickness = 1,
                    .layer_count = 2};
    double result = NAN;
    sf_error err = SF_ERROR_INIT;
    for (int part = 0; part < 2; part++)
        for (int k = 0; k < N; k++)
            for (int j = 0; j < N; j++)
                for (int i = 0; i < N; i++) {
                    int32_t node = part * NODES + at(i, j, k);
                    bool used = part ? i >= 6 : i <= 6;
                    position[3 * node] = used ? i : -1 - node;
                    position[3 * node + 1] = j;
                    position[3 * node + 2] = k;
                    displacement[3 * node + 2] = slips && part ? 0.1 : 0;
                    compression[node] = i <= 6 ? 0.6 : 0.2;
                }
    compression[NODES + at(6, 5, 5)] += lone;
    int64_t used = 0, cell = 0;
    for (int k = 0; k < N - 1; k++)
        for (int j = 0; j < N - 1; j++)
            for (int i = 0; i < N - 1; i++) {
                for (int corner = 0; corner < 8; corner++)
                    cell_node[used++] =
                        (i >= 6) * NODES + at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
                cell_ptr[++cell] = used;
            }
    if (sf_strain_field_collapse(&r, &(sf_peak_fields){compression, displacement, NULL, NULL}, &result,
                                 &err) != SF_OK)
        fail_msg("%s", err.text);
    return result;
}

static void layer_that_its_partner_carries_along_does_not_collapse(void **state) {
    (void)state;
    assert_close(plug_excess(false, 0), 0, 1e-12);
    assert_close(plug_excess(false, 0.3), 0.3, 1e-12);
    assert_close(plug_excess(true, 0), 0.4, 1e-12);
}

/* A wedge, edge down, over the block of cells of 1 m: its edge lies between two rows of nodes of the top, and
 * no vertex of it is in the block. */
static void an_edge_of_the_missile_between_nodes_is_measured(void **state) {
    static double moved[3 * NODES];
    double wedge[] = {-20, 6.5, 0, 30, 6.5, 0, -20, 16.5, 10, 30, 16.5, 10, -20, -3.5, 10, 30, -3.5, 10};
    int32_t triangle[] = {0, 3, 1, 0, 2, 3, 0, 5, 4, 0, 1, 5};
    sf_results r = *(sf_results *)*state;
    sf_frame_head head = {.missile_quaternion = {1, 0, 0, 0}};
    sf_error err = SF_ERROR_INIT;
    sf_rim_cut cut;
    r.surface_node_count = 6;
    r.surface_triangle_count = 4;
    r.surface_position = wedge;
    r.surface_triangle = triangle;
    for (int k = -1; k < 2; k++) { /* above, in, and deeper than a cell */
        double at = k < 0 ? 0.1 : k > 0 ? -2.4 : -0.4;
        head.missile_displacement[2] = N - 1 + at;
        assert_int_equal(sf_rim_cut_measure(&r, &head, moved, &cut, &err), SF_OK);
        assert_close(cut.depth, k < 0 ? 0 : -at, 1e-12);
        assert_true(k < 0 || cut.place[2] == N - 1);
    }
    assert_true(fabs(cut.place[1] - 6.5) < 0.6);
    /* the same wedge, at its place, as a support */
    for (int k = 0; k < 6; k++)
        wedge[3 * k + 2] += N - 1 - 0.4;
    r.support_node_count = 6;
    r.support_triangle_count = 4;
    r.support_position = wedge;
    r.support_triangle = triangle;
    r.surface_triangle_count = 0;
    assert_int_equal(sf_rim_cut_measure(&r, &head, moved, &cut, &err), SF_OK);
    assert_close(cut.depth, 0.4, 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smooth_strain_is_no_collapse_in_a_pad_of_any_thickness),
        cmocka_unit_test(edge_and_corner_of_a_flat_missile_are_no_collapse),
        cmocka_unit_test(nodes_that_collapse_alone_stand_out),
        cmocka_unit_test(the_surface_of_a_wall_that_bends_is_no_collapse),
        cmocka_unit_test(the_edge_of_the_contact_is_no_wall),
        cmocka_unit_test(nodes_that_hold_no_energy_do_not_count),
        cmocka_unit_test(layer_that_its_partner_carries_along_does_not_collapse),
        cmocka_unit_test(an_edge_of_the_missile_between_nodes_is_measured),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
