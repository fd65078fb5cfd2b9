/* SPDX-License-Identifier: GPL-3.0-or-later */
/* missile.position: where the missile's lowest point arrives at the pad's top. */
#include "model_fixture.h"
#include "pre/missile_body.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const fixture_block BLOCK = {.cells = {4, 4, 2}, .spacing = 0.01};

typedef enum form { DOME, FACETS, PLATE } form;

typedef struct drop {
    form form;
    const char *position, *direction, *gap;
    const char *symmetry; /* a plane of the block, or NULL */
    double from[2];       /* m, where the geometry has the missile's axis */
} drop;

static void make_missile(const drop *d, sf_surface *s) {
    if (d->form == PLATE)
        fixture_plate(0.01, d->from[0], d->from[1], s);
    else
        fixture_dome(0.08, 8, d->from[0], d->from[1], s);
}

/* The model over a block of 40 x 40 x 20 mm with corners at (0, 0) and (40, 40) mm; the error of the build.
 */
static sf_error place(const drop *d, sf_mesh *mesh, sf_model *m) {
    char option[4][128];
    const char *list[5] = {option[0], option[1], option[2], option[3], NULL};
    sf_case c;
    sf_surface surface;
    sf_build_report report;
    sf_error err = SF_ERROR_INIT;
    snprintf(option[0], sizeof option[0], "missile.direction=%s", d->direction);
    snprintf(option[1], sizeof option[1], "missile.gap=%s", d->gap);
    snprintf(option[2], sizeof option[2], "missile.shape=%s", d->form == DOME ? "sphere" : "surface");
    snprintf(option[3], sizeof option[3], "%s%s", d->position ? "missile.position=" : "pad.contact=top",
             d->position ? d->position : "");
    fixture_case(&c, list);
    c.mesh_error_limit = 10;
    c.symmetry_count = d->symmetry != NULL;
    c.symmetry_given = true;
    snprintf(c.symmetry_group[0], sizeof c.symmetry_group[0], "%s", d->symmetry ? d->symmetry : "");
    make_missile(d, &surface);
    sf_model_build(&c, mesh, &surface, m, &report, NULL, &err);
    sf_surface_free(&surface);
    sf_mesh_free(mesh);
    sf_case_free(&c);
    return err;
}

static sf_error place_block(const drop *d, sf_model *m) {
    sf_mesh mesh;
    fixture_block_mesh(&BLOCK, &mesh);
    return place(d, &mesh, m);
}

static void lowest_point_arrives_there(void **state) {
    (void)state;
    static const drop rows[] = {
        {DOME, "[\"30 mm\", \"1 cm\"]", "[0, 0, -1]", "0 mm", NULL, {0, 0}},
        {DOME, "[\"30 mm\", \"1 cm\"]", "[0, 0, -1]", "0 mm", NULL, {0.7, -0.3}},
        {DOME, "[\"30 mm\", \"1 cm\"]", "[3, -2, -4]", "25 mm", NULL, {0.7, -0.3}},
        {FACETS, "[\"30 mm\", \"1 cm\"]", "[0, 0, -1]", "0 mm", NULL, {0.7, -0.3}},
        {FACETS, "[\"30 mm\", \"1 cm\"]", "[1, 0, -2]", "25 mm", NULL, {0.7, -0.3}},
        {PLATE, "[\"30 mm\", \"1 cm\"]", "[0, 0, -1]", "3 mm", NULL, {0.7, -0.3}},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        sf_model m;
        double point[3], low = INFINITY, *x, *tip = NULL;
        sf_error err = place_block(&rows[k], &m);
        if (err.status != SF_OK)
            fail_msg("%zu: %s", k, err.text);
        const double *d = m.missile.direction;
        for (int64_t i = 0; i < m.surface_node_count; i++) /* the dome's pole is a node */
            if ((x = &m.surface_position[3 * i])[2] < low) {
                low = x[2];
                tip = x;
            }
        double travel = (0.02 - tip[2]) / d[2], half = rows[k].form == PLATE ? 0.005 : 0;
        assert_close(travel, m.missile.gap, 1e-12); /* a node of the top is there */
        assert_close(fabs(tip[0] + travel * d[0] - 0.03), half, 1e-12);
        assert_close(fabs(tip[1] + travel * d[1] - 0.01), half, 1e-12);
        if (rows[k].form == DOME)
            for (int c = 0; c < 2; c++)
                assert_close(m.missile.sphere_centre[c], tip[c], 1e-12);
        sf_impact_point(&m, point);
        assert_close(point[0], 0.03, 1e-12);
        assert_close(point[1], 0.01, 1e-12);
        assert_close(point[2], 0.02, 1e-12);
        assert_true(m.missile.impact_known == 1 && m.missile.impact[0] == point[0] &&
                    m.missile.impact[1] == point[1]);
        sf_model_free(&m);
    }
}

