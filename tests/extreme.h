/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Largest and smallest value of a loop in tests and studies. fmax and fmin drop a NaN, so that `worst =
 * fmax(worst, fabs(error))` passes when every error is NaN; these keep it, and a NaN meets no bound. The test
 * `extremes` refuses the other form. */
#ifndef SF_TESTS_EXTREME_H
#define SF_TESTS_EXTREME_H

#include <math.h>
#include <stdint.h>

static inline double larger(double a, double b) {
    return isnan(a) || isnan(b) ? NAN : fmax(a, b);
}

static inline double smaller(double a, double b) {
    return isnan(a) || isnan(b) ? NAN : fmin(a, b);
}

/* Largest absolute value of a list. */
static inline double largest_of(const double *a, int64_t count) {
    double value = 0;
    for (int64_t k = 0; k < count; k++)
        value = larger(value, fabs(a[k]));
    return value;
}

#endif
