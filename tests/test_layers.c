/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pads of several layers: clouds that end at the interface, ties that pass the patch test, and the physics of
 * stacks against closed forms. */
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

enum { SPACING_MM = 10 };
static const double H = 1e-3 * SPACING_MM;

/* ---- blocks of layers ---- */

/* The layer of a cell by the place of its centroid, in cells. */
typedef int (*layering)(const double cell[3]);

static int flat(const double x[3]) {
    return x[2] > 3;
}

/* An interface with two steps, so that it has edges and corners. */
static int stepped(const double x[3]) {
    return x[2] > 2 + (x[0] > 3) + (x[1] > 2 && x[0] > 3);
}

/* Three layers that meet in a line: below, and above left and right. */
static int junction(const double x[3]) {
    return x[2] < 2 ? 0 : x[0] < 3 ? 1 : 2;
}

/* An island in the middle of another material. */
static int inclusion(const double x[3]) {
    return fabs(x[0] - 3) < 1.1 && fabs(x[1] - 2.5) < 1 && fabs(x[2] - 2.5) < 1;
}

/* By the lattice, which the jitter of the nodes does not leave. */
static void assign_layers(sf_mesh *mesh, layering layer) {
    mesh->cell_layer = malloc((size_t)mesh->cell_count);
    for (int64_t k = 0; k < mesh->cell_count; k++) {
        double x[3] = {0};
        for (int64_t v = mesh->cell_ptr[k]; v < mesh->cell_ptr[k + 1]; v++)
            for (int c = 0; c < 3; c++)
                x[c] += mesh->position[3 * (int64_t)mesh->cell_node[v] + c] / (8 * H);
        mesh->cell_layer[k] = (uint8_t)layer(x);
    }
}

/* Moves the case's material and further ones, read again, to `count` layers. */
static void make_layers(sf_case *c, int count) {
    c->layer = calloc((size_t)count, sizeof *c->layer);
    c->layer_count = count;
    for (int k = 0; k < count; k++) {
        sf_case again;
        fixture_case(&again, NULL);
        c->layer[k] = k == 0 ? c->material : again.material;
        (k == 0 ? c : &again)->material = (sf_material){0};
        sf_case_free(&again);
        c->layer[k].name[0] = (char)('A' + k);
    }
}

static void build_block(const fixture_block *block, layering layer, int count, fixture *out) {
    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    fixture_block_mesh(block, &mesh);
    assign_layers(&mesh, layer);
    fixture_case(&c, NULL);
    fixture_hold(&c, (const char *const[]){"base", "top", "sides", NULL});
    make_layers(&c, count);
    fixture_plate(1, 0, 0, &surface);
    fixture_build(&c, &mesh, &surface, out);
}

/* ---- clouds ---- */

static const fixture_block JITTERED = {
    .cells = {6, 5, 5}, .spacing = 0.01, .jitter = 0.2, .surface_jitter = 0.2};

static void no_list_reaches_across_an_interface(void **state) {
    fixture f;
    (void)state;
    build_block(&JITTERED, stepped, 2, &f);
    const sf_model *m = &f.model;
    const int64_t *ptr[] = {m->domain_ptr, m->phi_ptr, m->edge_ptr};
    const int32_t *node[] = {m->domain_node, m->phi_node, m->edge_node};
    for (int k = 0; k < 3; k++)
        for (int64_t i = 0; i < m->node_count; i++)
            for (int64_t q = ptr[k][i]; q < ptr[k][i + 1]; q++)
                assert_int_equal(m->node_material[node[k][q]], m->node_material[i]);
    assert_int_equal(m->material_count, 2);
    assert_true(m->tie_count > 0);
    fixture_free(&f);
}

static void nodes_of_an_interface_exist_once_per_layer(void **state) {
    fixture f;
    (void)state;
    build_block(&JITTERED, flat, 2, &f);
    assert_int_equal(f.model.node_count, 7 * 6 * 6 + 7 * 6);
    assert_int_equal(f.model.tie_count, 5 * 4); /* those on the sides are held on both */
    fixture_free(&f);
}

static void junction_of_three_layers_is_a_chain_of_ties(void **state) {
    fixture f;
    (void)state;
    build_block(&JITTERED, junction, 3, &f);
    /* inner nodes: of the plane z = 2, 5 x 4, one of whose lines has a third layer; of the plane x = 3, 2
     * more heights */
    assert_int_equal(f.model.tie_count, 5 * 4 + 4 + 2 * 4);
    fixture_free(&f);
}

/* ---- patch test ---- */

/* Largest acceleration after the projection, of the largest that the unconstrained forces would give. */
static double relative_acceleration(fixture *f) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    sf_constraint_step step = {.force = s->force, .v = s->v, .dt = 1e-5, .reaction = s->reaction};
    double free_motion = 0, held_motion = 0;
    sf_constraint_project(&f->operators.constraint, &step);
    for (int64_t k = 0; k < 3 * m->node_count; k++) {
        free_motion = larger(free_motion, fabs(s->force[k]) / m->mass[k / 3]);
        held_motion = larger(held_motion, fabs(s->force[k] - s->reaction[k]) / m->mass[k / 3]);
    }
    assert_true(free_motion > 0);
    return held_motion / free_motion;
}

static const struct {
    layering layer;
    int count;
} PATCHES[] = {{flat, 2}, {stepped, 2}, {junction, 3}, {inclusion, 2}};

static void affine_field_across_interfaces_is_in_equilibrium(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof PATCHES / sizeof *PATCHES; k++) {
        fixture f;
        build_block(&JITTERED, PATCHES[k].layer, PATCHES[k].count, &f);
        fixture_start(&f);
        fixture_set_affine(&f, GRADIENT, SHIFT);
        fixture_forces(&f);
        for (int64_t i = 0; i < f.model.node_count; i++)
            for (int q = 0; q < 9; q++)
                assert_close(f.state.f[9 * i + q], GRADIENT[q] + (q % 4 == 0), 1e-12);
        assert_close(relative_acceleration(&f), 0, 1e-10);
        fixture_free(&f);
    }
}

static void without_ties_the_patch_test_fails(void **state) {
    fixture f;
    (void)state;
    build_block(&JITTERED, stepped, 2, &f);
    f.model.tie_count = 0;
    fixture_start(&f);
    fixture_set_affine(&f, GRADIENT, SHIFT);
    fixture_forces(&f);
    assert_true(relative_acceleration(&f) > 1e-2);
    fixture_free(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_list_reaches_across_an_interface),
        cmocka_unit_test(nodes_of_an_interface_exist_once_per_layer),
        cmocka_unit_test(junction_of_three_layers_is_a_chain_of_ties),
        cmocka_unit_test(affine_field_across_interfaces_is_in_equilibrium),
        cmocka_unit_test(without_ties_the_patch_test_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
