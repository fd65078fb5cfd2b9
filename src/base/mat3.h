/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <math.h>
#include <stdint.h>

/* Small 3-vector and symmetric 3 x 3 algebra. Symmetric matrices are stored (xx, yy, zz, xy, yz, xz). */

static inline double sf_dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void sf_cross3(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* a - b; `out` may be one of them. */
static inline void sf_sub3(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static inline double sf_distance3(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* Widens the box from `low` to `high`, so that it holds x. */
static inline void sf_box3_add(const double x[3], double low[3], double high[3]) {
    for (int k = 0; k < 3; k++) {
        low[k] = fmin(low[k], x[k]);
        high[k] = fmax(high[k], x[k]);
    }
}

/* The smallest and the largest coordinates of `count` points; INFINITY and -INFINITY without any. */
static inline void sf_box3(int64_t count, const double *position, double low[3], double high[3]) {
    for (int k = 0; k < 3; k++)
        high[k] = -(low[k] = INFINITY);
    for (int64_t i = 0; i < count; i++)
        sf_box3_add(&position[3 * i], low, high);
}

/* Makes a vector one of unit length; zero stays zero. */
static inline void sf_unit3(double a[3]) {
    double size = sqrt(sf_dot3(a, a));
    for (int k = 0; k < 3 && size > 0; k++)
        a[k] /= size;
}

/* a . (b x c): the volume that they span, positive for a right-handed set. */
static inline double sf_triple3(const double a[3], const double b[3], const double c[3]) {
    double normal[3];
    sf_cross3(b, c, normal);
    return sf_dot3(a, normal);
}

/* Largest eigenvalue of a symmetric matrix: trigonometric solution of the characteristic equation (Smith
 * 1961, doi:10.1145/355578.366316), accurate to rounding relative to the matrix norm. */
static inline double sf_sym3_largest(const double s[6]) {
    double mean = (s[0] + s[1] + s[2]) / 3;
    double x = s[0] - mean, y = s[1] - mean, z = s[2] - mean;
    double p = sqrt((x * x + y * y + z * z + 2 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])) / 6);
    if (!(p > 0))
        return mean;
    double half_det =
        (x * (y * z - s[4] * s[4]) - s[3] * (s[3] * z - s[4] * s[5]) + s[5] * (s[3] * s[4] - y * s[5])) /
        (2 * p * p * p);
    double angle = acos(fmax(-1, fmin(1, half_det))) / 3;
    return mean + 2 * p * cos(angle);
}

/* The rotation, row by row, that takes the unit vector `up` to z, by the shortest way; exact for the axes. */
static inline void sf_turn_to_z(const double up[3], double r[9]) {
    const double c = up[2], v[3] = {up[1], -up[0], 0}; /* up x z */
    if (c < -1 + 1e-12) {                              /* half a turn about x */
        const double half[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1};
        for (int k = 0; k < 9; k++)
            r[k] = half[k];
        return;
    }
    const double cross[9] = {0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double square = 0;
            for (int k = 0; k < 3; k++)
                square += cross[3 * i + k] * cross[3 * k + j];
            r[3 * i + j] = (i == j) + cross[3 * i + j] + square / (1 + c);
        }
}

/* v = r v, in place. */
static inline void sf_mat3_apply(const double r[9], double v[3]) {
    const double x[3] = {v[0], v[1], v[2]};
    for (int i = 0; i < 3; i++)
        v[i] = sf_dot3(&r[3 * i], x);
}

/* The symmetric tensor s (xx, yy, zz, xy, yz, xz) turned: r s r^T, in place. */
static inline void sf_sym3_turn(const double r[9], double s[6]) {
    static const int place[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2}, row[6] = {0, 1, 2, 0, 1, 0},
                     column[6] = {0, 1, 2, 1, 2, 2};
    double out[6];
    for (int k = 0; k < 6; k++) {
        out[k] = 0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                out[k] += r[3 * row[k] + i] * s[place[3 * i + j]] * r[3 * column[k] + j];
    }
    for (int k = 0; k < 6; k++)
        s[k] = out[k];
}

/* Rotations as unit quaternions (w, x, y, z): x_space = q x_body q*. */

/* `v` turned by q. */
static inline void sf_rotate(const double q[4], const double v[3], double out[3]) {
    double t[3], u[3];
    sf_cross3(&q[1], v, t);
    for (int k = 0; k < 3; k++)
        t[k] *= 2;
    sf_cross3(&q[1], t, u);
    for (int k = 0; k < 3; k++)
        out[k] = v[k] + q[0] * t[k] + u[k];
}

/* `v` turned by the inverse of q. */
static inline void sf_rotate_back(const double q[4], const double v[3], double out[3]) {
    const double inverse[4] = {q[0], -q[1], -q[2], -q[3]};
    sf_rotate(inverse, v, out);
}

/* q followed by the Cayley rotation of `turn`: about that vector, by 2 atan(|turn| / 2). */
static inline void sf_rotation_advance(const double q[4], const double turn[3], double out[4]) {
    const double half[3] = {0.5 * turn[0], 0.5 * turn[1], 0.5 * turn[2]};
    double p[4], square = 0;
    p[0] = q[0] - sf_dot3(half, &q[1]);
    sf_cross3(half, &q[1], &p[1]);
    for (int k = 1; k < 4; k++)
        p[k] += q[k] + q[0] * half[k - 1];
    for (int k = 0; k < 4; k++)
        square += p[k] * p[k];
    for (int k = 0; k < 4; k++)
        out[k] = p[k] / sqrt(square);
}

/* The rotation of a rigid body: angular momentum L in space, orientation q (base/mat3.h), and the inertia
 * tensor (kg m2, xx, yy, zz, xy, yz, xz) about the centre of mass in the body's axes. docs/adr/0018 */

/* omega = R I^-1 R^T L (rad s-1). */
void sf_rigid_angular_velocity(const double inertia[6], const double q[4], const double momentum[3],
                               double omega[3]);
/* R I^-1 R^T (kg-1 m-2), like the inertia. */
void sf_rigid_mobility(const double inertia[6], const double q[4], double mobility[6]);
/* A symmetric matrix times a vector: of an inertia I omega, both in the body's axes. */
void sf_rigid_product(const double matrix[6], const double v[3], double out[3]);

/* The turn (sf_rotation_advance), in space, of a body without torque in `dt` (s): the implicit midpoint rule
 * of Euler's equations, whose steps keep |L| and the kinetic energy. Second order, symmetric in time. */
void sf_rigid_turn(const double inertia[6], const double q[4], const double momentum[3], double dt,
                   double turn[3]);

/* The places of a triangle's nodes. */
static inline void sf_corners(const double *position, const int32_t node[3], const double *out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = &position[3 * (int64_t)node[k]];
}

/* Normal of a triangle, of twice its area; by its corners, or by their numbers. */
static inline void sf_triangle_normal(const double *a, const double *b, const double *c, double out[3]) {
    double u[3], v[3];
    sf_sub3(b, a, u);
    sf_sub3(c, a, v);
    sf_cross3(u, v, out);
}
/* The weights of a triangle's corners at a point of its plane, with its `normal` of twice its area. */
static inline void sf_triangle_weights(const double *const x[3], const double point[3],
                                       const double normal[3], double weight[3]) {
    double square = sf_dot3(normal, normal);
    for (int k = 0; k < 3; k++) {
        double from[3], along[3], moment[3];
        sf_sub3(point, x[(k + 1) % 3], from);
        sf_sub3(x[(k + 2) % 3], x[(k + 1) % 3], along);
        sf_cross3(along, from, moment);
        weight[k] = sf_dot3(moment, normal) / square;
    }
}
static inline void sf_face_normal(const double *position, const int32_t node[3], double out[3]) {
    const double *x[3];
    sf_corners(position, node, x);
    sf_triangle_normal(x[0], x[1], x[2], out);
}

/* Finds the point of a triangle that is nearest to x (Ericson 2005, section 5.1.5). `feature`: where it lies,
 * 0-2 vertex, 3-5 edge, 6 face. */
static inline void sf_triangle_nearest(const double *a, const double *b, const double *c, const double x[3],
                                       double out[3], int *feature) {
    double ab[3], ac[3], ap[3], bp[3], cp[3], s = 0, t = 0;
    sf_sub3(b, a, ab);
    sf_sub3(c, a, ac);
    sf_sub3(x, a, ap);
    sf_sub3(x, b, bp);
    sf_sub3(x, c, cp);
    double d1 = sf_dot3(ab, ap), d2 = sf_dot3(ac, ap), d3 = sf_dot3(ab, bp), d4 = sf_dot3(ac, bp),
           d5 = sf_dot3(ab, cp), d6 = sf_dot3(ac, cp);
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (d1 <= 0 && d2 <= 0) {
        *feature = 0;
    } else if (d3 >= 0 && d4 <= d3) {
        *feature = 1;
        s = 1;
    } else if (d6 >= 0 && d5 <= d6) {
        *feature = 2;
        t = 1;
    } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        *feature = 3;
        s = d1 / (d1 - d3);
    } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        *feature = 4;
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        s = 1 - t;
    } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        *feature = 5;
        t = d2 / (d2 - d6);
    } else {
        *feature = 6;
        s = vb / (va + vb + vc);
        t = vc / (va + vb + vc);
    }
    for (int k = 0; k < 3; k++)
        out[k] = a[k] + s * ab[k] + t * ac[k];
}
