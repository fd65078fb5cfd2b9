/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <omp.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* The vector wrapper of the kernels: points in batches of SF_LANES, arrays [component][lane], loops over
 * lanes under `#pragma omp simd` (SF_EACH_LANE). Such a loop may not branch: a choice is a conditional
 * expression whose values are all computed. Sums over the neighbours of a node run over sf_vec instead. */

enum { SF_LANES = 16 };
#define SF_EACH_LANE(l) _Pragma("omp simd") for (int l = 0; l < SF_LANES; l++)

/* Below these sizes a loop runs on one thread: waking a thread takes about 50 us on a virtual machine. They
 * apply to loops with little work per node, and to loops over rows or contact points. A build with
 * SOFTFALL_THREADS_ALWAYS uses threads in every loop, so that analyses and tests with small models cover
 * them. */
#ifdef SF_THREADS_ALWAYS
enum { SF_FEW_NODES = 0, SF_FEW_POINTS = 0 };
#else
enum { SF_FEW_NODES = 50000, SF_FEW_POINTS = 3000 };
#endif

/* Calls a function whose loops are `omp for`, by all threads where that is `worth` it. One thread runs it
 * without a team: each barrier of a team is a system call in libgomp, even of a team of one, and the step of
 * a section has 17 of them. Drops side by side are in a parallel region already, if only of one
 * thread, and need teams of their own: such a loop would be one of that region. */
#define SF_BY_ALL_THREADS(worth, call)                                                                       \
    do {                                                                                                     \
        const bool many = worth;                                                                             \
        if (omp_get_max_threads() > 1 || omp_get_level() > 0) {                                              \
            _Pragma("omp parallel if (many)") call;                                                          \
        } else                                                                                               \
            call;                                                                                            \
    } while (0)

/* A kernel is compiled for three levels of the processor, with all functions of its file that it calls; the
 * program selects the best level at its start. The levels differ in the width of the vectors only: nothing is
 * fused or reordered, so that all give the same bits. Arguments and results of kernels are pointers and
 * scalars, since vectors are passed differently at different levels. SF_DISPATCH: set by the build. */
#ifdef SF_DISPATCH
#define SF_KERNEL __attribute__((flatten, target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SF_KERNEL
#endif

/* A vector of three components in one register; the fourth is spare. */
typedef double sf_vec __attribute__((vector_size(32)));

static inline sf_vec sf_vec_load(const double x[3]) {
    return (sf_vec){x[0], x[1], x[2]};
}

/* The columns of a row-major 3 x 3 matrix, by three overlapping reads. */
static inline void sf_vec_columns(const double f[9], sf_vec column[3]) {
    sf_vec a, b, c;
    memcpy(&a, &f[0], sizeof a);
    memcpy(&b, &f[1], sizeof b);
    memcpy(&c, &f[5], sizeof c);
    column[0] = __builtin_shufflevector(a, c, 0, 3, 5, 5);
    column[1] = __builtin_shufflevector(b, c, 0, 3, 6, 6);
    column[2] = __builtin_shufflevector(a, c, 2, 4, 7, 7);
}

/* fmax and fmin without their call: the second argument where the comparison fails, so that a NaN in the
 * first gives the second, and a NaN in the second is kept. */
static inline double sf_larger(double a, double b) {
    return a > b ? a : b;
}
static inline double sf_smaller(double a, double b) {
    return a < b ? a : b;
}

/* Logarithm and exponential without branches or calls, for loops over lanes: they vectorise where those of
 * the C library do not, and have the same bits on every processor. Relative error below 1e-15. */

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
