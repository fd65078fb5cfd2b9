/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Surfaces of several closed parts: cavities, bodies side by side, overlaps; against closed forms. */

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/mat3.h"
#include "body_fixture.h"
#include "post_check.h"
#include "pre/mesh/missile_shape.h"
#include "pre/missile_body.h"

static const double DOWN[3] = {0, 0, -1};

/* Appends a part; with `inverted` its triangles face inwards. */
static void append(sf_surface *s, const sf_surface *part, bool inverted) {
    s->position = realloc(s->position, 3 * (size_t)(s->node_count + part->node_count) * sizeof(double));
    s->triangle =
        realloc(s->triangle, 3 * (size_t)(s->triangle_count + part->triangle_count) * sizeof(int32_t));
    assert_non_null(s->position);
    assert_non_null(s->triangle);
    memcpy(&s->position[3 * s->node_count], part->position, 3 * (size_t)part->node_count * sizeof(double));
    for (int64_t k = 0; k < 3 * part->triangle_count; k++) {
        int64_t from = inverted && k % 3 > 0 ? k + (k % 3 == 1 ? 1 : -1) : k;
        s->triangle[3 * s->triangle_count + k] = part->triangle[from] + (int32_t)s->node_count;
    }
    s->node_count += part->node_count;
    s->triangle_count += part->triangle_count;
}

static void append_ball(sf_surface *s, int n, double radius, const double centre[3], bool inverted) {
    body b;
    body_ball(&b, n, radius, centre);
    append(s, &b.surface, inverted);
    body_free(&b, NULL);
}

