/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/mat3.h"

enum { MOST_ITERATIONS = 20 };
static const double SETTLED = 4e-16; /* change of the momentum in an iteration, relative */

void sf_rigid_product(const double a[6], const double v[3], double out[3]) {
    double x = a[0] * v[0] + a[3] * v[1] + a[5] * v[2], y = a[3] * v[0] + a[1] * v[1] + a[4] * v[2],
           z = a[5] * v[0] + a[4] * v[1] + a[2] * v[2];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

static void invert(const double a[6], double inverse[6]) {
    double xx = a[1] * a[2] - a[4] * a[4], xy = a[4] * a[5] - a[3] * a[2], xz = a[3] * a[4] - a[1] * a[5],
           determinant = a[0] * xx + a[3] * xy + a[5] * xz;
    inverse[0] = xx / determinant;
    inverse[1] = (a[0] * a[2] - a[5] * a[5]) / determinant;
    inverse[2] = (a[0] * a[1] - a[3] * a[3]) / determinant;
    inverse[3] = xy / determinant;
    inverse[4] = (a[3] * a[5] - a[0] * a[4]) / determinant;
    inverse[5] = xz / determinant;
}

void sf_rigid_angular_velocity(const double inertia[6], const double q[4], const double momentum[3],
                               double omega[3]) {
    double inverse[6], body[3];
    invert(inertia, inverse);
    sf_rotate_back(q, momentum, body);
    sf_rigid_product(inverse, body, body);
    sf_rotate(q, body, omega);
}

void sf_rigid_mobility(const double inertia[6], const double q[4], double mobility[6]) {
    static const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double row[3][3];
    for (int k = 0; k < 3; k++)
        sf_rigid_angular_velocity(inertia, q, unit[k], row[k]);
    for (int k = 0; k < 3; k++) {
        mobility[k] = row[k][k];
        mobility[3 + k] = 0.5 * (row[k % 2][1 + (k > 0)] + row[1 + (k > 0)][k % 2]);
    }
}

/* x with m x = b, by cofactors. */
static void solve(const double m[3][3], const double b[3], double x[3]) {
    double c[3][3];
    for (int k = 0; k < 3; k++)
        sf_cross3(m[(k + 1) % 3], m[(k + 2) % 3], c[k]);
    double determinant = sf_dot3(m[0], c[0]);
    for (int r = 0; r < 3; r++)
        x[r] = (c[0][r] * b[0] + c[1][r] * b[1] + c[2][r] * b[2]) / determinant;
}

/* hat(a) v = a x v */
static void hat(const double a[3], double out[3][3]) {
    const double rows[3][3] = {{0, -a[2], a[1]}, {a[2], 0, -a[0]}, {-a[1], a[0], 0}};
    for (int k = 0; k < 9; k++)
        out[k / 3][k % 3] = rows[k / 3][k % 3];
}

/* One step of Newton's method for p' - p = dt P x I^-1 P, P = (p + p') / 2; p' in place. Returns the size of
 * its change. */
static double improve(const double inverse[6], const double p[3], double dt, double next[3],
                      double omega[3]) {
    double middle[3], rate[3], residual[3], change[3], matrix[3][3], of_p[3][3], of_omega[3][3];
    const double full[3][3] = {{inverse[0], inverse[3], inverse[5]},
                               {inverse[3], inverse[1], inverse[4]},
                               {inverse[5], inverse[4], inverse[2]}};
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (p[k] + next[k]);
    sf_rigid_product(inverse, middle, omega);
    sf_cross3(middle, omega, rate);
    hat(middle, of_p);
    hat(omega, of_omega);
    for (int r = 0; r < 3; r++) {
        residual[r] = next[r] - p[r] - dt * rate[r];
        for (int c = 0; c < 3; c++) {
            double slope = of_p[r][0] * full[0][c] + of_p[r][1] * full[1][c] + of_p[r][2] * full[2][c];
            matrix[r][c] = (r == c) - 0.5 * dt * (slope - of_omega[r][c]);
        }
    }
    solve(matrix, residual, change);
    for (int k = 0; k < 3; k++)
        next[k] -= change[k];
    return sqrt(sf_dot3(change, change));
}

void sf_rigid_turn(const double inertia[6], const double q[4], const double momentum[3], double dt,
                   double turn[3]) {
    double inverse[6], p[3], next[3], middle[3], omega[3];
    invert(inertia, inverse);
    sf_rotate_back(q, momentum, p);
    double size = sqrt(sf_dot3(p, p));
    for (int k = 0; k < 3; k++)
        next[k] = p[k];
    for (int i = 0; i < MOST_ITERATIONS; i++)
        if (!(improve(inverse, p, dt, next, omega) > SETTLED * size))
            break;
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (p[k] + next[k]);
    sf_rigid_product(inverse, middle, omega);
    sf_rotate(q, omega, turn);
    for (int k = 0; k < 3; k++)
        turn[k] *= dt;
}
