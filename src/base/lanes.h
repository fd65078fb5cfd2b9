/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vector wrapper of the kernels: points in batches of SF_LANES, arrays [component][lane], loops over
 * lanes under `#pragma omp simd`. Such a loop may not branch: a choice is a conditional expression whose
 * values are all computed. Sums over the neighbours of a node run over sf_vec instead. */
#ifndef SF_CORE_LANES_H
#define SF_CORE_LANES_H

#include <string.h>

enum { SF_LANES = 16 };

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

#endif
