/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Logarithm and exponential without branches or calls, for loops over lanes: they vectorise where those of
 * the C library do not, and have the same bits on every processor. Relative error below 1e-15. */
#ifndef SF_SOLVER_MATERIAL_LANE_MATH_H
#define SF_SOLVER_MATERIAL_LANE_MATH_H

#include <stdint.h>
#include <string.h>

static inline uint64_t sf_lane_bits(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}
static inline double sf_lane_double(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* ln 2 in two parts; the first has 32 bits. */
#define SF_LANE_LN2_HIGH 0x1.62e42feep-1
#define SF_LANE_LN2_LOW 0x1.a39ef35793c76p-33

/* Natural logarithm of a positive normal number: x = m 2^k with m in [0.7, 1.4], ln m = 2 artanh s. Anything
 * else gives a number that means nothing. */
static inline double sf_lane_log(double x) {
    const uint64_t start = 0x3fe6a09e00000000; /* sqrt(1/2) */
    uint64_t shifted = sf_lane_bits(x) - start;
    /* k + 2^52 as the mantissa of a number of that size; k may be negative */
    double k = sf_lane_double(((shifted >> 52) ^ 0x800) | 0x4330000000000000) - (0x1p52 + 0x800);
    double m = sf_lane_double((shifted & 0x000fffffffffffff) + start);
    double s = (m - 1) / (m + 1), z = s * s;
    double p = 2. / 21;
    p = p * z + 2. / 19;
    p = p * z + 2. / 17;
    p = p * z + 2. / 15;
    p = p * z + 2. / 13;
    p = p * z + 2. / 11;
    p = p * z + 2. / 9;
    p = p * z + 2. / 7;
    p = p * z + 2. / 5;
    p = p * z + 2. / 3;
    return k * SF_LANE_LN2_HIGH + (2 * s + (s * z * p + k * SF_LANE_LN2_LOW));
}

/* exp(x) - 1, and into `*rest` exp(x) - 1 - x; x beyond +-690 counts as that. */
static inline double sf_lane_expm1(double x, double *rest) {
    x = x < 690 ? x : 690;
    x = x > -690 ? x : -690;
    double shifted = x * 0x1.71547652b82fep+0 + 0x1.8p52, k = shifted - 0x1.8p52;
    double scale = sf_lane_double((sf_lane_bits(shifted) + 1023) << 52);
    double r = (x - k * SF_LANE_LN2_HIGH) - k * SF_LANE_LN2_LOW;
    double p = 1. / 87178291200; /* 1 / 14! */
    p = p * r + 1. / 6227020800;
    p = p * r + 1. / 479001600;
    p = p * r + 1. / 39916800;
    p = p * r + 1. / 3628800;
    p = p * r + 1. / 362880;
    p = p * r + 1. / 40320;
    p = p * r + 1. / 5040;
    p = p * r + 1. / 720;
    p = p * r + 1. / 120;
    p = p * r + 1. / 24;
    p = p * r + 1. / 6;
    p = p * r + 0.5;
    double near = p * r * r, all = scale * (near + r) + (scale - 1);
    *rest = k == 0 ? near : all - x;
    return all;
}

#endif
