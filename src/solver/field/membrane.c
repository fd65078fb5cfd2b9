/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/field/membrane.h"

#include "base/mat3.h"
#include "base/sets.h"
#include "model/stability.h"

/* ---- constants ---- */

static sf_status number_nodes(const sf_model *m, sf_membrane *b, sf_error *err) {
    b->triangle_count = m->membrane_count;
    b->triangle = sf_alloc(err, 3 * m->membrane_count, sizeof *b->triangle, "membrane");
    SF_TRY(err->status);
    memcpy(b->triangle, m->membrane_triangle, 3 * (size_t)m->membrane_count * sizeof *b->triangle);
    b->node = sf_list_number(m->node_count, 3 * b->triangle_count, b->triangle, &b->count, "membrane", err);
    return err->status;
}

/* Gradients of the shape functions in the axes along the first side and across it, and the area. */
static double shape_triangle(const double *const x[3], double gradient[6]) {
    double side[2][3], normal[3], along[3], across[3];
    for (int k = 0; k < 2; k++)
        sf_sub3(x[k + 1], x[0], side[k]);
    sf_cross3(side[0], side[1], normal);
    double twice = sqrt(sf_dot3(normal, normal));
    memcpy(along, side[0], sizeof along);
    sf_unit3(along);
    sf_unit3(normal);
    sf_cross3(normal, along, across);
    for (int k = 0; k < 3; k++) { /* the opposite side, turned by a right angle, over twice the area */
        const double *from = x[(k + 1) % 3], *to = x[(k + 2) % 3];
        double opposite[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
        gradient[2 * k] = -sf_dot3(opposite, across) / twice;
        gradient[2 * k + 1] = sf_dot3(opposite, along) / twice;
    }
    return 0.5 * twice;
}

static sf_status shape_triangles(const sf_model *m, sf_membrane *b, sf_error *err) {
    b->gradient = sf_alloc(err, 6 * b->triangle_count, sizeof *b->gradient, "membrane");
    b->volume = sf_alloc(err, b->triangle_count, sizeof *b->volume, "membrane");
    for (int64_t t = 0; err->status == SF_OK && t < b->triangle_count; t++) {
        const double *x[3];
        sf_corners(m->position, &m->membrane_triangle[3 * t], x);
        b->volume[t] = shape_triangle(x, &b->gradient[6 * t]) * m->membrane.thickness * m->membrane_share[t];
    }
    return err->status;
}

sf_status sf_membrane_build(const sf_model *m, sf_membrane *b, sf_error *err) {
    *b = (sf_membrane){0};
    if (m->membrane_count == 0)
        return SF_OK;
    if (number_nodes(m, b, err) != SF_OK || shape_triangles(m, b, err) != SF_OK ||
        sf_point_rows_build(m, b->count, b->node, &b->rows, err) != SF_OK ||
        sf_stability_membrane(m, &b->load, err) != SF_OK)
        sf_membrane_free(b);
    return err->status;
}

void sf_membrane_free(sf_membrane *b) {
    sf_point_rows_free(&b->rows);
    SF_CLEAR(b, b->node, b->triangle, b->gradient, b->volume);
}

/* ---- forces ---- */

/* Second Piola-Kirchhoff stress (xx, yy, xy) of the Green strain in plane stress; returns the energy density.
 * Of a fabric compression relaxes: its energy is the least over folds. */
static double stress_of(const sf_membrane_card *card, const double strain[3], double stress[3]) {
    double mean = 0.5 * (strain[0] + strain[1]), half = 0.5 * (strain[0] - strain[1]),
           radius = hypot(half, strain[2]), major = mean + radius, minor = mean - radius,
           plane = card->modulus / (1 - card->poisson * card->poisson),
           large = plane * (major + card->poisson * minor), small = plane * (minor + card->poisson * major);
    if (card->fabric && small < 0) { /* it folds across the larger strain, or altogether */
        large = major > 0 ? card->modulus * major : 0;
        small = 0;
    }
    double middle = 0.5 * (large + small), spread = radius > 0 ? 0.5 * (large - small) / radius : 0;
    stress[0] = middle + spread * half;
    stress[1] = middle - spread * half;
    stress[2] = spread * strain[2];
    return 0.5 * (large * major + small * minor);
}

/* Forces, energy and largest strain of triangle t into its row. */
static void load_triangle(const sf_model *m, const sf_membrane *b, const double *position, int64_t t,
                          double row[SF_MEMBRANE_ROW]) {
    const double *gradient = &b->gradient[6 * t];
    double f[3][2] = {{0}}, strain[3], stress[3];
    for (int k = 0; k < 3; k++)
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 2; c++)
                f[r][c] += position[3 * (int64_t)b->triangle[3 * t + k] + r] * gradient[2 * k + c];
    strain[0] = strain[1] = -0.5;
    strain[2] = 0;
    for (int r = 0; r < 3; r++) {
        strain[0] += 0.5 * f[r][0] * f[r][0];
        strain[1] += 0.5 * f[r][1] * f[r][1];
        strain[2] += 0.5 * f[r][0] * f[r][1];
    }
    row[9] = b->volume[t] * stress_of(&m->membrane, strain, stress);
    row[10] = 0.5 * (strain[0] + strain[1]) + hypot(0.5 * (strain[0] - strain[1]), strain[2]);
    for (int r = 0; r < 3; r++) {
        double first[2] = {f[r][0] * stress[0] + f[r][1] * stress[2],
                           f[r][0] * stress[2] + f[r][1] * stress[1]};
        for (int k = 0; k < 3; k++)
            row[3 * k + r] = -b->volume[t] * (first[0] * gradient[2 * k] + first[1] * gradient[2 * k + 1]);
    }
}

