/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missiles of geo/missiles through gmsh: volume, centroid and inertia of their closed surfaces against
 * closed forms, and that their facets converge to them. */
#include "model_fixture.h"
#include "pre/mesh/gmsh_session.h"
#include "pre/missile_body.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

/* In mm, for unit density; about the centroid, along the axes. */
typedef struct expected {
    double volume, height; /* of the centroid above the lowest point */
    double inertia[3];
} expected;

static expected cylinder(const double *p) {
    double r = p[0] / 2, h = p[1], volume = M_PI * r * r * h, across = volume * (3 * r * r + h * h) / 12;
    return (expected){volume, h / 2, {across, across, volume * r * r / 2}};
}

static expected headform(const double *p) {
    double a = p[0] / 2, b = p[1] / 2, c = p[2] / 2, volume = 4 * M_PI * a * b * c / 3;
    return (expected){
        volume,
        c,
        {volume * (b * b + c * c) / 5, volume * (c * c + a * a) / 5, volume * (a * a + b * b) / 5}};
}

static expected bar(const double *p) {
    double r = p[0] / 2, l = p[1] - p[0], round = M_PI * r * r * l, ends = 4 * M_PI * r * r * r / 3;
    double along = round * r * r / 2 + ends * 2 * r * r / 5;
    double across = round * (l * l / 12 + r * r / 4) + ends * (2 * r * r / 5 + l * l / 4 + 3 * l * r / 8);
    return (expected){round + ends, r, {across, along, across}};
}

/* A solid of revolution of radius rho(z): below the height r of the edge rho = a + r sin t at z = r (1 - cos
 * t), with t from 0 to a right angle; the integrals of the powers of sin t are s[]. */
static expected disc(const double *p) {
    const double s[6] = {M_PI / 2, 1, M_PI / 4, 2.0 / 3, 3 * M_PI / 16, 8.0 / 15};
    double big = p[0] / 2, h = p[1], r = p[2], a = big - r;
    double square = a * a * s[1] + 2 * a * r * s[2] + r * r * s[3],
           cosine = a * a / 2 + 2 * a * r / 3 + r * r / 4,
           cube = a * a * s[3] + 2 * a * r * s[4] + r * r * s[5];
    double fourth = r * (pow(a, 4) * s[1] + 4 * pow(a, 3) * r * s[2] + 6 * a * a * r * r * s[3] +
                         4 * a * pow(r, 3) * s[4] + pow(r, 4) * s[5]) +
                    pow(big, 4) * (h - r);
    double volume = M_PI * (r * square + big * big * (h - r));
    double first = M_PI * (r * r * (square - cosine) + big * big * (h * h - r * r) / 2);
    double second =
        M_PI * (pow(r, 3) * (2 * square - 2 * cosine - cube) + big * big * (pow(h, 3) - pow(r, 3)) / 3);
    double across = M_PI / 4 * fourth + second - first * first / volume;
    return (expected){volume, first / volume, {across, across, M_PI / 2 * fourth}};
}

/* Parameters with names, the last one element_size. */
typedef struct missile {
    const char *file;
    expected (*closed_form)(const double *parameter);
    int count;
    const char *name[3];
    double value[3];
    double element_size;
} missile;

static const missile missiles[] = {
    {"geo/missiles/disc.geo", disc, 3, {"diameter", "thickness", "edge_radius"}, {100, 50, 25}, 12},
    {"geo/missiles/cylinder.geo", cylinder, 2, {"diameter", "length"}, {80, 60}, 12},
    {"geo/missiles/headform.geo", headform, 3, {"length", "width", "height"}, {200, 150, 220}, 30},
    {"geo/missiles/bar.geo", bar, 2, {"diameter", "length"}, {60, 180}, 14},
};
enum { MISSILES = sizeof missiles / sizeof missiles[0] };

/* The surface in mm, with one more parameter. */
static void load(const missile *m, double element_size, const char *more, double value, sf_surface *surface) {
    sf_geo_source source = {.path = strdup(fixture_source(m->file)), .parameter_count = m->count + 2};
    sf_error err = SF_ERROR_INIT;
    sf_gmsh *session = NULL;
    assert_non_null(source.path);
    for (int k = 0; k < m->count + 2; k++) {
        sf_geo_parameter *p = &source.parameter[k];
        const char *name = k < m->count ? m->name[k] : k == m->count ? "element_size" : more;
        snprintf(p->name, sizeof p->name, "%s", name);
        p->value = k < m->count ? m->value[k] : k == m->count ? element_size : value;
    }
    if (sf_gmsh_begin(&session, &err) != SF_OK || sf_gmsh_load(session, &source, &err) != SF_OK ||
        sf_gmsh_read_surface(session, "missile_surface", 1, surface, &err) != SF_OK)
        fail_msg("%s: %s", m->file, err.text);
    sf_gmsh_end(&session);
    free(source.path);
}

static void measure(const missile *m, const sf_surface *s, sf_solid *solid) {
    sf_error err = SF_ERROR_INIT;
    if (sf_solid_measure(s->node_count, s->position, s->triangle_count, s->triangle, solid, &err) != SF_OK)
        fail_msg("%s: %s", m->file, err.text);
}

