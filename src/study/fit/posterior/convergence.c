/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/posterior/convergence.h"

#include <math.h>

/* The halves as chains of their own: value `k` of half `h`. */
typedef struct halves {
    int chains, count, stride;
    const double *x;
} halves;

static halves split(int chains, int count, const double *x) {
    return (halves){.chains = 2 * chains, .count = count / 2, .stride = count, .x = x};
}

static const double *half(const halves *s, int h) {
    return &s->x[h / 2 * s->stride + (h % 2 ? s->stride - s->count : 0)];
}

static double mean(const double *x, int count) {
    double sum = 0;
    for (int k = 0; k < count; k++)
        sum += x[k];
    return sum / count;
}

/* Autocovariance at a lag, divided by the whole number. */
static double autocovariance(const double *x, int count, int lag) {
    double about = mean(x, count), sum = 0;
    for (int k = 0; k + lag < count; k++)
        sum += (x[k] - about) * (x[k + lag] - about);
    return sum / count;
}

/* Variance within the halves, and the estimate of the whole variance. */
static void variances(const halves *s, double *within, double *whole) {
    double about = 0, between = 0;
    *within = 0;
    for (int h = 0; h < s->chains; h++)
        about += mean(half(s, h), s->count) / s->chains;
    for (int h = 0; h < s->chains; h++) {
        double m = mean(half(s, h), s->count);
        between += (m - about) * (m - about) / (s->chains - 1);
        *within += autocovariance(half(s, h), s->count, 0) * s->count / (s->count - 1) / s->chains;
    }
    *whole = *within * (s->count - 1) / s->count + between;
}

double sf_split_rhat(int chains, int count, const double *x) {
    halves s = split(chains, count, x);
    double within, whole;
    if (s.count < 2)
        return NAN;
    variances(&s, &within, &whole);
    if (within == 0)
        return whole == 0 ? 1 : INFINITY;
    return sqrt(whole / within);
}

/* Correlation at a lag over all halves. */
static double correlation(const halves *s, double within, double whole, int lag) {
    double sum = 0;
    for (int h = 0; h < s->chains; h++)
        sum += autocovariance(half(s, h), s->count, lag) * s->count / (s->count - 1) / s->chains;
    return 1 - (within - sum) / whole;
}

double sf_effective_size(int chains, int count, const double *x) {
    halves s = split(chains, count, x);
    double within, whole, all = (double)s.chains * s.count, last = INFINITY, sum = 0;
    if (!isfinite(sf_split_rhat(chains, count, x)))
        return 0;
    variances(&s, &within, &whole);
    if (within == 0)
        return all;
    for (int lag = 0; lag + 1 < s.count; lag += 2) {
        double pair =
            (lag == 0 ? 1 : correlation(&s, within, whole, lag)) + correlation(&s, within, whole, lag + 1);
        if (!(pair > 0))
            break;
        last = fmin(last, pair);
        sum += 2 * last;
    }
    return fmin(all / fmax(sum - 1, 1e-3), all * log10(all));
}
