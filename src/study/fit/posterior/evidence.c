/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/posterior/evidence.h"

#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>

double sf_log_mean(int count, const double *x) {
    double largest = -INFINITY, sum = 0;
    for (int k = 0; k < count; k++)
        largest = fmax(largest, x[k]);
    if (!isfinite(largest))
        return largest;
    for (int k = 0; k < count; k++)
        sum += exp(x[k] - largest);
    return largest + log(sum / count);
}

/* (sum w)^2 / sum w^2. */
static double effective_size(int count, const double *x) {
    double largest = -INFINITY, sum = 0, squares = 0;
    for (int k = 0; k < count; k++)
        largest = fmax(largest, x[k]);
    for (int k = 0; k < count && isfinite(largest); k++) {
        sum += exp(x[k] - largest);
        squares += exp(2 * (x[k] - largest));
    }
    return squares > 0 ? sum * sum / squares : 0;
}

sf_status sf_evidence_estimate(const sf_target *target, const sf_mixture *mixture, int draws, uint64_t seed,
                               sf_evidence *e, sf_error *err) {
    int n = target->parameters;
    *e = (sf_evidence){.draws = draws};
    double *u = sf_alloc(err, (unsigned long)(draws * n), sizeof *u, "draws"),
           *weight = sf_alloc(err, (unsigned long)draws, sizeof *weight, "draws");
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    if (!random)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a random generator");
    if (err->status == SF_OK) {
        gsl_rng_set(random, (unsigned long)sf_seed_of(seed, 0) & 0xffffffffu);
        for (int k = 0; k < draws; k++)
            sf_mixture_draw(mixture, random, &u[k * n]);
#pragma omp parallel for schedule(dynamic, 8)
        for (int k = 0; k < draws; k++)
            weight[k] = sf_target_at(target, &u[k * n]) - sf_mixture_log_density(mixture, &u[k * n]);
        e->log_value = sf_log_mean(draws, weight);
        e->effective = effective_size(draws, weight);
        e->error = e->effective > 0 ? sqrt(fmax(0, 1 / e->effective - 1. / draws)) : INFINITY;
        e->trusted = e->effective >= 100 && e->effective >= draws / 50.;
    }
    if (random)
        gsl_rng_free(random);
    free(u);
    free(weight);
    return err->status;
}

/* ---- Pareto smoothing ---- */

/* Shape and scale of a generalised Pareto distribution for ascending x [count] > 0: the mean of the profile
 * likelihood's b over a grid, with the weakly informative prior of the reference (k drawn to 0.5 by ten
 * observations). */
static double fit_tail(int count, const double *x, double *scale) {
    enum { MOST = 200 };
    int grid = 30 + (int)sqrt(count);
    double b[MOST], likelihood[MOST], largest = -INFINITY, sum = 0, mean = 0,
                                      quartile = x[(count + 2) / 4 - 1];
    grid = grid > MOST ? MOST : grid;
    for (int j = 0; j < grid; j++) {
        double k = 0;
        b[j] = 1 / x[count - 1] + (1 - sqrt(grid / (j + 0.5))) / (3 * quartile);
        for (int i = 0; i < count; i++)
            k += log1p(-b[j] * x[i]) / count;
        likelihood[j] = count * (log(-b[j] / k) - k - 1);
        largest = fmax(largest, likelihood[j]);
    }
    for (int j = 0; j < grid; j++) {
        double w = exp(likelihood[j] - largest);
        sum += w;
        mean += w * b[j];
    }
    double shape = 0;
    mean /= sum;
    for (int i = 0; i < count; i++)
        shape += log1p(-mean * x[i]) / count;
    *scale = -shape / mean;
    return (count * shape + 10 * 0.5) / (count + 10.);
}

static double quantile(double shape, double scale, double p) {
    return fabs(shape) < 1e-9 ? -scale * log1p(-p) : scale * expm1(-shape * log1p(-p)) / shape;
}

double sf_pareto_smooth(int count, double *weight, sf_error *err) {
    enum { LEAST = 5 };
    int tail = (int)fmin(0.2 * count, 3 * sqrt(count));
    if (tail < LEAST)
        return INFINITY;
    size_t *order = sf_alloc(err, (unsigned long)count, sizeof *order, "weights");
    double *x = sf_alloc(err, (unsigned long)tail, sizeof *x, "weights"), shape = INFINITY, scale;
    if (order && x) {
        gsl_sort_index(order, weight, 1, (size_t)count);
        double largest = weight[order[count - 1]], cut = exp(weight[order[count - tail - 1]] - largest);
        for (int k = 0; k < tail; k++)
            x[k] = exp(weight[order[count - tail + k]] - largest) - cut;
        if (x[tail - 1] - x[0] < 1e-12) {
            shape = -INFINITY; /* all alike: nothing to smooth */
        } else {
            for (int k = 0; k < tail; k++) /* ties with the cut */
                x[k] = fmax(x[k], 1e-15);
            shape = fit_tail(tail, x, &scale);
            for (int k = 0; k < tail && isfinite(shape); k++)
                weight[order[count - tail + k]] =
                    largest + fmin(0, log(cut + quantile(shape, scale, (k + 0.5) / tail)));
            if (!isfinite(shape))
                shape = INFINITY;
        }
    }
    free(order);
    free(x);
    return shape;
}
