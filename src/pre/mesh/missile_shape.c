/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/missile_shape.h"

#include "base/mat3.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit.h>
#include <stdbool.h>

static const double SPHERE_TOLERANCE = 1e-6;

/* |x|^2 = 2 c.x + (R^2 - |c|^2) is linear in c and the constant; solved about the nodes' mean, scaled. */
sf_status sf_missile_fit_sphere(const sf_surface *surface, double centre[3], double *radius,
                                double *deviation, sf_error *err) {
    int64_t n = surface->node_count;
    double mean[3] = {0}, scale = 0, chisq;
    if (n < 4)
        return SF_FAIL(err, SF_ERR_MODEL, "the missile's surface has %lld nodes; a sphere needs 4",
                       (long long)n);
    for (int64_t k = 0; k < 3 * n; k++)
        mean[k % 3] += surface->position[k] / (double)n;
    for (int64_t k = 0; k < 3 * n; k++)
        scale = fmax(scale, fabs(surface->position[k] - mean[k % 3]));
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    gsl_matrix *a = gsl_matrix_alloc((size_t)n, 4), *covariance = gsl_matrix_alloc(4, 4);
    gsl_vector *rhs = gsl_vector_alloc((size_t)n), *x = gsl_vector_alloc(4);
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc((size_t)n, 4);
    if (!a || !covariance || !rhs || !x || !work) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory fitting a sphere to %lld nodes", (long long)n);
        goto done;
    }
    for (int64_t i = 0; i < n; i++) {
        double p[3], square = 0;
        for (int c = 0; c < 3; c++) {
            p[c] = (surface->position[3 * i + c] - mean[c]) / scale;
            square += p[c] * p[c];
            gsl_matrix_set(a, (size_t)i, (size_t)c, 2 * p[c]);
        }
        gsl_matrix_set(a, (size_t)i, 3, 1);
        gsl_vector_set(rhs, (size_t)i, square);
    }
    size_t rank = 0;
    if (gsl_multifit_linear_tsvd(a, rhs, 1e-10, x, covariance, &chisq, &rank, work) != GSL_SUCCESS ||
        rank < 4) {
        SF_FAIL(err, SF_ERR_MODEL, "the missile's surface is flat: no sphere fits it");
        goto done;
    }
    double square = gsl_vector_get(x, 3);
    for (size_t c = 0; c < 3; c++) {
        square += gsl_vector_get(x, c) * gsl_vector_get(x, c);
        centre[c] = mean[c] + scale * gsl_vector_get(x, c);
    }
    *radius = scale * sqrt(square);
    *deviation = 0;
    for (int64_t i = 0; i < n; i++) {
        const double *p = &surface->position[3 * i];
        double r[3] = {p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};
        *deviation = fmax(*deviation, fabs(sqrt(sf_dot3(r, r)) / *radius - 1));
    }
done:
    gsl_multifit_linear_free(work);
    gsl_matrix_free(a);
    gsl_matrix_free(covariance);
    gsl_vector_free(rhs);
    gsl_vector_free(x);
    gsl_set_error_handler(handler);
    return err->status;
}

/* Does the surface, from outside, cover the point of the sphere that leads along the direction? A recess, a
 * bowl that opens downwards and a ring do not. */
static bool covers_pole(const sf_surface *surface, const double centre[3], double radius,
                        const double direction[3]) {
    static const double SLACK = 1e-9;
    for (int64_t t = 0; t < surface->triangle_count; t++) {
        double x[3][3];
        for (int v = 0; v < 3; v++)
            for (int c = 0; c < 3; c++)
                x[v][c] =
                    (surface->position[3 * (int64_t)surface->triangle[3 * t + v] + c] - centre[c]) / radius;
        if (sf_triple3(x[0], x[1], x[2]) > 0 && sf_triple3(direction, x[1], x[2]) >= -SLACK &&
            sf_triple3(x[0], direction, x[2]) >= -SLACK && sf_triple3(x[0], x[1], direction) >= -SLACK)
            return true;
    }
    return false;
}