/* The facets' nodes lie on the surface: everything is a little too small, by the square of the element size.
 */
static void solids_converge_to_the_closed_forms(void **state) {
    (void)state;
    for (int k = 0; k < MISSILES; k++) {
        const missile *m = &missiles[k];
        expected e = m->closed_form(m->value);
        double defect[2][4];
        for (int fine = 0; fine < 2; fine++) {
            sf_surface s = {0};
            sf_solid solid;
            sf_missile_card card = {.shape = SF_SHAPE_SURFACE, .direction = {0, 0, -1}};
            double lowest[3], size = cbrt(e.volume);
            load(m, m->element_size / (fine ? 2 : 1), "quarter", 0, &s);
            measure(m, &s, &solid);
            sf_impact_lowest(&s, &card, lowest);
            for (int c = 0; c < 3; c++) {
                assert_close(lowest[c], 0, 1e-6 * size);
                assert_close(solid.centroid[c], c == 2 ? e.height : 0, (fine ? 3e-3 : 1e-2) * size);
                assert_close(solid.inertia[3 + c], 0, 3e-3 * e.inertia[0]);
                defect[fine][c] = 1 - solid.inertia[c] / e.inertia[c];
            }
            defect[fine][3] = 1 - solid.volume / e.volume;
            sf_surface_free(&s);
        }
        for (int c = 0; c < 4; c++) {
            double order = log2(defect[0][c] / defect[1][c]);
            if (!(defect[1][c] > 0 && defect[1][c] < 0.02 && order > 1.6 && order < 2.4))
                fail_msg("%s, quantity %d: defects %g, %g, order %g", m->file, c, defect[0][c], defect[1][c],
                         order);
        }
    }
}

/* The symmetry planes hold the axis: seen from a point of it they add no volume. */
static void quarters_are_quarters(void **state) {
    (void)state;
    for (int k = 0; k < MISSILES; k++) {
        sf_surface s = {0};
        double volume = 0, low[2] = {INFINITY, INFINITY};
        load(&missiles[k], missiles[k].element_size, "quarter", 1, &s);
        for (int64_t t = 0; t < s.triangle_count; t++) {
            const double *a = &s.position[3 * (int64_t)s.triangle[3 * t]],
                         *b = &s.position[3 * (int64_t)s.triangle[3 * t + 1]],
                         *c = &s.position[3 * (int64_t)s.triangle[3 * t + 2]];
            volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                       a[2] * (b[0] * c[1] - b[1] * c[0])) /
                      6;
        }
        for (int64_t i = 0; i < 3 * s.node_count; i++)
            if (i % 3 < 2)
                low[i % 3] = fmin(low[i % 3], s.position[i]);
        assert_relative(4 * volume, missiles[k].closed_form(missiles[k].value).volume, 0.06);
        assert_close(low[0], 0, 1e-6);
        assert_close(low[1], 0, 1e-6);
        sf_surface_free(&s);
    }
}

/* The tensor of a missile that is turned is the turned tensor; the missile stays what it is. */
static void tilt_turns_the_missile(void **state) {
    (void)state;
    for (int k = 0; k < MISSILES; k++) {
        const missile *m = &missiles[k];
        expected e = m->closed_form(m->value);
        sf_surface s = {0};
        sf_solid solid;
        int axis = m->closed_form == bar ? 0 : 1, a = (axis + 1) % 3, b = (axis + 2) % 3;
        load(m, m->element_size, "tilt", 30, &s);
        measure(m, &s, &solid);
        assert_relative(solid.volume, e.volume, 0.06);
        assert_relative(solid.inertia[axis], e.inertia[axis], 0.1);
        assert_relative(solid.inertia[a], 0.75 * e.inertia[a] + 0.25 * e.inertia[b], 0.1);
        assert_relative(solid.inertia[b], 0.25 * e.inertia[a] + 0.75 * e.inertia[b], 0.1);
        sf_surface_free(&s);
    }
}

static void wrong_parameters_are_refused(void **state) {
    (void)state;
    static const struct {
        int missile;
        const char *name;
        double value;
        const char *part;
    } rows[] = {
        {0, "edge_radius", 60, "must be less than the thickness"},
        {1, "length", 0, "must be above 0"},
        {2, "width", -1, "must be above 0"},
        {3, "length", 40, "must be more than the diameter"},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        sf_geo_source source = {.path = strdup(fixture_source(missiles[rows[k].missile].file)),
                                .parameter_count = 1};
        sf_error err = SF_ERROR_INIT;
        sf_gmsh *session = NULL;
        snprintf(source.parameter[0].name, sizeof source.parameter[0].name, "%s", rows[k].name);
        source.parameter[0].value = rows[k].value;
        assert_int_equal(sf_gmsh_begin(&session, &err), SF_OK);
        assert_int_not_equal(sf_gmsh_load(session, &source, &err), SF_OK);
        if (!strstr(err.text, rows[k].part))
            fail_msg("\"%s\" is missing in: %s", rows[k].part, err.text);
        sf_gmsh_end(&session);
        free(source.path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solids_converge_to_the_closed_forms),
        cmocka_unit_test(quarters_are_quarters),
        cmocka_unit_test(tilt_turns_the_missile),
        cmocka_unit_test(wrong_parameters_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
