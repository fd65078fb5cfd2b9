/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vector wrapper of the kernels: points in batches of SF_LANES, arrays [component][lane], loops over
 * lanes under `#pragma omp simd`. What is in such a loop may not branch: a choice is a conditional expression
 * of values that all exist. Sums over the neighbours of a node run over sf_vec instead. */
#ifndef SF_CORE_LANES_H
#define SF_CORE_LANES_H

enum { SF_LANES = 8 };

/* A vector of three components in one register; the fourth is spare. */
typedef double sf_vec __attribute__((vector_size(32)));

/* fmax and fmin without their call: the second argument where the comparison fails, so that a NaN in the
 * first gives the second, and a NaN in the second is kept. */
static inline double sf_larger(double a, double b) {
    return a > b ? a : b;
}
static inline double sf_smaller(double a, double b) {
    return a < b ? a : b;
}

#endif
