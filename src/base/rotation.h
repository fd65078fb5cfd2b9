/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rotations as unit quaternions (w, x, y, z): x_space = q x_body q*. */
#ifndef SF_CORE_ROTATION_H
#define SF_CORE_ROTATION_H

#include "base/mat3.h"

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

#endif
