/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/mls.h"

#include <math.h>

double sf_mls_weight(double q) {
    if (q >= 1)
        return 0;
    if (q <= 0.5)
        return 2.0 / 3 - 4 * q * q + 4 * q * q * q;
    double r = 1 - q;
    return 4.0 / 3 * r * r * r;
}

/* Inverse of a symmetric positive definite 4 x 4 matrix by Cholesky; -1 if it is not. */
static int invert4(const double m[4][4], double inverse[4][4]) {
    double l[4][4] = {{0}}, k[4][4] = {{0}}; /* M = L Lt, K = inverse of L */
    for (int i = 0; i < 4; i++)
        for (int j = 0; j <= i; j++) {
            double sum = m[i][j];
            for (int p = 0; p < j; p++)
                sum -= l[i][p] * l[j][p];
            if (i == j) {
                if (!(sum > 1e-14 * m[i][i]))
                    return -1;
                l[i][i] = sqrt(sum);
            } else {
                l[i][j] = sum / l[j][j];
            }
        }
    for (int j = 0; j < 4; j++)
        for (int i = j; i < 4; i++) {
            double sum = i == j;
            for (int p = j; p < i; p++)
                sum -= l[i][p] * k[p][j];
            k[i][j] = sum / l[i][i];
        }
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            inverse[i][j] = 0;
            for (int p = i > j ? i : j; p < 4; p++)
                inverse[i][j] += k[p][i] * k[p][j];
        }
    return 0;
}

static double norm1(const double m[4][4]) {
    double largest = 0;
    for (int j = 0; j < 4; j++) {
        double sum = 0;
        for (int i = 0; i < 4; i++)
            sum += fabs(m[i][j]);
        largest = fmax(largest, sum);
    }
    return largest;
}

int sf_mls_evaluate(const sf_mls_cloud *cloud, const double x[3], int64_t count, const int32_t *candidate,
                    sf_mls_point *out) {
    double basis[SF_MLS_MAX_NODES][4], moment[4][4] = {{0}}, inverse[4][4], scale = 0;
    out->count = 0;
    out->condition = INFINITY;
    for (int64_t k = 0; k < count; k++) {
        int32_t node = candidate[k];
        const double *p = &cloud->position[3 * node];
        double r[3] = {p[0] - x[0], p[1] - x[1], p[2] - x[2]}, radius = cloud->support[node];
        double weight = sf_mls_weight(sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]) / radius);
        if (weight <= 0)
            continue;
        if (out->count == SF_MLS_MAX_NODES)
            return -1;
        scale = fmax(scale, radius);
        out->node[out->count] = node;
        out->value[out->count] = weight;
        basis[out->count][0] = 1;
        for (int c = 0; c < 3; c++)
            basis[out->count][c + 1] = r[c];
        out->count++;
    }
    if (out->count < 4)
        return -1;
    for (int k = 0; k < out->count; k++) {
        for (int c = 1; c < 4; c++)
            basis[k][c] /= scale;
        for (int i = 0; i < 4; i++)
            for (int j = 0; j <= i; j++)
                moment[i][j] += out->value[k] * basis[k][i] * basis[k][j];
    }
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++)
            moment[i][j] = moment[j][i];
    if (invert4(moment, inverse) != 0)
        return -1;
    out->condition = norm1(moment) * norm1(inverse);
    for (int k = 0; k < out->count; k++) {
        double sum = 0;
        for (int i = 0; i < 4; i++)
            sum += inverse[0][i] * basis[k][i];
        out->value[k] *= sum;
    }
    return 0;
}