sf_status sf_missile_set_shape(const sf_surface *surface, int rule, sf_missile_card *card, sf_error *err) {
    double centre[3], radius = 0, deviation = INFINITY;
    sf_error quiet = SF_ERROR_INIT;
    card->shape = SF_SHAPE_SURFACE;
    if (rule == 2)
        return SF_OK;
    sf_status status = sf_missile_fit_sphere(surface, centre, &radius, &deviation, &quiet);
    if (status != SF_OK || deviation > SPHERE_TOLERANCE) {
        if (rule == 1)
            return SF_FAIL(err, SF_ERR_MODEL,
                           "missile.shape is \"sphere\", but the surface deviates from the best sphere by "
                           "%.3g of its radius (bound %.0e)",
                           deviation, SPHERE_TOLERANCE);
        return SF_OK;
    }
    if (!covers_pole(surface, centre, radius, card->direction)) {
        if (rule == 1)
            return SF_FAIL(
                err, SF_ERR_MODEL,
                "missile.shape is \"sphere\", but the surface does not cover the point of its sphere that "
                "leads along missile.direction, or is hollow there");
        return SF_OK;
    }
    card->shape = SF_SHAPE_SPHERE;
    card->sphere_radius = radius;
    card->sphere_cap_cosine = 1;
    for (int c = 0; c < 3; c++)
        card->sphere_centre[c] = centre[c];
    for (int64_t i = 0; i < surface->node_count; i++) {
        const double *p = &surface->position[3 * i];
        double r[3] = {p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};
        card->sphere_cap_cosine = fmin(card->sphere_cap_cosine, sf_dot3(r, card->direction) / radius);
    }
    return SF_OK;
}

/* Travel of a sphere until it touches x, or infinity. */
static double sphere_travel(const sf_missile_card *card, const double x[3]) {
    double r[3], along, across;
    for (int c = 0; c < 3; c++)
        r[c] = x[c] - card->sphere_centre[c];
    along = sf_dot3(r, card->direction);
    across = sf_dot3(r, r) - along * along;
    double square = card->sphere_radius * card->sphere_radius - across;
    if (square < 0 || sqrt(square) < card->sphere_cap_cosine * card->sphere_radius)
        return INFINITY;
    return along - sqrt(square);
}

/* Travel of a triangle until it touches x: intersection with the line through x along the direction (Moeller
 * and Trumbore 1997), or infinity. */
static double triangle_travel(const double *a, const double *b, const double *c, const double direction[3],
                              const double x[3]) {
    double u[3], v[3], r[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
        r[k] = x[k] - a[k];
    }
    sf_cross3(direction, v, p);
    sf_cross3(r, u, q);
    double determinant = sf_dot3(u, p), slack = 1e-9;
    if (determinant == 0)
        return INFINITY;
    double s = sf_dot3(r, p) / determinant, t = sf_dot3(direction, q) / determinant;
    if (s < -slack || t < -slack || s + t > 1 + slack)
        return INFINITY;
    return -sf_dot3(v, q) / determinant; /* x = point of the triangle + travel * direction */
}

double sf_missile_travel(const sf_surface *surface, const sf_missile_card *card, const double x[3]) {
    if (card->shape == SF_SHAPE_SPHERE)
        return sphere_travel(card, x);
    double travel = INFINITY;
    for (int64_t t = 0; t < surface->triangle_count; t++) {
        const int32_t *v = &surface->triangle[3 * t];
        travel = fmin(travel, triangle_travel(&surface->position[3 * v[0]], &surface->position[3 * v[1]],
                                              &surface->position[3 * v[2]], card->direction, x));
    }
    return travel;
}

sf_status sf_missile_distance(const sf_surface *surface, const sf_missile_card *card, const double *position,
                              int64_t count, const int32_t *node, double *distance, sf_error *err) {
    *distance = INFINITY;
    for (int64_t k = 0; k < count; k++)
        *distance = fmin(*distance, sf_missile_travel(surface, card, &position[3 * (int64_t)node[k]]));
    if (!isfinite(*distance))
        return SF_FAIL(err, SF_ERR_MODEL,
                       "the missile, moving along (%g, %g, %g), never touches the contact group: check its "
                       "position over the pad and missile.direction",
                       card->direction[0], card->direction[1], card->direction[2]);
    return SF_OK;
}