static void place_nodes(const sf_model *m, const sf_membrane *b, const double *d, double *position) {
#pragma omp parallel for if (b->count > SF_FEW_NODES) default(none) shared(m, b, d, position) schedule(static)
    for (int64_t p = 0; p < b->count; p++)
        for (int r = 0; r < 3; r++) {
            double x = m->position[3 * (int64_t)b->node[p] + r];
            for (int64_t e = b->rows.ptr[p]; e < b->rows.ptr[p + 1]; e++)
                x += b->rows.value[e] * d[3 * (int64_t)b->rows.node[e] + r];
            position[3 * p + r] = x;
        }
}

void sf_membrane_force(const sf_model *m, const sf_membrane *b, const double *d, sf_membrane_state *s,
                       double *force) {
    double stretch = 0;
    s->energy = 0;
    if (b->count == 0)
        return;
    place_nodes(m, b, d, s->position);
#pragma omp parallel for if (b->triangle_count > SF_FEW_NODES) default(none) shared(m, b, s) schedule(static)
    for (int64_t t = 0; t < b->triangle_count; t++)
        load_triangle(m, b, s->position, t, &s->row[SF_MEMBRANE_ROW * t]);
    memset(s->force, 0, 3 * (size_t)b->count * sizeof *s->force);
    for (int64_t t = 0; t < b->triangle_count; t++) {
        const double *row = &s->row[SF_MEMBRANE_ROW * t];
        for (int k = 0; k < 9; k++)
            s->force[3 * (int64_t)b->triangle[3 * t + k / 3] + k % 3] += row[k];
        s->energy += row[9];
        stretch = fmax(stretch, row[10]);
    }
    for (int64_t p = 0; p < b->count; p++)
        for (int64_t e = b->rows.ptr[p]; e < b->rows.ptr[p + 1]; e++)
            for (int r = 0; r < 3; r++)
                force[3 * (int64_t)b->rows.node[e] + r] += b->rows.value[e] * s->force[3 * p + r];
    s->load = b->load * (1 + 4 * stretch);
}