/* The box from `low`, of 12 triangles. */
static void append_box(sf_surface *s, const double low[3], const double size[3], bool inverted) {
    static int32_t triangle[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                   2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    double x[24];
    for (int k = 0; k < 24; k++)
        x[k] = low[k % 3] + (k / 3 >> k % 3 & 1) * size[k % 3];
    append(s, &(sf_surface){.node_count = 8, .position = x, .triangle_count = 12, .triangle = triangle},
           inverted);
}

/* Turns the surface for contact and measures it; releases it. */
static sf_status measure(sf_surface *s, sf_solid *solid, sf_error *err) {
    if (sf_surface_orient(s, DOWN, err) == SF_OK)
        sf_solid_measure(s->node_count, s->position, s->triangle_count, s->triangle, solid, err);
    sf_surface_free(s);
    return err->status;
}

static void assert_solid(sf_surface *s, const sf_solid *expected) {
    sf_solid solid;
    sf_error err = SF_ERROR_INIT;
    if (measure(s, &solid, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_relative(solid.volume, expected->volume, 1e-12);
    for (int c = 0; c < 3; c++)
        assert_close(solid.centroid[c], expected->centroid[c], 1e-13);
    for (int c = 0; c < 6; c++)
        assert_close(solid.inertia[c], expected->inertia[c], 1e-12 * expected->inertia[0]);
}

/* Adds `sign` bodies to one about the origin. */
static void add_solid(sf_solid *sum, double sign, double volume, const double own[3], const double at[3]) {
    double square = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
    sum->volume += sign * volume;
    for (int c = 0; c < 3; c++) {
        sum->centroid[c] += sign * volume * at[c];
        sum->inertia[c] += sign * (own[c] + volume * (square - at[c] * at[c]));
        sum->inertia[3 + c] -= sign * volume * at[c] * at[(c + 1) % 3];
    }
}

/* From about the origin to about the centroid. */
static void finish_solid(sf_solid *sum) {
    sf_solid about = {0};
    for (int c = 0; c < 3; c++)
        sum->centroid[c] /= sum->volume;
    add_solid(&about, 1, sum->volume, (const double[3]){0}, sum->centroid);
    for (int c = 0; c < 6; c++)
        sum->inertia[c] -= about.inertia[c];
}

/* Volume, and moment about its middle, of a ball of facets; they are those of a sphere to 2 and 3 %. */
static void facet_ball(int n, double radius, double *volume, double inertia[3]) {
    sf_surface s = {0};
    sf_solid solid;
    sf_error err = SF_ERROR_INIT;
    append_ball(&s, n, radius, (const double[3]){0}, false);
    assert_int_equal(measure(&s, &solid, &err), SF_OK);
    *volume = solid.volume;
    memcpy(inertia, solid.inertia, 3 * sizeof *inertia);
    assert_relative(*volume, 4 * M_PI * pow(radius, 3) / 3, 0.02);
    assert_relative(inertia[0], 8 * M_PI * pow(radius, 5) / 15, 0.03);
}

static void a_ball_within_a_ball_is_a_cavity(void **state) {
    (void)state;
    const double at[2][3] = {{0.01, 0.02, 0.3}, {0.015, 0.02, 0.302}}, radius[2] = {0.08, 0.07};
    sf_solid shell = {0};
    for (int k = 0; k < 2; k++) {
        double volume, own[3];
        facet_ball(16, radius[k], &volume, own);
        add_solid(&shell, k ? -1 : 1, volume, own, at[k]);
    }
    finish_solid(&shell);
    for (int turned = 0; turned < 8; turned++) { /* however, and in whichever order, they are drawn */
        sf_surface s = {0};
        int first = turned >> 2;
        append_ball(&s, 16, radius[first], at[first], turned & 1);
        append_ball(&s, 16, radius[!first], at[!first], turned >> 1 & 1);
        assert_solid(&s, &shell);
    }
}

/* Five boxes: a shell with a core, and a lump beside the core in the same cavity that is hollow itself. */
static void material_and_cavities_alternate(void **state) {
    (void)state;
    static const struct {
        double low[3], size[3], sign;
    } box[] = {{{0.0, 0.0, 0.0}, {0.4, 0.3, 0.2}, 1},
               {{0.02, 0.02, 0.02}, {0.36, 0.26, 0.16}, -1},
               {{0.05, 0.05, 0.05}, {0.1, 0.1, 0.1}, 1},
               {{0.2, 0.05, 0.03}, {0.15, 0.2, 0.14}, 1},
               {{0.21, 0.06, 0.05}, {0.1, 0.1, 0.1}, -1}};
    enum { BOXES = sizeof box / sizeof box[0] };
    for (int turned = 0; turned < 1 << BOXES; turned++) {
        sf_solid sum = {0};
        sf_surface s = {0};
        for (int k = 0; k < BOXES; k++) {
            double own[3], middle[3], volume = box[k].size[0] * box[k].size[1] * box[k].size[2];
            for (int c = 0; c < 3; c++) {
                middle[c] = box[k].low[c] + box[k].size[c] / 2;
                own[c] = volume * (pow(box[k].size[(c + 1) % 3], 2) + pow(box[k].size[(c + 2) % 3], 2)) / 12;
            }
            add_solid(&sum, box[k].sign, volume, own, middle);
            append_box(&s, box[k].low, box[k].size, turned >> k & 1);
        }
        finish_solid(&sum);
        assert_solid(&s, &sum);
    }
}

/* A dumbbell of two balls, and boxes that touch: at a whole face, at a part of one, at an edge. */
static void parts_side_by_side_add(void **state) {
    (void)state;
    static const double at[2][3] = {{-0.1, 0, 0.2}, {0.1, 0, 0.2}}, side[3] = {0.1, 0.1, 0.1};
    static const double beside[][3] = {{0.1, 0, 0}, {0.1, 0.05, 0}, {0.1, 0.03, 0.07}, {0.1, 0.1, 0}};
    sf_solid sum = {0};
    sf_surface s = {0};
    for (int k = 0; k < 2; k++) {
        double volume, own[3];
        facet_ball(12, 0.06, &volume, own);
        add_solid(&sum, 1, volume, own, at[k]);
        append_ball(&s, 12, 0.06, at[k], k);
    }
    finish_solid(&sum);
    assert_solid(&s, &sum);
    for (size_t k = 0; k < sizeof beside / sizeof beside[0]; k++) {
        sf_solid solid;
        sf_error err = SF_ERROR_INIT;
        append_box(&s, (const double[3]){0}, side, false);
        append_box(&s, beside[k], side, true);
        if (measure(&s, &solid, &err) != SF_OK)
            fail_msg("%zu: %s", k, err.text);
        assert_relative(solid.volume, 2e-3, 1e-12);
        memset(&s, 0, sizeof s);
    }
}

static void overlaps_are_refused(void **state) {
    (void)state;
    static const double origin[3] = {0}, side[3] = {0.1, 0.1, 0.1};
    static const struct {
        double at[3], size[3];
        const char *said;
    } rows[] = {
        {{0.03, 0.04, 0.02}, {0.1, 0.1, 0.1}, "overlap"},   /* corner in corner */
        {{0.05, 0, 0}, {0.1, 0.1, 0.1}, "overlap"},         /* with four faces in common planes */
        {{-0.1, 0.02, 0.02}, {0.3, 0.05, 0.05}, "overlap"}, /* right through */
        {{0.02, 0.02, 0}, {0.05, 0.05, 0.05}, "overlap"},   /* within, at a face */
        {{0, 0, 0}, {0.1, 0.1, 0.1}, "are the same at"},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++)
        for (int order = 0; order < 2; order++) {
            sf_surface s = {0};
            sf_solid solid;
            sf_error err = SF_ERROR_INIT;
            append_box(&s, order ? rows[k].at : origin, order ? rows[k].size : side, false);
            append_box(&s, order ? origin : rows[k].at, order ? side : rows[k].size, true);
            if (measure(&s, &solid, &err) != SF_ERR_INPUT || !strstr(err.text, rows[k].said))
                fail_msg("%zu, %d: %d %s", k, order, err.status, err.text);
            assert_close(solid.volume, 0, 0);
        }
    for (int n = 3; n <= 12; n++)
        for (int same = 0; same < 2; same++) { /* balls that overlap a little; one of them finer */
            sf_surface s = {0};
            sf_solid solid;
            sf_error err = SF_ERROR_INIT;
            append_ball(&s, n, 0.08, origin, false);
            append_ball(&s, same ? n : n + 4, 0.08, (const double[3]){same ? 0 : 0.14, 0, 0}, false);
            if (measure(&s, &solid, &err) != SF_ERR_INPUT || !strstr(err.text, same ? "same" : "overlap"))
                fail_msg("%d, %d: %d %s", n, same, err.status, err.text);
        }
}

/* Contact sees what normals face: that of a shell looks out at its outer surface and into its cavity. Parts
 * that overlap look out. */
static void cavities_face_inwards(void **state) {
    (void)state;
    for (int overlap = 0; overlap < 2; overlap++) {
        sf_surface s = {0};
        sf_error err = SF_ERROR_INIT;
        append_ball(&s, 4, 0.08, (const double[3]){0}, true);
        append_ball(&s, 4, 0.05, (const double[3]){overlap ? 0.06 : 0, 0, 0}, false);
        int64_t half = s.triangle_count / 2;
        assert_int_equal(sf_surface_orient(&s, DOWN, &err), SF_OK);
        for (int64_t t = 0; t < s.triangle_count; t++) {
            double normal[3], *x = &s.position[3 * (int64_t)s.triangle[3 * t]],
                              from[3] = {x[0] - (t >= half && overlap ? 0.06 : 0), x[1], x[2]};
            sf_face_normal(s.position, &s.triangle[3 * t], normal);
            assert_true((sf_dot3(normal, from) > 0) == (t < half || overlap));
        }
        sf_surface_free(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_within_a_ball_is_a_cavity),
        cmocka_unit_test(material_and_cavities_alternate),
        cmocka_unit_test(parts_side_by_side_add),
        cmocka_unit_test(overlaps_are_refused),
        cmocka_unit_test(cavities_face_inwards),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