/* As if the geometry had put it there, bit by bit at places that are exact. */
static void same_model_as_from_the_geometry(void **state) {
    (void)state;
    const drop drawn = {DOME, NULL, "[0, 0, -1]", "0 mm", NULL, {0.03125, 0.015625}},
               given = {DOME, "[\"0.03125 m\", \"0.015625 m\"]", "[0, 0, -1]", "0 mm", NULL, {0, 0}};
    sf_model a, b;
    sf_error first = place_block(&drawn, &a), second = place_block(&given, &b);
    assert_int_equal(first.status, SF_OK);
    assert_int_equal(second.status, SF_OK);
    for (int64_t k = 0; k < 3 * a.surface_node_count; k++)
        assert_close(a.surface_position[k], b.surface_position[k], 1e-15);
    assert_close(a.missile.clearance, b.missile.clearance, 1e-15);
    sf_model_free(&a);
    sf_model_free(&b);
}

static void assert_refused(const drop *d, const char *part) {
    sf_model m;
    sf_error err = place_block(d, &m);
    assert_int_equal(err.status, SF_ERR_INPUT);
    if (!strstr(err.text, part) || !strstr(err.text, "missile.position"))
        fail_msg("\"%s\" is missing in: %s", part, err.text);
}

static void places_off_the_pad_are_refused(void **state) {
    (void)state;
    const drop beside = {DOME, "[\"41 mm\", \"10 mm\"]", "[0, 0, -1]", "0 mm", NULL, {0, 0}},
               behind = {PLATE, "[\"20 mm\", \"-5 mm\"]", "[0, 0, -1]", "0 mm", NULL, {0.02, 0.02}},
               edge[] = {{DOME, "[\"40 mm\", \"13 mm\"]", "[0, 0, -1]", "0 mm", NULL, {0, 0}},
                         {DOME, "[\"40 mm\", \"0 mm\"]", "[0, 0, -1]", "0 mm", NULL, {0, 0}}};
    assert_refused(&beside, "(41, 10) mm lies outside the pad's top, the group \"top\"");
    assert_refused(&behind, "(20, -5) mm lies outside the pad's top");
    for (int k = 0; k < 2; k++) {
        sf_model m;
        sf_error err = place_block(&edge[k], &m);
        if (err.status != SF_OK)
            fail_msg("%s", err.text);
        sf_model_free(&m);
    }
}

/* The plane x = 0 of the block. */
static void symmetry_is_kept(void **state) {
    (void)state;
    drop d = {DOME, "[\"5 mm\", \"10 mm\"]", "[0, 0, -1]", "0 mm", "plane_x", {0, 0}};
    sf_model m;
    double point[3];
    assert_refused(&d, "x = 5 mm lies off the symmetry plane x = 0 mm");
    d.position = "[\"0 mm\", \"10 mm\"]"; /* along the plane it moves */
    sf_error err = place_block(&d, &m);
    if (err.status != SF_OK)
        fail_msg("%s", err.text);
    sf_impact_point(&m, point);
    assert_close(point[0], 0, 0);
    assert_close(point[1], 0.01, 1e-12);
    assert_close(m.missile.sphere_centre[1], 0.01, 1e-12);
    sf_model_free(&m);
}

/* In the hole of x from `begin` to 45 mm, y from 15 to 45 mm. */
static bool is_bored(const sf_mesh *mesh, int32_t node, double begin) {
    const double *x = &mesh->position[3 * (int64_t)node];
    return x[0] > begin && x[0] < 0.045 && x[1] > 0.015 && x[1] < 0.045;
}

/* Sinks the nodes of the top in the hole, and takes them out of the group. */
static void bore(sf_mesh *mesh, double begin) {
    sf_node_set *top = &mesh->set[1];
    int64_t nodes = 0;
    for (int64_t k = 0; k < top->count; k++)
        if (is_bored(mesh, top->node[k], begin))
            mesh->position[3 * (int64_t)top->node[k] + 2] -= 0.006;
        else
            top->node[nodes++] = top->node[k];
    assert_true(nodes > 0 && nodes < top->count);
    top->count = nodes;
}

/* Also over a hole that a symmetry plane cuts: the outline counts. */
static void holes_are_part_of_the_top(void **state) {
    (void)state;
    const fixture_block block = {.cells = {6, 6, 2}, .spacing = 0.01};
    static const struct {
        drop d;
        double begin;
        bool inside;
    } rows[] = {
        {{DOME, "[\"30 mm\", \"30 mm\"]", "[0, 0, -1]", "0 mm", NULL, {0, 0}}, 0.015, true},
        {{DOME, "[\"0 mm\", \"30 mm\"]", "[0, 0, -1]", "0 mm", "plane_x", {0, 0}}, -1, true},
        {{DOME, "[\"-1 mm\", \"30 mm\"]", "[0, 0, -1]", "0 mm", NULL, {0, 0}}, -1, false}, /* a notch */
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        sf_mesh mesh;
        sf_model m;
        fixture_block_mesh(&block, &mesh);
        bore(&mesh, rows[k].begin);
        sf_error err = place(&rows[k].d, &mesh, &m);
        if (rows[k].inside && err.status != SF_OK)
            fail_msg("%s", err.text);
        if (rows[k].inside)
            assert_close(m.missile.sphere_centre[1], 0.03, 1e-12);
        else
            assert_non_null(strstr(err.text, "outside the pad's top"));
        sf_model_free(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lowest_point_arrives_there),     cmocka_unit_test(same_model_as_from_the_geometry),
        cmocka_unit_test(places_off_the_pad_are_refused), cmocka_unit_test(symmetry_is_kept),
        cmocka_unit_test(holes_are_part_of_the_top),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
